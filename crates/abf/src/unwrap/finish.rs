//! From a flattened chart with virtual faces to one without.

use super::component::Finished;
use crate::{FlattenError, Flattening};
use abf_cut::Chart;
use abf_mesh::{TriMesh, UvId, UvMap, VertexId};
use abf_metrics::{Certificate, certify, measure_certified, per_face};
use abf_solve_core::AngleSolution;

/// Drops the faces from `real` on, gives the rest the area of its surface, and judges it.
pub(super) fn finish(chart: &Chart, real: usize, flat: Flattening) -> Result<Finished, FlattenError> {
    let layout_error = layout_error(chart, real, &flat)?;
    let (uv, metrics) = if real == chart.mesh.face_count() {
        let metrics = measure_certified(&chart.mesh, &flat.uv, flat.certificate)?;
        (flat.uv, metrics)
    } else {
        let faces: Vec<[usize; 3]> = chart.mesh.faces()[..real].iter().map(|face| face.map(VertexId::index)).collect();
        let mesh = TriMesh::new(chart.mesh.positions().to_vec(), &faces)?;
        let precision = flat.certificate.precision;
        let uv = of_first_faces(&flat.uv, real);
        let factor = (mesh.area() / uv.signed_area()).sqrt();
        let factor = if factor.is_finite() && flat.layout.scaled { factor } else { 1.0 };
        let uv = uv.mapped(|p| p.map(|x| precision.round(x * factor)));
        let constraint_residual = flat.certificate.constraint_residual;
        let certificate = Certificate { constraint_residual, ..certify(&mesh, &uv, precision)? };
        let metrics = measure_certified(&mesh, &uv, certificate)?;
        (uv, metrics)
    };
    Ok(Finished {
        uv,
        metrics,
        solver: flat.solver,
        termination: flat.termination,
        layout: flat.layout,
        rungs: flat.rungs,
        layout_error,
        rounds: 0,
        holes_filled: 0,
        virtual_faces: 0,
    })
}

/// The largest difference between a laid-out angle and the one solved for, rad.
fn layout_error(chart: &Chart, real: usize, flat: &Flattening) -> Result<Option<f64>, FlattenError> {
    let Some(angles) = flat.solution.as_ref().map(AngleSolution::angles) else { return Ok(None) };
    let faces = per_face(&chart.mesh, &flat.uv)?;
    let laid_out = faces[..real].iter().flat_map(|face| face.uv_angles);
    Ok(Some(laid_out.zip(angles).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)))
}

/// The map of the first faces, with the points they use in their order.
fn of_first_faces(uv: &UvMap, faces: usize) -> UvMap {
    let corners = &uv.corners()[..3 * faces];
    let mut is_used = vec![false; uv.points().len()];
    corners.iter().for_each(|c| is_used[c.index()] = true);
    let mut number = vec![UvId::new(0); is_used.len()];
    let mut points = Vec::new();
    for (i, point) in uv.points().iter().enumerate().filter(|&(i, _)| is_used[i]) {
        number[i] = UvId::new(points.len());
        points.push(*point);
    }
    UvMap::new(points, corners.iter().map(|c| number[c.index()]).collect())
}
