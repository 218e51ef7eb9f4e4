//! The calls, without pointers.

use crate::event::{AbfEvent, Relay};
use crate::known::{Known, check_range};
use crate::options::Settings;
use crate::status::{AbfStatus, Failure};
use crate::view::AbfResult;
use abf::mesh::{Point2, Point3, TriMesh, UvId, UvMap};
use abf::metrics::measure_certified;
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
    let triangles = triangles(indices)?;
    let pipeline = &settings.unwrapper.unwrap.pipeline;
    pipeline.check().map_err(|error| Failure::setting(&error))?;
    let mut work = || {
        let mesh = mesh(positions, triangles)?;
        let flat = pipeline.run(&mesh, &mut Relay::new(callback))?;
        let metrics = flat.metrics(&mesh)?;
        Ok(AbfResult::of_disk(&mesh, &flat, metrics))
    };
    on_threads(settings.threads, &mut work)
}

/// UVs that anybody made: one per vertex, or those that the indices say.
#[derive(Clone, Copy)]
pub(crate) struct GivenMap<'a> {
    pub(crate) uv: &'a [[f64; 2]],
    pub(crate) corners: Option<&'a [u32]>,
}

/// Relaxes a map.
pub(crate) fn relax(
    positions: &[[f64; 3]],
    indices: &[u32],
    given: GivenMap<'_>,
    settings: &Settings,
    callback: Callback<'_>,
) -> Result<AbfResult, Failure> {
    let triangles = triangles(indices)?;
    let (rows, vertices) = (given.uv.len(), positions.len());
    match given.corners {
        Some(corners) => check_range(corners, rows, "uv_indices", "UVs")?,
        None if rows != vertices => {
            let text = format!(
                "uv_count must be the number of vertices, {vertices}, got {rows}; give uv_indices where UVs are per corner"
            );
            return Err(Failure::new(AbfStatus::Setting, text));
        }
        None => {}
    }
    let pipeline = &settings.unwrapper.unwrap.pipeline;
    let mut work = || {
        let mesh = mesh(positions, triangles)?;
        let points = given.uv.iter().map(|&p| Point2::from(p)).collect();
        let corners = given.corners.unwrap_or(indices).iter().map(|&i| UvId::new(i as usize)).collect();
        let map = pipeline.relax_map(&mesh, &UvMap::new(points, corners), &mut Relay::new(callback))?;
        let metrics = measure_certified(&mesh, &map.uv, map.certificate.clone())?;
        Ok(AbfResult::of_map(&mesh, &map, metrics, given.corners.is_some()))
    };
    on_threads(settings.threads, &mut work)
}

fn triangles(indices: &[u32]) -> Result<&[[u32; 3]], Failure> {
    let (triangles, rest) = indices.as_chunks::<3>();
    if rest.is_empty() {
        return Ok(triangles);
    }
    let text = format!("{} indices are no triangles: their number must be a multiple of 3", indices.len());
    Err(Failure::new(AbfStatus::IndexCount, text))
}

fn mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<TriMesh, Failure> {
    let triangles: Vec<[usize; 3]> = triangles.iter().map(|t| t.map(|i| i as usize)).collect();
    let mesh = TriMesh::new(positions.iter().copied().map(Point3::from).collect(), &triangles);
    Ok(mesh.map_err(FlattenError::from)?)
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
