//! A mesh, read once for all that is done with it.

use crate::cancel::Cancel;
use crate::console;
use crate::errors::Failure;
use crate::memory::HeapWatch;
use crate::progress::Progress;
use crate::record::{Record, Size};
use crate::source::Source;
use abf_mesh::TriMesh;
use std::time::Instant;

/// A mesh and what is known of it.
#[derive(Debug)]
pub(crate) struct Loaded {
    /// What it is called in the output.
    pub(crate) name: String,
    /// Vertices and triangles.
    pub(crate) mesh: TriMesh,
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
        let file = source.read()?;
        let read_s = begin.elapsed().as_secs_f64();
        let notes = file.notes.sentences();
        let (mesh, fanned) = (file.mesh, file.notes.polygons_fanned > 0);
        let (bytes, peak_of_reading) = (heap.bytes(), heap.peak_bytes());
        Ok(Self { name, mesh, notes, fanned, read_s, bytes, peak_of_reading })
    }

    /// A record of what is known so far.
    pub(crate) fn record(&self) -> Record {
        let size = Some(Size::of(&self.mesh, None));
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

/// The record of a mesh that cannot be used, whatever the solver.
pub(crate) fn unusable(mesh: String, failure: Failure) -> Record {
    Record { mesh, error: Some(failure), ..Record::default() }
}
