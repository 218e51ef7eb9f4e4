//! Cholesky factors in single precision, for preconditioning.
//!
//! Triangular solves are bound by the memory that the factor is read from. A preconditioner needs no more
//! than a few digits, so it is computed and kept in single precision: half the bytes, half the work, the
//! same iterations. The matrix is scaled to a unit diagonal first, so that its entries fit.
//!
//! A factor whose unknowns come in independent parts ([`Parts`]) is solved with part by part in parallel,
//! and the unknowns that separate them at the end (forward) or at the beginning (backward). What the parts
//! add to the separating unknowns is summed in the order of the parts: the bits do not depend on the threads.

use crate::cholesky::allocate;
use crate::{LinearError, Parts, Permutation, Preconditioner, SymbolicCholesky, SymmetricMatrix};
use abf_parallel::prelude::*;
use faer::dyn_stack::MemStack;
use faer::linalg::solvers::LltError;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::{Par, Side};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;
use std::sync::Arc;

/// How many columns of a block are multiplied together.
const GROUP: usize = 4;

/// How many entries one task renumbers.
const PER_TASK: usize = 1 << 13;

/// `L` of `A ≈ L Lᵀ` in single precision, blocks (supernodes) of columns of equal pattern together.
#[derive(Debug)]
pub struct SingleCholesky {
    symbolic: Arc<SymbolicCholesky>,
    blocks: Vec<Block>,
    parts: Vec<Part>,
    /// The blocks after the parts, and their first unknown.
    top: Range<usize>,
    top_begin: usize,
    /// By blocks and columns, each as high as its block; `1 / L_jj` on the diagonal.
    values: Vec<f32>,
    /// `1 / √a_ii`.
    scale: Vec<f32>,
}

/// Columns `begin .. begin + columns`; their entries below the block are in `below` shared rows, the first
/// `inside` of which belong to the same part.
#[derive(Clone, Copy, Debug)]
struct Block {
    begin: usize,
    columns: usize,
    rows: usize,
    inside: usize,
    below: usize,
    values: usize,
}

/// Blocks that meet other parts nowhere.
#[derive(Clone, Debug)]
struct Part {
    blocks: Range<usize>,
    columns: Range<usize>,
}

impl SymbolicCholesky {
    /// Factorises one matrix of this pattern in single precision.
    ///
    /// # Errors
    /// [`LinearError::NotPositiveDefinite`] (also for NaN), [`LinearError::OutOfMemory`].
    ///
    /// # Panics
    /// If the matrix has another pattern.
    pub fn factorise_single(
        self: &Arc<Self>,
        matrix: &SymmetricMatrix<f64>,
        parts: &Parts,
    ) -> Result<SingleCholesky, LinearError> {
        assert!(Arc::ptr_eq(&self.pattern, matrix.pattern()), "a matrix of the analysed pattern");
        let size = self.pattern.size();
        let diagonal = |column: usize| matrix.values[self.pattern.column(column).start];
        if let Some(pivot) = (0..size).find(|&i| !(diagonal(i) > 0.0 && diagonal(i).is_finite())) {
            return Err(LinearError::NotPositiveDefinite { pivot, size });
        }
        let inverse_roots: Vec<f64> = (0..size).map(|i| diagonal(i).sqrt().recip()).collect();
        let mut scaled = Vec::with_capacity(matrix.values.len());
        for (column, &root) in inverse_roots.iter().enumerate() {
            let range = self.pattern.column(column);
            let entries = self.pattern.rows[range.clone()].iter().zip(&matrix.values[range]);
            scaled.extend(entries.map(|(&row, value)| (value * inverse_roots[row as usize] * root) as f32));
        }
        let lower = SparseColMatRef::new(matrix.lower().symbolic(), &scaled[..]);
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f32>(Par::Seq, Default::default());
        let mut memory = allocate(scratch, size)?;
        let mut values = vec![0.0_f32; self.factor_len()];
        let stack = MemStack::new(&mut memory);
        self.symbolic
            .factorize_numeric_llt(
                &mut values,
                lower,
                Side::Lower,
                Default::default(),
                Par::Seq,
                stack,
                Default::default(),
            )
            .map_err(|LltError::NonPositivePivot { index }| LinearError::NotPositiveDefinite { pivot: index, size })?;
        let scale = inverse_roots.into_iter().map(|v| v as f32).collect();
        Ok(SingleCholesky::new(self, parts, values, scale))
    }
}

impl SingleCholesky {
    fn new(symbolic: &Arc<SymbolicCholesky>, parts: &Parts, mut values: Vec<f32>, scale: Vec<f32>) -> Self {
        let mut blocks = blocks_of(symbolic);
        for block in &blocks {
            for j in 0..block.columns {
                let diagonal = &mut values[block.values + j * (block.height() + 1)];
                *diagonal = diagonal.recip();
            }
        }
        let mut made: Vec<Part> = Vec::new();
        let mut next = 0;
        for columns in parts.ranges() {
            let first = next;
            while next < blocks.len() && blocks[next].end() <= columns.end {
                next += 1;
            }
            let end = if next > first { blocks[next - 1].end() } else { columns.start };
            made.push(Part { blocks: first..next, columns: columns.start..end });
            // A block that reaches into what follows: everything from here on is solved in order.
            if end < columns.end {
                break;
            }
        }
        let top_begin = made.last().map_or(0, |part| part.columns.end);
        let rows = rows_of(symbolic);
        for part in &made {
            for block in &mut blocks[part.blocks.clone()] {
                let own = &rows[block.rows..block.rows + block.below];
                block.inside = own.partition_point(|&row| (row as usize) < part.columns.end);
                assert!(own[block.inside..].iter().all(|&row| row as usize >= top_begin), "independent parts");
            }
        }
        let top = made.last().map_or(0, |part| part.blocks.end)..blocks.len();
        Self { symbolic: Arc::clone(symbolic), blocks, parts: made, top, top_begin, values, scale }
    }

    /// `L Lᵀ x = b`, in place.
    fn solve(&self, x: &mut [f32]) {
        let size = self.scale.len();
        let (parts, top) = x.split_at_mut(self.top_begin);
        let down = |(part, x): (&Part, &mut [f32])| {
            let mut addition = vec![0.0; top.len()];
            self.down(part.blocks.clone(), (x, part.columns.start), (&mut addition, self.top_begin));
            addition
        };
        let additions: Vec<Vec<f32>> = self.split(parts).into_par_iter().map(down).collect();
        for addition in additions {
            top.iter_mut().zip(addition).for_each(|(x, a)| *x += a);
        }
        self.down(self.top.clone(), (top, self.top_begin), (&mut [], size));
        self.up(self.top.clone(), (top, self.top_begin), (&[], size));
        let top = &*top;
        self.split(parts).into_par_iter().for_each(|(part, x)| {
            self.up(part.blocks.clone(), (x, part.columns.start), (top, self.top_begin));
        });
    }

    /// `L y = x` for some blocks in a row. `own` are the unknowns of their part and `top` the separating
    /// ones, each with the number of its first.
    fn down(&self, blocks: Range<usize>, (own, own_begin): (&mut [f32], usize), (top, top_begin): (&mut [f32], usize)) {
        Arch::new().dispatch(Down { factor: self, blocks, own: (own, own_begin), top: (top, top_begin) });
    }

    /// `Lᵀ x = y` for some blocks in a row, from the last to the first.
    fn up(&self, blocks: Range<usize>, (own, own_begin): (&mut [f32], usize), top: (&[f32], usize)) {
        Arch::new().dispatch(Up { factor: self, blocks, own: (own, own_begin), top });
    }

    fn split<'a>(&'a self, mut x: &'a mut [f32]) -> Vec<(&'a Part, &'a mut [f32])> {
        let take = |part: &'a Part| {
            let (own, rest) = std::mem::take(&mut x).split_at_mut(part.columns.len());
            x = rest;
            (part, own)
        };
        self.parts.iter().map(take).collect()
    }

    /// The columns of a block, each from the first row of the block down.
    fn columns(&self, block: &Block) -> &[f32] {
        &self.values[block.values..block.values + block.columns * block.height()]
    }

    /// `L y = x` for the columns of one block.
    #[inline(always)]
    fn forward(
        &self,
        block: &Block,
        rows: &[u32],
        (own, own_begin): (&mut [f32], usize),
        (top, top_begin): (&mut [f32], usize),
        sums: &mut Vec<f32>,
    ) {
        let columns = self.columns(block);
        let (height, wide) = (block.height(), block.columns);
        let x = &mut own[block.begin - own_begin..][..wide];
        for (j, column) in columns.chunks_exact(height).enumerate() {
            let y = x[j] * column[j];
            x[j] = y;
            x[j + 1..].iter_mut().zip(&column[j + 1..wide]).for_each(|(x, l)| *x -= l * y);
        }
        if block.below == 0 {
            return;
        }
        let below = |j: usize| &columns[j * height + wide..(j + 1) * height];
        sums.clear();
        let mut j = wide % GROUP;
        match j {
            0 => sums.resize(block.below, 0.0),
            1 => sums.extend(below(0).iter().map(|a| a * x[0])),
            2 => sums.extend(below(0).iter().zip(below(1)).map(|(a, b)| a * x[0] + b * x[1])),
            _ => sums
                .extend(below(0).iter().zip(below(1)).zip(below(2)).map(|((a, b), c)| a * x[0] + b * x[1] + c * x[2])),
        }
        while j < wide {
            let y = [x[j], x[j + 1], x[j + 2], x[j + 3]];
            let group = below(j).iter().zip(below(j + 1)).zip(below(j + 2).iter().zip(below(j + 3)));
            for (sum, ((a, b), (c, d))) in sums.iter_mut().zip(group) {
                *sum += (a * y[0] + b * y[1]) + (c * y[2] + d * y[3]);
            }
            j += GROUP;
        }
        let rows = &rows[block.rows..block.rows + block.below];
        let (inside, outside) = rows.split_at(block.inside);
        inside.iter().zip(&*sums).for_each(|(&row, sum)| own[row as usize - own_begin] -= sum);
        outside.iter().zip(&sums[block.inside..]).for_each(|(&row, sum)| top[row as usize - top_begin] -= sum);
    }

    /// `Lᵀ x = y` for the columns of one block.
    #[inline(always)]
    fn backward(
        &self,
        block: &Block,
        rows: &[u32],
        (own, own_begin): (&mut [f32], usize),
        (top, top_begin): (&[f32], usize),
        gathered: &mut Vec<f32>,
    ) {
        let columns = self.columns(block);
        let (height, wide) = (block.height(), block.columns);
        let rows = &rows[block.rows..block.rows + block.below];
        let (inside, outside) = rows.split_at(block.inside);
        gathered.clear();
        gathered.extend(inside.iter().map(|&row| own[row as usize - own_begin]));
        gathered.extend(outside.iter().map(|&row| top[row as usize - top_begin]));
        let x = &mut own[block.begin - own_begin..][..wide];
        for (j, column) in columns.chunks_exact(height).enumerate().rev() {
            let (triangle, below) = column.split_at(wide);
            let sum = dot(&triangle[j + 1..], &x[j + 1..]) + dot(below, gathered);
            x[j] = (x[j] - sum) * triangle[j];
        }
    }

    /// [`Preconditioner::apply`] for vectors that are not numbered in the order of elimination: unknown `i`
    /// of theirs is `order.new_index(i)` of the factor.
    ///
    /// # Panics
    /// If a length is not that of the factor.
    pub fn apply_in_order(&self, order: &Permutation, r: &[f64], out: &mut [f64]) {
        let size = self.scale.len();
        assert!(r.len() == size && out.len() == size && order.len() == size, "vectors fit the factor");
        self.apply_renumbered(r, out, |i| order.old_index(i), |i| order.new_index(i));
    }

    fn apply_renumbered(
        &self,
        r: &[f64],
        out: &mut [f64],
        old: impl Fn(usize) -> usize + Sync,
        new: impl Fn(usize) -> usize + Sync,
    ) {
        // Residuals shrink towards the solution; scaled, they stay clear of the smallest singles.
        let largest = r.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
        if !(largest > 0.0 && largest.is_finite()) {
            out.copy_from_slice(r);
            return;
        }
        let mut x = vec![0.0; r.len()];
        x.par_chunks_mut(PER_TASK).zip(self.scale.par_chunks(PER_TASK)).enumerate().for_each(|(task, (x, scale))| {
            for (k, (x, scale)) in x.iter_mut().zip(scale).enumerate() {
                *x = (r[old(task * PER_TASK + k)] / largest) as f32 * scale;
            }
        });
        self.solve(&mut x);
        x.par_chunks_mut(PER_TASK).zip(self.scale.par_chunks(PER_TASK)).for_each(|(x, scale)| {
            x.iter_mut().zip(scale).for_each(|(x, scale)| *x *= scale);
        });
        out.par_chunks_mut(PER_TASK).enumerate().for_each(|(task, out)| {
            for (k, out) in out.iter_mut().enumerate() {
                *out = f64::from(x[new(task * PER_TASK + k)]) * largest;
            }
        });
    }
}

/// [`SingleCholesky::down`], compiled for the instructions of the processor. A closure would not be: it is a function of its own.
struct Down<'a> {
    factor: &'a SingleCholesky,
    blocks: Range<usize>,
    own: (&'a mut [f32], usize),
    top: (&'a mut [f32], usize),
}

impl WithSimd for Down<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { factor, blocks, own, top } = self;
        let (rows, mut sums) = (rows_of(&factor.symbolic), Vec::new());
        for block in &factor.blocks[blocks] {
            factor.forward(block, rows, (&mut *own.0, own.1), (&mut *top.0, top.1), &mut sums);
        }
    }
}

/// [`SingleCholesky::up`], likewise.
struct Up<'a> {
    factor: &'a SingleCholesky,
    blocks: Range<usize>,
    own: (&'a mut [f32], usize),
    top: (&'a [f32], usize),
}

impl WithSimd for Up<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { factor, blocks, own, top } = self;
        let (rows, mut gathered) = (rows_of(&factor.symbolic), Vec::new());
        for block in factor.blocks[blocks].iter().rev() {
            factor.backward(block, rows, (&mut *own.0, own.1), top, &mut gathered);
        }
    }
}

impl Preconditioner for SingleCholesky {
    fn apply(&self, r: &[f64], out: &mut [f64]) {
        assert!(r.len() == self.scale.len() && out.len() == r.len(), "vectors fit the factor");
        self.apply_renumbered(r, out, |i| i, |i| i);
    }
}

impl Block {
    fn height(&self) -> usize {
        self.columns + self.below
    }

    fn end(&self) -> usize {
        self.begin + self.columns
    }
}

fn blocks_of(symbolic: &SymbolicCholesky) -> Vec<Block> {
    // A matrix without unknowns is the one case that faer does not treat by supernodes.
    let SymbolicCholeskyRaw::Supernodal(raw) = symbolic.symbolic.raw() else { return Vec::new() };
    let (rows, values) = (raw.col_ptr_for_row_idx(), raw.col_ptr_for_val());
    let block = |s: usize| {
        let (begin, end) = (raw.supernode_begin()[s] as usize, raw.supernode_end()[s] as usize);
        let below = (rows[s + 1] - rows[s]) as usize;
        Block { begin, columns: end - begin, rows: rows[s] as usize, inside: below, below, values: values[s] as usize }
    };
    (0..raw.n_supernodes()).map(block).collect()
}

fn rows_of(symbolic: &SymbolicCholesky) -> &[u32] {
    match symbolic.symbolic.raw() {
        SymbolicCholeskyRaw::Supernodal(raw) => raw.row_idx(),
        SymbolicCholeskyRaw::Simplicial(_) => &[],
    }
}

/// In eight sums, always the same ones: fast, and the same bits every time.
#[inline(always)]
fn dot(a: &[f32], b: &[f32]) -> f32 {
    const LANES: usize = 8;
    let mut sums = [0.0_f32; LANES];
    // As arrays, a product of eight is one instruction.
    let ((eights_a, rest_a), (eights_b, rest_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in eights_a.iter().zip(eights_b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f32 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    if eights_a.is_empty() { rest } else { sums.iter().sum::<f32>() + rest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::with_threads;
    use crate::{Graph, KrylovEnd, KrylovParams, SymmetricPattern, minres};

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
        let symbolic = SymbolicCholesky::analyse(Arc::clone(a.pattern())).expect("fits");
        let single = symbolic.factorise_single(&a, &Parts::default()).expect("positive");
        let b: Vec<f64> = (0..900).map(|i| 1e-60 * (0.3 * f64::from(i)).sin()).collect();
        let factors = symbolic.factorise(&a).expect("positive");
        let (mut exact, mut rounded) = (vec![0.0; 900], vec![0.0; 900]);
        factors.apply(&b, &mut exact);
        single.apply(&b, &mut rounded);
        let largest = exact.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let error = exact.iter().zip(&rounded).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-5 * largest && error > 0.0, "{}", error / largest);
    }

    #[test]
    fn minres_with_single_factors_reaches_double_precision_in_a_few_iterations() {
        let a = grid(40);
        let symbolic = SymbolicCholesky::analyse(Arc::clone(a.pattern())).expect("fits");
        let single = symbolic.factorise_single(&a, &Parts::default()).expect("positive");
        let b: Vec<f64> = (0..1600).map(|i| (0.7 * f64::from(i)).cos()).collect();
        let mut x = vec![0.0; 1600];
        let params = KrylovParams { relative_tolerance: 1e-12, max_iterations: 10 };
        let stats = minres(&a, &single, &b, &mut x, &params, &mut |_, _| true);
        assert_eq!(stats.end, KrylovEnd::Converged, "{stats:?}");
        assert!(stats.iterations <= 4, "{}", stats.iterations);
    }

    #[test]
    fn zero_and_nan_pass_through() {
        let a = grid(3);
        let symbolic = SymbolicCholesky::analyse(Arc::clone(a.pattern())).expect("fits");
        let single = symbolic.factorise_single(&a, &Parts::default()).expect("positive");
        let mut out = vec![1.0; 9];
        single.apply(&[0.0; 9], &mut out);
        assert_eq!(out, [0.0; 9]);
        single.apply(&[f64::NAN; 9], &mut out);
        assert!(out.iter().all(|x| x.is_nan()));
    }

    /// A grid in independent parts: the same solution as in one, with the same bits for any number of threads.
    #[test]
    fn parts_are_solved_side_by_side() {
        let n = 70;
        let at = |i: usize, j: usize| (i * n + j) as u32;
        let edges = (0..n).flat_map(|i| (1..n).flat_map(move |j| [(at(i, j - 1), at(i, j)), (at(j - 1, i), at(j, i))]));
        let graph = Graph::from_edges(n * n, edges.clone());
        let (order, parts) = graph.in_parts(&graph.amd().expect("an ordering"));
        assert!(parts.ranges().count() > 4, "{parts:?}");
        let mut a = SymmetricMatrix::zeros(Arc::new(SymmetricPattern::of_blocks(&graph, &order, 1)));
        (0..n * n).for_each(|v| a.add(v, v, 4.01));
        edges.for_each(|(p, q)| a.add(order.new_index(p as usize), order.new_index(q as usize), -1.0));
        let symbolic = SymbolicCholesky::analyse(Arc::clone(a.pattern())).expect("fits");
        let b: Vec<f64> = (0..n * n).map(|i| (0.3 * i as f64).sin()).collect();
        let solve = |parts: &Parts, threads| {
            let factor = symbolic.factorise_single(&a, parts).expect("positive");
            let mut x = vec![0.0; b.len()];
            with_threads(threads, || factor.apply_in_order(&order, &b, &mut x));
            x
        };
        let whole = solve(&Parts::default(), 1);
        let apart = solve(&parts, 1);
        assert_eq!(apart, solve(&parts, 2));
        assert!(whole.iter().zip(&apart).all(|(x, y)| (x - y).abs() < 1e-4));
    }
}
