//! Supernodal Cholesky: symbolic once, numeric many, refined and checked.

use crate::refine::solve_refined;
use crate::{LinearError, LinearStats, Preconditioner, Refinement, Scalar, SymmetricMatrix, SymmetricPattern};
use abf_control::Checkpoint;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::solvers::LltError;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    self as faer_cholesky, CholeskySymbolicParams, LltRef, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{FaerError, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};
use std::sync::Arc;

/// The analysis of a pattern: elimination tree, supernodes, the pattern of the factor.
///
/// Unknowns are eliminated in the order they are numbered: build the pattern with a fill-reducing
/// [`Permutation`](crate::Permutation).
#[derive(Debug)]
pub struct SymbolicCholesky {
    pub(crate) pattern: Arc<SymmetricPattern>,
    pub(crate) symbolic: faer_cholesky::SymbolicCholesky<u32>,
}

/// Factors `A = L Lᴴ` of one matrix.
#[derive(Debug)]
pub struct Cholesky<T> {
    symbolic: Arc<SymbolicCholesky>,
    factor: Vec<T>,
}

impl SymbolicCholesky {
    /// Analyses a pattern. The result serves every matrix that has it, real or complex.
    ///
    /// # Errors
    /// [`LinearError::TooLarge`] or [`LinearError::OutOfMemory`].
    pub fn analyse(pattern: Arc<SymmetricPattern>) -> Result<Arc<Self>, LinearError> {
        let size = pattern.size();
        // The analysis wants the upper triangle by columns, the numbers want the lower one.
        let (start, columns) = pattern.transposed();
        let upper = SymbolicSparseColMat::<u32>::new_checked(size, size, start, None, columns);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(upper.as_ref(), Side::Upper, SymmetricOrdering::Identity, params)
            .map_err(|error| match error {
                FaerError::OutOfMemory => LinearError::OutOfMemory { size },
                _ => LinearError::TooLarge { size },
            })?;
        Ok(Arc::new(Self { pattern, symbolic }))
    }

    /// The pattern that was analysed.
    #[must_use]
    pub fn pattern(&self) -> &Arc<SymmetricPattern> {
        &self.pattern
    }

    /// How many numbers a factor holds.
    #[must_use]
    pub fn factor_len(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Multiplications of a factorisation: `Σ c²` over the lengths `c` of the factor's columns.
    #[must_use]
    pub fn flops(&self) -> f64 {
        // A matrix without unknowns is the one case that faer does not treat by supernodes.
        let SymbolicCholeskyRaw::Supernodal(raw) = self.symbolic.raw() else { return 0.0 };
        let rows = raw.col_ptr_for_row_idx();
        let of_supernode = |s: usize| {
            let wide = raw.supernode_end()[s] - raw.supernode_begin()[s];
            let below = f64::from(rows[s + 1] - rows[s]);
            (1..=wide).map(|columns| (below + f64::from(columns)).powi(2)).sum::<f64>()
        };
        (0..raw.n_supernodes()).map(of_supernode).sum()
    }

    /// Factorises one matrix of this pattern.
    ///
    /// Runs on the calling thread: threads inside dense blocks cost a third more work here and
    /// change the bits with their number.
    ///
    /// # Errors
    /// [`LinearError::NotPositiveDefinite`] (also for NaN), [`LinearError::OutOfMemory`].
    ///
    /// # Panics
    /// If the matrix has another pattern.
    pub fn factorise<T: Scalar>(self: &Arc<Self>, matrix: &SymmetricMatrix<T>) -> Result<Cholesky<T>, LinearError> {
        assert!(Arc::ptr_eq(&self.pattern, matrix.pattern()), "a matrix of the analysed pattern");
        let size = self.pattern.size();
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<T>(Par::Seq, Default::default());
        let mut memory = allocate(scratch, size)?;
        let mut factor = vec![T::ZERO; self.factor_len()];
        self.symbolic
            .factorize_numeric_llt(
                &mut factor,
                matrix.lower(),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|LltError::NonPositivePivot { index }| LinearError::NotPositiveDefinite { pivot: index, size })?;
        Ok(Cholesky { symbolic: Arc::clone(self), factor })
    }
}

impl<T: Scalar> Cholesky<T> {
    /// The number of unknowns.
    #[must_use]
    pub fn size(&self) -> usize {
        self.symbolic.pattern.size()
    }

    /// Overwrites `rhs` (columns of length [`SymmetricPattern::size`], one after the other) with
    /// `(L Lᴴ)⁻¹ rhs`. Nothing is checked: this is the preconditioner's call.
    ///
    /// # Errors
    /// [`LinearError::OutOfMemory`].
    ///
    /// # Panics
    /// If the length is not a multiple of the size.
    pub fn apply_inverse(&self, rhs: &mut [T]) -> Result<(), LinearError> {
        let size = self.symbolic.pattern.size();
        if size == 0 {
            return Ok(());
        }
        assert_eq!(rhs.len() % size, 0, "whole columns");
        let columns = rhs.len() / size;
        let scratch = self.symbolic.symbolic.solve_in_place_scratch::<T>(columns, Par::Seq);
        let mut memory = allocate(scratch, size)?;
        LltRef::<u32, T>::new(&self.symbolic.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, size, columns),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        Ok(())
    }

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
        matrix: &SymmetricMatrix<T>,
        rhs: &mut [T],
        refinement: Refinement,
    ) -> Result<LinearStats, LinearError> {
        self.solve_asking(matrix, rhs, refinement, &mut || Ok(()))
    }

    /// [`Cholesky::solve`] that asks around every refinement whether to go on.
    ///
    /// # Errors
    /// As `solve`, and [`LinearError::Cancelled`].
    ///
    /// # Panics
    /// As `solve`.
    pub fn solve_asking(
        &self,
        matrix: &SymmetricMatrix<T>,
        rhs: &mut [T],
        refinement: Refinement,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<LinearStats, LinearError> {
        let inverse = |x: &mut [T]| self.apply_inverse(x);
        solve_refined(rhs, refinement, inverse, |x, b, out| matrix.residual(x, b, out), checkpoint)
    }
}

/// The factors as a preconditioner. Memory running out shows as NaN, which ends any iteration.
impl Preconditioner for Cholesky<f64> {
    fn apply(&self, r: &[f64], out: &mut [f64]) {
        out.copy_from_slice(r);
        if self.apply_inverse(out).is_err() {
            out.fill(f64::NAN);
        }
    }
}

pub(crate) fn allocate(scratch: StackReq, size: usize) -> Result<MemBuffer, LinearError> {
    MemBuffer::try_new(scratch).map_err(|_| LinearError::OutOfMemory { size })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::grid_matrix;
    use crate::{Complex64, Graph, Permutation};

    fn grid<T: Scalar>(n: usize, diagonal: T, edge: T) -> (SymmetricMatrix<T>, Arc<SymbolicCholesky>) {
        let a = grid_matrix(n, diagonal, edge);
        let symbolic = SymbolicCholesky::analyse(Arc::clone(a.pattern())).expect("an analysis");
        (a, symbolic)
    }

    fn check_planted<T: Scalar>(a: &SymmetricMatrix<T>, symbolic: &Arc<SymbolicCholesky>, x: &[T]) {
        let mut minus_b = vec![T::ZERO; x.len()];
        a.residual(x, &vec![T::ZERO; x.len()], &mut minus_b);
        let mut y: Vec<T> = minus_b.iter().map(|&v| T::ZERO - v).collect();
        let stats = symbolic.factorise(a).expect("positive definite").solve(a, &mut y, Refinement::default());
        assert!(stats.expect("a solution").relative_residual < 1e-14);
        let error = y.iter().zip(x).map(|(&u, &v)| (u - v).norm_squared()).sum::<f64>().sqrt();
        assert!(error < 1e-11, "{error}");
    }

    #[test]
    fn recovers_a_planted_real_solution() {
        let (a, symbolic) = grid(20, 4.5, -1.0);
        let x: Vec<f64> = (0..400).map(|i| (f64::from(i) * 0.37).sin()).collect();
        check_planted(&a, &symbolic, &x);
    }

    #[test]
    fn recovers_a_planted_complex_solution() {
        let (a, symbolic) = grid(15, Complex64::from(4.5), Complex64::from_polar(1.0, 0.7));
        let x: Vec<Complex64> = (0..225).map(|i| Complex64::from_polar(1.0, f64::from(i))).collect();
        check_planted(&a, &symbolic, &x);
    }

    #[test]
    fn one_analysis_serves_many_matrices() {
        let (mut a, symbolic) = grid(8, 4.5, -1.0);
        let x = vec![1.0; 64];
        check_planted(&a, &symbolic, &x);
        a.values.iter_mut().for_each(|v| *v *= 3.0);
        check_planted(&a, &symbolic, &x);
    }

    #[test]
    fn an_indefinite_matrix_and_a_nan_are_refused() {
        let (mut a, symbolic) = grid(5, 0.5, -1.0);
        assert!(matches!(symbolic.factorise(&a), Err(LinearError::NotPositiveDefinite { size: 25, .. })));
        a.values[3] = f64::NAN;
        assert!(matches!(symbolic.factorise(&a), Err(LinearError::NotPositiveDefinite { .. })));
    }

    #[test]
    fn a_zero_right_hand_side_has_the_zero_solution() {
        let (a, symbolic) = grid(5, 4.5, -1.0);
        let mut x = vec![0.0; 25];
        let stats = symbolic.factorise(&a).expect("factors").solve(&a, &mut x, Refinement::default());
        assert_eq!(stats, Ok(LinearStats::default()));
        assert_eq!(x, vec![0.0; 25]);
    }

    #[test]
    fn a_system_without_unknowns_is_solved() {
        let graph = Graph::from_edges(0, std::iter::empty());
        let pattern = Arc::new(SymmetricPattern::of_blocks(&graph, &Permutation::identity(0), 2));
        let symbolic = SymbolicCholesky::analyse(Arc::clone(&pattern)).expect("an analysis");
        let a = SymmetricMatrix::<f64>::zeros(pattern);
        let factors = symbolic.factorise(&a).expect("factors");
        assert!(factors.solve(&a, &mut [], Refinement::default()).is_ok());
    }
}
