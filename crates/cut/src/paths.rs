//! Shortest paths along edges (Dijkstra 1959), and the trees that they make.

use crate::EdgeCosts;
use crate::seams::{edges_at, interior_edges, other_end};
use abf_mesh::{CornerId, DisjointSets, Topology, VertexId};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Marks vertices that no source reaches.
const NONE: u32 = u32::MAX;

/// How far every vertex is from the nearest source, and the way there.
#[derive(Clone)]
pub(crate) struct ShortestPathTree {
    distance: Vec<f64>,
    /// The edge towards the source, by a corner that faces it; `None` at sources.
    towards: Vec<Option<CornerId>>,
    /// The label of the nearest source.
    label: Vec<u32>,
}

impl ShortestPathTree {
    /// Grows from all sources at once, each with its label; along edges of finite cost only. Of equal ways the one
    /// through the vertex of lower index is taken.
    pub(crate) fn grow(
        topology: &Topology,
        costs: &EdgeCosts,
        sources: impl IntoIterator<Item = (VertexId, u32)>,
    ) -> Self {
        let n = topology.vertex_count();
        let mut tree = Self { distance: vec![f64::INFINITY; n], towards: vec![None; n], label: vec![NONE; n] };
        tree.add(topology, costs, sources);
        tree
    }

    /// Adds sources: only what is nearer to them than to those before is looked at again. A vertex that an earlier
    /// source reaches at no cost is none.
    pub(crate) fn add(
        &mut self,
        topology: &Topology,
        costs: &EdgeCosts,
        sources: impl IntoIterator<Item = (VertexId, u32)>,
    ) {
        let tree = self;
        let mut heap = BinaryHeap::new();
        for (v, label) in sources {
            if tree.distance[v.index()] > 0.0 {
                tree.distance[v.index()] = 0.0;
                tree.towards[v.index()] = None;
                tree.label[v.index()] = label;
                heap.push(Reverse((0_u64, v)));
            }
        }
        while let Some(Reverse((key, v))) = heap.pop() {
            // The order of the bits of doubles that are not negative is that of the doubles.
            let here = f64::from_bits(key);
            if here > tree.distance[v.index()] {
                continue;
            }
            for (edge, w) in edges_at(topology, v) {
                let there = here + costs.of(edge);
                if there < tree.distance[w.index()] {
                    tree.distance[w.index()] = there;
                    tree.towards[w.index()] = Some(edge);
                    tree.label[w.index()] = tree.label[v.index()];
                    heap.push(Reverse((there.to_bits(), w)));
                }
            }
        }
    }

    /// The distance to the nearest source; infinite where there is no way.
    pub(crate) fn distance(&self, vertex: VertexId) -> f64 {
        self.distance[vertex.index()]
    }

    /// The label of the nearest source.
    pub(crate) fn label(&self, vertex: VertexId) -> Option<u32> {
        Some(self.label[vertex.index()]).filter(|&label| label != NONE)
    }

    /// The edge towards the nearest source.
    pub(crate) fn towards(&self, vertex: VertexId) -> Option<CornerId> {
        self.towards[vertex.index()]
    }

    /// The edges from a vertex to its source.
    pub(crate) fn trace<'f>(&'f self, topology: &'f Topology, from: VertexId) -> impl Iterator<Item = CornerId> + 'f {
        let mut at = from;
        std::iter::from_fn(move || {
            let edge = self.towards(at)?;
            at = other_end(topology, edge, at);
            Some(edge)
        })
    }

    /// The vertex farthest from all sources, among those that are reached; the lowest of equals.
    pub(crate) fn farthest(&self) -> Option<VertexId> {
        let reached = self.distance.iter().enumerate().filter(|(_, d)| d.is_finite());
        let (v, _) = reached.max_by(|(v, a), (w, b)| a.total_cmp(b).then(w.cmp(v)))?;
        Some(VertexId::new(v))
    }

    /// The edges that join the regions of different labels into one tree of least cost, as far as there is a way: the
    /// spanning tree of the regions, each bridge counted with the ways from its ends to their sources (Mehlhorn 1988).
    /// With the ways themselves this is a Steiner tree of at most twice the least cost.
    pub(crate) fn bridges(&self, topology: &Topology, costs: &EdgeCosts, labels: usize) -> Vec<CornerId> {
        let mut candidates: Vec<(u64, CornerId, u32, u32)> = interior_edges(topology)
            .filter_map(|(corner, _)| {
                let [a, b] = crate::seams::ends(topology, corner);
                let (from, to) = (self.label(a)?, self.label(b)?);
                let way = self.distance(a) + costs.of(corner) + self.distance(b);
                (from != to && way.is_finite()).then_some((way.to_bits(), corner, from, to))
            })
            .collect();
        candidates.sort_unstable();
        let mut joined = DisjointSets::new(labels);
        candidates.retain(|&(_, _, from, to)| joined.unite(from as usize, to as usize));
        candidates.into_iter().map(|(_, corner, ..)| corner).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CostSettings;
    use crate::test_support::sheet;

    #[test]
    fn distances_on_a_sheet_are_those_along_its_edges() {
        let mesh = sheet(12, 12);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let costs = EdgeCosts::new(&mesh, &topology, &CostSettings::LENGTH, |_| false);
        // Diagonals run from (i, j) to (i + 1, j + 1); the boundary, six edges away, costs nothing.
        let at = |i: usize, j: usize| VertexId::new(i * 13 + j);
        let tree = ShortestPathTree::grow(&topology, &costs, [(at(6, 6), 0)]);
        assert!((tree.distance(at(9, 6)) - 3.0).abs() < 1e-12);
        assert!((tree.distance(at(9, 8)) - (1.0 + 8.0_f64.sqrt())).abs() < 1e-12);
        assert_eq!(tree.distance(at(0, 0)), 6.0);
        assert_eq!(tree.trace(&topology, at(9, 8)).count(), 3);
    }
}
