//! The material libraries that an OBJ names, read with `tobj`.

use std::io;
use std::path::{Path, PathBuf};

pub use tobj::Material;

/// The materials of an OBJ, and what was not read of them.
#[derive(Clone, Debug, Default)]
pub struct Materials {
    /// The materials, in the order of the libraries.
    pub materials: Vec<Material>,
    /// What is missing or was left alone.
    pub notes: Vec<MaterialNote>,
}

/// Something about a material library that is worth saying but stops nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MaterialNote {
    /// The library cannot be opened.
    #[error("{}: the material library cannot be read: {cause}", path.display())]
    Missing {
        /// Where it should be.
        path: PathBuf,
        /// What the system says.
        cause: io::ErrorKind,
    },
    /// The library makes no sense.
    #[error("{}: the material library cannot be understood: {reason}", path.display())]
    Unreadable {
        /// The library.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A colour that is not three numbers (a spectrum, say).
    #[error("{}, line {line}: the colour is not three numbers and is not read", path.display())]
    ColourSkipped {
        /// The library.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
    },
}

/// Reads the material libraries that an OBJ file names, see
/// [`ReadNotes::material_libraries`](super::ReadNotes::material_libraries).
///
/// A library is looked for next to the file. A name with blanks is tried as one name, then as
/// several. Nothing here is an error, because no mesh depends on it; see [`Materials::notes`].
#[must_use]
pub fn load_materials(obj: &Path, libraries: &[String]) -> Materials {
    let folder = obj.parent().unwrap_or(Path::new(""));
    let mut out = Materials::default();
    for name in libraries {
        let whole = folder.join(name);
        if whole.is_file() || !name.contains(char::is_whitespace) {
            load(whole, &mut out);
        } else {
            name.split_whitespace().for_each(|name| load(folder.join(name), &mut out));
        }
    }
    out
}

fn load(path: PathBuf, out: &mut Materials) {
    let bytes = match std::fs::read(&path) {
        Ok(bytes) => bytes,
        Err(cause) => return out.notes.push(MaterialNote::Missing { path, cause: cause.kind() }),
    };
    let Materials { materials, notes } = parse_materials(&path, &bytes);
    out.materials.extend(materials);
    out.notes.extend(notes);
}

/// Reads a material library from the bytes of its file. The path serves the notes only.
#[must_use]
pub fn parse_materials(path: &Path, bytes: &[u8]) -> Materials {
    let mut out = Materials::default();
    let text = readable_lines(path, &String::from_utf8_lossy(bytes), &mut out.notes);
    match tobj::load_mtl_buf(&mut text.as_bytes()) {
        Ok((materials, _)) => out.materials = materials,
        Err(e) => out.notes.push(MaterialNote::Unreadable { path: path.to_owned(), reason: e.to_string() }),
    }
    out
}

/// The text without the colours that `tobj` would give up the whole library (or panic) for.
fn readable_lines(path: &Path, text: &str, notes: &mut Vec<MaterialNote>) -> String {
    let mut out = String::with_capacity(text.len());
    for (i, line) in text.lines().enumerate() {
        if is_bad_colour(line) {
            notes.push(MaterialNote::ColourSkipped { path: path.to_owned(), line: i + 1 });
        } else {
            out.push_str(line);
            out.push('\n');
        }
    }
    out
}

fn is_bad_colour(line: &str) -> bool {
    const COLOURS: [&str; 4] = ["Ka", "Kd", "Ks", "Ke"];
    let mut words = line.split_whitespace();
    let is_colour = words.next().is_some_and(|keyword| COLOURS.contains(&keyword));
    is_colour && words.take(3).filter(|word| word.parse::<f64>().is_ok()).count() < 3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_are_read_and_what_is_missing_is_noted() {
        let folder = tempfile::tempdir().expect("a folder");
        let library = "newmtl red\nKd 1 0 0\nKs spectral x.rfl\nKa 0.5\nmap_Kd red.png\nnewmtl blue\nKd 0 0 1\n";
        std::fs::write(folder.path().join("a b.mtl"), library).expect("written");
        std::fs::write(folder.path().join("bad.mtl"), "newmtl x\nNs many\n").expect("written");
        let names = ["a b.mtl", "none.mtl bad.mtl"].map(str::to_owned);
        let read = load_materials(&folder.path().join("cow.obj"), &names);
        assert_eq!(read.materials.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["red", "blue"]);
        assert_eq!(read.materials[0].diffuse, Some([1.0, 0.0, 0.0]));
        assert_eq!(read.materials[0].diffuse_texture.as_deref(), Some("red.png"));
        let path = |name| folder.path().join(name);
        assert_eq!(
            read.notes,
            [
                MaterialNote::ColourSkipped { path: path("a b.mtl"), line: 3 },
                MaterialNote::ColourSkipped { path: path("a b.mtl"), line: 4 },
                MaterialNote::Missing { path: path("none.mtl"), cause: io::ErrorKind::NotFound },
                MaterialNote::Unreadable { path: path("bad.mtl"), reason: "material parse error".to_owned() },
            ]
        );
    }
}
