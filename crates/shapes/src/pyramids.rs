//! Curvature in a single vertex: the obtuse apex, the low pyramid and the spike.

use crate::lattice::{RingVertex, Rings};
use crate::portable::sin_cos;
use abf_mesh::{Point3, TriMesh};
use std::f64::consts::TAU;

/// Apex angle of each face of the low pyramid: six of them leave a deficit of π/6.
const LOW_APEX_ANGLE: f64 = 55.0 * TAU / 360.0;

/// Apex angle of each face of the spike: six of them leave a deficit of 4π/3.
const SPIKE_APEX_ANGLE: f64 = 20.0 * TAU / 360.0;

/// Three triangles around an apex with |2π − Σα°| = 4.56, after Figure 4 of Zayer, Lévy, Seidel,
/// *Linear Angle Based Parameterization*, 2007: one linear step from the mesh's own angles leaves
/// (0, π) here, one from the angles of the exponential map does not.
pub(crate) fn obtuse() -> TriMesh {
    let positions = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.985_639_21, 1.050_957_5]];
    let faces = [[0, 1, 3], [1, 2, 3], [2, 0, 3]];
    TriMesh::new(positions.map(Point3::from).to_vec(), &faces).expect("the faces use the four vertices")
}

/// A flat roof: deficit π/6 at the apex, none elsewhere.
pub(crate) fn low(triangles: usize) -> TriMesh {
    pyramid(triangles, LOW_APEX_ANGLE)
}

/// A needle: deficit 4π/3 at the apex, none elsewhere.
pub(crate) fn spike(triangles: usize) -> TriMesh {
    pyramid(triangles, SPIKE_APEX_ANGLE)
}

/// A pyramid without base over a regular polygon, lateral edges of length 1, each face divided
/// into `rings²` equal triangles.
///
/// With apex angle γ the base edges are 2 sin(γ/2), so the polygon of `n` sides has circumradius
/// R = sin(γ/2) / sin(π/n), and the apex stands √(1 − R²) above it.
fn pyramid(triangles: usize, apex_angle: f64) -> TriMesh {
    let (half_base, _) = sin_cos(apex_angle / 2.0);
    let (half_turn, _) = sin_cos(TAU / 2.0 / Rings::SECTORS as f64);
    let circumradius = half_base / half_turn;
    let height = (1.0 - circumradius * circumradius).sqrt();
    Rings::sized(triangles).lift(|v| {
        let corner = |sector| RingVertex { radius: v.radius * circumradius, sector, through: 0.0, ..v }.in_unit_disk();
        let ((ax, ay), (bx, by)) = (corner(v.sector), corner(v.sector + 1));
        let (s, t) = (1.0 - v.through, v.through);
        Point3::new(s * ax + t * bx, s * ay + t * by, height * (1.0 - v.radius))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Angle sum at one vertex.
    fn angle_sum(mesh: &TriMesh, vertex: usize) -> f64 {
        let angles = mesh.corner_angles();
        mesh.faces().iter().flatten().zip(angles).filter(|(v, _)| v.index() == vertex).map(|(_, a)| a).sum()
    }

    #[test]
    fn the_obtuse_apex_has_the_published_deficit() {
        assert!(((TAU - angle_sum(&obtuse(), 3)).abs() - 4.56).abs() < 0.005);
    }

    #[test]
    fn pyramids_have_the_stated_deficit_at_every_size() {
        for triangles in [6, 150, 600] {
            assert!((TAU - angle_sum(&low(triangles), 0) - TAU / 12.0).abs() < 1e-6);
            assert!((TAU - angle_sum(&spike(triangles), 0) - TAU / 1.5).abs() < 1e-6);
        }
    }

    #[test]
    fn the_smallest_pyramid_is_a_plain_fan() {
        assert_eq!(low(0).face_count(), Rings::SECTORS);
    }
}
