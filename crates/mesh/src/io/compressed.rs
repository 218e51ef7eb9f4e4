//! Files compressed with gzip: `mesh.obj.gz` is read as `mesh.obj`.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use super::MeshFormat;

/// The extension of a compressed file.
const EXTENSION: &str = "gz";

impl MeshFormat {
    /// The format of a file to read: the extension in front of `.gz` counts, in whatever case.
    ///
    /// ```
    /// # use abf_mesh::io::MeshFormat;
    /// # use std::path::Path;
    /// assert_eq!(MeshFormat::of_input(Path::new("cow.obj.gz")), Some(MeshFormat::Obj));
    /// ```
    #[must_use]
    pub fn of_input(path: &Path) -> Option<Self> {
        if is_compressed(path) { Self::from_path(Path::new(path.file_stem()?)) } else { Self::from_path(path) }
    }
}

fn is_compressed(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
}

/// The bytes of a file, decompressed where its name ends in `.gz`.
///
/// # Errors
/// Those of the file system, and those of a damaged or truncated stream.
pub fn read_bytes(path: &Path) -> io::Result<Vec<u8>> {
    if !is_compressed(path) {
        return std::fs::read(path);
    }
    let mut bytes = Vec::new();
    MultiGzDecoder::new(BufReader::new(File::open(path)?)).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use crate::io::{ObjDocument, ReadError, read};
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use std::io::Write;

    const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    fn compressed(text: &str) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(text.as_bytes()).expect("memory");
        encoder.finish().expect("memory")
    }

    #[test]
    fn a_compressed_file_means_the_same_as_the_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("triangle.OBJ.Gz");
        // Two streams, one after the other, are one file.
        let (head, tail) = TRIANGLE.split_at(11);
        std::fs::write(&path, [compressed(head), compressed(tail)].concat()).expect("written");
        let file = read(&path).expect("a readable file");
        assert_eq!((file.mesh.vertex_count(), file.mesh.face_count()), (3, 1));
        assert_eq!(ObjDocument::read(&path).expect("a readable file").file(), &file);
    }

    #[test]
    fn a_truncated_or_mistaken_stream_is_an_error() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("triangle.obj.gz");
        let whole = compressed(TRIANGLE);
        for bytes in [&whole[..whole.len() - 9], TRIANGLE.as_bytes(), b""] {
            std::fs::write(&path, bytes).expect("written");
            assert!(matches!(read(&path), Err(ReadError::Open { .. })), "{} bytes", bytes.len());
        }
    }
}
