//! Meshes with angles below the bound: solved with their own angles and with bounded ones, and the better kept.
//!
//! Neither is always right. A flat sheet with needles in it is exact with its own angles; a needle on a curved surface can
//! spoil the linearisation, and the bound is what keeps its neighbours in shape. A map that is no worse around its thin triangles
//! than elsewhere has nothing to gain from the bound, and is the only one that is made.

use crate::{FlattenError, Flattening, SolverKind};
use abf_control::{Event, Observer, Termination, ask};
use abf_mesh::TriMesh;
use abf_metrics::{FaceDistortion, Metrics, per_face};
use std::f64::consts::PI;

/// A map whose L² stretch is above 1 by no more than this has nothing to gain.
const ISOMETRIC: f64 = 1e-9;

/// Stretches this near to each other, relative, are the same: the weighted F decides then.
const SAME_STRETCH: f64 = 1e-6;

/// What is known of a mesh with thin triangles.
#[derive(Clone, Copy)]
pub(super) struct ThinMesh<'m> {
    pub(super) mesh: &'m TriMesh,
    /// Below it, or as near to π, the angles of a triangle are thin, rad.
    pub(super) angle_bound: f64,
    /// A stretch that is as good as 1.
    pub(super) enough: f64,
}

/// The better of a result and another, which is made only where the first leaves something to gain. `bounded` is told whose
/// result the first is.
pub(super) fn better(
    ThinMesh { mesh, angle_bound, enough }: ThinMesh<'_>,
    own: Result<Flattening, FlattenError>,
    observer: &mut dyn Observer,
    bounded: impl FnOnce(Option<SolverKind>, &mut dyn Observer) -> Result<Flattening, FlattenError>,
) -> Result<Flattening, FlattenError> {
    let own = match own {
        Ok(own) => own,
        Err(FlattenError::Cancelled(cancelled)) => return Err(cancelled.into()),
        Err(error) => return bounded(None, observer).map_err(|_| error),
    };
    ask(observer, Event::Working)?;
    let Ok(with_own) = own.metrics(mesh) else { return Ok(own) };
    ask(observer, Event::Working)?;
    let has_nothing_to_gain = || {
        with_own.stretch_l2 <= enough.max(1.0 + ISOMETRIC)
            || (with_own.injective()
                && per_face(mesh, &own.uv).is_ok_and(|faces| is_elsewhere(mesh, angle_bound, &faces)))
    };
    let is_enough = own.is_certified() && has_nothing_to_gain();
    if is_enough || own.termination == Termination::Cancelled {
        return Ok(own);
    }
    let bounded = match bounded(Some(own.solver), observer) {
        Ok(bounded) => bounded,
        Err(FlattenError::Cancelled(cancelled)) => return Err(cancelled.into()),
        Err(_) => return Ok(own),
    };
    ask(observer, Event::Working)?;
    let Ok(with_bound) = bounded.metrics(mesh) else { return Ok(own) };
    let is_better = is_better(&(&bounded, &with_bound), &(&own, &with_own));
    Ok(if is_better { bounded } else { own })
}

/// Whether the stretch is no more around thin triangles, at whose vertices the bound would change something, than on the whole
/// surface: their part of what its square is above 1 is no more than their part of the surface.
fn is_elsewhere(mesh: &TriMesh, angle_bound: f64, faces: &[FaceDistortion]) -> bool {
    let is_thin = |face: &FaceDistortion| {
        face.degenerate_3d || face.mesh_angles.iter().any(|&angle| !(angle_bound..=PI - angle_bound).contains(&angle))
    };
    let mut is_near = vec![false; mesh.vertex_count()];
    for (_, vertices) in faces.iter().zip(mesh.faces()).filter(|(face, _)| is_thin(face)) {
        vertices.iter().for_each(|v| is_near[v.index()] = true);
    }
    let (mut surface, mut near, mut all) = (0.0, 0.0, 0.0);
    for (face, vertices) in faces.iter().zip(mesh.faces()).filter(|(face, _)| !face.degenerate_3d) {
        let excess = face.surface_share * (face.stretch_l2.powi(2) - 1.0);
        all += excess;
        if vertices.iter().any(|v| is_near[v.index()]) {
            surface += face.surface_share;
            near += excess;
        }
    }
    near <= surface * all
}

/// Certified before valid before not; then without overlap, less stretch, less relative angle error.
fn is_better(one: &(&Flattening, &Metrics), other: &(&Flattening, &Metrics)) -> bool {
    let rank = |(flat, metrics): &(&Flattening, &Metrics)| (flat.is_certified(), metrics.valid(), metrics.injective());
    if rank(one) != rank(other) {
        return rank(one) > rank(other);
    }
    let (a, b) = (one.1.stretch_l2, other.1.stretch_l2);
    let is_same = (a - b).abs() <= SAME_STRETCH * b;
    if is_same { one.1.f_weighted < other.1.f_weighted } else { a < b }
}
