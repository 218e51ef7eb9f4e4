//! What a mesh file holds.

use super::{ReadNotes, VertexColours};
use crate::{TriMesh, UvMap};

/// What a mesh file holds.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
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

impl MeshFile {
    /// A mesh, with its UVs if it has some, without colours.
    #[must_use]
    pub fn new(mesh: TriMesh, uv: Option<UvMap>, notes: ReadNotes) -> Self {
        Self { mesh, uv, colours: None, notes }
    }
}
