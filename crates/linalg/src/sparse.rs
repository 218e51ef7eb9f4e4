//! A square sparse matrix without symmetry.

use crate::LinOp;

/// A square real matrix, compressed by columns, rows ascending.
#[derive(Clone, Debug, PartialEq)]
pub struct SparseMatrix {
    pub(crate) column_start: Vec<u32>,
    pub(crate) rows: Vec<u32>,
    pub(crate) values: Vec<f64>,
}

impl SparseMatrix {
    /// The `size × size` matrix with these `(row, column, value)`; what falls on one place is summed,
    /// in the order given. Zeros are kept: the pattern does not depend on the values.
    ///
    /// # Panics
    /// If a triplet lies outside, or there are 2³² or more of them.
    #[must_use]
    pub fn from_triplets(size: usize, triplets: &[(u32, u32, f64)]) -> Self {
        assert!(u32::try_from(triplets.len()).is_ok(), "fewer than 2³² entries");
        let inside = |&(row, column, _): &(u32, u32, f64)| (row as usize) < size && (column as usize) < size;
        assert!(triplets.iter().all(inside), "entries of a {size} × {size} matrix");
        let mut sorted = triplets.to_vec();
        // Stable: the order of a sum is the order of the triplets.
        sorted.sort_by_key(|&(row, column, _)| (column, row));
        let mut column_start = vec![0_u32; size + 1];
        let mut rows = Vec::with_capacity(sorted.len());
        let mut values: Vec<f64> = Vec::with_capacity(sorted.len());
        let mut last = None;
        for (row, column, value) in sorted {
            if last == Some((row, column)) {
                *values.last_mut().expect("one for every place") += value;
            } else {
                rows.push(row);
                values.push(value);
                column_start[column as usize + 1] += 1;
                last = Some((row, column));
            }
        }
        for column in 0..size {
            column_start[column + 1] += column_start[column];
        }
        Self { column_start, rows, values }
    }

    /// The number of rows and columns.
    #[must_use]
    pub fn size(&self) -> usize {
        self.column_start.len() - 1
    }

    /// How many entries are stored.
    #[must_use]
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    /// `out = b − A x`.
    ///
    /// # Panics
    /// If a vector is not as long as the matrix is wide.
    pub fn residual(&self, x: &[f64], b: &[f64], out: &mut [f64]) {
        assert!(x.len() == self.size() && b.len() == self.size() && out.len() == self.size(), "vectors fit the matrix");
        out.copy_from_slice(b);
        self.add_product(-1.0, x, out);
    }

    /// `out ← out + scale · A x`.
    fn add_product(&self, scale: f64, x: &[f64], out: &mut [f64]) {
        for (range, x) in self.column_start.windows(2).zip(x) {
            let range = range[0] as usize..range[1] as usize;
            let x = scale * x;
            for (&row, value) in self.rows[range.clone()].iter().zip(&self.values[range]) {
                out[row as usize] += value * x;
            }
        }
    }
}

impl LinOp for SparseMatrix {
    fn size(&self) -> usize {
        self.column_start.len() - 1
    }

    fn apply(&self, x: &[f64], out: &mut [f64]) {
        assert!(x.len() == self.size() && out.len() == self.size(), "vectors fit the matrix");
        out.fill(0.0);
        self.add_product(1.0, x, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_triplets_are_summed_and_columns_sorted() {
        let a = SparseMatrix::from_triplets(3, &[(2, 1, 1.0), (0, 1, 4.0), (2, 1, 2.0), (1, 0, 0.0)]);
        assert_eq!(a.column_start, [0, 1, 3, 3]);
        assert_eq!(a.rows, [1, 0, 2]);
        assert_eq!(a.values, [0.0, 4.0, 3.0]);
        assert_eq!(a.entries(), 3);
    }

    #[test]
    fn a_product_and_a_residual_use_every_entry() {
        let a = SparseMatrix::from_triplets(2, &[(0, 0, 1.0), (0, 1, 2.0), (1, 0, 3.0)]);
        let mut out = [f64::NAN; 2];
        a.apply(&[5.0, 7.0], &mut out);
        assert_eq!(out, [19.0, 15.0]);
        a.residual(&[5.0, 7.0], &[20.0, 20.0], &mut out);
        assert_eq!(out, [1.0, 5.0]);
    }

    #[test]
    #[should_panic(expected = "entries of a 2 × 2 matrix")]
    fn a_triplet_outside_is_refused() {
        let _ = SparseMatrix::from_triplets(2, &[(0, 2, 1.0)]);
    }
}
