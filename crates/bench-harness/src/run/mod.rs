//! One mesh, flattened by one solver and judged.

pub(crate) mod cancel;
pub(crate) mod charts;
pub(crate) mod judge;
pub(crate) mod load;
pub(crate) mod memory;
pub(crate) mod meshes;
pub(crate) mod progress;
pub(crate) mod source;
pub(crate) mod write;

use crate::cli::charts::Charting;
use crate::cli::methods::Method;
use crate::cli::sheet::Sheet;
use crate::record::failure::Failure;
use crate::record::history::{Ended, History};
use crate::record::{Kkt, Quality, Record, RunRecord, Size, Stages, Timings};
use crate::run::cancel::Cancel;
use crate::run::charts::{Charts, charts};
use crate::run::load::Loaded;
use crate::run::progress::Progress;
use crate::show::advice;
use abf::constraints::ProblemError;
use abf::{Developed, FlattenError, Flattening, Termination};
use abf_mesh::{Topology, TopologyError, TriMesh, UvMap, VertexId};
use std::time::Instant;

/// A result with what is not in its record.
#[derive(Debug)]
pub(crate) struct Flattened {
    /// What is known about it.
    pub(crate) record: Record,
    /// The UVs, if there are any.
    pub(crate) uv: Option<UvMap>,
    /// The edges it was cut along, if it was.
    pub(crate) seams: Vec<[VertexId; 2]>,
    /// Its charts side by side in units of the mesh, if they are to be drawn.
    pub(crate) sheet: Option<Developed>,
    /// Every iteration, if they were wanted.
    pub(crate) history: Option<History>,
    /// Whether no other solver can do better, because the mesh itself cannot be flattened.
    pub(crate) mesh_is_unusable: bool,
}

impl From<Record> for Flattened {
    fn from(record: Record) -> Self {
        Self { record, uv: None, seams: Vec::new(), sheet: None, history: None, mesh_is_unusable: false }
    }
}

/// What a run is to come to.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wanted<'a> {
    /// How to make charts; without it only disks are flattened.
    pub(crate) charting: Option<&'a Charting>,
    /// How they lie on a sheet, if they do.
    pub(crate) sheet: Option<&'a Sheet>,
    /// Whether every iteration is collected.
    pub(crate) with_history: bool,
}

/// The bits that runs of the same settings have in common.
#[derive(Debug, PartialEq)]
pub(crate) struct Fingerprint {
    uv: UvMap,
    termination: Termination,
}

/// Flattens and judges a mesh. Whatever goes wrong is in the record.
pub(crate) fn flatten(loaded: &Loaded, method: &Method, wanted: &Wanted<'_>, cancel: &Cancel) -> Flattened {
    let &Wanted { charting, sheet, with_history } = wanted;
    let solver = method.pipeline.solver.name().to_owned();
    let mut record = Record { solver: Some(solver.clone()), ..loaded.record() };
    if let Some(not_run) = method.not_run(loaded.mesh()) {
        return Record { not_run: Some(not_run), ..record }.into();
    }
    let (triangles, vertices) = (loaded.mesh().face_count(), loaded.mesh().vertex_count());
    record.predicted_memory_bytes = Some(abf::predict_memory(&method.pipeline.solver, triangles, vertices));
    if cancel.is_asked() {
        return Record { error: Some(Failure::cancelled(&loaded.name)), ..record }.into();
    }
    let heap = loaded.watch_memory();
    let begin = Instant::now();
    if let Some(charting) = charting.filter(|charting| charting.is_for(loaded.is_gltf())) {
        return in_charts(loaded, method, (charting, sheet), cancel, record);
    }
    let mut progress = watch(loaded, method, cancel).with_trace(with_history.then_some(solver.as_str()));
    let mesh = loaded.sized();
    // Inside the pool once, and not anew for every loop that is shared out.
    let flat = match (rayon::scope(|_| method.pipeline.run(mesh, &mut progress)), charting) {
        (Ok(flat), _) => flat,
        (Err(error), Some(charting)) if is_no_disk(&error) => {
            return in_charts(loaded, method, (charting, sheet), cancel, record);
        }
        (Err(error), _) => return refused(loaded, method, record, &error),
    };
    progress.end_stages();
    // What was flattened is a disk.
    let (interior_vertices, boundary_loops) = (Some(flat.interior_vertices), Some(1));
    record.size = Some(Size { interior_vertices, boundary_loops, ..Size::of(loaded.sized(), None) });
    record.run = Some(RunRecord::new(&method.pipeline, &flat, &progress.rungs()));

    progress.say("metrics");
    let judging = Instant::now();
    // Both formats hold doubles exactly, so these are the UVs as written.
    match flat.metrics(loaded.sized()) {
        Ok(metrics) => record.quality = Some(Quality::new(&metrics)),
        Err(error) => record.error = Some(Failure::metrics(&loaded.name, &error)),
    }
    let laid = sheet.map(|sheet| (sheet, sheet.pattern.lay_disk(loaded.sized(), &flat)));
    let mut drawn = None;
    let mut uv = flat.uv;
    match laid {
        None => {}
        Some((_, Err(error))) => record.error = Some(Failure::atlas(&loaded.name, &error)),
        Some((sheet, Ok(laid))) => {
            drawn = sheet.is_drawn.then(|| laid.developed(loaded.sized()));
            if sheet.is_for_uvs {
                record.quality = Some(Quality::new(&laid.metrics));
                uv = laid.uv;
            }
        }
    }
    let metrics = judging.elapsed().as_secs_f64();
    let total = loaded.read_s + begin.elapsed().as_secs_f64();
    record.timings_s = Some(Timings {
        read: loaded.read_s,
        stages: progress.stages(),
        charts: 0.0,
        atlas: 0.0,
        certificate: progress.certificate(),
        metrics,
        write: 0.0,
        total,
    });
    record.peak_memory_bytes = Some(loaded.peak_bytes(heap));
    record.kkt = method.pipeline.solver.kind().finds_angles().then(|| Kkt::new(flat.kkt));
    record.hint = advice::next_to_try(&record, charting.is_some());
    let history = progress.take_trace().map(|trace| {
        let (mesh, solved_by) = (loaded.name.clone(), flat.solver.to_string());
        let figures = record.quality.as_ref().map(|quality| (quality.f, quality.flips));
        let ended = Ended { mesh, solved_by, corners: 3 * triangles, figures };
        History::new(&method.pipeline, ended, trace)
    });
    Flattened { record, uv: Some(uv), seams: Vec::new(), sheet: drawn, history, mesh_is_unusable: false }
}

/// Whether cutting may help.
fn is_no_disk(error: &FlattenError) -> bool {
    matches!(
        error,
        FlattenError::NotADisk(_)
            | FlattenError::Problem(ProblemError::NotADisk(_))
            | FlattenError::Topology(
                TopologyError::RepeatedVertex { .. }
                    | TopologyError::NonManifoldEdge { .. }
                    | TopologyError::NonManifoldVertex { .. }
                    | TopologyError::InconsistentOrientation { .. }
                    | TopologyError::NonOrientable { .. }
            )
    )
}

/// Makes charts and an atlas of a mesh.
fn in_charts(
    loaded: &Loaded,
    method: &Method,
    (charting, sheet): (&Charting, Option<&Sheet>),
    cancel: &Cancel,
    mut record: Record,
) -> Flattened {
    let heap = loaded.watch_memory();
    let begin = Instant::now();
    let mut progress = watch(loaded, method, cancel);
    let made = rayon::scope(|_| charts(charting, sheet, loaded, &method.pipeline, &mut progress));
    progress.end_stages();
    let Charts { uv, metrics, sheet, record: atlas, seams, turned, shared, charts_s } = match made {
        Ok(charts) => charts,
        Err(failure) => {
            let failure = failure.of_boundary_in(method.angles_file.as_deref());
            let mesh_is_unusable = failure.kind.is_of_the_mesh();
            let record = Record { size: Some(Size::of(loaded.mesh(), None)), error: Some(failure), ..record };
            return Flattened { mesh_is_unusable, ..record.into() };
        }
    };
    let elapsed = begin.elapsed().as_secs_f64();
    record.size = Some(Size::of(loaded.mesh(), None));
    record.run = RunRecord::of_charts(&method.pipeline, atlas.charts.iter().map(|chart| &chart.solved));
    record.atlas = Some(atlas);
    record.quality = Some(Quality::of_repaired(&metrics, turned, shared));
    record.timings_s = Some(Timings {
        read: loaded.read_s,
        stages: Stages { flatten: charts_s, flatten_cpu: None, ..progress.stages() },
        charts: charts_s,
        atlas: elapsed - charts_s,
        total: loaded.read_s + elapsed,
        ..Timings::default()
    });
    record.peak_memory_bytes = Some(loaded.peak_bytes(heap));
    record.hint = advice::next_for_charts(&record);
    Flattened { uv: Some(uv), seams, sheet, ..record.into() }
}

/// Flattens a mesh that has been flattened before, for the time it takes.
///
/// # Errors
/// That there is no result.
pub(crate) fn flatten_again(
    loaded: &Loaded,
    method: &Method,
    cancel: &Cancel,
) -> Result<(Fingerprint, Stages), Failure> {
    let mut progress = watch(loaded, method, cancel);
    let mesh = loaded.mesh();
    let flat = rayon::scope(|_| method.pipeline.run(mesh, &mut progress));
    progress.end_stages();
    match flat {
        Ok(Flattening { uv, termination, .. }) => Ok((Fingerprint { uv, termination }, progress.stages())),
        Err(error) => Err(Failure::flatten(&loaded.name, &error, loaded.fanned)),
    }
}

impl Flattened {
    /// What another run should have in common with this one; `None` where there are no UVs.
    pub(crate) fn is_the_same_as(&self, other: &Fingerprint) -> bool {
        let ended = self.record.termination();
        self.uv.as_ref() == Some(&other.uv) && ended == Some(other.termination)
    }
}

fn watch<'a>(loaded: &Loaded, method: &Method, cancel: &'a Cancel) -> Progress<'a> {
    Progress::new(&format!("{}, {}", loaded.name, method.pipeline.solver), cancel)
}

/// The record of a mesh that was not flattened.
fn refused(loaded: &Loaded, method: &Method, record: Record, error: &FlattenError) -> Flattened {
    let mesh_is_unusable = matches!(
        error,
        FlattenError::Geometry(_) | FlattenError::Topology(_) | FlattenError::NotADisk(_) | FlattenError::Problem(_)
    );
    let failure = Failure::flatten(&loaded.name, error, loaded.fanned);
    let failure = failure.of_boundary_in(method.angles_file.as_deref());
    let size = Some(size_of_refused(loaded.mesh(), error));
    let solver = record.solver.clone().filter(|_| !mesh_is_unusable);
    let record = Record { size, solver, error: Some(failure), ..record };
    Flattened { mesh_is_unusable, ..record.into() }
}

/// The size of a mesh that could not be flattened, with its topology if that was not the reason.
fn size_of_refused(mesh: &TriMesh, error: &FlattenError) -> Size {
    let topology = match error {
        FlattenError::Topology(_) | FlattenError::Cancelled(_) => None,
        _ => Topology::build(mesh.vertex_count(), mesh.faces()).ok(),
    };
    Size::of(mesh, topology.as_ref())
}
