//! The lower triangle of a symmetric or Hermitian sparse matrix.

use crate::{Graph, LinOp, Permutation, Scalar};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use std::sync::Arc;

/// Which entries of a lower triangle are stored: compressed columns, rows ascending, every
/// diagonal entry present.
#[derive(Debug, PartialEq, Eq)]
pub struct SymmetricPattern {
    pub(crate) column_start: Vec<u32>,
    pub(crate) rows: Vec<u32>,
}

impl SymmetricPattern {
    /// The pattern of a matrix with a dense `block × block` block for every vertex of the graph
    /// and every edge, its unknowns numbered by `order`: unknown `i` of vertex `v` is
    /// `block · order.new_index(v) + i`.
    ///
    /// # Panics
    /// If `order` is not for as many vertices as the graph has, or the pattern has more than
    /// 2³² entries.
    #[must_use]
    pub fn of_blocks(graph: &Graph, order: &Permutation, block: usize) -> Self {
        assert_eq!(graph.vertex_count(), order.len(), "an ordering of this graph");
        let mut column_start = Vec::with_capacity(block * order.len() + 1);
        let mut rows: Vec<u32> = Vec::new();
        let mut later: Vec<u32> = Vec::new();
        column_start.push(0);
        for new in 0..order.len() {
            let neighbours = graph.neighbours(order.old_index(new));
            later.clear();
            later.extend(neighbours.iter().map(|&v| order.new_index(v as usize) as u32).filter(|&n| n as usize > new));
            later.sort_unstable();
            for i in 0..block {
                rows.extend((i..block).map(|k| (block * new + k) as u32));
                rows.extend(later.iter().flat_map(|&n| (0..block).map(move |k| n * block as u32 + k as u32)));
                column_start.push(u32::try_from(rows.len()).expect("fewer than 2³² entries"));
            }
        }
        Self { column_start, rows }
    }

    /// The number of rows and columns.
    #[must_use]
    pub fn size(&self) -> usize {
        self.column_start.len() - 1
    }

    /// How many entries the lower triangle stores.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.rows.len()
    }

    /// Where the entries of a column are stored: its diagonal first, then the rows below, ascending.
    #[inline]
    #[must_use]
    pub fn column(&self, column: usize) -> std::ops::Range<usize> {
        self.column_start[column] as usize..self.column_start[column + 1] as usize
    }

    /// Where entry `(row, column)`, `row >= column`, is stored.
    ///
    /// # Panics
    /// If the pattern has no such entry.
    #[inline]
    #[must_use]
    pub fn slot(&self, row: usize, column: usize) -> usize {
        let range = self.column(column);
        let place = self.rows[range.clone()].binary_search(&(row as u32));
        range.start + place.expect("the pattern holds every pair of unknowns that share a triangle")
    }

    /// The same pattern as an upper triangle by columns, which is the lower one by rows.
    pub(crate) fn transposed(&self) -> (Vec<u32>, Vec<u32>) {
        let size = self.size();
        let mut start = vec![0_u32; size + 1];
        for &row in &self.rows {
            start[row as usize + 1] += 1;
        }
        for i in 0..size {
            start[i + 1] += start[i];
        }
        let mut cursor = start.clone();
        let mut columns = vec![0_u32; self.rows.len()];
        for column in 0..size {
            for &row in &self.rows[self.column(column)] {
                columns[cursor[row as usize] as usize] = column as u32;
                cursor[row as usize] += 1;
            }
        }
        (start, columns)
    }
}

/// A symmetric (`f64`) or Hermitian ([`Complex64`](crate::Complex64)) matrix, lower triangle stored.
#[derive(Clone, Debug)]
pub struct SymmetricMatrix<T> {
    pattern: Arc<SymmetricPattern>,
    /// The entries, in the order of the pattern.
    pub values: Vec<T>,
}

impl<T: Scalar> SymmetricMatrix<T> {
    /// A matrix of zeros with this pattern.
    #[must_use]
    pub fn zeros(pattern: Arc<SymmetricPattern>) -> Self {
        let values = vec![T::ZERO; pattern.stored()];
        Self { pattern, values }
    }

    /// Which entries are stored.
    #[must_use]
    pub fn pattern(&self) -> &Arc<SymmetricPattern> {
        &self.pattern
    }

    /// The number of rows and columns.
    #[must_use]
    pub fn size(&self) -> usize {
        self.pattern.size()
    }

    /// The matrix of every second unknown, from `part` (0 or 1) on: of a matrix of 2 × 2 blocks, one of
    /// the two diagonal blocks. `pattern` is that of the same graph and order with blocks of size 1.
    ///
    /// # Panics
    /// If `pattern` is another one.
    #[must_use]
    pub fn every_second(&self, pattern: &Arc<SymmetricPattern>, part: usize) -> Self {
        let mut half = Self::zeros(Arc::clone(pattern));
        // Column 2q holds rows 2q, 2q + 1 and then pairs; column 2q + 1 its own diagonal and the same pairs.
        let slots = (0..pattern.size()).flat_map(|q| self.pattern.column(2 * q + part).step_by(2));
        let mut taken = 0;
        for (value, slot) in half.values.iter_mut().zip(slots) {
            *value = self.values[slot];
            taken += 1;
        }
        assert!(taken == pattern.stored() && 2 * pattern.size() == self.size(), "a pattern of the same graph");
        half
    }

    /// Adds to entry `(row, column)` of the full matrix; one above the diagonal is added,
    /// conjugated, to its mirror image.
    ///
    /// # Panics
    /// If the pattern has no such entry.
    #[inline]
    pub fn add(&mut self, row: usize, column: usize, value: T) {
        if row >= column {
            self.values[self.pattern.slot(row, column)] += value;
        } else {
            self.values[self.pattern.slot(column, row)] += value.conjugate();
        }
    }

    /// `out = b − A x`.
    ///
    /// # Panics
    /// If a vector is not as long as the matrix is wide.
    pub fn residual(&self, x: &[T], b: &[T], out: &mut [T]) {
        assert!(x.len() == self.size() && b.len() == self.size() && out.len() == self.size(), "vectors fit the matrix");
        out.copy_from_slice(b);
        self.subtract_product(x, out);
    }

    /// `out ← out − A x`.
    fn subtract_product(&self, x: &[T], out: &mut [T]) {
        for column in 0..self.size() {
            let range = self.pattern.column(column);
            let mut mirrored = T::ZERO;
            for (&row, &value) in self.pattern.rows[range.clone()].iter().zip(&self.values[range]) {
                let row = row as usize;
                out[row] -= value * x[column];
                if row != column {
                    mirrored += value.conjugate() * x[row];
                }
            }
            out[column] -= mirrored;
        }
    }

    /// The stored triangle as the factorisations take it.
    pub(crate) fn lower(&self) -> SparseColMatRef<'_, u32, T> {
        let SymmetricPattern { column_start, rows } = &*self.pattern;
        let symbolic = SymbolicSparseColMatRef::new_checked(self.size(), self.size(), column_start, None, rows);
        SparseColMatRef::new(symbolic, &self.values)
    }
}

/// Both triangles, from the stored one.
impl LinOp for SymmetricMatrix<f64> {
    fn size(&self) -> usize {
        self.pattern.size()
    }

    fn apply(&self, x: &[f64], out: &mut [f64]) {
        assert!(x.len() == self.size() && out.len() == self.size(), "vectors fit the matrix");
        out.fill(0.0);
        self.subtract_product(x, out);
        out.iter_mut().for_each(|v| *v = -*v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Complex64;

    fn path_of_three() -> (Graph, Permutation) {
        let graph = Graph::from_edges(3, [(0, 1), (1, 2)].into_iter());
        let order = Permutation::identity(3);
        (graph, order)
    }

    #[test]
    fn blocks_are_dense_and_sorted() {
        let (graph, order) = path_of_three();
        let pattern = SymmetricPattern::of_blocks(&graph, &order, 2);
        assert_eq!(pattern.size(), 6);
        assert_eq!(pattern.rows[..7], [0, 1, 2, 3, 1, 2, 3]);
        assert_eq!(pattern.slot(3, 1), 6);
    }

    #[test]
    fn the_transposed_pattern_lists_columns_by_row() {
        let (graph, order) = path_of_three();
        let pattern = SymmetricPattern::of_blocks(&graph, &order, 1);
        assert_eq!(pattern.transposed(), (vec![0, 1, 3, 5], vec![0, 0, 1, 1, 2]));
    }

    #[test]
    fn the_upper_triangle_is_the_conjugate_of_the_lower() {
        let (graph, order) = path_of_three();
        let i = Complex64::i();
        let mut a = SymmetricMatrix::zeros(Arc::new(SymmetricPattern::of_blocks(&graph, &order, 1)));
        a.add(0, 1, i);
        a.add(2, 2, Complex64::from(3.0));
        // A = [0 i 0; −i 0 0; 0 0 3], so A·(1, 2, 1) = (2i, −i, 3).
        let x = [1.0, 2.0, 1.0].map(Complex64::from);
        let mut out = vec![Complex64::default(); 3];
        a.residual(&x, &[Complex64::default(); 3], &mut out);
        assert_eq!(out, [-2.0 * i, i, Complex64::from(-3.0)]);
    }
}
