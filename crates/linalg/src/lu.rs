//! Sparse LU with partial pivoting: symbolic once, numeric many, refined and checked.

use crate::cholesky::allocate;
use crate::refine::solve_refined;
use crate::{LinearError, LinearStats, Refinement, SparseMatrix};
use abf_control::Checkpoint;
use faer::dyn_stack::MemStack;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::lu::{self as faer_lu, LuRef, LuSymbolicParams, NumericLu, factorize_symbolic_lu};
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};
use std::sync::Arc;

/// The analysis of a pattern for LU: a column ordering (COLAMD) that keeps the fill low whichever
/// rows are chosen as pivots, and supernodes where they pay.
#[derive(Debug)]
pub struct SymbolicLu {
    column_start: Vec<u32>,
    rows: Vec<u32>,
    symbolic: faer_lu::SymbolicLu<u32>,
}

/// Factors `P A Q = L U` of one matrix.
#[derive(Debug)]
pub struct Lu {
    symbolic: Arc<SymbolicLu>,
    numeric: NumericLu<u32, f64>,
}

impl SymbolicLu {
    /// Analyses the pattern of a matrix; its values do not matter.
    ///
    /// # Errors
    /// [`LinearError::TooLarge`] or [`LinearError::OutOfMemory`].
    pub fn analyse(matrix: &SparseMatrix) -> Result<Arc<Self>, LinearError> {
        let symbolic = factorize_symbolic_lu(pattern(matrix), LuSymbolicParams::default())
            .map_err(|error| failure(&error, matrix.size()))?;
        Ok(Arc::new(Self { column_start: matrix.column_start.clone(), rows: matrix.rows.clone(), symbolic }))
    }

    /// Factorises one matrix of this pattern, on the calling thread.
    ///
    /// # Errors
    /// [`LinearError::Singular`] if the pattern alone leaves a column without a pivot. Values that
    /// make a matrix singular show in [`Lu::solve`]. [`LinearError::OutOfMemory`] and
    /// [`LinearError::TooLarge`], as the fill depends on the pivots.
    ///
    /// # Panics
    /// If the matrix has another pattern.
    pub fn factorise(self: &Arc<Self>, matrix: &SparseMatrix) -> Result<Lu, LinearError> {
        let same = self.column_start == matrix.column_start && self.rows == matrix.rows;
        assert!(same, "a matrix of the analysed pattern");
        let size = matrix.size();
        let mut numeric = NumericLu::new();
        if size > 0 {
            let scratch = self.symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default());
            let mut memory = allocate(scratch, size)?;
            self.symbolic
                .factorize_numeric_lu(
                    &mut numeric,
                    SparseColMatRef::new(pattern(matrix), &matrix.values),
                    Par::Seq,
                    MemStack::new(&mut memory),
                    Default::default(),
                )
                .map_err(|error| match error {
                    LuError::SymbolicSingular { .. } => LinearError::Singular { size },
                    LuError::Generic(error) => failure(&error, size),
                })?;
        }
        Ok(Lu { symbolic: Arc::clone(self), numeric })
    }
}

impl Lu {
    /// Solves `A x = b`, `rhs` being `b` on entry and `x` on return; refined until the true
    /// residual meets `refinement.tolerance` or no longer falls.
    ///
    /// # Errors
    /// [`LinearError::NoSolution`] when what came out is not finite or no better than `x = 0`.
    ///
    /// # Panics
    /// If `rhs` is not as long as the matrix is wide.
    pub fn solve(
        &self,
        matrix: &SparseMatrix,
        rhs: &mut [f64],
        refinement: Refinement,
    ) -> Result<LinearStats, LinearError> {
        self.solve_asking(matrix, rhs, refinement, &mut || Ok(()))
    }

    /// [`Lu::solve`] that asks before every refinement whether to go on.
    ///
    /// # Errors
    /// As `solve`, and [`LinearError::Cancelled`].
    ///
    /// # Panics
    /// As `solve`.
    pub fn solve_asking(
        &self,
        matrix: &SparseMatrix,
        rhs: &mut [f64],
        refinement: Refinement,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<LinearStats, LinearError> {
        let inverse = |x: &mut [f64]| self.apply_inverse(x);
        solve_refined(rhs, refinement, inverse, |x, b, out| matrix.residual(x, b, out), checkpoint)
    }

    fn apply_inverse(&self, rhs: &mut [f64]) -> Result<(), LinearError> {
        let size = rhs.len();
        let symbolic = &self.symbolic.symbolic;
        let mut memory = allocate(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq), size)?;
        LuRef::new_unchecked(symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, size, 1),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        Ok(())
    }
}

fn pattern(matrix: &SparseMatrix) -> SymbolicSparseColMatRef<'_, u32> {
    let size = matrix.size();
    SymbolicSparseColMatRef::new_checked(size, size, &matrix.column_start, None, &matrix.rows)
}

fn failure(error: &FaerError, size: usize) -> LinearError {
    match error {
        FaerError::OutOfMemory => LinearError::OutOfMemory { size },
        _ => LinearError::TooLarge { size },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LinOp;
    use crate::test_support::{Random, mirrored, saddle_point};

    fn solve(a: &SparseMatrix, rhs: &mut [f64]) -> Result<LinearStats, LinearError> {
        SymbolicLu::analyse(a)?.factorise(a)?.solve(a, rhs, Refinement::default())
    }

    fn error_of_planted(a: &SparseMatrix) -> f64 {
        let planted = Random::new(21).vector(a.size());
        let mut x = vec![0.0; a.size()];
        a.apply(&planted, &mut x);
        let stats = solve(a, &mut x).expect("a solution");
        assert!(stats.relative_residual < 1e-12, "{stats:?}");
        x.iter().zip(&planted).fold(0.0, |m, (u, v)| f64::max(m, (u - v).abs()))
    }

    #[test]
    fn three_unknowns_by_hand() {
        // [0 2 0; 1 0 1; 4 0 0] (1, 2, 3) = (4, 4, 4)
        let a = SparseMatrix::from_triplets(3, &[(0, 1, 2.0), (1, 0, 1.0), (1, 2, 1.0), (2, 0, 4.0)]);
        let mut x = [4.0; 3];
        solve(&a, &mut x).expect("a solution");
        assert_eq!(x, [1.0, 2.0, 3.0]);
    }

    #[test]
    fn recovers_planted_solutions_of_random_systems() {
        for (size, per_row) in [(1_usize, 1_u32), (10, 3), (200, 4), (300, 60)] {
            let mut random = Random::new(size as u64);
            let mut triplets = Vec::new();
            for i in 0..size {
                // A cyclic shift carries the rank: no diagonal to lean on.
                triplets.push((i as u32, ((i + 1) % size) as u32, f64::from(per_row)));
                let others = (0..per_row).map(|_| (i as u32, random.index(size) as u32, random.next()));
                triplets.extend(others.collect::<Vec<_>>());
            }
            assert!(error_of_planted(&SparseMatrix::from_triplets(size, &triplets)) < 1e-9, "{size}");
        }
    }

    #[test]
    fn recovers_a_planted_solution_of_convection_on_a_grid() {
        let n = 30_usize;
        let at = |i: usize, j: usize| (i * n + j) as u32;
        let mut triplets = Vec::new();
        for i in 0..n {
            for j in 0..n {
                triplets.push((at(i, j), at(i, j), 4.0));
                if j > 0 {
                    triplets.extend([(at(i, j), at(i, j - 1), -1.8), (at(i, j - 1), at(i, j), -0.2)]);
                    triplets.extend([(at(j, i), at(j - 1, i), -1.5), (at(j - 1, i), at(j, i), -0.5)]);
                }
            }
        }
        assert!(error_of_planted(&SparseMatrix::from_triplets(n * n, &triplets)) < 1e-9);
    }

    #[test]
    fn solves_saddle_point_systems() {
        for seed in 0..20 {
            let (primal, constraints) = (400, 150);
            let a = mirrored(primal + constraints, &saddle_point(primal, constraints, seed));
            assert!(error_of_planted(&a) < 1e-9);
        }
    }

    #[test]
    fn one_analysis_serves_many_matrices() {
        let mut a = mirrored(30, &saddle_point(20, 10, 1));
        let symbolic = SymbolicLu::analyse(&a).expect("an analysis");
        for _ in 0..3 {
            a.values.iter_mut().for_each(|v| *v *= 1.5);
            let factors = symbolic.factorise(&a).expect("factors");
            let mut x = vec![1.0; 30];
            assert!(factors.solve(&a, &mut x, Refinement::default()).expect("a solution").relative_residual < 1e-12);
        }
    }

    #[test]
    fn a_column_without_entries_is_singular() {
        let a = SparseMatrix::from_triplets(3, &[(0, 0, 1.0), (1, 1, 1.0), (2, 1, 1.0)]);
        assert!(matches!(solve(&a, &mut [1.0; 3]), Err(LinearError::Singular { size: 3 })));
    }

    #[test]
    fn a_matrix_singular_by_its_values_has_no_solution() {
        let dense = |n: usize| (0..n * n).map(move |k| ((k / n) as u32, (k % n) as u32, 1.0 + (k / n) as f64));
        for n in [2, 3, 40] {
            let a = SparseMatrix::from_triplets(n, &dense(n).collect::<Vec<_>>());
            let mut x = vec![1.0; n];
            x[0] = -1.0;
            assert!(solve(&a, &mut x).is_err(), "{n}");
        }
    }

    #[test]
    fn a_nan_has_no_solution() {
        for size in [3, 40, 300] {
            let mut a = mirrored(size, &saddle_point(size - size / 3, size / 3, 5));
            a.values[2] = f64::NAN;
            assert!(solve(&a, &mut vec![1.0; size]).is_err(), "{size}");
        }
    }

    #[test]
    fn zero_and_nothing_are_solved() {
        let a = mirrored(30, &saddle_point(20, 10, 1));
        let mut x = vec![0.0; 30];
        assert_eq!(solve(&a, &mut x), Ok(LinearStats::default()));
        assert_eq!(solve(&SparseMatrix::from_triplets(0, &[]), &mut []), Ok(LinearStats::default()));
    }
}
