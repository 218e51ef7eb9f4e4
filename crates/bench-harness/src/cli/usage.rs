//! Usage errors.

use super::args::Args;
use clap::error::ErrorKind;

/// A usage error.
pub(crate) fn usage(kind: ErrorKind, message: impl std::fmt::Display) -> clap::Error {
    use clap::CommandFactory;
    Args::command().error(kind, message)
}
