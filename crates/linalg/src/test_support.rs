//! Matrices that the tests of several modules use.

use crate::{Graph, Permutation, Scalar, SparseMatrix, SymmetricMatrix, SymmetricPattern};
use std::sync::Arc;

/// Reproducible numbers in `[−1, 1)` (splitmix64).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn index(&mut self, below: usize) -> usize {
        ((self.next() + 1.0) / 2.0 * below as f64) as usize
    }

    pub(crate) fn vector(&mut self, len: usize) -> Vec<f64> {
        (0..len).map(|_| self.next()).collect()
    }
}

/// Runs a closure in a pool of so many threads.
pub(crate) fn with_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    abf_parallel::with_threads(threads, run).expect("threads")
}

/// A square of `n × n` vertices with one diagonal a cell.
pub(crate) fn sheet(n: usize) -> Graph {
    let at = |i: usize, j: usize| (i * n + j) as u32;
    let cells = (1..n).flat_map(|i| (1..n).map(move |j| (i, j)));
    Graph::from_edges(
        n * n,
        cells.flat_map(move |(i, j)| {
            let (a, b, c, d) = (at(i - 1, j - 1), at(i - 1, j), at(i, j - 1), at(i, j));
            [(a, b), (a, c), (a, d), (b, d), (c, d)]
        }),
    )
}

/// A symmetric matrix with these entries of its lower triangle, in the order given.
pub(crate) fn symmetric(size: usize, lower: &[(usize, usize, f64)]) -> SymmetricMatrix<f64> {
    ordered(size, lower, &Permutation::identity(size))
}

/// The same with its unknowns renumbered.
pub(crate) fn ordered(size: usize, lower: &[(usize, usize, f64)], order: &Permutation) -> SymmetricMatrix<f64> {
    let graph = Graph::from_edges(size, lower.iter().map(|&(i, j, _)| (i as u32, j as u32)));
    let mut a = SymmetricMatrix::zeros(Arc::new(SymmetricPattern::of_blocks(&graph, order, 1)));
    for &(i, j, value) in lower {
        a.add(order.new_index(i), order.new_index(j), value);
    }
    a
}

/// `diagonal` at every vertex of an `n × n` grid and `edge` at every edge, in an order of little fill.
pub(crate) fn grid_matrix<T: Scalar>(n: usize, diagonal: T, edge: T) -> SymmetricMatrix<T> {
    let at = |i: usize, j: usize| (i * n + j) as u32;
    let edges = (0..n).flat_map(|i| (1..n).flat_map(move |j| [(at(i, j - 1), at(i, j)), (at(j - 1, i), at(j, i))]));
    let graph = Graph::from_edges(n * n, edges.clone());
    let order = graph.amd().expect("an ordering");
    let mut a = SymmetricMatrix::zeros(Arc::new(SymmetricPattern::of_blocks(&graph, &order, 1)));
    for v in 0..n * n {
        a.add(v, v, diagonal);
    }
    for (p, q) in edges {
        a.add(order.new_index(p as usize), order.new_index(q as usize), edge);
    }
    a
}

/// The lower triangle of a random saddle point system `[Λ Jᵀ; J 0]`: `primal` unknowns with a
/// positive diagonal, and constraints with four entries each, of full rank by their first entry.
pub(crate) fn saddle_point(primal: usize, constraints: usize, seed: u64) -> Vec<(usize, usize, f64)> {
    let mut random = Random::new(seed);
    let mut lower: Vec<_> = (0..primal).map(|i| (i, i, 1.5 + random.next())).collect();
    for k in 0..constraints {
        lower.push((primal + k, k, 4.0));
        lower.extend((0..3).map(|_| (primal + k, random.index(primal), random.next())));
    }
    lower
}

/// A symmetric matrix without its symmetry.
pub(crate) fn mirrored(size: usize, lower: &[(usize, usize, f64)]) -> SparseMatrix {
    let triplets: Vec<_> = lower
        .iter()
        .flat_map(|&(i, j, v)| {
            let (i, j) = (i as u32, j as u32);
            [(i, j, v)].into_iter().chain((i != j).then_some((j, i, v)))
        })
        .collect();
    SparseMatrix::from_triplets(size, &triplets)
}
