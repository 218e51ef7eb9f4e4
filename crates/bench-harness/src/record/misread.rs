//! Values of options that cannot be read.

/// A value that is not what an option takes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("must be {allowed}, got '{given}'")]
pub(crate) struct Misread {
    /// What it may be.
    allowed: String,
    /// What was typed.
    given: String,
}

impl Misread {
    pub(crate) fn new(allowed: impl Into<String>, given: &str) -> Self {
        Self { allowed: allowed.into(), given: given.to_owned() }
    }
}
