//! What cannot be measured.

use abf_control::Cancelled;
use abf_mesh::FaceId;

/// Why a mesh and its UVs cannot be measured.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MetricsError {
    /// The checkpoint ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no face at all.
    #[error("the mesh has no faces")]
    NoFaces,
    /// The UV map belongs to another mesh.
    #[error("the UV map has {corners} corners, but the mesh has {faces} faces of 3 corners each")]
    CornerCount {
        /// How many corners the map has.
        corners: usize,
        /// How many faces the mesh has.
        faces: usize,
    },
    /// A face with a NaN or infinite UV.
    #[error("face {first} has a UV that is not finite ({count} in all)")]
    UvNotFinite {
        /// The first such face.
        first: FaceId,
        /// How many there are.
        count: usize,
    },
    /// A face with a NaN or infinite vertex.
    #[error("face {first} has a vertex that is not finite ({count} in all)")]
    PositionNotFinite {
        /// The first such face.
        first: FaceId,
        /// How many there are.
        count: usize,
    },
    /// Every face is a line or a point in 3-D.
    #[error("the surface has no area: the corners of each of its {faces} faces lie on one line")]
    NoArea {
        /// How many faces there are.
        faces: usize,
    },
}
