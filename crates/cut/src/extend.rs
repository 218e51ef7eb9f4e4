//! A seam that reaches further.

use crate::paths::ShortestPathTree;
use crate::seams::ends;
use crate::{EdgeCosts, Seams};
use abf_mesh::{DisjointSets, Topology, VertexId};

/// The cheapest ways from the vertices of a surface to its seam, kept while the seam grows: what is far from where it grows
/// is not looked at again.
#[derive(Clone)]
pub struct SeamWays {
    tree: ShortestPathTree,
}

impl SeamWays {
    /// Finds the ways to a seam. The boundary counts as seam.
    #[must_use]
    pub fn new(topology: &Topology, costs: &EdgeCosts, seams: &Seams) -> Self {
        Self { tree: ShortestPathTree::grow(topology, costs, cut_vertices(topology, seams).map(|v| (v, 0))) }
    }

    /// The cost of the cheapest way from a vertex to the seam; infinite where there is none.
    #[must_use]
    pub fn distance(&self, vertex: VertexId) -> f64 {
        self.tree.distance(vertex)
    }

    /// Joins vertices to the seam by a Steiner tree of at most twice the least cost (Mehlhorn 1988), and says how many edges
    /// that took. Topology, costs and seams are those of [`SeamWays::new`], and the seams what this made of them.
    ///
    /// What was a disk stays one. A terminal to which no way of finite cost leads is left out, and so are all where there is
    /// neither seam nor boundary.
    pub fn extend(
        &mut self,
        topology: &Topology,
        costs: &EdgeCosts,
        seams: &mut Seams,
        terminals: &[VertexId],
    ) -> usize {
        let before = seams.len();
        let mut tree = self.tree.clone();
        tree.add(topology, costs, terminals.iter().copied().zip(1..));
        let bridges = tree.bridges(topology, costs, terminals.len() + 1);
        let mut joined = DisjointSets::new(terminals.len() + 1);
        let labels_at = |c| ends(topology, c).map(|v| tree.label(v).unwrap_or(0) as usize);
        for [a, b] in bridges.iter().map(|&c| labels_at(c)) {
            joined.unite(a, b);
        }
        // What the seam reaches at no cost has no label of its own, and is joined by the way that it has.
        let at_no_cost = terminals.iter().filter(|&&v| self.tree.distance(v) == 0.0);
        let mut cut: Vec<_> = at_no_cost.flat_map(|&v| self.tree.trace(topology, v)).collect();
        for edge in bridges {
            if joined.find(labels_at(edge)[0]) == joined.find(0) {
                cut.push(edge);
                ends(topology, edge).into_iter().for_each(|end| cut.extend(tree.trace(topology, end)));
            }
        }
        cut.iter().for_each(|&edge| seams.insert(topology, edge));
        self.tree.add(topology, costs, cut.iter().flat_map(|&edge| ends(topology, edge)).map(|v| (v, 0)));
        seams.len() - before
    }
}

/// The cost of the cheapest way from every vertex to a seam or the boundary; infinite where there is none.
#[must_use]
pub fn distances(topology: &Topology, costs: &EdgeCosts, seams: &Seams) -> Vec<f64> {
    let ways = SeamWays::new(topology, costs, seams);
    topology.vertices().map(|v| ways.distance(v)).collect()
}

/// Joins vertices to a seam: [`SeamWays::extend`], once.
pub fn extend(topology: &Topology, costs: &EdgeCosts, seams: &mut Seams, terminals: &[VertexId]) -> usize {
    SeamWays::new(topology, costs, seams).extend(topology, costs, seams, terminals)
}

/// The vertices on the boundary, then those at the ends of seams; some of them more than once.
fn cut_vertices(topology: &Topology, seams: &Seams) -> impl Iterator<Item = VertexId> {
    let on_seam = seams.edges(topology).flat_map(|c| ends(topology, c));
    topology.vertices().filter(|&v| topology.is_boundary(v)).chain(on_seam)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{octahedron, sheet, topology};
    use crate::{CostSettings, open, split};

    #[test]
    fn terminals_are_joined_to_the_boundary_by_a_short_tree() {
        let mesh = sheet(10, 10);
        let topology = topology(&mesh);
        let costs = EdgeCosts::new(&mesh, &topology, &CostSettings::LENGTH, |_| false);
        let mut seams = Seams::none(&topology);
        // Both at height 5, next but one to each other: five edges to the border and two between them.
        let at = |i: usize, j: usize| VertexId::new(11 * i + j);
        assert_eq!(extend(&topology, &costs, &mut seams, &[at(4, 5), at(6, 5)]), 6);
        let charts = split(&mesh, &topology, &seams).expect("a chart");
        charts[0].topology.require_disk().expect("a disk");
        assert_eq!(extend(&topology, &costs, &mut seams, &[at(4, 5)]), 0);
        let ways = SeamWays::new(&topology, &costs, &seams);
        assert_eq!((ways.distance(at(0, 3)), ways.distance(at(4, 5)), ways.distance(at(3, 3))), (0.0, 0.0, 2.0));
    }

    #[test]
    fn ways_that_grow_with_the_seam_are_those_that_are_found_anew() {
        let mesh = sheet(14, 9);
        let topology = topology(&mesh);
        let costs = EdgeCosts::new(&mesh, &topology, &CostSettings::LENGTH, |c| c.index().is_multiple_of(5));
        let mut seams = Seams::none(&topology);
        let mut ways = SeamWays::new(&topology, &costs, &seams);
        for terminals in [[37, 91], [64, 52], [81, 82]].map(|pair| pair.map(VertexId::new)) {
            assert!(ways.extend(&topology, &costs, &mut seams, &terminals) > 0);
            let anew = distances(&topology, &costs, &seams);
            topology.vertices().for_each(|v| assert_eq!(ways.distance(v), anew[v.index()], "{v:?}"));
            let charts = split(&mesh, &topology, &seams).expect("a chart");
            charts[0].topology.require_disk().expect("a disk");
        }
    }

    #[test]
    fn without_a_seam_to_join_there_is_nothing_to_do() {
        let mesh = octahedron();
        let topology = topology(&mesh);
        let costs = EdgeCosts::new(&mesh, &topology, &CostSettings::LENGTH, |_| false);
        let mut seams = Seams::none(&topology);
        assert_eq!(extend(&topology, &costs, &mut seams, &[VertexId::new(0), VertexId::new(1)]), 0);
        let mut seams = open(&topology, &costs);
        extend(&topology, &costs, &mut seams, &topology.vertices().collect::<Vec<_>>());
        let charts = split(&mesh, &topology, &seams).expect("a chart");
        charts[0].topology.require_disk().expect("a disk");
        assert_eq!(charts[0].mesh.vertex_count(), 2 * 5, "a tree of five edges, cut open");
    }
}
