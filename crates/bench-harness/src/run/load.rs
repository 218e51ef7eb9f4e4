//! A mesh, read once for all that is done with it.

use crate::record::failure::Failure;
use crate::record::{Record, Size};
use crate::run::cancel::Cancel;
use crate::run::memory::HeapWatch;
use crate::run::progress::Progress;
use crate::run::source::{Document, Gltf, Source, holds_more};
use crate::show::console;
use abf_mesh::io::{ObjDocument, UvDropped, VertexColours};
use abf_mesh::{TriMesh, UvMap, VertexId};
use std::collections::{BTreeMap, HashSet};
use std::time::Instant;

/// A mesh and what is known of it.
#[derive(Debug)]
pub(crate) struct Loaded {
    /// What it is called in the output.
    pub(crate) name: String,
    /// What was read.
    document: Document,
    /// What reading did beyond copying.
    pub(crate) notes: Vec<String>,
    /// Whether polygons were cut into triangles.
    pub(crate) fanned: bool,
    /// How long reading took, seconds.
    pub(crate) read_s: f64,
    /// What the mesh takes, bytes.
    bytes: usize,
    peak_of_reading: usize,
}

impl Loaded {
    /// Reads a mesh and says on stderr what is worth knowing about the file.
    ///
    /// # Errors
    /// What is wrong with the file, that it would take more memory than allowed, or that the user has cancelled.
    pub(crate) fn read(source: &Source, max_memory: Option<u64>, cancel: &Cancel) -> Result<Self, Failure> {
        let loaded = Self::read_quietly(source, max_memory, cancel)?;
        loaded.notes.iter().for_each(|note| console::note(&loaded.name, note));
        Ok(loaded)
    }

    /// Reads a mesh, and says nothing.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(crate) fn read_quietly(source: &Source, max_memory: Option<u64>, cancel: &Cancel) -> Result<Self, Failure> {
        let name = source.name();
        if cancel.is_asked() {
            return Err(Failure::cancelled(&name));
        }
        let predicted = source.memory_to_read();
        if let Some(limit) = max_memory.filter(|&limit| predicted > limit) {
            return Err(Failure::file_memory(&name, predicted, limit));
        }
        let heap = HeapWatch::start();
        let _progress = Progress::new(&name, cancel);
        let begin = Instant::now();
        let document = source.read()?;
        let read_s = begin.elapsed().as_secs_f64();
        let notes = document.sentences();
        let fanned = document.file().notes.polygons_fanned > 0;
        let (bytes, peak_of_reading) = (heap.bytes(), heap.peak_bytes());
        Ok(Self { name, document, notes, fanned, read_s, bytes, peak_of_reading })
    }

    /// Vertices and triangles.
    pub(crate) fn mesh(&self) -> &TriMesh {
        &self.document.file().mesh
    }

    /// The same with every mesh of a glTF as large as in its scene: what areas and stretch are measured on.
    pub(crate) fn sized(&self) -> &TriMesh {
        self.gltf().and_then(|gltf| gltf.sized.as_ref()).unwrap_or_else(|| self.mesh())
    }

    /// The same with every mesh of a glTF where it is in its scene: what pictures show.
    pub(crate) fn placed(&self) -> &TriMesh {
        self.gltf().map_or_else(|| self.mesh(), |gltf| &gltf.placed)
    }

    /// For every face the mesh of a glTF that it is of.
    pub(crate) fn objects(&self) -> Option<&[u32]> {
        self.gltf().map(|gltf| gltf.objects.as_slice())
    }

    /// The UVs that the file has.
    pub(crate) fn uv(&self) -> Option<&UvMap> {
        self.document.file().uv.as_ref()
    }

    /// The colours of its vertices, if the file is a PLY that has some.
    pub(crate) fn colours(&self) -> Option<&VertexColours> {
        self.document.file().colours.as_ref()
    }

    /// Why it has none, if it has some that cannot be used.
    pub(crate) fn uv_dropped(&self) -> Option<UvDropped> {
        self.document.file().notes.uv_dropped
    }

    /// The document, if it is a glTF.
    pub(crate) fn gltf(&self) -> Option<&Gltf> {
        match &self.document {
            Document::Gltf(gltf) => Some(gltf),
            Document::Obj(_) | Document::Plain(_) => None,
        }
    }

    /// Whether it is a glTF document.
    pub(crate) fn is_gltf(&self) -> bool {
        self.gltf().is_some()
    }

    /// The text of an OBJ that holds more than a mesh, to be written with other UVs; `None` for other files.
    pub(crate) fn obj(&self) -> Option<&ObjDocument> {
        match &self.document {
            Document::Obj(document) => Some(document),
            Document::Gltf(_) | Document::Plain(_) => None,
        }
    }

    /// Whether the file has materials, normals or anything else besides vertices, faces and UVs.
    pub(crate) fn holds_more(&self) -> bool {
        match &self.document {
            Document::Gltf(_) => true,
            Document::Obj(document) => holds_more(document.file()),
            Document::Plain(_) => false,
        }
    }

    /// What the file knows of its faces; groups only if `with_groups`.
    pub(crate) fn known_of_faces(&self, with_groups: bool) -> Known {
        if let Some(gltf) = self.gltf() {
            let materials = Some(gltf.materials.clone());
            return Known { labels: materials.clone().filter(|_| with_groups), materials, forbidden: None };
        }
        let Some(document) = self.obj() else { return Known::default() };
        let (groups, materials) = (&document.groups().of_faces, &document.materials().of_faces);
        let mut pairs = BTreeMap::new();
        let pair = |(&group, &material): (&u32, &u32)| {
            let next = pairs.len() as u32;
            *pairs.entry((group, material)).or_insert(next)
        };
        let labels = with_groups.then(|| groups.iter().zip(materials).map(pair).collect());
        let forbidden = self.fanned.then(|| self.diagonals(document));
        Known { labels, materials: Some(materials.clone()), forbidden }
    }

    /// For every corner whether it faces an edge that a polygon was cut along.
    fn diagonals(&self, document: &ObjDocument) -> Vec<bool> {
        let ends = |a: VertexId, b: VertexId| [a.min(b), a.max(b)];
        let diagonals: HashSet<[VertexId; 2]> = document.diagonals().into_iter().map(|[a, b]| ends(a, b)).collect();
        let faces = |&[a, b, c]: &[VertexId; 3]| [ends(b, c), ends(c, a), ends(a, b)];
        self.mesh().faces().iter().flat_map(faces).map(|edge| diagonals.contains(&edge)).collect()
    }

    /// A record of what is known so far.
    pub(crate) fn record(&self) -> Record {
        let size = Some(Size::of(self.mesh(), None));
        Record { mesh: self.name.clone(), size, notes: self.notes.clone(), ..Record::default() }
    }

    /// Starts measuring the memory of one solver.
    pub(crate) fn watch_memory(&self) -> HeapWatch {
        HeapWatch::start_with(self.bytes)
    }

    /// The most bytes in use while the mesh was read, or since `watch` was started: what reading and
    /// that solver take alone.
    pub(crate) fn peak_bytes(&self, watch: HeapWatch) -> usize {
        self.peak_of_reading.max(watch.peak_bytes())
    }
}

/// What a file knows of its faces.
#[derive(Debug, Default)]
pub(crate) struct Known {
    /// Group and material of every face.
    pub(crate) labels: Option<Vec<u32>>,
    /// The material of every face.
    pub(crate) materials: Option<Vec<u32>>,
    /// For every corner whether the edge that it faces may not be a seam.
    pub(crate) forbidden: Option<Vec<bool>>,
}

/// The record of a mesh that cannot be used, whatever the solver.
pub(crate) fn unusable(mesh: String, failure: Failure) -> Record {
    Record { mesh, error: Some(failure), ..Record::default() }
}
