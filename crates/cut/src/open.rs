//! The least seam that makes a component a disk.

use crate::paths::ShortestPathTree;
use crate::seams::{edges_at, ends, interior_edges};
use crate::{EdgeCosts, Seams};
use abf_mesh::{BoundaryLoop, CornerId, DisjointSets, Topology, VertexId};
use std::collections::VecDeque;

/// How many base points are tried for the loops of a closed surface with handles.
const BASE_POINTS: usize = 6;

/// The seam that makes one connected component a disk, as cheap as these searches find it; empty where it is one.
///
/// * A sphere is cut along the shortest path between two vertices far apart.
/// * Handles are opened along short loops, the greedy basis of Erickson and Whittlesey (2005): a tree of shortest paths
///   from a base point, a tree of faces across the edges whose loops are longest, and the edges in neither. Several
///   base points are tried, later ones on the seam found before.
/// * Boundary loops are joined, to each other and to the handles, by a short Steiner tree (Mehlhorn 1988).
///
/// What is cut is the complement of a spanning tree of faces, without its dead ends: a disk whatever the costs are.
/// Edges of infinite cost are cut only where there is no other way.
#[must_use]
pub fn open(topology: &Topology, costs: &EdgeCosts) -> Seams {
    let loops = topology.boundary_loops();
    let closed_genus = (2 - topology.euler_characteristic()) / 2;
    match (loops.len(), closed_genus) {
        (0, 0) => slit(topology, costs),
        (0, _) => best_of_base_points(topology, costs),
        _ => {
            let label = |(l, rim): (u32, BoundaryLoop)| rim.vertices.into_iter().map(move |v| (v, l));
            let count = loops.len();
            let sources: Vec<_> = (0..).zip(loops).flat_map(label).collect();
            complement_of_faces(topology, costs, &sources, count)
        }
    }
}

/// The path between two vertices far apart: the one farthest from any, and the one farthest from that.
fn slit(topology: &Topology, costs: &EdgeCosts) -> Seams {
    let mut seams = Seams::none(topology);
    let Some(any) = first_used(topology, costs) else { return seams };
    let from = |v| ShortestPathTree::grow(topology, costs, [(v, 0)]);
    let one = from(any).farthest().unwrap_or(any);
    let tree = from(one);
    let other = tree.farthest().unwrap_or(one);
    tree.trace(topology, other).for_each(|edge| seams.insert(topology, edge));
    // Two edges are the least that open anything; those that cost everything come last.
    let is_finite = |edge: &CornerId| costs.of(*edge).is_finite();
    let (finite, rest): (Vec<_>, Vec<_>) = edges_at(topology, one).map(|(edge, _)| edge).partition(is_finite);
    for edge in finite.into_iter().chain(rest) {
        if seams.len() < 2 {
            seams.insert(topology, edge);
        }
    }
    seams
}

/// The first vertex from which there is a way, if there is one; else the first with a face.
fn first_used(topology: &Topology, costs: &EdgeCosts) -> Option<VertexId> {
    let used = |v: &VertexId| topology.fan_start(*v).is_some();
    let is_open = |v: &VertexId| edges_at(topology, *v).any(|(edge, _)| costs.of(edge).is_finite());
    topology.vertices().find(is_open).or_else(|| topology.vertices().find(used))
}

fn best_of_base_points(topology: &Topology, costs: &EdgeCosts) -> Seams {
    let cost = |seams: &Seams| seams.edges(topology).map(|c| costs.of(c)).sum::<f64>();
    let Some(first) = first_used(topology, costs) else { return Seams::none(topology) };
    let from = |v| complement_of_faces(topology, costs, &[(v, 0)], 1);
    let mut best = from(first);
    let mut least = cost(&best);
    for attempt in 1..BASE_POINTS {
        let on_seam: Vec<CornerId> = best.edges(topology).collect();
        let Some(edge) = on_seam.get(attempt * on_seam.len() / BASE_POINTS) else { break };
        let next = from(ends(topology, *edge)[0]);
        let its_cost = cost(&next);
        if its_cost < least {
            (best, least) = (next, its_cost);
        }
    }
    best
}

/// The edges that a spanning tree of faces does not cross, without dead ends. The tree leaves out, if it can, a tree of
/// shortest paths from the sources and the edges with the shortest loops through it.
fn complement_of_faces(topology: &Topology, costs: &EdgeCosts, sources: &[(VertexId, u32)], labels: usize) -> Seams {
    let tree = ShortestPathTree::grow(topology, costs, sources.iter().copied());
    let mut paths = Seams::none(topology);
    for edge in topology.vertices().filter_map(|v| tree.towards(v)).chain(tree.bridges(topology, costs, labels)) {
        paths.insert(topology, edge);
    }
    let mut crossings: Vec<(u64, CornerId)> = interior_edges(topology)
        .map(|(corner, _)| {
            let [a, b] = ends(topology, corner).map(|v| tree.distance(v));
            (if paths.contains(corner) { 0 } else { 1 + (a + costs.of(corner) + b).to_bits() }, corner)
        })
        .collect();
    crossings.sort_unstable();
    let mut joined = DisjointSets::new(topology.face_count());
    let mut seams = Seams::none(topology);
    for &(_, corner) in crossings.iter().rev() {
        let opposite = topology.opposite(corner).expect("interior edges have two sides");
        if !joined.unite(corner.face().index(), opposite.face().index()) {
            seams.insert(topology, corner);
        }
    }
    prune(topology, &mut seams);
    seams
}

/// Takes out, again and again, edges that end in the open.
fn prune(topology: &Topology, seams: &mut Seams) {
    let mut degree = vec![0_u32; topology.vertex_count()];
    for edge in seams.edges(topology) {
        ends(topology, edge).iter().for_each(|v| degree[v.index()] += 1);
    }
    let is_end = |v: VertexId, degree: &[u32]| degree[v.index()] == 1 && topology.is_interior(v);
    let mut queue: VecDeque<VertexId> = topology.vertices().filter(|&v| is_end(v, &degree)).collect();
    while let Some(v) = queue.pop_front() {
        let last = edges_at(topology, v).find(|(edge, _)| seams.contains(*edge));
        let Some((edge, other)) = last else { continue };
        seams.remove(topology, edge);
        degree[v.index()] -= 1;
        degree[other.index()] -= 1;
        if is_end(other, &degree) {
            queue.push_back(other);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{double_torus, octahedron, sheet, tetrahedron, topology, torus, without_faces};
    use crate::{CostSettings, split};
    use abf_mesh::TriMesh;

    fn opened(mesh: &TriMesh, is_forbidden: impl Fn(CornerId) -> bool) -> (usize, f64) {
        let topology = topology(mesh);
        let costs = EdgeCosts::new(mesh, &topology, &CostSettings::LENGTH, is_forbidden);
        let seams = open(&topology, &costs);
        assert_eq!(seams, open(&topology, &costs), "the same again");
        let charts = split(mesh, &topology, &seams).expect("charts");
        assert_eq!(charts.len(), 1);
        charts[0].topology.check().expect("lawful");
        charts[0].topology.require_disk().expect("a disk");
        assert_eq!(charts[0].topology.euler_characteristic(), 1);
        (seams.len(), seams.length(mesh, &topology))
    }

    #[test]
    fn spheres_however_small_become_disks() {
        assert_eq!(opened(&tetrahedron(), |_| false).0, 2);
        assert_eq!(opened(&octahedron(), |_| false).0, 2);
    }

    #[test]
    fn a_disk_needs_no_seam() {
        assert_eq!(opened(&sheet(5, 5), |_| false).0, 0);
    }

    #[test]
    fn a_torus_is_cut_along_its_two_shortest_loops() {
        // Around the tube 6 edges, around the hole 9 at the inside.
        assert_eq!(opened(&torus(9, 6), |_| false).0, 15);
    }

    #[test]
    fn two_handles_and_holes_at_once_become_a_disk() {
        let double = double_torus();
        assert_eq!(topology(&double).euler_characteristic(), -2);
        opened(&double, |_| false);
        let holed = without_faces(&double, &[3, 40, 77]);
        assert_eq!(topology(&holed).boundary_loops().len(), 3);
        opened(&holed, |_| false);
    }

    #[test]
    fn a_sheet_with_holes_is_joined_by_the_shortest_ways() {
        let holed = without_faces(&sheet(12, 12), &[2 * (12 * 3 + 3), 2 * (12 * 3 + 8)]);
        // Each hole is three edges from the nearest border.
        let (edges, _) = opened(&holed, |_| false);
        assert!(edges <= 6, "{edges}");
    }

    #[test]
    fn forbidden_edges_are_cut_only_where_there_is_no_other_way() {
        opened(&torus(5, 5), |_| true);
        opened(&tetrahedron(), |_| true);
        let mesh = torus(7, 7);
        let topology = topology(&mesh);
        // Diagonals: corner 1 of the first triangle of a square, corner 2 of the second face them.
        let is_diagonal =
            |c: CornerId| if c.face().index().is_multiple_of(2) { c.place() == 1 } else { c.place() == 2 };
        let costs = EdgeCosts::new(&mesh, &topology, &CostSettings::LENGTH, is_diagonal);
        assert!(open(&topology, &costs).edges(&topology).all(|c| !is_diagonal(c)));
    }
}
