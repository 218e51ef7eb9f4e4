//! One mesh, flattened: from the file to the record.

use crate::cancel::Cancel;
use crate::console;
use crate::errors::Failure;
use crate::memory::HeapWatch;
use crate::progress::Progress;
use crate::record::{Quality, Record, Run, Size, Timings};
use crate::settings::Settings;
use crate::source::Source;
use crate::{advice, files};
use abf::{FlattenError, Stage};
use abf_mesh::{Topology, TriMesh, UvMap, io};
use abf_report::{PictureStyle, picture};
use std::path::Path;
use std::time::Instant;

/// Reads, flattens, judges and writes one mesh. Whatever goes wrong is in the record and on stderr.
pub(crate) fn run(source: &Source, settings: &Settings, cancel: &Cancel) -> Record {
    let mut record = Record { mesh: source.name(), ..Record::default() };
    let result = if cancel.is_asked() {
        Err(Failure::cancelled(&record.mesh))
    } else {
        flatten(source, settings, cancel, &mut record)
    };
    if let Err(failure) = result {
        console::failure(&failure);
        record.error = Some(failure);
    }
    record.hint = advice::next_to_try(&record);
    if let Some(hint) = &record.hint {
        console::hint(&record.mesh, hint);
    }
    record
}

/// Fills the record as far as it gets.
fn flatten(source: &Source, settings: &Settings, cancel: &Cancel, record: &mut Record) -> Result<(), Failure> {
    let heap = HeapWatch::start();
    let mut progress = Progress::new(&record.mesh, cancel);
    let mut timings = Timings::default();
    let begin = Instant::now();

    let file = timed(&mut timings.read, || source.read())?;
    for note in file.notes.sentences() {
        console::note(&record.mesh, &note);
        record.notes.push(note);
    }
    let (mesh, fanned) = (file.mesh, file.notes.polygons_fanned > 0);
    record.size = Some(Size::of(&mesh, None));

    let flat = settings.pipeline.run(&mesh, &mut progress).map_err(|error| {
        record.size = Some(size_of_refused(&mesh, &error));
        Failure::flatten(&record.mesh, &error, fanned)
    })?;
    progress.end_stages();
    timings.topology = progress.seconds(Stage::Topology);
    timings.solve = progress.seconds(Stage::Solve);
    timings.layout = progress.seconds(Stage::Layout);
    // What was flattened is a disk.
    let (interior_vertices, boundary_loops) = (Some(flat.interior_vertices), Some(1));
    record.size = Some(Size { interior_vertices, boundary_loops, ..Size::of(&mesh, None) });
    record.run = Some(Run::new(&settings.pipeline, &flat));

    // Both formats hold doubles exactly, so these are the UVs as written.
    progress.say("metrics");
    let metrics = timed(&mut timings.metrics, || flat.metrics(&mesh));
    record.quality = Some(Quality::new(metrics.map_err(|error| Failure::metrics(&record.mesh, &error))?));

    progress.say("writing");
    let written = match &settings.output {
        Some(path) => timed(&mut timings.write, || write(path, &mesh, &flat.uv)),
        None => Ok(()),
    };
    timings.total = begin.elapsed().as_secs_f64();
    record.timings_s = Some(timings);
    record.peak_memory_bytes = Some(heap.peak_bytes());
    // One file that cannot be written does not keep the other from being tried.
    let drawn = draw(settings.png.as_deref(), &mesh, &flat.uv);
    for (path, result) in [(&settings.output, &written), (&settings.png, &drawn)] {
        record.written.extend(path.as_ref().filter(|_| result.is_ok()).map(|path| path.display().to_string()));
    }
    if let (Err(_), Err(failure)) = (&written, &drawn) {
        console::failure(failure);
    }
    written.and(drawn)
}

/// Does something and adds the seconds it took.
fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let begin = Instant::now();
    let done = work();
    *seconds += begin.elapsed().as_secs_f64();
    done
}

/// The size of a mesh that could not be flattened, with its topology if that was not the reason.
fn size_of_refused(mesh: &TriMesh, error: &FlattenError) -> Size {
    let topology = match error {
        FlattenError::Topology(_) | FlattenError::Cancelled => None,
        _ => Topology::build(mesh.vertex_count(), mesh.faces()).ok(),
    };
    Size::of(mesh, topology.as_ref())
}

fn write(path: &Path, mesh: &TriMesh, uv: &UvMap) -> Result<(), Failure> {
    io::write(path, mesh, Some(uv)).map_err(|error| Failure::write(path, &error))
}

fn draw(path: Option<&Path>, mesh: &TriMesh, uv: &UvMap) -> Result<(), Failure> {
    let Some(path) = path else { return Ok(()) };
    let png = picture(mesh, uv, &PictureStyle::default()).map_err(|error| Failure::picture(path, &error))?;
    files::replace(path, &png)
}
