//! Which edges are cut.

use abf_mesh::{CornerId, Topology, TriMesh, VertexId};

/// A set of interior edges of a [`Topology`].
///
/// An edge is named by a corner that faces it; both sides name the same edge.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seams {
    marked: Vec<bool>,
    count: usize,
}

impl Seams {
    /// No seam.
    #[must_use]
    pub fn none(topology: &Topology) -> Self {
        Self { marked: vec![false; topology.corner_count()], count: 0 }
    }

    /// The interior edges for which `is_seam` holds; it is asked once for each, with the lower corner that faces it and
    /// the opposite one.
    #[must_use]
    pub fn where_edges(topology: &Topology, is_seam: impl Fn(CornerId, CornerId) -> bool) -> Self {
        let mut seams = Self::none(topology);
        for (corner, opposite) in interior_edges(topology) {
            if is_seam(corner, opposite) {
                seams.insert(topology, corner);
            }
        }
        seams
    }

    /// Whether the edge that `corner` faces is a seam.
    #[inline]
    #[must_use]
    pub fn contains(&self, corner: CornerId) -> bool {
        self.marked[corner.index()]
    }

    /// Adds the edge that `corner` faces. Edges of the boundary are cut already and are left out.
    pub fn insert(&mut self, topology: &Topology, corner: CornerId) {
        let Some(opposite) = topology.opposite(corner) else { return };
        if !self.marked[corner.index()] {
            self.marked[corner.index()] = true;
            self.marked[opposite.index()] = true;
            self.count += 1;
        }
    }

    /// Takes an edge out.
    pub(crate) fn remove(&mut self, topology: &Topology, corner: CornerId) {
        if let (Some(opposite), true) = (topology.opposite(corner), self.marked[corner.index()]) {
            self.marked[corner.index()] = false;
            self.marked[opposite.index()] = false;
            self.count -= 1;
        }
    }

    /// How many edges are seams.
    #[must_use]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether none is.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Every seam, by the lower of the two corners that face it.
    pub fn edges(&self, topology: &Topology) -> impl Iterator<Item = CornerId> {
        interior_edges(topology).map(|(corner, _)| corner).filter(|&c| self.contains(c))
    }

    /// The length of all seams, in units of the mesh.
    #[must_use]
    pub fn length(&self, mesh: &TriMesh, topology: &Topology) -> f64 {
        self.edges(topology).map(|c| edge_length(mesh, topology, c)).sum()
    }
}

/// Every interior edge once: the lower of the corners that face it, and the other.
pub(crate) fn interior_edges(topology: &Topology) -> impl Iterator<Item = (CornerId, CornerId)> {
    topology.corners().filter_map(|c| topology.opposite(c).filter(|&o| c < o).map(|o| (c, o)))
}

/// The ends of the edge that a corner faces.
pub(crate) fn ends(topology: &Topology, corner: CornerId) -> [VertexId; 2] {
    [topology.vertex(corner.next()), topology.vertex(corner.prev())]
}

/// The end of the edge that is not `vertex`.
pub(crate) fn other_end(topology: &Topology, corner: CornerId, vertex: VertexId) -> VertexId {
    let [a, b] = ends(topology, corner);
    if a == vertex { b } else { a }
}

pub(crate) fn edge_length(mesh: &TriMesh, topology: &Topology, corner: CornerId) -> f64 {
    let [a, b] = ends(topology, corner).map(|v| mesh.positions()[v.index()]);
    (b - a).norm()
}

/// Every edge at a vertex once, by a corner that faces it, with the vertex at its other end.
pub(crate) fn edges_at(topology: &Topology, vertex: VertexId) -> impl Iterator<Item = (CornerId, VertexId)> {
    topology.fan(vertex).flat_map(move |c| {
        let first = (c.prev(), topology.vertex(c.next()));
        // The last edge of an open fan has no face behind it.
        let last = topology.rotate_ccw(c).is_none().then(|| (c.next(), topology.vertex(c.prev())));
        std::iter::once(first).chain(last)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{sheet, torus};

    #[test]
    fn every_edge_at_a_vertex_is_met_once() {
        for mesh in [sheet(4, 3), torus(5, 6)] {
            let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
            let ends: usize = topology.vertices().map(|v| edges_at(&topology, v).count()).sum();
            assert_eq!(ends, 2 * topology.edge_count());
            for v in topology.vertices() {
                let mut others: Vec<_> = edges_at(&topology, v).map(|(_, w)| w).collect();
                assert!(edges_at(&topology, v).all(|(c, w)| other_end(&topology, c, v) == w));
                others.sort();
                others.dedup();
                assert_eq!(others.len(), edges_at(&topology, v).count());
            }
        }
    }

    #[test]
    fn both_sides_name_one_edge_and_the_boundary_is_left_out() {
        let mesh = sheet(2, 2);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let mut seams = Seams::none(&topology);
        topology.corners().for_each(|c| seams.insert(&topology, c));
        assert_eq!(seams.len(), topology.edge_count() - topology.boundary_edge_count());
        assert_eq!(seams.edges(&topology).count(), seams.len());
        topology.corners().for_each(|c| seams.remove(&topology, c));
        assert!(seams.is_empty());
    }
}
