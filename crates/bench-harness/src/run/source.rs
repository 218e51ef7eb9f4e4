//! Where a mesh comes from.

use crate::record::failure::Failure;
use abf_mesh::TriMesh;
use abf_mesh::io::{GltfDocument, GltfSurface, MeshFile, MeshFormat, ObjDocument, ReadError, ReadNotes, read};
use abf_shapes::{DEFAULT_FIXTURE, Fixture, fixtures};
use std::fs;
use std::path::{Path, PathBuf};

/// One mesh to flatten.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    /// A file.
    File(PathBuf),
    /// A glTF with the UVs of one of its sets, `TEXCOORD_n`.
    UvSet(PathBuf, u32),
    /// The default fixture, made in memory so that an installed program has it too; the committed
    /// file holds the same bits.
    Builtin,
}

impl Source {
    /// What it is called in the output.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::File(path) | Self::UvSet(path, _) => path.display().to_string(),
            Self::Builtin => format!("fixtures/{DEFAULT_FIXTURE}.obj (builtin)"),
        }
    }

    /// About how many bytes reading it takes at most, the mesh included; 0 where that cannot be told.
    pub(crate) fn memory_to_read(&self) -> u64 {
        /// Bytes in memory per byte of a file: a binary STL, whose corners are compared, has the most.
        const BYTES_PER_BYTE: u64 = 5;
        match self {
            Self::File(path) | Self::UvSet(path, _) => {
                fs::metadata(path).map_or(0, |about| BYTES_PER_BYTE.saturating_mul(about.len()))
            }
            Self::Builtin => 0,
        }
    }

    /// Reads and parses it, once: the document is kept for writing.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub(crate) fn read(&self) -> Result<Document, Failure> {
        let failed = |error| Failure::read(&error);
        match self {
            Self::File(path) => match MeshFormat::of_input(path) {
                Some(format) if format.is_gltf() && !path.is_dir() => read_gltf(path, None),
                Some(MeshFormat::Obj) if !path.is_dir() => {
                    let document = ObjDocument::read(path).map_err(failed)?;
                    // A writer of meshes would write all there is in it.
                    let is_plain = !holds_more(document.file()) && !document.has_comments();
                    Ok(if is_plain {
                        Document::Plain(Box::new(document.into_file()))
                    } else {
                        Document::Obj(Box::new(document))
                    })
                }
                _ => Ok(Document::Plain(Box::new(read(path).map_err(failed)?))),
            },
            Self::UvSet(path, set) => read_gltf(path, Some(*set)),
            Self::Builtin => {
                let mesh = default_fixture().mesh();
                let file = MeshFile::new(mesh, None, ReadNotes::default());
                Ok(Document::Plain(Box::new(file)))
            }
        }
    }
}

/// What was read.
#[derive(Debug)]
pub(crate) enum Document {
    /// An OBJ that holds more than the mesh, to be written with other UVs.
    Obj(Box<ObjDocument>),
    /// A glTF, to be written with other UVs.
    Gltf(Box<Gltf>),
    /// A file of which the mesh is all.
    Plain(Box<MeshFile>),
}

impl Document {
    /// The mesh, its UVs, and what there is to say of them.
    pub(crate) fn file(&self) -> &MeshFile {
        match self {
            Self::Obj(document) => document.file(),
            Self::Gltf(gltf) => &gltf.file,
            Self::Plain(file) => file,
        }
    }

    /// What there is to say of the reading. What an OBJ keeps when it is written again is not missing.
    pub(crate) fn sentences(&self) -> Vec<String> {
        /// What is about normals, names, materials and smoothing. Curves and points, which are no surface, are said.
        const KEPT: [&str; 6] = ["vn", "s", "g", "o", "usemtl", "mtllib"];
        let mut notes = self.file().notes.clone();
        if matches!(self, Self::Obj(_)) {
            notes.ignored.retain(|what, _| !KEPT.contains(&what.as_str()));
        }
        notes.sentences()
    }
}

/// A glTF with the UVs of a set, or of the one that was written last.
fn read_gltf(path: &Path, uv_set: Option<u32>) -> Result<Document, Failure> {
    let failed = |error| Failure::read(&error);
    let document = GltfDocument::read(path).map_err(failed)?;
    let surface = surface(&document, uv_set).map_err(failed)?;
    Ok(Document::Gltf(Box::new(Gltf::new(document, surface))))
}

/// The surface of a glTF with the UVs of a set, or of the one that was written last.
pub(crate) fn surface(document: &GltfDocument, uv_set: Option<u32>) -> Result<GltfSurface, ReadError> {
    uv_set.map_or_else(|| document.surface(), |set| document.surface_with_set(set))
}

/// Whether an OBJ holds more than vertices and faces, comments aside.
pub(crate) fn holds_more(file: &MeshFile) -> bool {
    let notes = &file.notes;
    let has_more = notes.polygons_fanned > 0 || !notes.ignored.is_empty() || !notes.material_libraries.is_empty();
    has_more || file.uv.is_some()
}

impl Gltf {
    fn new(document: GltfDocument, surface: GltfSurface) -> Self {
        let (materials, objects) = (surface.material_of_faces(), surface.mesh_of_faces());
        let (sized, placed, uv_set) = (surface.sized(), surface.placed(), surface.set);
        let file = MeshFile::new(surface.mesh, surface.uv, surface.notes);
        Self { document, file, uv_set, sized, placed, materials, objects }
    }
}

/// A glTF document, to be written with other UVs.
#[derive(Debug)]
pub(crate) struct Gltf {
    /// Everything in it.
    pub(crate) document: GltfDocument,
    /// Its surface.
    file: MeshFile,
    /// The `n` of the `TEXCOORD_n` that the UVs of its surface are.
    pub(crate) uv_set: u32,
    /// Its surface with every mesh as large as in the scene, where that is another.
    pub(crate) sized: Option<TriMesh>,
    /// Its surface with every mesh where it is in the scene.
    pub(crate) placed: TriMesh,
    /// The mesh of every face of its surface.
    pub(crate) objects: Vec<u32>,
    /// The material of every face of its surface.
    pub(crate) materials: Vec<u32>,
}

fn default_fixture() -> Fixture {
    let mut all = fixtures().into_iter();
    all.find(|fixture| fixture.name == DEFAULT_FIXTURE).expect("the default fixture is a fixture")
}
