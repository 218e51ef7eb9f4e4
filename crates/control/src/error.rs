//! The errors that every crate shares.

use std::fmt;

/// A setting outside its range.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name} must be {allowed}, got {value}")]
#[non_exhaustive]
pub struct SettingError {
    /// Which setting. It is called as the option of the program is, with `_` for `-`.
    pub name: &'static str,
    /// What it may be.
    pub allowed: &'static str,
    /// What it was.
    pub value: String,
}

impl SettingError {
    /// The setting `name` must be `allowed` and was `value`.
    #[must_use]
    pub fn new(name: &'static str, allowed: &'static str, value: impl fmt::Display) -> Self {
        Self { name, allowed, value: value.to_string() }
    }
}

/// The observer aborted the run with [`Verdict::Abort`](crate::Verdict::Abort); there is no result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, thiserror::Error)]
#[error("cancelled before there was a result")]
pub struct Cancelled;
