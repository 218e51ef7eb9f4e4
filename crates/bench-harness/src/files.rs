//! Writing files whole or not at all.

use crate::errors::Failure;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

/// Writes a file under a temporary name in the same folder and renames it when it is complete.
///
/// # Errors
/// When the system refuses; what stood under that name before is then still there.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    try_replace(path, bytes).map_err(|error| Failure::unwritable(&path.display().to_string(), &error))
}

fn try_replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match fs::metadata(path) {
        // A pipe or a device (`/dev/null`) is written to; a rename would put a file in its place.
        Ok(found) if !found.is_file() => fs::OpenOptions::new().write(true).open(path)?.write_all(bytes),
        // A link stays one: what it points to is replaced.
        Ok(_) => rename_into_place(&path.canonicalize()?, bytes),
        Err(_) => rename_into_place(path, bytes),
    }
}

fn rename_into_place(path: &Path, bytes: &[u8]) -> io::Result<()> {
    abf_mesh::io::replace(path, |out| out.write_all(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.json");
        for text in ["first, and longer", "second"] {
            replace(&path, text.as_bytes()).expect("written");
            assert_eq!(fs::read_to_string(&path).expect("read"), text);
        }
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }

    #[test]
    fn a_folder_cannot_be_replaced_by_a_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let failure = replace(folder.path(), b"text").unwrap_err();
        assert!(failure.message.contains(&folder.path().display().to_string()), "{}", failure.message);
    }
}
