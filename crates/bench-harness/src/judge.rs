//! One file, judged by the UVs it has.

use crate::console;
use crate::errors::Failure;
use crate::memory::HeapWatch;
use crate::record::{Quality, Record, Size, Timings};
use abf_mesh::{Topology, io};
use std::path::Path;
use std::time::Instant;

/// Reads and judges one file. Whatever goes wrong is in the record and on stderr.
pub(crate) fn judge(path: &Path) -> Record {
    let mut record = Record { mesh: path.display().to_string(), ..Record::default() };
    if let Err(failure) = fill(path, &mut record) {
        console::failure(&failure);
        record.error = Some(failure);
    }
    record
}

/// Fills the record as far as it gets.
fn fill(path: &Path, record: &mut Record) -> Result<(), Failure> {
    let heap = HeapWatch::start();
    let begin = Instant::now();
    let file = io::read(path).map_err(|error| Failure::read(&error))?;
    let read = begin.elapsed().as_secs_f64();
    record.notes = file.notes.sentences();
    record.notes.iter().for_each(|note| console::note(&record.mesh, note));
    // UVs can be judged on any set of faces, manifold or not.
    let topology = Topology::build(file.mesh.vertex_count(), file.mesh.faces()).ok();
    record.size = Some(Size::of(&file.mesh, topology.as_ref()));
    let built = begin.elapsed().as_secs_f64();

    let uv = file.uv.ok_or_else(|| Failure::no_uv(&record.mesh, file.notes.uv_dropped))?;
    let metrics = abf_metrics::measure(&file.mesh, &uv);
    record.quality = Some(Quality::new(metrics.map_err(|error| Failure::metrics(&record.mesh, &error))?));
    let total = begin.elapsed().as_secs_f64();
    let timings = Timings { read, topology: built - read, metrics: total - built, total, ..Timings::default() };
    record.timings_s = Some(timings);
    record.peak_memory_bytes = Some(heap.peak_bytes());
    Ok(())
}
