//! What people see: tables, advice, and files written whole.

pub(crate) mod advice;
pub(crate) mod console;
pub(crate) mod errors;
pub(crate) mod files;
pub(crate) mod findings;
pub(crate) mod history;
pub(crate) mod table;

use crate::cli::targets::JsonTarget;
use crate::record::failure::Failure;

/// Shows a table and, if asked for, JSON.
///
/// # Errors
/// When a stream or file cannot be written; the other is then tried all the same.
pub(crate) fn show(table: &str, json: impl Fn() -> String, target: Option<&JsonTarget>) -> Result<(), Failure> {
    match target {
        None => console::data(table),
        Some(JsonTarget::Stdout) => {
            console::words(table);
            console::data(&json())
        }
        Some(JsonTarget::File(path)) => {
            let printed = console::data(table);
            files::replace(path, json().as_bytes()).and(printed)
        }
    }
}
