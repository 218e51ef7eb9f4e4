//! Solvers that were left out.

use super::kind::NotRunKind;
use serde::{Deserialize, Serialize};

/// Why a solver was not run on a mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct NotRun {
    /// A word or two for tables and programs.
    pub(crate) kind: NotRunKind,
    /// The whole sentence.
    pub(crate) message: String,
}
