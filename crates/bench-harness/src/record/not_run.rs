//! Solvers that were left out.

/// Why a solver was not run on a mesh.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(crate) struct NotRun {
    /// A word or two for tables and programs.
    pub(crate) kind: &'static str,
    /// The whole sentence.
    pub(crate) message: String,
}
