//! What a mesh file holds.

use super::{ReadNotes, VertexColours};
use crate::{TriMesh, UvMap};

/// What a mesh file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Vertices and triangles, in the order of the file.
    pub mesh: TriMesh,
    /// The UVs, if every corner has one.
    pub uv: Option<UvMap>,
    /// The colours of the vertices, of a PLY that has some; [`write_coloured`](super::write_coloured) keeps them.
    pub colours: Option<VertexColours>,
    /// What was done to get there, and what was left alone.
    pub notes: ReadNotes,
}
