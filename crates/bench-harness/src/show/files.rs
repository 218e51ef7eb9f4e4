//! Writing files whole or not at all.

use crate::record::failure::Failure;
use crate::show::console;
use std::path::Path;

/// Writes a file under a temporary name in the same folder and renames it when it is complete; see
/// [`abf_mesh::io::replace`].
///
/// # Errors
/// When the system refuses; what stood under that name before is then still there.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let written = abf_mesh::io::replace(path, |out| out.write_all(bytes));
    written.map_err(|error| unwritable(path, &error))
}

/// Checks before any work is done that files can be written where they are asked for. Says what is wrong
/// with every one that cannot.
///
/// # Errors
/// The last failure, which is not yet said.
pub(crate) fn check<'a>(targets: impl IntoIterator<Item = Option<&'a Path>>) -> Result<(), Failure> {
    let check = |path: &Path| abf_mesh::io::check_replaceable(path).map_err(|error| unwritable(path, &error));
    let mut failures = targets.into_iter().flatten().filter_map(|path| check(path).err());
    let Some(mut last) = failures.next() else { return Ok(()) };
    for failure in failures {
        console::failure(&std::mem::replace(&mut last, failure));
    }
    Err(last)
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::unwritable(&path.display().to_string(), error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

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
