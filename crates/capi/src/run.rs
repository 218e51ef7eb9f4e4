//! The calls, without pointers.

use crate::event::{AbfEvent, Relay};
use crate::known::Known;
use crate::options::Settings;
use crate::status::{AbfStatus, Failure};
use crate::view::AbfResult;
use abf::mesh::{Point3, TriMesh};
use abf::parallel::with_threads;
use abf::{FlattenError, Solver, predict_memory};

/// Who is told what happens.
pub(crate) type Callback<'a> = &'a mut (dyn FnMut(&AbfEvent) -> i32 + Send);

/// Flattens a disk.
pub(crate) fn flatten(
    positions: &[[f64; 3]],
    indices: &[u32],
    settings: &Settings,
    callback: Callback<'_>,
) -> Result<AbfResult, Failure> {
    let (triangles, rest) = indices.as_chunks::<3>();
    if !rest.is_empty() {
        let count = indices.len();
        let text = format!("{count} indices are no triangles: their number must be a multiple of 3");
        return Err(Failure::new(AbfStatus::IndexCount, text));
    }
    let pipeline = &settings.unwrapper.unwrap.pipeline;
    pipeline.check().map_err(|error| Failure::setting(&error))?;
    let mut work = || {
        let triangles: Vec<[usize; 3]> = triangles.iter().map(|t| t.map(|i| i as usize)).collect();
        let mesh = TriMesh::new(positions.iter().copied().map(Point3::from).collect(), &triangles);
        let mesh = mesh.map_err(FlattenError::from)?;
        let flat = pipeline.run(&mesh, &mut Relay::new(callback))?;
        let metrics = flat.metrics(&mesh)?;
        Ok(AbfResult::of_disk(&flat, metrics))
    };
    on_threads(settings.threads, &mut work)
}

/// Unwraps a mesh into an atlas.
pub(crate) fn unwrap(
    positions: &[[f32; 3]],
    indices: &[u32],
    known: &Known<'_>,
    settings: &Settings,
    callback: Callback<'_>,
) -> Result<AbfResult, Failure> {
    let unwrapper = &settings.unwrapper;
    unwrapper.unwrap.check().map_err(|error| Failure::setting(&error))?;
    known.check(settings)?;
    let mut work = || {
        let mut relay = Relay::new(callback);
        let read = known.read(positions.len(), indices)?;
        let arrays = unwrapper.run_with(positions, indices, &read.hints(known), &mut relay)?;
        Ok(AbfResult::of_atlas(arrays, unwrapper.atlas.page, settings.may_overlap))
    };
    on_threads(settings.threads, &mut work)
}

/// About how many bytes a disk takes at most; of "auto" what its first solver takes, which is refused for too much.
pub(crate) fn predict(solver: Option<&str>, triangles: usize, vertices: usize) -> Result<u64, Failure> {
    let solver: Solver =
        solver.unwrap_or("linabf").parse().map_err(|error: abf::UnknownName| Failure::setting(&error))?;
    Ok(predict_memory(&solver, triangles, vertices))
}

fn on_threads<R: Send>(threads: usize, work: &mut (dyn FnMut() -> Result<R, Failure> + Send)) -> Result<R, Failure> {
    if threads == 0 {
        return work();
    }
    match with_threads(threads, work) {
        Ok(result) => result,
        Err(error) => Err(Failure::new(AbfStatus::Threads, error.to_string())),
    }
}
