//! The outlines of a chart.

use abf_mesh::UvId;
use std::collections::HashMap;
use std::hash::Hash;

/// The polygons that triangles cover: one with a loop for every boundary of an injective chart; of any other, which may
/// lie over itself, every triangle.
pub(super) fn polygons(
    triangles: impl Iterator<Item = [UvId; 3]>,
    place: impl Fn(UvId) -> [f64; 2],
    is_injective: bool,
) -> Vec<Vec<Vec<[f64; 2]>>> {
    if !is_injective {
        return triangles.map(|three| vec![three.map(&place).to_vec()]).collect();
    }
    let loops = boundary_loops(triangles);
    vec![loops.into_iter().map(|ids| ids.into_iter().map(&place).collect()).collect()]
}

/// Closed ways along the edges that an odd number of triangles have. Where two boundaries meet in a point, it does not
/// matter which way goes on: what is inside an odd number of loops is the same.
pub(super) fn boundary_loops<Id: Copy + Ord + Hash>(triangles: impl Iterator<Item = [Id; 3]>) -> Vec<Vec<Id>> {
    let mut edges: Vec<[Id; 2]> =
        triangles.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    let edges: Vec<[Id; 2]> =
        edges.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1).map(|same| same[0]).collect();
    let mut at: HashMap<Id, Vec<usize>> = HashMap::new();
    edges.iter().enumerate().for_each(|(i, ends)| ends.iter().for_each(|&end| at.entry(end).or_default().push(i)));
    let mut is_used = vec![false; edges.len()];
    let mut loops = Vec::new();
    for start in 0..edges.len() {
        let mut way = Vec::new();
        let mut next = Some(start).filter(|&i| !is_used[i]);
        let mut end = edges[start][0];
        // An even number of edges meets in every point, so the way ends only where it began.
        while let Some(edge) = next {
            is_used[edge] = true;
            way.push(end);
            let [a, b] = edges[edge];
            end = if a == end { b } else { a };
            next = at[&end].iter().copied().find(|&i| !is_used[i]);
        }
        if !way.is_empty() {
            loops.push(way);
        }
    }
    loops
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_of_triangles_has_an_outer_and_an_inner_loop() {
        // Around a square 0..4 a larger one 4..8.
        let ring = (0..4_u32).flat_map(|i| {
            let j = (i + 1) % 4;
            [[i, i + 4, j + 4], [i, j + 4, j]]
        });
        let mut loops = boundary_loops(ring);
        loops.iter_mut().for_each(|ids| ids.sort_unstable());
        loops.sort();
        assert_eq!(loops, [vec![0, 1, 2, 3], vec![4, 5, 6, 7]]);
    }

    #[test]
    fn triangles_that_meet_in_a_point_have_every_edge_once() {
        let loops = boundary_loops([[0, 1, 2], [0, 3, 4]].into_iter());
        assert_eq!(loops.iter().map(Vec::len).sum::<usize>(), 6);
        assert_eq!(boundary_loops([[0, 1, 2], [0, 2, 1]].into_iter()), [] as [Vec<i32>; 0]);
    }
}
