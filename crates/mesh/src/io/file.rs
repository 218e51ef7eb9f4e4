//! Files that are written whole, or not at all.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes a temporary file beside `path`, then renames it: what stood there before stays until the new
/// file is complete. A symbolic link stays one, and what it points to is replaced; a pipe or a device
/// (`/dev/stdout`) is written to as it is.
///
/// # Errors
/// When the system refuses, or `fill` does; no temporary file is left.
pub fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let path = destination(path)?;
    if std::fs::metadata(&path).is_ok_and(|found| !found.is_file()) {
        let mut out = BufWriter::new(std::fs::OpenOptions::new().write(true).open(&path)?);
        return fill(&mut out).and_then(|()| out.flush());
    }
    let mut file = temporary_beside(&path)?;
    let mut out = BufWriter::new(file.as_file_mut());
    fill(&mut out)?;
    out.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
    file.persist(&path).map(drop).map_err(|e| e.error)
}

/// Finds out whether [`replace`] could write there, and changes nothing: for programs that have work to do
/// before they write. A pipe is not opened, because that would wait for its reader.
///
/// # Errors
/// What the system would say to `replace`, but for what can be known only by writing, such as a full disk.
pub fn check_replaceable(path: &Path) -> io::Result<()> {
    let path = destination(path)?;
    match std::fs::metadata(&path) {
        Ok(found) if found.is_dir() => std::fs::OpenOptions::new().write(true).open(&path).map(drop),
        Ok(found) if !found.is_file() => Ok(()),
        _ => temporary_beside(&path).map(drop),
    }
}

/// The file that a path leads to, whether it exists or not; pipes and devices by the name they have.
fn destination(path: &Path) -> io::Result<PathBuf> {
    /// As many links after each other as Linux follows.
    const LINKS: usize = 40;
    match std::fs::metadata(path) {
        Ok(found) if found.is_file() => return path.canonicalize(),
        Ok(_) => return Ok(path.to_owned()),
        Err(_) => {}
    }
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        match std::fs::read_link(&path) {
            // An absolute target replaces the whole.
            Ok(target) => path = folder_of(&path).join(target),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

/// The folder of a file.
pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn temporary_beside(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".abf-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Temporary files are private unless told; the mask of the process still applies.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder_of(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_other() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.obj");
        std::fs::write(&path, "old").expect("written");
        let fail = |out: &mut dyn Write| out.write_all(b"half").and(Err(io::Error::other("no room")));
        assert_eq!(replace(&path, fail).unwrap_err().to_string(), "no room");
        assert_eq!(std::fs::read_to_string(&path).expect("read"), "old");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_also_to_a_file_that_is_not_there_yet() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("inner")).expect("a folder");
        std::os::unix::fs::symlink("second", at("first")).expect("a link");
        std::os::unix::fs::symlink("inner/file", at("second")).expect("a link");
        for text in ["new", "newer"] {
            replace(&at("first"), |out| out.write_all(text.as_bytes())).expect("written");
            assert_eq!(std::fs::read_to_string(at("inner/file")).expect("read"), text);
        }
        assert!(at("first").is_symlink() && at("second").is_symlink());
        std::os::unix::fs::symlink("round", at("round")).expect("a link");
        assert!(replace(&at("round"), |_| Ok(())).is_err());
    }

    #[test]
    fn what_cannot_be_replaced_is_known_before_and_nothing_is_changed() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.obj");
        std::fs::write(&path, "old").expect("written");
        check_replaceable(&path).expect("it can");
        check_replaceable(&folder.path().join("b.obj")).expect("it can");
        assert_eq!(check_replaceable(&folder.path().join("no/b.obj")).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert!(check_replaceable(folder.path()).is_err());
        assert_eq!(std::fs::read_to_string(&path).expect("read"), "old");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error() {
        let full = Path::new("/dev/full");
        check_replaceable(full).expect("a device");
        let e = replace(full, |out| out.write_all(&[0; 100_000])).unwrap_err();
        assert_eq!(e.kind(), io::ErrorKind::StorageFull);
        assert_eq!(
            replace(full, |out| out.write_all(b"less than a buffer")).unwrap_err().kind(),
            io::ErrorKind::StorageFull
        );
    }
}
