//! glTF 2.0: `.glb`, and `.gltf` with its buffers beside it or in data URIs.
//!
//! A model is more than its triangles, so a document is kept whole and edited in place: [`GltfDocument`] holds the
//! JSON as it was read, with everything this library knows nothing of (extensions, extras, the order of keys, numbers
//! to the bit), and its buffers. [`GltfDocument::surface`] gives the triangles of all primitives as one mesh,
//! [`GltfDocument::set_uvs`] adds a set of texture coordinates to them, [`GltfDocument::write`] writes the whole again.
//!
//! **Welding.** glTF splits a vertex wherever a normal or a UV differs, so the surface joins the vertices of one mesh
//! whose positions are equal as numbers. Meshes are not joined with each other. Every mesh is in its own coordinates. [`GltfSurface::places`]
//! says what the nodes do to it: [`GltfSurface::sized`] has every mesh as large as its largest instance in the scene.
//!
//! **The v axis.** The origin of a glTF texture is its upper left corner. A [`UvMap`](crate::UvMap) has v upwards, as OBJ
//! does, so that `v = 1 − t` for the second number `t` of a `TEXCOORD`, both when reading and when writing; a picture of
//! the layout with v up is then the texture as it is. Numbers are stored in 32 bits: [`stored_uv`] says what becomes of
//! a UV.
//!
//! **What is edited.** Buffer views and accessors stay as they are, but for the name that marks the UVs written last; what is
//! new is appended. A vertex is split only where
//! corners of it have different UVs: the first keeps its number, the others come after all old vertices, with all
//! attributes and morph targets copied byte by byte.
//!
//! Reference: Khronos, *glTF 2.0 Specification*, version 2.0.1; the section numbers below are of that text.

mod accessor;
mod append;
mod container;
mod edit;
mod json;
mod place;
mod plain;
mod save;
mod scene;
mod surface;

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

pub use edit::{GltfRemap, GltfTexcoords, PrimitiveRemap, stored_uv};
pub use place::GltfPlace;
pub(super) use plain::write_plain;
pub use surface::{GltfPrimitive, GltfSurface};

use self::json::{Item, Object};
use super::MeshFile;
use super::error::{FilePlace, Location, ReadError};
use super::text::without_mark;

/// Gives the bytes of a buffer that has a file of its own, by its name relative to the document: as many as are said,
/// or fewer if there are no more.
pub type BufferSource<'a> = dyn FnMut(&str, usize) -> io::Result<Vec<u8>> + 'a;

/// Extensions whose geometry only a decoder of their own can read.
const COMPRESSIONS: [&str; 3] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// A glTF document with its buffers.
#[derive(Clone, Debug)]
pub struct GltfDocument {
    /// What messages call it.
    file: String,
    /// Where relative names count from; `None` for a document that is in no folder.
    folder: Option<PathBuf>,
    json: Object,
    /// Whether the JSON was laid out in lines.
    in_lines: bool,
    buffers: Vec<Buffer>,
    /// Chunks of a `.glb` of unknown types.
    chunks: Vec<([u8; 4], Vec<u8>)>,
}

/// The bytes of a buffer.
#[derive(Clone, Debug)]
struct Buffer {
    bytes: Vec<u8>,
    origin: Origin,
}

/// Where a buffer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    /// In the `.glb` itself, or nowhere yet: it has no URI.
    Own,
    /// In a data URI.
    Data,
    /// In a file of its own.
    File,
}

impl GltfDocument {
    /// Reads a document and its buffers. What it is, a `.glb` or JSON, is told by its first bytes.
    ///
    /// # Errors
    /// A [`ReadError`]: the file, a buffer, or something in the document.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let file = path.display().to_string();
        let bytes = super::read_bytes(path).map_err(|cause| ReadError::Open { file: file.clone(), cause })?;
        let folder = super::file::folder_of(path).to_owned();
        let mut document = Self::parse(&file, &bytes, &mut |name, length| read_buffer(&folder.join(name), length))?;
        document.folder = Some(folder);
        Ok(document)
    }

    /// Reads a document from bytes. The name serves the messages; `source` gives the buffers that are files.
    ///
    /// # Errors
    /// A [`ReadError`] with the place in the document.
    pub fn parse(name: &str, bytes: &[u8], source: &mut BufferSource<'_>) -> Result<Self, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty { file: name.to_owned() });
        }
        let chunks = if bytes.starts_with(container::MAGIC) {
            container::split(name, bytes)?
        } else {
            let json = without_mark(bytes);
            if !json.trim_ascii_start().starts_with(b"{") {
                let at = Location { file: name.to_owned(), place: FilePlace::Byte(0) };
                let reason = "neither `glTF`, with which a .glb begins, nor JSON".to_owned();
                return Err(ReadError::BadHeader { at, reason });
            }
            container::Chunks { json, bin: None, others: Vec::new() }
        };
        let json: Object =
            serde_json::from_slice(chunks.json).map_err(|cause| ReadError::Json { file: name.to_owned(), cause })?;
        let root = Item::root(name, &json);
        check_version(&root)?;
        check_compression(&root)?;
        let buffers = load_buffers(&root, chunks.bin, source)?;
        Ok(Self {
            file: name.to_owned(),
            folder: None,
            in_lines: chunks.json.trim_ascii().contains(&b'\n'),
            buffers,
            chunks: chunks.others.iter().map(|&(kind, content)| (kind, content.to_vec())).collect(),
            json,
        })
    }

    /// The document itself.
    #[must_use]
    pub fn json(&self) -> &serde_json::Map<String, serde_json::Value> {
        &self.json
    }

    /// The bytes of a buffer, as many as the document says it has.
    #[must_use]
    pub fn buffer(&self, index: usize) -> Option<&[u8]> {
        self.buffers.get(index).map(|buffer| buffer.bytes.as_slice())
    }

    fn buffers(&self) -> &[Buffer] {
        &self.buffers
    }

    fn root(&self) -> Item<'_> {
        Item::root(&self.file, &self.json)
    }
}

/// Reads a document as a mesh.
pub(super) fn parse(name: &str, bytes: &[u8]) -> Result<MeshFile, ReadError> {
    let nowhere = "the document was not read from a file, so that there is no folder to look in";
    GltfDocument::parse(name, bytes, &mut |_, _| Err(io::Error::other(nowhere)))?.into_mesh()
}

/// Reads a file as a mesh.
pub(super) fn read(path: &Path) -> Result<MeshFile, ReadError> {
    GltfDocument::read(path)?.into_mesh()
}

/// At most `length` bytes of a file: a device that never ends is none.
fn read_buffer(path: &Path, length: usize) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(ErrorKind::InvalidInput.into());
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(length as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Only version 2 has the structure that is read here.
fn check_version(root: &Item<'_>) -> Result<(), ReadError> {
    let asset = root.object("asset")?.ok_or_else(|| root.fault("`asset` is missing: no glTF, or not of version 2"))?;
    let version = asset.text("version").unwrap_or_default();
    match version.split('.').next() {
        Some("2") => Ok(()),
        _ => Err(asset.fault_at("version", format!("version `{version}` of glTF is not read, only 2"))),
    }
}

/// Refuses geometry that is compressed, also where it is there a second time without compression: an edit of one would
/// leave the other as it was.
fn check_compression(root: &Item<'_>) -> Result<(), ReadError> {
    let required = root.fields().get("extensionsRequired").and_then(serde_json::Value::as_array);
    let required = |name: &str| required.is_some_and(|list| list.iter().any(|entry| entry.as_str() == Some(name)));
    if let Some(extension) = COMPRESSIONS.into_iter().find(|name| required(name)) {
        return Err(root.compressed(extension));
    }
    let check = |item: &Item<'_>| {
        let Some(extensions) = item.object("extensions")? else { return Ok(()) };
        let found = COMPRESSIONS.into_iter().find(|&name| extensions.fields().contains_key(name));
        found.map_or(Ok(()), |extension| Err(item.compressed(extension)))
    };
    root.list("bufferViews")?.iter().try_for_each(check)?;
    for mesh in root.list("meshes")? {
        mesh.list("primitives")?.iter().try_for_each(check)?;
    }
    Ok(())
}

fn load_buffers(root: &Item<'_>, bin: Option<&[u8]>, source: &mut BufferSource<'_>) -> Result<Vec<Buffer>, ReadError> {
    let load = |(i, item): (usize, &Item<'_>)| {
        let length = item.required("byteLength")?;
        let (mut bytes, origin) = match (item.text("uri"), bin) {
            (None, Some(bin)) if i == 0 => (bin.get(..length).unwrap_or(bin).to_vec(), Origin::Own),
            (None, _) => return Err(item.fault("`uri` is missing, and there is no binary chunk for it")),
            (Some(uri), _) if container::is_data(uri) => {
                let data = container::data(uri).ok_or_else(|| item.fault_at("uri", "is data that is no base64"))?;
                (data, Origin::Data)
            }
            (Some(uri), _) => {
                let name = container::file_name(uri).ok_or_else(|| {
                    let cause = io::Error::other("only names relative to the document are followed");
                    item.missing_buffer(uri, cause)
                })?;
                (source(&name, length).map_err(|cause| item.missing_buffer(uri, cause))?, Origin::File)
            }
        };
        if bytes.len() < length {
            return Err(item.fault(format!("truncated: {length} bytes are claimed, {} are there", bytes.len())));
        }
        bytes.truncate(length);
        Ok(Buffer { bytes, origin })
    };
    root.list("buffers")?.iter().enumerate().map(load).collect()
}
