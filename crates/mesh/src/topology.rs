//! The corner table: who is opposite whom, without coordinates.

mod build;
mod error;

pub use error::{BrokenLaw, TopologyError};

use crate::{CornerId, FaceId, VertexId};
use abf_control::{Cancelled, Checkpoint};
use build::{End, find_fans, pair_edges, reject_repeated_vertices};

/// Marks "no corner" in the packed tables.
const NONE: u32 = u32::MAX;

/// The connectivity of an oriented manifold with or without boundary, in any number of components.
///
/// Corner `3f + k` sits at the `k`-th vertex of face `f`. The edge facing a corner runs from
/// `next` to `prev`; the corner that faces the same edge from the other side is its *opposite*,
/// and a boundary edge has none.
#[derive(Clone, Debug, PartialEq)]
pub struct Topology {
    corner_vertex: Vec<VertexId>,
    opposite: Vec<u32>,
    /// For every vertex the corner its fan starts with: on the boundary the first counter-clockwise,
    /// in the interior the one of lowest index. `NONE` where no face uses the vertex.
    fan_start: Vec<u32>,
    interior: Vec<bool>,
    interior_count: usize,
    boundary_edge_count: usize,
}

impl Topology {
    /// Builds the corner table in time linear in the number of faces (edges are sorted per vertex).
    ///
    /// # Errors
    /// One [`TopologyError`] naming the first offending element and how many there are.
    ///
    /// # Panics
    /// If a face names a vertex `>= vertex_count`; a [`crate::TriMesh`] cannot hold such a face.
    pub fn build(vertex_count: usize, faces: &[[VertexId; 3]]) -> Result<Self, TopologyError> {
        Self::build_asking(vertex_count, faces, &mut || Ok(())).expect("nobody ends it")
    }

    /// [`Topology::build`] that asks between its parts and blocks whether to go on.
    ///
    /// # Errors
    /// [`Cancelled`]; inside of what comes out otherwise, as for `build`.
    ///
    /// # Panics
    /// As `build`.
    pub fn build_asking(
        vertex_count: usize,
        faces: &[[VertexId; 3]],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Result<Self, TopologyError>, Cancelled> {
        match Self::built(vertex_count, faces, checkpoint) {
            Ok(topology) => Ok(Ok(topology)),
            Err(End::Refused(error)) => Ok(Err(error)),
            Err(End::Cancelled(cancelled)) => Err(cancelled),
        }
    }

    fn built(vertex_count: usize, faces: &[[VertexId; 3]], checkpoint: &mut Checkpoint<'_>) -> Result<Self, End> {
        if faces.is_empty() {
            return Err(TopologyError::Empty.into());
        }
        if faces.len() > (NONE as usize - 1) / 3 {
            return Err(TopologyError::TooLarge { faces: faces.len() }.into());
        }
        reject_repeated_vertices(faces)?;
        let opposite = pair_edges(vertex_count, faces, checkpoint)?;
        checkpoint()?;
        let corner_vertex = faces.as_flattened().to_vec();
        let (fan_start, interior) = find_fans(vertex_count, faces, &opposite)?;
        let interior_count = interior.iter().filter(|&&i| i).count();
        let boundary_edge_count = opposite.iter().filter(|&&o| o == NONE).count();
        Ok(Self { corner_vertex, opposite, fan_start, interior, interior_count, boundary_edge_count })
    }

    /// How many vertices the mesh has, used or not.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.fan_start.len()
    }

    /// How many faces there are: `nt`.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.corner_vertex.len() / 3
    }

    /// How many corners there are: `3 nt`.
    #[must_use]
    pub fn corner_count(&self) -> usize {
        self.corner_vertex.len()
    }

    /// How many vertices have faces all around: `ni`.
    #[must_use]
    pub fn interior_vertex_count(&self) -> usize {
        self.interior_count
    }

    /// How many edges have a face on one side only.
    #[must_use]
    pub fn boundary_edge_count(&self) -> usize {
        self.boundary_edge_count
    }

    /// How many edges there are.
    #[must_use]
    pub fn edge_count(&self) -> usize {
        (self.corner_count() + self.boundary_edge_count) / 2
    }

    /// How many vertices some face uses.
    #[must_use]
    pub fn used_vertex_count(&self) -> usize {
        self.fan_start.iter().filter(|&&c| c != NONE).count()
    }

    /// Every face.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceId> + use<> {
        (0..self.face_count()).map(FaceId::new)
    }

    /// Every corner.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = CornerId> + use<> {
        (0..self.corner_count()).map(CornerId::new)
    }

    /// Every vertex, used or not.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = VertexId> + use<> {
        (0..self.vertex_count()).map(VertexId::new)
    }

    /// The vertex a corner sits at.
    #[inline]
    #[must_use]
    pub fn vertex(&self, corner: CornerId) -> VertexId {
        self.corner_vertex[corner.index()]
    }

    /// The three vertices of a face, counter-clockwise.
    #[inline]
    #[must_use]
    pub fn face_vertices(&self, face: FaceId) -> [VertexId; 3] {
        face.corners().map(|c| self.vertex(c))
    }

    /// The corner that faces the same edge from the other side; `None` on the boundary.
    #[inline]
    #[must_use]
    pub fn opposite(&self, corner: CornerId) -> Option<CornerId> {
        match self.opposite[corner.index()] {
            NONE => None,
            other => Some(CornerId::new(other as usize)),
        }
    }

    /// The opposite of every corner, `u32::MAX` where there is none.
    #[must_use]
    pub fn packed_opposites(&self) -> &[u32] {
        &self.opposite
    }

    /// The next corner counter-clockwise around the same vertex; `None` past the last of a
    /// boundary fan.
    #[inline]
    #[must_use]
    pub fn rotate_ccw(&self, corner: CornerId) -> Option<CornerId> {
        self.opposite(corner.next()).map(CornerId::next)
    }

    /// The next corner clockwise around the same vertex; `None` past the first of a boundary fan.
    #[inline]
    #[must_use]
    pub fn rotate_cw(&self, corner: CornerId) -> Option<CornerId> {
        self.opposite(corner.prev()).map(CornerId::prev)
    }

    /// Whether the vertex has faces all around.
    #[inline]
    #[must_use]
    pub fn is_interior(&self, vertex: VertexId) -> bool {
        self.interior[vertex.index()]
    }

    /// Whether the vertex lies on the boundary (a vertex without faces does not).
    #[must_use]
    pub fn is_boundary(&self, vertex: VertexId) -> bool {
        !self.is_interior(vertex) && self.fan_start(vertex).is_some()
    }

    /// The corner the fan of a vertex starts with: on the boundary the first counter-clockwise.
    /// `None` where no face uses the vertex.
    #[must_use]
    pub fn fan_start(&self, vertex: VertexId) -> Option<CornerId> {
        match self.fan_start[vertex.index()] {
            NONE => None,
            corner => Some(CornerId::new(corner as usize)),
        }
    }

    /// The corners at a vertex, counter-clockwise, each once.
    pub fn fan(&self, vertex: VertexId) -> impl Iterator<Item = CornerId> + '_ {
        let start = self.fan_start(vertex);
        std::iter::successors(start, move |&c| self.rotate_ccw(c).filter(|&next| Some(next) != start))
    }

    /// Asserts every law of the corner table. Tests call it after every change.
    ///
    /// # Errors
    /// The first law that does not hold.
    pub fn check(&self) -> Result<(), BrokenLaw> {
        let mut seen = vec![false; self.corner_count()];
        for c in self.corners() {
            let broken = |law| Err(BrokenLaw { corner: c, law });
            if let Some(o) = self.opposite(c) {
                if self.opposite(o) != Some(c) {
                    return broken("the opposite of the opposite is the corner itself");
                }
                if self.vertex(o.next()) != self.vertex(c.prev()) || self.vertex(o.prev()) != self.vertex(c.next()) {
                    return broken("opposite corners face the same edge in opposite directions");
                }
                if o.face() == c.face() {
                    return broken("a face is not its own neighbour");
                }
            } else if self.is_interior(self.vertex(c.next())) || self.is_interior(self.vertex(c.prev())) {
                return broken("both ends of a boundary edge lie on the boundary");
            }
        }
        for v in self.vertices() {
            for c in self.fan(v) {
                let broken = |law| Err(BrokenLaw { corner: c, law });
                if self.vertex(c) != v {
                    return broken("a fan stays at its vertex");
                }
                if std::mem::replace(&mut seen[c.index()], true) {
                    return broken("a fan visits each corner once");
                }
            }
            let closed = self.fan_start(v).is_some_and(|start| self.rotate_cw(start).is_some());
            if closed != self.is_interior(v) {
                let corner = self.fan_start(v).unwrap_or(CornerId::new(0));
                return Err(BrokenLaw { corner, law: "a vertex is interior exactly when its fan closes" });
            }
        }
        match seen.iter().position(|&s| !s) {
            Some(c) => Err(BrokenLaw { corner: CornerId::new(c), law: "every corner is in the fan of its vertex" }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(faces: &[[usize; 3]]) -> Vec<[VertexId; 3]> {
        faces.iter().map(|f| f.map(VertexId::new)).collect()
    }

    fn build(n: usize, faces: &[[usize; 3]]) -> Result<Topology, TopologyError> {
        let topology = Topology::build(n, &ids(faces))?;
        topology.check().expect("every law holds");
        Ok(topology)
    }

    #[test]
    fn a_fan_is_walked_counter_clockwise_from_the_boundary() {
        let t = build(5, &[[0, 3, 4], [0, 1, 2], [0, 2, 3]]).expect("a fan");
        let around: Vec<usize> = t.fan(VertexId::new(0)).map(|c| t.vertex(c.next()).index()).collect();
        assert_eq!(around, [1, 2, 3]);
        assert_eq!(t.boundary_edge_count(), 5);
        assert_eq!(t.edge_count(), 7);
        assert_eq!(t.interior_vertex_count(), 0);
    }

    #[test]
    fn a_closed_fan_has_an_interior_vertex() {
        let t = build(5, &[[0, 1, 2], [0, 2, 3], [0, 3, 1]]).expect("a pyramid without its base");
        assert!(t.is_interior(VertexId::new(0)));
        assert_eq!(t.fan(VertexId::new(0)).count(), 3);
        assert!(!t.is_boundary(VertexId::new(4)) && t.fan_start(VertexId::new(4)).is_none());
        assert_eq!(t.used_vertex_count(), 4);
    }

    #[test]
    fn rejects_an_edge_of_three_faces() {
        let e = build(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]).unwrap_err();
        let (a, b) = (VertexId::new(0), VertexId::new(1));
        assert_eq!(e, TopologyError::NonManifoldEdge { a, b, faces: 3, count: 1 });
    }

    #[test]
    fn rejects_faces_oriented_against_each_other() {
        let e = build(4, &[[0, 1, 2], [0, 1, 3]]).unwrap_err();
        assert!(matches!(e, TopologyError::InconsistentOrientation { count: 1, .. }), "{e}");
    }

    #[test]
    fn tells_a_one_sided_surface_from_a_badly_oriented_one() {
        // The five-vertex Möbius band.
        let e = build(5, &[[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]]).unwrap_err();
        assert!(matches!(e, TopologyError::NonOrientable { .. }), "{e}");
    }

    #[test]
    fn rejects_two_fans_that_touch_in_a_vertex() {
        let e = build(5, &[[0, 1, 2], [0, 3, 4]]).unwrap_err();
        assert_eq!(e, TopologyError::NonManifoldVertex { vertex: VertexId::new(0), fans: 2, count: 1 });
        let closed_and_open = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [0, 4, 5]];
        let e = build(6, &closed_and_open).unwrap_err();
        assert_eq!(e, TopologyError::NonManifoldVertex { vertex: VertexId::new(0), fans: 2, count: 1 });
    }

    #[test]
    fn rejects_a_face_that_repeats_a_vertex() {
        let e = build(3, &[[0, 1, 2], [2, 1, 2]]).unwrap_err();
        let (face, vertex) = (FaceId::new(1), VertexId::new(2));
        assert_eq!(e, TopologyError::RepeatedVertex { face, vertex, count: 1 });
    }

    #[test]
    fn rejects_no_faces() {
        assert_eq!(build(3, &[]).unwrap_err(), TopologyError::Empty);
    }

    #[test]
    fn two_triangles_glued_along_two_edges_are_a_manifold() {
        // The vertex they both surround has degree two.
        let t = build(3, &[[0, 1, 2], [0, 2, 1]]).expect("a two-sided triangle");
        assert_eq!(t.boundary_edge_count(), 0);
        assert!(t.is_interior(VertexId::new(0)));
    }
}
