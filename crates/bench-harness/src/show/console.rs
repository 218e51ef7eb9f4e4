//! The only module that prints: data on stdout, words on stderr.
//!
//! A reader that went away (`| head`) is no error: there is nobody left to tell.

use crate::record::failure::Failure;
use std::io::{self, ErrorKind, Write};

/// Prints data on stdout.
///
/// # Errors
/// When stdout cannot be written, unless its reader has closed it.
pub(crate) fn data(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::unwritable("stdout", &error)),
        _ => Ok(()),
    }
}

/// Prints words on stderr, if it can be.
pub(crate) fn words(text: &str) {
    // A program cannot complain that complaining failed.
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Says something worth knowing about a mesh.
pub(crate) fn note(mesh: &str, text: &str) {
    words(&format!("note: {mesh}: {text}\n"));
}

/// Says what to try next for a mesh.
pub(crate) fn hint(mesh: &str, text: &str) {
    words(&format!("hint: {mesh}: {text}\n"));
}

/// Says what went wrong and what to try next.
pub(crate) fn failure(failure: &Failure) {
    words(&format!("error: {}\n  hint: {}\n", failure.message, failure.hint));
}
