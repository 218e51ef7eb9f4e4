//! A seam that reaches further.

use crate::paths::ShortestPathTree;
use crate::seams::ends;
use crate::{EdgeCosts, Seams};
use abf_mesh::{DisjointSets, Topology, VertexId};

/// Joins vertices to the seam by a Steiner tree of at most twice the least cost (Mehlhorn 1988), and says how many edges
/// that took.
///
/// What was a disk stays one. The boundary counts as seam. A terminal to which no way of finite cost leads is left out,
/// and so are all where there is neither seam nor boundary.
pub fn extend(topology: &Topology, costs: &EdgeCosts, seams: &mut Seams, terminals: &[VertexId]) -> usize {
    let before = seams.len();
    let root = cut_vertices(topology, seams).map(|v| (v, 0));
    let labelled = (1..).zip(terminals).map(|(label, &v)| (v, label));
    let tree = ShortestPathTree::grow(topology, costs, root.chain(labelled));
    let bridges = tree.bridges(topology, costs, terminals.len() + 1);
    let mut joined = DisjointSets::new(terminals.len() + 1);
    let labels_at = |c| ends(topology, c).map(|v| tree.label(v).unwrap_or(0) as usize);
    for [a, b] in bridges.iter().map(|&c| labels_at(c)) {
        joined.unite(a, b);
    }
    for edge in bridges {
        if joined.find(labels_at(edge)[0]) == joined.find(0) {
            seams.insert(topology, edge);
            for end in ends(topology, edge) {
                tree.trace(topology, end).for_each(|way| seams.insert(topology, way));
            }
        }
    }
    seams.len() - before
}

/// The cost of the cheapest way from every vertex to a seam or the boundary; infinite where there is none.
#[must_use]
pub fn distances(topology: &Topology, costs: &EdgeCosts, seams: &Seams) -> Vec<f64> {
    let tree = ShortestPathTree::grow(topology, costs, cut_vertices(topology, seams).map(|v| (v, 0)));
    topology.vertices().map(|v| tree.distance(v)).collect()
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
        let way = distances(&topology, &costs, &seams);
        assert_eq!((way[at(0, 3).index()], way[at(4, 5).index()]), (0.0, 0.0));
        assert_eq!(way[at(3, 3).index()], 2.0);
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
