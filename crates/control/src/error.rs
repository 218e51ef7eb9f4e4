//! The errors that every crate shares.

use std::fmt;
use strum::VariantNames;

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

/// A name that is none of the known ones.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {what} '{given}'; there are: {}", known.join(", "))]
#[non_exhaustive]
pub struct UnknownName {
    /// What it should have named, in the singular.
    pub what: &'static str,
    /// The name that was given.
    pub given: String,
    /// All names there are, in the order of the documentation.
    pub known: &'static [&'static str],
}

impl UnknownName {
    /// `given` names no variant of `T`.
    #[must_use]
    pub fn of<T: VariantNames>(what: &'static str, given: &str) -> Self {
        Self::new(what, given, T::VARIANTS)
    }

    /// `given` is none of the names in `known`.
    #[must_use]
    pub fn new(what: &'static str, given: &str, known: &'static [&'static str]) -> Self {
        Self { what, given: given.to_owned(), known }
    }
}

/// The observer aborted the run with [`Verdict::Abort`](crate::Verdict::Abort); there is no result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, thiserror::Error)]
#[error("cancelled before there was a result")]
pub struct Cancelled;
