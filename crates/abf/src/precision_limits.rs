//! How near a drawing is to what doubles can hold.

use abf_mesh::{TriMesh, UvMap};
use abf_metrics::Certificate;

/// Lengths that shrink by this much more in one place of a map than in another are beyond what doubles hold safely: of
/// their 16 digits few are left for the triangles in the small places.
const MOST_SPREAD: f64 = 1e12;

/// Faces with less than this share of the surface have no shape to compare with: the rule of `degenerate_3d`.
const NO_AREA: f64 = 1e-14;

/// Why double precision, and not the method, is what a drawing suffers from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrecisionLimits {
    /// Triangles whose area is within the rounding of their coordinates: valid as they are, but not safe from another
    /// rounding ([`Certificate::near_collapsed`]).
    pub near_collapsed: usize,
    /// Triangles that the descent held in place in its last step, because a few roundings could turn them over.
    pub held_faces: usize,
    /// How much more lengths shrink in one place than in another: the largest `√(A₂ / A₃)` over the smallest. Infinite
    /// with a collapsed triangle.
    pub spread: f64,
}

impl PrecisionLimits {
    /// The limits a drawing has come to, if it has come to any.
    pub(crate) fn of(certificate: &Certificate, held_faces: usize, spread: f64) -> Option<Self> {
        let limits = Self { near_collapsed: certificate.near_collapsed, held_faces, spread };
        let is_near = limits.near_collapsed > 0 || limits.held_faces > 0 || limits.spread > MOST_SPREAD;
        is_near.then_some(limits)
    }
}

/// The largest `√(A₂ / A₃)` over the smallest.
pub(crate) fn spread(mesh: &TriMesh, uv: &UvMap) -> f64 {
    let surface = mesh.triangles().map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm());
    let least = NO_AREA * mesh.area();
    let flat = uv.triangles().map(|[a, b, c]| 0.5 * (b - a).perp(&(c - a)).abs());
    let ratios = surface.zip(flat).filter(|&(surface, _)| surface > least).map(|(surface, flat)| flat / surface);
    let (low, high) = ratios.fold((f64::INFINITY, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
    if high > 0.0 { (high / low).sqrt() } else { 1.0 }
}
