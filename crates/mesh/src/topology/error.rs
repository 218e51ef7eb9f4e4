//! Why faces form no manifold, and which law of a corner table is broken.

use crate::{CornerId, FaceId, VertexId};

/// Why faces do not form an oriented manifold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// There is no face at all.
    #[error("the mesh has no faces")]
    Empty,
    /// More corners than 32-bit indices can name.
    #[error("the mesh has {faces} faces, more than 32-bit corner indices can name")]
    TooLarge {
        /// How many faces there are.
        faces: usize,
    },
    /// A face that uses one vertex twice.
    #[error("face {face} uses vertex {vertex} twice ({count} in all)")]
    RepeatedVertex {
        /// The first such face.
        face: FaceId,
        /// The vertex it repeats.
        vertex: VertexId,
        /// How many such faces there are.
        count: usize,
    },
    /// An edge of three or more faces.
    #[error("the edge between vertices {a} and {b} has {faces} faces ({count} in all)")]
    NonManifoldEdge {
        /// One end of the first such edge.
        a: VertexId,
        /// Its other end.
        b: VertexId,
        /// How many faces share it.
        faces: usize,
        /// How many such edges there are.
        count: usize,
    },
    /// Two faces that run along their common edge the same way; turning some faces around mends it.
    #[error(
        "faces {first} and {second} are oriented against each other along the edge between vertices {a} and {b} ({count} in all)"
    )]
    InconsistentOrientation {
        /// One face at the first such edge.
        first: FaceId,
        /// The other.
        second: FaceId,
        /// One end of the edge.
        a: VertexId,
        /// Its other end.
        b: VertexId,
        /// How many such edges there are.
        count: usize,
    },
    /// No choice of orientations fits together (a Möbius band, a Klein bottle).
    #[error("the surface has one side only: faces {first} and {second} cannot both be oriented")]
    NonOrientable {
        /// One face where the two sides meet.
        first: FaceId,
        /// The other.
        second: FaceId,
    },
    /// A vertex where several fans of faces touch in a point.
    #[error("the faces at vertex {vertex} form {fans} separate fans ({count} in all)")]
    NonManifoldVertex {
        /// The first such vertex.
        vertex: VertexId,
        /// How many fans meet there.
        fans: usize,
        /// How many such vertices there are.
        count: usize,
    },
}

/// A law of the corner table that does not hold; see [`Topology::check`](super::Topology::check).
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("corner table broken at corner {corner}: {law}")]
#[non_exhaustive]
pub struct BrokenLaw {
    /// Where.
    pub corner: CornerId,
    /// Which law.
    pub law: &'static str,
}
