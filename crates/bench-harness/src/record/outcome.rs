//! How it went.

use super::kind::FailureKind;

/// How it went, from good to bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Outcome {
    /// As asked, and valid.
    AsAsked,
    /// There is a result, but not converged or not valid; or the user stopped it.
    NotAsAsked,
    /// No result, or a file that could not be written.
    Failed,
}

impl Outcome {
    /// The exit code of the program.
    pub(crate) fn exit_code(self) -> u8 {
        match self {
            Self::AsAsked => 0,
            Self::NotAsAsked => 1,
            Self::Failed => 2,
        }
    }
}

/// One word, or two, on a result of which this is known.
pub(crate) fn result_word(error: Option<FailureKind>, termination: Option<&str>, valid: bool) -> String {
    match (error, termination, valid) {
        (Some(kind), ..) => format!("error: {kind}"),
        (None, Some(word), true) => word.to_owned(),
        (None, Some(word), false) => format!("{word}, not valid"),
        (None, None, true) => "valid".to_owned(),
        (None, None, false) => "not valid".to_owned(),
    }
}
