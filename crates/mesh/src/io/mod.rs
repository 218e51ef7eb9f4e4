//! Reading and writing mesh files: the only place in the workspace that touches files of geometry.
//!
//! | format | read | written |
//! | --- | --- | --- |
//! | glTF (`.gltf`, `.glb`) | all primitives of triangles, vertices welded by exact position, `TEXCOORD_0` | yes, in 32 bits |
//! | OBJ | polygons, negative indices, UVs per corner | yes |
//! | OFF | text, with normals, colours or UVs per vertex | no |
//! | PLY | text and both binary byte orders, UVs per vertex or per corner | binary, little endian |
//! | STL | text and binary, vertices welded by exact position | no |
//!
//! Two formats can be written as they were, with everything a mesh has no place for, and new UVs: [`GltfDocument`],
//! [`ObjDocument`].
//!
//! A reader keeps every vertex (but glTF those that a triangle uses), in the order of the file, and every face; it judges neither
//! topology nor shape. Polygons are cut into triangles inside their outline:
//! into a fan from their first corner wherever that does not fold. Reading never repairs
//! silently: whatever was done or left alone is counted in the [`ReadNotes`] next to the mesh.
//! Whatever cannot be read is a [`ReadError`] that names the file and the line or byte; no input
//! causes a panic, and no memory is taken on the word of a header.

mod compressed;
mod error;
mod gather;
mod gltf;
mod materials;
mod notes;
mod obj;
mod off;
mod ply;
mod polygon;
mod stl;
mod text;
mod write;

use std::io::ErrorKind;
use std::path::Path;
use std::str::FromStr;

pub use compressed::read_bytes;
pub use error::{Location, Place, ReadError};
pub use gltf::{
    BufferSource, GltfDocument, GltfPrimitive, GltfRemap, GltfSurface, GltfTexcoords, PrimitiveRemap, stored_uv,
};
pub use materials::{Material, MaterialNote, Materials, load_materials, parse_materials};
pub use notes::{ReadNotes, UvDropped};
pub use obj::{Labels, ObjDocument, ObjWritten};
pub use write::{WriteError, check_replaceable, replace, write, write_obj, write_ply};

use crate::{TriMesh, UvMap};

/// A file format of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshFormat {
    /// glTF 2.0, binary.
    Glb,
    /// glTF 2.0, JSON with buffers beside it or within.
    Gltf,
    /// Wavefront OBJ, text.
    Obj,
    /// Object File Format of Geomview, text.
    Off,
    /// Polygon File Format of Stanford, text or binary.
    Ply,
    /// Stereolithography, text or binary.
    Stl,
}

/// A word that names no [`MeshFormat`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a mesh format; known are {known}", known = MeshFormat::known())]
pub struct UnknownFormat(
    /// The word.
    pub String,
);

impl MeshFormat {
    /// Every format, in alphabetical order.
    pub const ALL: [Self; 6] = [Self::Glb, Self::Gltf, Self::Obj, Self::Off, Self::Ply, Self::Stl];

    /// The extension of its files, which is also the name that [`FromStr`] takes.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Gltf => "gltf",
            Self::Obj => "obj",
            Self::Off => "off",
            Self::Ply => "ply",
            Self::Stl => "stl",
        }
    }

    /// The format that the extension of `path` names, in whatever case.
    #[must_use]
    pub fn from_path(path: &Path) -> Option<Self> {
        path.extension()?.to_str()?.parse().ok()
    }

    /// Whether it is one of the two of glTF.
    #[must_use]
    pub const fn is_gltf(self) -> bool {
        matches!(self, Self::Glb | Self::Gltf)
    }

    /// All extensions, for messages.
    fn known() -> String {
        Self::ALL.map(Self::extension).join(", ")
    }
}

impl FromStr for MeshFormat {
    type Err = UnknownFormat;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        let named = |format: &Self| format.extension().eq_ignore_ascii_case(word);
        Self::ALL.into_iter().find(named).ok_or_else(|| UnknownFormat(word.to_owned()))
    }
}

/// What a mesh file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Vertices and triangles, in the order of the file.
    pub mesh: TriMesh,
    /// The UVs, if every corner has one.
    pub uv: Option<UvMap>,
    /// What was done to get there, and what was left alone.
    pub notes: ReadNotes,
}

/// Reads a mesh file; its extension (in whatever case) names the format. One that ends in `.gz` is decompressed.
///
/// # Errors
/// [`ReadError::UnknownExtension`], [`ReadError::Open`], and whatever [`parse`] finds.
pub fn read(path: &Path) -> Result<MeshFile, ReadError> {
    let file = path.display().to_string();
    if path.is_dir() {
        return Err(ReadError::Open { file, cause: ErrorKind::IsADirectory.into() });
    }
    let Some(format) = MeshFormat::of_input(path) else {
        // What does not exist has no wrong extension.
        if let Err(cause) = std::fs::metadata(path) {
            return Err(ReadError::Open { file, cause });
        }
        return Err(ReadError::UnknownExtension { file, known: MeshFormat::known() });
    };
    if format.is_gltf() {
        return gltf::read(path);
    }
    match read_bytes(path) {
        Ok(bytes) => parse(format, &file, &bytes),
        Err(cause) => Err(ReadError::Open { file, cause }),
    }
}

/// Reads a mesh from the bytes of a file. The name serves the error messages only. A `.gltf` whose buffers are files
/// needs [`read`], or [`GltfDocument::parse`].
///
/// # Errors
/// A [`ReadError`] with the place in the file.
pub fn parse(format: MeshFormat, name: &str, bytes: &[u8]) -> Result<MeshFile, ReadError> {
    check_readable(format, name, bytes)?;
    match format {
        MeshFormat::Glb | MeshFormat::Gltf => gltf::parse(name, bytes),
        MeshFormat::Obj => obj::parse(name, bytes),
        MeshFormat::Off => off::parse(name, bytes),
        MeshFormat::Ply => ply::parse(name, bytes),
        MeshFormat::Stl => stl::parse(name, bytes),
    }
}

/// Refuses an empty file, and a text in UTF-16.
fn check_readable(format: MeshFormat, name: &str, bytes: &[u8]) -> Result<(), ReadError> {
    const UTF_16_MARKS: [&[u8]; 2] = [&[0xff, 0xfe], &[0xfe, 0xff]];
    if bytes.is_empty() {
        return Err(ReadError::Empty { file: name.to_owned() });
    }
    // A binary PLY begins with "ply", and a binary STL may begin with anything.
    if format != MeshFormat::Stl && UTF_16_MARKS.iter().any(|mark| bytes.starts_with(mark)) {
        let at = Location { file: name.to_owned(), place: Place::Line(1) };
        return Err(ReadError::Unsupported { at, feature: "UTF-16 text".to_owned() });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_name_formats_in_any_case() {
        assert_eq!(MeshFormat::from_path(Path::new("a/b.c/Cow.OBJ")), Some(MeshFormat::Obj));
        assert_eq!(MeshFormat::from_path(Path::new("cow.obj.gz")), None);
        assert_eq!(MeshFormat::from_path(Path::new("obj")), None);
        for format in MeshFormat::ALL {
            assert_eq!(format.extension().parse(), Ok(format));
        }
        let e = "fbx".parse::<MeshFormat>().unwrap_err();
        assert_eq!(e.to_string(), "`fbx` is not a mesh format; known are glb, gltf, obj, off, ply, stl");
    }
}
