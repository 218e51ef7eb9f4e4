//! Files, judged by the UVs they have.

use crate::cli::args::MetricsArgs;
use crate::cli::packing::check_page;
use crate::cli::targets::{JsonTarget, check_uv_set};
use crate::cli::typed::Typed;
use crate::record::failure::Failure;
use crate::record::{Outcome, Record, Size, Stages, Timings, to_json};
use crate::run::judge::Judging;
use crate::run::memory::HeapWatch;
use crate::run::source::surface;
use crate::show::console;
use crate::show::files;
use crate::show::findings;
use crate::show::show;
use crate::show::table;
use abf::Precision;
use abf_mesh::io::{GltfDocument, MeshFile, MeshFormat};
use abf_mesh::{Topology, UvMap, io};
use std::path::Path;
use std::time::Instant;

/// Checks the arguments.
///
/// # Errors
/// A usage error that names the option.
pub(crate) fn check(args: &MetricsArgs) -> Result<(), clap::Error> {
    if let Some(page) = args.page {
        check_page(page)?;
    }
    check_uv_set(args.uv_set, &args.files)
}

/// Judges every file asked for.
pub(crate) fn judge_all(args: &MetricsArgs, typed: &Typed) -> Outcome {
    let json = JsonTarget::new(args.json.clone());
    if let Err(failure) = files::check([json.as_ref().and_then(JsonTarget::file)]) {
        console::failure(&failure);
        return Outcome::Failed;
    }
    let records: Vec<Record> = args.files.iter().map(|file| judge(file, args, typed)).collect();
    let worst = records.iter().map(Record::outcome).max().unwrap_or(Outcome::AsAsked);
    match show(&table::of_meshes(&records), || to_json(&records), json.as_ref()) {
        Ok(()) => worst,
        Err(failure) => {
            console::failure(&failure);
            Outcome::Failed
        }
    }
}

/// Reads and judges one file. Whatever goes wrong is in the record and on stderr.
fn judge(path: &Path, args: &MetricsArgs, typed: &Typed) -> Record {
    let mut record = Record { mesh: path.display().to_string(), ..Record::default() };
    if let Err(mut failure) = fill(path, args, &mut record) {
        typed.fit_failure(&mut failure);
        console::failure(&failure);
        record.error = Some(failure);
    }
    record
}

/// Fills the record as far as it gets.
fn fill(path: &Path, args: &MetricsArgs, record: &mut Record) -> Result<(), Failure> {
    let heap = HeapWatch::start();
    let begin = Instant::now();
    let (file, objects) = read(path, args.uv_set)?;
    let read = begin.elapsed().as_secs_f64();
    record.notes = file.notes.sentences();
    record.notes.iter().for_each(|note| console::note(&record.mesh, note));
    // UVs can be judged on any set of faces, manifold or not.
    let topology = Topology::build(file.mesh.vertex_count(), file.mesh.faces()).ok();
    record.size = Some(Size::of(&file.mesh, topology.as_ref()));
    let built = begin.elapsed().as_secs_f64();

    let uv = file.uv.ok_or_else(|| Failure::no_uv(&record.mesh, file.notes.uv_dropped, "judge"))?;
    let (uv, precision) = as_stored(uv, MeshFormat::of_input(path), file.notes.uv_single);
    let repair = (!args.as_stored).then(|| args.weld.unwrap_or_default());
    let page = args.page.map(|page| page.0);
    let quality = Judging { precision, page, repair }.judged(&file.mesh, objects.as_deref(), &uv);
    record.quality = Some(quality.map_err(|error| Failure::metrics(&record.mesh, &error))?);
    if let Some(overlap) = findings::overlap(record) {
        console::note(&record.mesh, &overlap);
    }
    let total = begin.elapsed().as_secs_f64();
    let stages = Stages { topology: built - read, ..Stages::default() };
    let timings = Timings { read, stages, metrics: total - built, total, ..Timings::default() };
    record.timings_s = Some(timings);
    record.peak_memory_bytes = Some(heap.peak_bytes());
    Ok(())
}

/// A file, and of a glTF the mesh that every face is of. Its meshes are as large as in the scene.
fn read(path: &Path, uv_set: Option<u32>) -> Result<(MeshFile, Option<Vec<u32>>), Failure> {
    let failed = |error| Failure::read(&error);
    if MeshFormat::of_input(path).is_none_or(|format| !format.is_gltf()) || path.is_dir() {
        return Ok((io::read(path).map_err(failed)?, None));
    }
    let surface = GltfDocument::read(path).and_then(|document| surface(&document, uv_set)).map_err(failed)?;
    let objects = surface.mesh_of_faces();
    let mesh = surface.sized().unwrap_or(surface.mesh);
    Ok((MeshFile::new(mesh, surface.uv, surface.notes), Some(objects)))
}

/// The UVs as the file stores them, and in what.
fn as_stored(uv: UvMap, format: Option<MeshFormat>, is_single: bool) -> (UvMap, Precision) {
    match format {
        // It stores 1 − v, which has been turned back without rounding.
        Some(format) if format.is_gltf() => (uv, Precision::Single),
        _ if !is_single => (uv, Precision::Double),
        // Binary files hold them rounded; the digits of a text may say more than it stores.
        _ => (uv.mapped(|p| p.map(|x| Precision::Single.round(x))), Precision::Single),
    }
}
