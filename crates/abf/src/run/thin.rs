//! Meshes with angles below the bound: solved with their own angles and with bounded ones, and the better kept.
//!
//! Neither is always right. A flat sheet with needles in it is exact with its own angles; a needle on a curved surface can
//! spoil the linearisation, and the bound is what keeps its neighbours in shape. Where the first map is no worse around thin
//! triangles than elsewhere, they are not what spoils it, and it is the only one that is made.

use super::hearing::Hearing;
use crate::{FlattenError, Flattening, SolverKind};
use abf_control::{Event, Observer, Termination, ask};
use abf_mesh::TriMesh;
use abf_metrics::{FaceDistortion, Metrics, per_face};
use std::f64::consts::PI;

/// A map whose L² stretch is above 1 by no more than this has nothing to gain.
pub(super) const ISOMETRIC: f64 = 1e-9;

/// Stretches this near to each other, relative, are the same: the weighted F decides then.
const SAME_STRETCH: f64 = 1e-6;

/// What is known of a mesh with thin triangles.
#[derive(Clone, Copy)]
pub(super) struct ThinMesh<'m> {
    pub(super) mesh: &'m TriMesh,
    /// Below it, or as near to π, the angles of a triangle are thin, rad.
    pub(super) angle_bound: f64,
    /// A stretch that is as good as 1, for a chart that is cut where it misses it; `None` for a lone disk.
    pub(super) enough: Option<f64>,
    /// Whether it lies in a plane.
    pub(super) is_flat: bool,
}

/// The better of a result and another, which is made only where the first leaves something to gain. `other` is told whose
/// result the first is; it has none where there is no other way.
pub(super) fn better(
    ThinMesh { mesh, angle_bound, enough, is_flat }: ThinMesh<'_>,
    own: Result<Flattening, FlattenError>,
    observer: &mut dyn Observer,
    other: impl FnOnce(Option<SolverKind>, &mut dyn Observer) -> Result<Option<Flattening>, FlattenError>,
) -> Result<Flattening, FlattenError> {
    let observer = &mut Hearing::new(observer);
    let own = match own {
        Ok(own) => own,
        Err(FlattenError::Cancelled(cancelled)) => return Err(cancelled.into()),
        Err(error) => {
            let other = other(None, observer);
            observer.aborted()?;
            return other.ok().flatten().ok_or(error);
        }
    };
    ask(observer, Event::Working)?;
    let Ok(with_own) = own.metrics(mesh) else { return Ok(own) };
    ask(observer, Event::Working)?;
    let is_as_good_as_1 = || with_own.stretch_l2 <= enough.unwrap_or(1.0).max(1.0 + ISOMETRIC);
    // A chart that misses its aim is cut: before that both are made. A flat mesh is not spoilt, wherever it is worse.
    let is_spoilt_elsewhere = || {
        enough.is_none()
            && !is_flat
            && with_own.injective()
            && per_face(mesh, &own.uv).is_ok_and(|faces| is_elsewhere(mesh, angle_bound, &faces))
    };
    let is_enough = own.is_certified() && (is_as_good_as_1() || is_spoilt_elsewhere());
    if is_enough || own.termination == Termination::Cancelled {
        return Ok(own);
    }
    let other = other(Some(own.solver), observer);
    observer.aborted()?;
    let other = match other {
        Ok(Some(other)) => other,
        // It was stopped: the first result is there.
        Err(FlattenError::Cancelled(_)) => return Ok(Flattening { termination: Termination::Cancelled, ..own }),
        Ok(None) | Err(_) => return Ok(own),
    };
    ask(observer, Event::Working)?;
    let Ok(of_other) = other.metrics(mesh) else { return Ok(own) };
    let is_better = is_better(&(&other, &of_other), &(&own, &with_own));
    let rungs = [&own, &other].into_iter().flat_map(|flat| flat.rungs.iter().cloned()).collect();
    let kept = if is_better { other } else { own };
    Ok(Flattening { rungs, ..kept })
}

/// Whether the map is no worse around thin triangles, at whose vertices the bound would change something, than on the rest of the
/// surface. `false` where there is no rest.
fn is_elsewhere(mesh: &TriMesh, angle_bound: f64, faces: &[FaceDistortion]) -> bool {
    let is_thin = |face: &FaceDistortion| {
        face.degenerate_3d || face.mesh_angles.iter().any(|&angle| !(angle_bound..=PI - angle_bound).contains(&angle))
    };
    let mut is_near = vec![false; mesh.vertex_count()];
    for (_, vertices) in faces.iter().zip(mesh.faces()).filter(|(face, _)| is_thin(face)) {
        vertices.iter().for_each(|v| is_near[v.index()] = true);
    }
    let (mut near, mut rest) = (Part::default(), Part::default());
    for (face, vertices) in faces.iter().zip(mesh.faces()).filter(|(face, _)| !face.degenerate_3d) {
        let part = if vertices.iter().any(|v| is_near[v.index()]) { &mut near } else { &mut rest };
        part.surface += face.surface_share;
        part.distortion += face.surface_share * symmetric_distortion(face);
    }
    let is_known = near.distortion.is_finite() && rest.distortion.is_finite() && rest.surface > 0.0;
    is_known && near.distortion * rest.surface <= rest.distortion * near.surface
}

/// Some faces together.
#[derive(Default)]
struct Part {
    surface: f64,
    distortion: f64,
}

/// What a face is stretched and what it is enlarged by: the mean of `(s₁² + s₂²)/2` and `(1/s₁² + 1/s₂²)/2`, less 1, where the map
/// keeps the area of the whole. 0 for an isometry, never less.
fn symmetric_distortion(face: &FaceDistortion) -> f64 {
    0.5 * face.stretch_l2.powi(2) * (1.0 + face.area_ratio.powi(2)) - 1.0
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

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::{Point2, Point3, UvMap};

    const BOUND: f64 = 1e-3;

    /// A row of squares and a needle below one of its edges; the UVs are those of the surface, but for what `moved` does.
    fn is_elsewhere_with(squares: usize, moved: impl Fn(usize, Point2<f64>) -> Point2<f64>) -> bool {
        let mut points: Vec<[f64; 3]> = (0..=squares).flat_map(|i| [0.0, 1.0].map(|y| [i as f64, y, 0.0])).collect();
        points.push([0.5, -1e-4, 0.0]);
        let needle = points.len() - 1;
        let mut faces: Vec<[usize; 3]> =
            (0..squares).map(|i| 2 * i).flat_map(|a| [[a, a + 2, a + 3], [a, a + 3, a + 1]]).collect();
        faces.push([0, needle, 2]);
        let mesh = TriMesh::new(points.into_iter().map(Point3::from).collect(), &faces).expect("indices in range");
        let uv: Vec<Point2<f64>> =
            mesh.positions().iter().enumerate().map(|(v, p)| moved(v, Point2::new(p.x, p.y))).collect();
        let faces = per_face(&mesh, &UvMap::per_vertex(&mesh, &uv)).expect("faces");
        is_elsewhere(&mesh, BOUND, &faces)
    }

    #[test]
    fn a_map_is_spoilt_elsewhere_or_around_its_thin_triangles() {
        let far = 19;
        assert!(is_elsewhere_with(9, |v, p| if v == far { p + abf_mesh::Vector2::new(3.0, 0.0) } else { p }));
        assert!(
            !is_elsewhere_with(9, |v, p| if v == 1 { p + abf_mesh::Vector2::new(-3.0, 0.0) } else { p }),
            "enlarged"
        );
        assert!(!is_elsewhere_with(9, |v, p| if v == 1 { Point2::new(0.0, 0.1) } else { p }), "shrunk");
    }

    #[test]
    fn where_every_face_is_near_a_thin_one_nothing_is_known() {
        assert!(!is_elsewhere_with(1, |_, p| p));
    }

    #[test]
    fn what_is_enlarged_is_distorted_as_much_as_what_shrinks() {
        let face = |scale: f64| {
            let mesh = TriMesh::new(
                [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, 1.0, 0.0]]
                    .map(Point3::from)
                    .to_vec(),
                &[[0, 1, 2], [3, 4, 5]],
            )
            .expect("indices in range");
            let uv = [[0.0, 0.0], [scale, 0.0], [0.0, scale], [5.0, 0.0], [6.0, 0.0], [5.0, 1.0]].map(Point2::from);
            per_face(&mesh, &UvMap::per_vertex(&mesh, &uv))
                .expect("faces")
                .iter()
                .map(symmetric_distortion)
                .sum::<f64>()
        };
        assert!(face(1.0).abs() < 1e-12);
        assert!((face(2.0) - face(0.5)).abs() < 1e-12 && face(2.0) > 0.1);
    }
}
