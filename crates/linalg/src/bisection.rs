//! Nested dissection: an elimination order that halves a graph again and again (George 1973).
//!
//! A separator's vertices are eliminated after both of its sides. Minimum degree orders as well on graphs of up to about a
//! million vertices and is several times quicker. On larger, round ones its factors cost twice the work, and its elimination
//! tree has one long trunk where here the halves are independent.

use crate::{Graph, LinearError, Permutation};
use abf_control::Checkpoint;
use abf_parallel::prelude::*;
use std::collections::VecDeque;

/// Pieces of at most so many vertices are ordered by minimum degree.
const LEAF: usize = 1000;

/// How often the distances are averaged over the neighbours before the median cuts them.
const AVERAGED: usize = 4;

/// How many sweeps straighten a separator, and after how many the direction changes.
const SWEEPS: usize = 60;
const ONE_WAY: usize = 6;

/// The largest part of a piece that straightening may leave on one side.
const LARGEST_SIDE: f64 = 0.56;

/// Where a vertex of a piece belongs.
const FIRST: u8 = 0;
const SECOND: u8 = 1;
const SEPARATOR: u8 = 2;

/// Marks a vertex that a search has not reached, or that is not in a part.
const NONE: u32 = u32::MAX;

impl Graph {
    /// An elimination order by nested dissection, minimum degree in its leaves. The same for any number of threads.
    ///
    /// Every piece is cut at the median of `d(a) − d(b)`, distances from two vertices that lie far apart.
    ///
    /// # Errors
    /// [`LinearError`] as [`Graph::amd`], or when the checkpoint ends it.
    pub fn nested_dissection(&self, checkpoint: &mut Checkpoint<'_>) -> Result<Permutation, LinearError> {
        Dissection::new(self).finish(checkpoint)
    }

    /// All vertices in the order in which breadth-first searches reach them.
    fn by_breadth(&self) -> Vec<u32> {
        let size = self.vertex_count();
        let (mut order, mut is_reached) = (Vec::with_capacity(size), vec![false; size]);
        let mut next = 0;
        for start in 0..size {
            if !std::mem::replace(&mut is_reached[start], true) {
                order.push(start as u32);
            }
            while next < order.len() {
                let around = self.neighbours(order[next] as usize).iter();
                order.extend(around.filter(|&&n| !std::mem::replace(&mut is_reached[n as usize], true)));
                next += 1;
            }
        }
        order
    }

    /// The graph of some vertices, which are numbered in the order given. `number` is `NONE` everywhere, before
    /// and after.
    fn induced(&self, vertices: &[u32], number: &mut [u32]) -> Self {
        vertices.iter().zip(0..).for_each(|(&v, i)| number[v as usize] = i);
        let inside = |i: usize| {
            let all = self.neighbours(vertices[i] as usize).iter();
            all.map(|&n| number[n as usize]).filter(|&n| n != NONE)
        };
        let made = Self::from_neighbours(vertices.len(), inside);
        vertices.iter().for_each(|&v| number[v as usize] = NONE);
        made
    }
}

/// A nested dissection that has come to one of its levels.
pub(crate) struct Dissection {
    /// The pieces of this level. They do not meet.
    pieces: Vec<Piece>,
    new_to_old: Vec<u32>,
}

impl Dissection {
    /// All of a graph in one piece.
    pub(crate) fn new(graph: &Graph) -> Self {
        // Vertices that are close to each other get numbers that are: memory is read in about that order from here on.
        let ids = graph.by_breadth();
        let mut number = vec![NONE; ids.len()];
        let new_to_old = vec![0; ids.len()];
        Self { pieces: vec![Piece { graph: graph.induced(&ids, &mut number), ids, begin: 0 }], new_to_old }
    }

    pub(crate) fn is_complete(&self) -> bool {
        self.pieces.is_empty()
    }

    /// Parts every piece once.
    ///
    /// # Errors
    /// [`LinearError`] as [`Graph::amd`].
    pub(crate) fn level(&mut self) -> Result<(), LinearError> {
        let pieces = std::mem::take(&mut self.pieces);
        let parted: Result<Vec<Parted>, LinearError> = pieces.into_par_iter().map(Piece::part).collect();
        for Parted { ordered, begin, halves } in parted? {
            self.new_to_old[begin..begin + ordered.len()].copy_from_slice(&ordered);
            self.pieces.extend(halves);
        }
        Ok(())
    }

    /// The order, when all levels are done.
    ///
    /// # Errors
    /// [`LinearError`] as [`Graph::amd`], or when the checkpoint ends it.
    pub(crate) fn finish(mut self, checkpoint: &mut Checkpoint<'_>) -> Result<Permutation, LinearError> {
        while !self.is_complete() {
            checkpoint()?;
            self.level()?;
        }
        Ok(Permutation::from_elimination_order(self.new_to_old))
    }
}

/// Vertices that take the places `begin ..` of the order.
struct Piece {
    graph: Graph,
    /// Their numbers in the whole graph.
    ids: Vec<u32>,
    begin: usize,
}

/// What became of a piece: vertices with their final places, `begin ..`, and what is left to order.
struct Parted {
    ordered: Vec<u32>,
    begin: usize,
    halves: Vec<Piece>,
}

impl Piece {
    fn part(self) -> Result<Parted, LinearError> {
        if self.ids.len() <= LEAF {
            return self.leaf();
        }
        let side = sides(&self.graph);
        let [first, second, separator] = [FIRST, SECOND, SEPARATOR].map(|wanted| {
            let all = 0..self.ids.len() as u32;
            all.filter(|&v| side[v as usize] == wanted).collect::<Vec<u32>>()
        });
        // Everything touches everything: nothing is gained by a separator.
        if first.is_empty() || second.is_empty() {
            return self.leaf();
        }
        let mut number = vec![NONE; self.ids.len()];
        let mut half = |vertices: &[u32], begin| Piece {
            graph: self.graph.induced(vertices, &mut number),
            ids: self.names(vertices),
            begin,
        };
        let halves = vec![half(&first, self.begin), half(&second, self.begin + first.len())];
        Ok(Parted { ordered: self.names(&separator), begin: self.begin + first.len() + second.len(), halves })
    }

    fn leaf(self) -> Result<Parted, LinearError> {
        let order = self.graph.amd()?;
        let ordered = (0..self.ids.len()).map(|place| self.ids[order.old_index(place)]).collect();
        Ok(Parted { ordered, begin: self.begin, halves: Vec::new() })
    }

    fn names(&self, vertices: &[u32]) -> Vec<u32> {
        vertices.iter().map(|&v| self.ids[v as usize]).collect()
    }
}

/// For every vertex its side, or that it is in the separator. No edge joins the two sides.
fn sides(graph: &Graph) -> Vec<u8> {
    let (from_start, last) = distances(graph, 0);
    if from_start.contains(&NONE) {
        return components(graph);
    }
    let (from_a, b) = distances(graph, last);
    let (from_b, _) = distances(graph, b);
    let mut key: Vec<f32> = from_a.iter().zip(&from_b).map(|(&a, &b)| a as f32 - b as f32).collect();
    for _ in 0..AVERAGED {
        key = averaged(graph, &key);
    }
    let mut by_key: Vec<u32> = (0..key.len() as u32).collect();
    let half = by_key.len() / 2;
    by_key.select_nth_unstable_by(half, |&u, &v| key[u as usize].total_cmp(&key[v as usize]).then(u.cmp(&v)));
    let mut side = vec![SECOND; key.len()];
    by_key[..half].iter().for_each(|&v| side[v as usize] = FIRST);
    separate(graph, &mut side);
    side
}

/// How many edges each vertex is away from `start`, and the last one reached.
fn distances(graph: &Graph, start: usize) -> (Vec<u32>, usize) {
    let mut distance = vec![NONE; graph.vertex_count()];
    distance[start] = 0;
    let (mut queue, mut last) = (VecDeque::from([start as u32]), start);
    while let Some(v) = queue.pop_front() {
        last = v as usize;
        for &n in graph.neighbours(last) {
            if distance[n as usize] == NONE {
                distance[n as usize] = distance[last] + 1;
                queue.push_back(n);
            }
        }
    }
    (distance, last)
}

/// A graph in several pieces needs no separator: whole components, the largest first, each to the side that has less so far.
fn components(graph: &Graph) -> Vec<u8> {
    let size = graph.vertex_count();
    let (mut component, mut members, mut stack) = (vec![NONE; size], Vec::new(), Vec::new());
    for start in 0..size {
        if component[start] != NONE {
            continue;
        }
        let (own, mut count) = (members.len() as u32, 0_usize);
        component[start] = own;
        stack.push(start as u32);
        while let Some(v) = stack.pop() {
            count += 1;
            for &n in graph.neighbours(v as usize) {
                if component[n as usize] == NONE {
                    component[n as usize] = own;
                    stack.push(n);
                }
            }
        }
        members.push(count);
    }
    let mut largest_first: Vec<usize> = (0..members.len()).collect();
    largest_first.sort_by_key(|&c| std::cmp::Reverse(members[c]));
    let (mut side, mut sizes) = (vec![FIRST; members.len()], [0_usize; 2]);
    for c in largest_first {
        side[c] = if sizes[0] <= sizes[1] { FIRST } else { SECOND };
        sizes[side[c] as usize] += members[c];
    }
    component.into_iter().map(|c| side[c as usize]).collect()
}

fn averaged(graph: &Graph, key: &[f32]) -> Vec<f32> {
    let mean = |v: usize| {
        let around = graph.neighbours(v);
        let sum: f32 = around.iter().map(|&n| key[n as usize]).sum();
        (sum + key[v]) / (around.len() + 1) as f32
    };
    (0..key.len()).map(mean).collect()
}

/// Takes a separator out of the side that has fewer vertices at the cut, and straightens it.
fn separate(graph: &Graph, side: &mut [u8]) {
    let at_cut = |wanted: u8| -> Vec<u32> {
        let touches = |v: usize| graph.neighbours(v).iter().any(|&n| side[n as usize] == 1 - wanted);
        (0..side.len()).filter(|&v| side[v] == wanted && touches(v)).map(|v| v as u32).collect()
    };
    let (first, second) = (at_cut(FIRST), at_cut(SECOND));
    let mut separator = if first.len() <= second.len() { first } else { second };
    separator.iter().for_each(|&v| side[v as usize] = SEPARATOR);
    let mut sizes = [FIRST, SECOND].map(|wanted| side.iter().filter(|&&s| s == wanted).count());
    let largest = (LARGEST_SIDE * side.len() as f64) as usize;
    let mut idle = 0;
    for sweep in 0..SWEEPS {
        let to = ((sweep / ONE_WAY) % 2) as u8;
        let moved = straighten(graph, side, &mut separator, to, &mut sizes, largest);
        // Nothing moves either way: nothing will.
        idle = if moved { 0 } else { idle + 1 };
        if idle > ONE_WAY {
            break;
        }
    }
}

/// One sweep: a vertex with at most one neighbour beyond changes to the near side, and that neighbour takes its place in the
/// separator, which never grows. Whether one did.
fn straighten(
    graph: &Graph,
    side: &mut [u8],
    separator: &mut Vec<u32>,
    to: u8,
    sizes: &mut [usize; 2],
    largest: usize,
) -> bool {
    let beyond = 1 - to;
    let before = std::mem::take(separator);
    let mut any = false;
    for v in before {
        let mut across = graph.neighbours(v as usize).iter().filter(|&&n| side[n as usize] == beyond);
        let (one, more) = (across.next().copied(), across.next().is_some());
        if more || sizes[to as usize] >= largest {
            separator.push(v);
            continue;
        }
        any = true;
        side[v as usize] = to;
        sizes[to as usize] += 1;
        if let Some(n) = one {
            side[n as usize] = SEPARATOR;
            sizes[beyond as usize] -= 1;
            separator.push(n);
        }
    }
    any
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{sheet, with_threads};
    use crate::{SymbolicCholesky, SymmetricPattern};
    use std::sync::Arc;

    fn flops(graph: &Graph, order: &Permutation) -> f64 {
        let pattern = SymmetricPattern::of_blocks(graph, order, 1);
        SymbolicCholesky::analyse(Arc::new(pattern)).expect("fits").flops()
    }

    #[test]
    fn no_edge_joins_the_sides_and_they_are_about_as_large() {
        let graph = sheet(60);
        let side = sides(&graph);
        for v in 0..3600 {
            assert!(
                graph.neighbours(v).iter().all(|&n| side[v] + side[n as usize] != 1 || side[v] == side[n as usize])
            );
        }
        let count = |wanted| side.iter().filter(|&&s| s == wanted).count();
        assert!(count(FIRST) > 1500 && count(SECOND) > 1500, "{} {}", count(FIRST), count(SECOND));
        assert!(count(SEPARATOR) <= 90, "{}", count(SEPARATOR));
    }

    #[test]
    fn a_large_sheet_costs_less_than_by_minimum_degree() {
        let graph = sheet(700);
        let bisected = graph.nested_dissection(&mut || Ok(())).expect("an ordering");
        let (ours, amd) = (flops(&graph, &bisected), flops(&graph, &graph.amd().expect("an ordering")));
        assert!(ours < amd, "{ours:.3e} against {amd:.3e}");
    }

    #[test]
    fn the_order_does_not_depend_on_the_threads() {
        let graph = sheet(120);
        let order = |threads| with_threads(threads, || graph.nested_dissection(&mut || Ok(())).expect("an ordering"));
        assert_eq!(order(1), order(2));
    }

    #[test]
    fn a_large_component_is_alone_on_its_side_wherever_it_comes() {
        let graph = Graph::from_edges(2000, (2..2000).map(|v| (v - 1, v)));
        let side = sides(&graph);
        assert_ne!(side[0], side[1]);
        assert!(side[1..].iter().all(|&s| s == side[1]));
    }

    #[test]
    fn many_components_a_star_a_path_and_a_complete_graph_are_ordered() {
        let path = (1..5000).map(|v| (v - 1, v));
        let complete = (0..1100).flat_map(|u| (0..u).map(move |v| (u, v)));
        let graphs = [
            Graph::from_edges(5000, std::iter::empty()),
            Graph::from_edges(5000, (1..5000).map(|leaf| (0, leaf))),
            Graph::from_edges(5000, path.clone()),
            Graph::from_edges(9000, path),
            Graph::from_edges(1100, complete),
        ];
        for graph in graphs {
            // An order that misses or repeats a vertex is refused by its maker.
            let order = graph.nested_dissection(&mut || Ok(())).expect("an ordering");
            assert_eq!(order.len(), graph.vertex_count());
        }
    }

    #[test]
    fn a_checkpoint_ends_it() {
        let ended = sheet(60).nested_dissection(&mut || Err(abf_control::Cancelled));
        assert!(matches!(ended, Err(LinearError::Cancelled(_))));
    }
}
