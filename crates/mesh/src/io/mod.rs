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

mod blocks;
mod compressed;
mod error;
mod file;
mod format;
mod gather;
#[cfg(feature = "gltf")]
mod gltf;
mod mesh_file;
mod notes;
mod obj;
mod off;
mod ply;
mod polygon;
mod stl;
mod text;

use std::io::ErrorKind;
use std::path::Path;

pub use compressed::read_bytes;
pub use error::{FilePlace, Location, ReadError, WriteError};
pub use file::{check_replaceable, replace};
pub use format::{MeshFormat, UnknownFormat};
#[cfg(feature = "gltf")]
pub use gltf::{
    BufferSource, GltfDocument, GltfPlace, GltfPrimitive, GltfRemap, GltfSurface, GltfTexcoords, PrimitiveRemap,
    stored_uv,
};
pub use mesh_file::MeshFile;
pub use notes::{ReadNotes, UvDropped};
pub use obj::{Labels, ObjDocument, ObjWritten, write_obj};
pub use ply::{VertexColours, write_ply};

use crate::{TriMesh, UvMap};
use blocks::{Format, check};

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
    #[cfg(feature = "gltf")]
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
        #[cfg(feature = "gltf")]
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
        let at = Location { file: name.to_owned(), place: FilePlace::Line(1) };
        return Err(ReadError::Unsupported { at, feature: "UTF-16 text".to_owned() });
    }
    Ok(())
}

/// Writes a mesh file; its extension (`obj`, `ply`, `glb` or `gltf`, in whatever case) names the format.
///
/// Vertices and faces keep their order, and all numbers are read back to the bit, except that glTF stores numbers of 32
/// bits. A `.gltf` has its buffer beside it, as `.bin`.
///
/// The file is written under a temporary name in the same folder and renamed when it is complete, so that a half-written
/// file never stands under the final name.
///
/// # Errors
/// A [`WriteError`]; what stood under that name before is then still there.
pub fn write(path: &Path, mesh: &TriMesh, uv: Option<&UvMap>) -> Result<(), WriteError> {
    write_coloured(path, mesh, uv, None)
}

/// [`write()`] with the colours of the vertices, which a PLY keeps as they were; other formats are written without.
///
/// # Errors
/// A [`WriteError`]; colours of another mesh are one.
pub fn write_coloured(
    path: &Path,
    mesh: &TriMesh,
    uv: Option<&UvMap>,
    colours: Option<&VertexColours>,
) -> Result<(), WriteError> {
    if let Some(colours) = colours.filter(|colours| colours.vertex_count() != mesh.vertex_count()) {
        let (colours, vertices) = (colours.vertex_count(), mesh.vertex_count());
        return Err(WriteError::ColourMismatch { colours, vertices });
    }
    let target = || path.display().to_string();
    let format: Format = match MeshFormat::from_path(path) {
        Some(MeshFormat::Obj) => obj::write,
        Some(MeshFormat::Ply) if colours.is_some() => {
            check(mesh, uv)?;
            let written = replace(path, |out| ply::write_coloured(out, mesh, uv, colours));
            return written.map_err(|cause| WriteError::Io { target: target(), cause });
        }
        Some(MeshFormat::Ply) => ply::write,
        #[cfg(feature = "gltf")]
        Some(MeshFormat::Glb | MeshFormat::Gltf) => {
            check(mesh, uv)?;
            return gltf::write_plain(path, mesh, uv);
        }
        Some(MeshFormat::Off | MeshFormat::Stl) | None => return Err(WriteError::UnknownExtension { file: target() }),
    };
    check(mesh, uv)?;
    replace(path, |out| format(out, mesh, uv)).map_err(|cause| WriteError::Io { target: target(), cause })
}
