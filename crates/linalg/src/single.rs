//! Cholesky factors in single precision, for preconditioning.
//!
//! Triangular solves are bound by the memory that the factor is read from. A preconditioner needs no
//! more than a few digits, so its factor is computed in double precision, then stored in single: half
//! the bytes, the same iterations.

use crate::{Cholesky, Preconditioner};

/// `L` of `A ≈ L Lᵀ` in single precision, column blocks (supernodes) of equal pattern together.
#[derive(Clone, Debug)]
pub struct SingleCholesky {
    size: usize,
    blocks: Vec<Block>,
    /// The rows below each block, ascending.
    rows: Vec<u32>,
    values: Vec<f32>,
}

/// Columns `begin .. begin + columns`, which share the rows `rows .. rows + below`. Column `j` of them
/// is stored as `1 / L_jj`, then the entries below it inside the block, then those in the shared rows.
#[derive(Clone, Copy, Debug)]
struct Block {
    begin: u32,
    columns: u32,
    below: u32,
    rows: usize,
    values: usize,
}

impl SingleCholesky {
    /// Rounds the factors.
    #[must_use]
    pub fn of(factors: &Cholesky<f64>) -> Self {
        let mut single = Self { size: factors.size(), blocks: Vec::new(), rows: Vec::new(), values: Vec::new() };
        factors.for_each_block(|begin, columns, rows, values| {
            single.blocks.push(Block {
                begin: begin as u32,
                columns: columns as u32,
                below: rows.len() as u32,
                rows: single.rows.len(),
                values: single.values.len(),
            });
            single.rows.extend_from_slice(rows);
            for j in 0..columns {
                let height = columns + rows.len();
                let entries = &values[j * height + j..(j + 1) * height];
                single.values.push(entries[0].recip() as f32);
                single.values.extend(entries[1..].iter().map(|&v| v as f32));
            }
        });
        single
    }

    /// How many bytes the factor takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.values) + size_of_val(&*self.rows) + size_of_val(&*self.blocks)
    }

    /// `L y = x`, in place; `sums` is scratch.
    fn forward(&self, x: &mut [f32], sums: &mut Vec<f32>) {
        for block in &self.blocks {
            let rows = &self.rows[block.rows..block.rows + block.below as usize];
            let (inside, begin) = (block.columns as usize, block.begin as usize);
            sums.clear();
            sums.resize(rows.len(), 0.0);
            let mut at = block.values;
            for j in 0..inside {
                let y = x[begin + j] * self.values[at];
                x[begin + j] = y;
                let (in_block, below) = self.values[at + 1..at + inside - j + rows.len()].split_at(inside - j - 1);
                x[begin + j + 1..begin + inside].iter_mut().zip(in_block).for_each(|(x, l)| *x -= l * y);
                sums.iter_mut().zip(below).for_each(|(sum, l)| *sum += l * y);
                at += inside - j + rows.len();
            }
            rows.iter().zip(&*sums).for_each(|(&row, sum)| x[row as usize] -= sum);
        }
    }

    /// `Lᵀ x = y`, in place; `gathered` is scratch.
    fn backward(&self, x: &mut [f32], gathered: &mut Vec<f32>) {
        for block in self.blocks.iter().rev() {
            let rows = &self.rows[block.rows..block.rows + block.below as usize];
            let (inside, begin) = (block.columns as usize, block.begin as usize);
            gathered.clear();
            gathered.extend(rows.iter().map(|&row| x[row as usize]));
            // Column j starts after the j longer ones before it.
            let start = |j: usize| block.values + j * (inside + rows.len()) - j * j.saturating_sub(1) / 2;
            for j in (0..inside).rev() {
                let at = start(j);
                let (in_block, below) = self.values[at + 1..at + inside - j + rows.len()].split_at(inside - j - 1);
                let sum = dot(in_block, &x[begin + j + 1..begin + inside]) + dot(below, gathered);
                x[begin + j] = (x[begin + j] - sum) * self.values[at];
            }
        }
    }
}

/// In eight sums, always the same ones: fast, and the same bits every time.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    const LANES: usize = 8;
    let mut sums = [0.0_f32; LANES];
    let (mut chunks_a, mut chunks_b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    for (a, b) in (&mut chunks_a).zip(&mut chunks_b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f32 = chunks_a.remainder().iter().zip(chunks_b.remainder()).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f32>() + rest
}

impl Preconditioner for SingleCholesky {
    fn apply(&self, r: &[f64], out: &mut [f64]) {
        assert!(r.len() == self.size && out.len() == self.size, "vectors fit the factor");
        // Residuals shrink towards the solution; scaled, they stay clear of the smallest singles.
        let scale = r.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
        if !(scale > 0.0 && scale.is_finite()) {
            out.copy_from_slice(r);
            return;
        }
        let mut x: Vec<f32> = r.iter().map(|v| (v / scale) as f32).collect();
        let mut scratch = Vec::new();
        self.forward(&mut x, &mut scratch);
        self.backward(&mut x, &mut scratch);
        out.iter_mut().zip(x).for_each(|(out, x)| *out = f64::from(x) * scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Graph, KrylovEnd, KrylovParams, SymbolicCholesky, SymmetricMatrix, SymmetricPattern, cg};
    use std::sync::Arc;

    /// The Laplacian of an `n × n` grid, and a little more on its diagonal.
    fn grid(n: usize) -> SymmetricMatrix<f64> {
        let at = |i: usize, j: usize| (i * n + j) as u32;
        let edges = (0..n).flat_map(|i| (1..n).flat_map(move |j| [(at(i, j - 1), at(i, j)), (at(j - 1, i), at(j, i))]));
        let graph = Graph::from_edges(n * n, edges.clone());
        let order = graph.amd().expect("an ordering");
        let mut a = SymmetricMatrix::zeros(Arc::new(SymmetricPattern::of_blocks(&graph, &order, 1)));
        (0..n * n).for_each(|v| a.add(v, v, 4.01));
        edges.for_each(|(p, q)| a.add(order.new_index(p as usize), order.new_index(q as usize), -1.0));
        a
    }

    #[test]
    fn single_precision_factors_solve_to_single_precision() {
        let a = grid(30);
        let factors =
            SymbolicCholesky::analyse(Arc::clone(a.pattern())).expect("fits").factorise(&a).expect("positive");
        let single = SingleCholesky::of(&factors);
        let b: Vec<f64> = (0..900).map(|i| 1e-60 * (0.3 * f64::from(i)).sin()).collect();
        let (mut exact, mut rounded) = (vec![0.0; 900], vec![0.0; 900]);
        factors.apply(&b, &mut exact);
        single.apply(&b, &mut rounded);
        let largest = exact.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let error = exact.iter().zip(&rounded).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-5 * largest && error > 0.0, "{}", error / largest);
    }

    #[test]
    fn conjugate_gradients_with_single_factors_reach_double_precision_in_a_few_iterations() {
        let a = grid(40);
        let factors =
            SymbolicCholesky::analyse(Arc::clone(a.pattern())).expect("fits").factorise(&a).expect("positive");
        let single = SingleCholesky::of(&factors);
        let b: Vec<f64> = (0..1600).map(|i| (0.7 * f64::from(i)).cos()).collect();
        let mut x = vec![0.0; 1600];
        let params = KrylovParams { relative_tolerance: 1e-12, max_iterations: 10 };
        let stats = cg(&a, &single, &b, &mut x, &params, &mut |_, _| true);
        assert_eq!(stats.end, KrylovEnd::Converged, "{stats:?}");
        assert!(stats.iterations <= 4, "{}", stats.iterations);
    }

    #[test]
    fn zero_and_nan_pass_through() {
        let a = grid(3);
        let factors =
            SymbolicCholesky::analyse(Arc::clone(a.pattern())).expect("fits").factorise(&a).expect("positive");
        let single = SingleCholesky::of(&factors);
        let mut out = vec![1.0; 9];
        single.apply(&[0.0; 9], &mut out);
        assert_eq!(out, [0.0; 9]);
        single.apply(&[f64::NAN; 9], &mut out);
        assert!(out.iter().all(|x| x.is_nan()));
    }
}
