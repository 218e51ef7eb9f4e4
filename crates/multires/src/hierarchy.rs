//! What coarsening leaves.

use abf_mesh::{TriMesh, VertexId};

/// A mesh, its coarser versions, and the way back.
///
/// A vertex keeps its index on every level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hierarchy {
    pub(crate) removals: Vec<Removal>,
    /// The rings of all removals, one after the other.
    pub(crate) rings: Vec<VertexId>,
    /// Where each round of removals ends.
    pub(crate) rounds: Vec<usize>,
    /// Those below the mesh itself, the coarsest last; never empty.
    pub(crate) levels: Vec<Level>,
    /// How many the mesh has.
    pub(crate) vertices: usize,
}

/// A vertex that was removed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Removal {
    pub(crate) vertex: VertexId,
    /// Where its ring ends.
    pub(crate) ring_end: usize,
    pub(crate) is_closed: bool,
}

/// The faces after so many rounds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Level {
    pub(crate) faces: Vec<[VertexId; 3]>,
    pub(crate) rounds: usize,
}

/// The coarsest version as a mesh of its own.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CoarseMesh {
    /// The mesh.
    pub mesh: TriMesh,
    /// Which vertex of the fine mesh each of its vertices is.
    pub vertices: Vec<VertexId>,
}

impl Hierarchy {
    /// How many vertices were removed, all rounds together.
    #[must_use]
    pub fn removed(&self) -> usize {
        self.removals.len()
    }

    /// How many rounds there were.
    #[must_use]
    pub fn rounds(&self) -> usize {
        self.rounds.len()
    }

    /// How many triangles the versions below the mesh itself have, the finest first; the last is the coarsest.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.levels.iter().map(|level| level.faces.len())
    }

    /// The coarsest version of `mesh`, its vertices in the order that they have there.
    ///
    /// # Panics
    /// If it is not the mesh that was coarsened.
    #[must_use]
    pub fn coarsest(&self, mesh: &TriMesh) -> CoarseMesh {
        self.level(mesh, self.levels.len() - 1)
    }

    /// A version of `mesh`, counted from 0, the finest below the mesh itself; its vertices in the order that they have there.
    ///
    /// # Panics
    /// If it is not the mesh that was coarsened, or there is no such version.
    #[must_use]
    pub fn level(&self, mesh: &TriMesh, level: usize) -> CoarseMesh {
        assert_eq!(mesh.vertex_count(), self.vertices, "the mesh that was coarsened");
        let faces = &self.levels[level].faces;
        let mut number = vec![usize::MAX; self.vertices];
        faces.iter().flatten().for_each(|v| number[v.index()] = 0);
        let mut vertices = Vec::new();
        for (v, number) in number.iter_mut().enumerate().filter(|(_, number)| **number == 0) {
            *number = vertices.len();
            vertices.push(VertexId::new(v));
        }
        let positions = vertices.iter().map(|v| mesh.positions()[v.index()]).collect();
        let faces: Vec<[usize; 3]> = faces.iter().map(|face| face.map(|v| number[v.index()])).collect();
        let mesh = TriMesh::new(positions, &faces).expect("numbers of its vertices");
        CoarseMesh { mesh, vertices }
    }

    /// The removals of a round, counted from 0, each by its number.
    pub(crate) fn round(&self, round: usize) -> std::ops::Range<usize> {
        let start = if round == 0 { 0 } else { self.rounds[round - 1] };
        start..self.rounds[round]
    }

    /// The neighbours of a removed vertex, counter-clockwise.
    pub(crate) fn ring(&self, removal: usize) -> &[VertexId] {
        let start = if removal == 0 { 0 } else { self.removals[removal - 1].ring_end };
        &self.rings[start..self.removals[removal].ring_end]
    }
}
