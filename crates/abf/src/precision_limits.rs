//! How near a drawing is to what doubles can hold.

use abf_mesh::FaceId;
use abf_metrics::Certificate;

/// Lengths that shrink by this much more in one place of a map than in another are beyond what doubles hold safely: of
/// their 16 digits few are left for the triangles in the small places.
const MOST_SPREAD: f64 = 1e12;

/// Why double precision, and not the method, is what a drawing suffers from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PrecisionLimits {
    /// Triangles whose area is within the rounding of their coordinates: valid as they are, but not safe from another
    /// rounding ([`Certificate::near_collapsed`]).
    pub near_collapsed: usize,
    /// The first of them, at most [`Certificate::LISTED`].
    pub near_collapsed_faces: Vec<FaceId>,
    /// Triangles that the descent held in place in its last step, because a few roundings could turn them over.
    pub held_faces: usize,
    /// The first of them.
    pub first_held_faces: Vec<FaceId>,
    /// How much more lengths shrink in one place than in another ([`Certificate::spread`]).
    pub spread: f64,
}

impl PrecisionLimits {
    /// The limits a drawing has come to, if it has come to any.
    pub(crate) fn of(certificate: &Certificate, held: &[FaceId]) -> Option<Self> {
        let limits = Self {
            near_collapsed: certificate.near_collapsed,
            near_collapsed_faces: certificate.near_collapsed_faces.clone(),
            held_faces: held.len(),
            first_held_faces: held.iter().copied().take(Certificate::LISTED).collect(),
            spread: certificate.spread,
        };
        let is_near = limits.near_collapsed > 0 || limits.held_faces > 0 || limits.spread > MOST_SPREAD;
        is_near.then_some(limits)
    }
}
