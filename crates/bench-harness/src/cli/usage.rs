//! Usage errors.

use clap::error::ErrorKind;

/// A usage error, without the usage of the command that it is of: [`super::program::exit`] adds that.
pub(crate) fn usage(kind: ErrorKind, message: impl std::fmt::Display) -> clap::Error {
    clap::Error::raw(kind, format!("{message}\n"))
}
