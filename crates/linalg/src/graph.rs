//! Undirected graphs and fill-reducing orderings of their vertices.

use crate::LinearError;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMat;
use faer::sparse::linalg::amd;

/// An undirected graph without loops: for every vertex its neighbours, ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Graph {
    start: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// The graph on `0..vertex_count` with these edges. Edges may come in either direction, or in
    /// both, or repeated; an edge from a vertex to itself is dropped. Linear time but for sorting
    /// each neighbourhood.
    ///
    /// # Panics
    /// If an edge names a vertex `>= vertex_count`.
    #[must_use]
    pub fn from_edges(vertex_count: usize, edges: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let edges = edges.filter(|(a, b)| a != b);
        let mut start = vec![0_u32; vertex_count + 1];
        for (a, b) in edges.clone() {
            start[a as usize + 1] += 1;
            start[b as usize + 1] += 1;
        }
        for v in 0..vertex_count {
            start[v + 1] += start[v];
        }
        let mut neighbours = vec![0_u32; start[vertex_count] as usize];
        let mut cursor = start.clone();
        let mut push = |a: u32, b: u32| {
            neighbours[cursor[a as usize] as usize] = b;
            cursor[a as usize] += 1;
        };
        for (a, b) in edges {
            push(a, b);
            push(b, a);
        }
        compact(&mut start, &mut neighbours);
        Self { start, neighbours }
    }

    /// The graph whose vertex `v` has these neighbours; each edge must be named from both ends.
    /// Repetitions are dropped.
    #[must_use]
    pub fn from_neighbours<I: Iterator<Item = u32>>(vertex_count: usize, neighbours: impl Fn(usize) -> I) -> Self {
        let mut start = Vec::with_capacity(vertex_count + 1);
        let mut all = Vec::new();
        start.push(0);
        for v in 0..vertex_count {
            all.extend(neighbours(v));
            start.push(all.len() as u32);
        }
        compact(&mut start, &mut all);
        Self { start, neighbours: all }
    }

    /// How many vertices there are.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.start.len() - 1
    }

    /// The neighbours of a vertex, ascending.
    #[inline]
    #[must_use]
    pub fn neighbours(&self, vertex: usize) -> &[u32] {
        &self.neighbours[self.start[vertex] as usize..self.start[vertex + 1] as usize]
    }

    /// An ordering of the vertices that keeps the fill of a factorisation low: approximate minimum
    /// degree (Amestoy, Davis, Duff 1996).
    ///
    /// Matrices whose unknowns come in blocks per vertex are ordered by ordering the vertices and
    /// expanding: several times cheaper than ordering the unknowns, with the same fill.
    ///
    /// # Errors
    /// [`LinearError::OutOfMemory`] or [`LinearError::TooLarge`].
    pub fn amd(&self) -> Result<Permutation, LinearError> {
        let size = self.vertex_count();
        let pattern =
            SymbolicSparseColMat::<u32>::new_checked(size, size, self.start.clone(), None, self.neighbours.clone());
        let scratch = amd::order_scratch::<u32>(size, self.neighbours.len());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| LinearError::OutOfMemory { size })?;
        let (mut new_to_old, mut old_to_new) = (vec![0_u32; size], vec![0_u32; size]);
        let stack = MemStack::new(&mut memory);
        amd::order(&mut new_to_old, &mut old_to_new, pattern.as_ref(), amd::Control::default(), stack)
            .map_err(|_| LinearError::TooLarge { size })?;
        Ok(Permutation { new_to_old, old_to_new })
    }
}

impl Graph {
    /// Renumbers an elimination order so that large subtrees of its elimination tree come first, one after
    /// the other, and the vertices that separate them last. The fill does not change: every vertex still
    /// comes before its ancestors. What is eliminated in one part does not touch another.
    #[must_use]
    pub fn in_parts(&self, order: &Permutation) -> (Permutation, Parts) {
        let size = self.vertex_count();
        if size < SMALLEST_WHOLE {
            return (order.clone(), Parts::default());
        }
        let parent = self.elimination_tree(order);
        let mut weight = vec![1_u32; size];
        for v in 0..size {
            if parent[v] != NONE {
                weight[parent[v] as usize] += weight[v];
            }
        }
        // From the roots down: a subtree that is too large loses its root to the separating vertices.
        let largest = (size / PARTS) as u32;
        let mut part = vec![NONE; size];
        let mut ends: Vec<u32> = Vec::new();
        let mut filled = 0;
        for v in (0..size).rev() {
            let inherited = if parent[v] == NONE { NONE } else { part[parent[v] as usize] };
            part[v] = if inherited != NONE {
                inherited
            } else if weight[v] > largest {
                NONE
            } else {
                // The next subtree joins the last part while there is room.
                if ends.is_empty() || filled + weight[v] > largest {
                    ends.push(0);
                    filled = 0;
                }
                filled += weight[v];
                (ends.len() - 1) as u32
            };
            if part[v] != NONE {
                ends[part[v] as usize] += 1;
            }
        }
        let mut cursor: Vec<u32> = Vec::with_capacity(ends.len() + 1);
        let mut total = 0;
        for end in &mut ends {
            cursor.push(total);
            total += *end;
            *end = total;
        }
        let mut separating = total;
        let mut new_to_old = vec![0_u32; size];
        for v in 0..size {
            let place = if part[v] == NONE { &mut separating } else { &mut cursor[part[v] as usize] };
            new_to_old[*place as usize] = order.new_to_old[v];
            *place += 1;
        }
        (Permutation::from_elimination_order(new_to_old), Parts { ends })
    }

    /// For every vertex, by its place in the order, the place of its parent in the elimination tree
    /// (Liu 1986); `NONE` for a root.
    fn elimination_tree(&self, order: &Permutation) -> Vec<u32> {
        let size = self.vertex_count();
        let (mut parent, mut ancestor) = (vec![NONE; size], vec![NONE; size]);
        for v in 0..size {
            for &neighbour in self.neighbours(order.old_index(v)) {
                let mut at = order.new_index(neighbour as usize);
                // Climb to the root, and make the path short for the next one.
                while at < v {
                    let above = std::mem::replace(&mut ancestor[at], v as u32);
                    if above == NONE {
                        parent[at] = v as u32;
                        break;
                    }
                    at = above as usize;
                }
            }
        }
        parent
    }
}

/// Marks a vertex without parent, or outside all parts.
const NONE: u32 = u32::MAX;

/// A tree is cut into about so many parts: enough to keep threads busy to the end.
const PARTS: usize = 16;

/// Below this many vertices a graph stays in one part.
const SMALLEST_WHOLE: usize = 1 << 12;

/// Unknowns `0..` of an elimination order that fall into independent parts, followed by those that
/// separate them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Parts {
    ends: Vec<u32>,
}

impl Parts {
    /// The unknowns of each part.
    pub fn ranges(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let begins = std::iter::once(0).chain(self.ends.iter().copied());
        begins.zip(&self.ends).map(|(begin, &end)| begin as usize..end as usize)
    }
}

/// Sorts every neighbourhood and drops repetitions, in place.
fn compact(start: &mut [u32], neighbours: &mut Vec<u32>) {
    let mut write = 0;
    let mut read = 0;
    for end_of_vertex in start.iter_mut().skip(1) {
        let end = *end_of_vertex as usize;
        neighbours[read..end].sort_unstable();
        let mut last = None;
        for k in read..end {
            let n = neighbours[k];
            if last != Some(n) {
                neighbours[write] = n;
                write += 1;
                last = Some(n);
            }
        }
        *end_of_vertex = write as u32;
        read = end;
    }
    neighbours.truncate(write);
}

/// A renumbering and its inverse.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Permutation {
    new_to_old: Vec<u32>,
    old_to_new: Vec<u32>,
}

impl Permutation {
    /// The renumbering that changes nothing.
    #[must_use]
    pub fn identity(size: usize) -> Self {
        let ids: Vec<u32> = (0..size as u32).collect();
        Self { new_to_old: ids.clone(), old_to_new: ids }
    }

    /// The renumbering that lists the old indices in the order given: the first becomes 0.
    ///
    /// # Panics
    /// If an index is missing, repeated or too large.
    #[must_use]
    pub fn from_elimination_order(new_to_old: Vec<u32>) -> Self {
        let mut old_to_new = vec![u32::MAX; new_to_old.len()];
        for (new, &old) in new_to_old.iter().enumerate() {
            let slot = &mut old_to_new[old as usize];
            assert_eq!(*slot, u32::MAX, "every index once");
            *slot = new as u32;
        }
        Self { new_to_old, old_to_new }
    }

    /// The new number of an old index.
    #[inline]
    #[must_use]
    pub fn new_index(&self, old: usize) -> usize {
        self.old_to_new[old] as usize
    }

    /// The old index behind a new number.
    #[inline]
    #[must_use]
    pub fn old_index(&self, new: usize) -> usize {
        self.new_to_old[new] as usize
    }

    /// How many indices are renumbered.
    #[must_use]
    pub fn len(&self) -> usize {
        self.new_to_old.len()
    }

    /// Whether there is nothing to renumber.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.new_to_old.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_and_reversed_edges_are_one_edge() {
        let edges = [(0, 1), (1, 0), (1, 2), (1, 2), (2, 2)];
        let graph = Graph::from_edges(4, edges.into_iter());
        assert_eq!(graph.neighbours(1), [0, 2]);
        assert_eq!(graph.neighbours(2), [1]);
        assert!(graph.neighbours(3).is_empty());
    }

    #[test]
    fn minimum_degree_orders_the_centre_of_a_star_last_or_next_to_it() {
        let graph = Graph::from_edges(8, (1..8).map(|leaf| (0, leaf)));
        let order = graph.amd().expect("an ordering");
        assert!(order.new_index(0) >= 6, "the hub would fill everything if eliminated early");
        assert!((0..8).all(|v| order.old_index(order.new_index(v)) == v));
    }

    #[test]
    fn an_elimination_order_and_its_inverse_agree() {
        let order = Permutation::from_elimination_order(vec![2, 0, 1]);
        assert_eq!([0, 1, 2].map(|old| order.new_index(old)), [1, 2, 0]);
        assert_eq!(order.old_index(0), 2);
    }

    #[test]
    #[should_panic(expected = "every index once")]
    fn an_order_that_repeats_an_index_is_refused() {
        let _ = Permutation::from_elimination_order(vec![0, 0, 1]);
    }

    #[test]
    fn an_empty_graph_has_an_ordering() {
        let graph = Graph::from_edges(0, std::iter::empty());
        assert!(graph.amd().expect("an ordering").is_empty());
    }
}
