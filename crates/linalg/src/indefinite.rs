//! Symmetric indefinite factors `P A Pᵀ = L B Lᵀ`: Bunch–Kaufman pivots inside supernodes.
//!
//! Bunch, Kaufman, *Some Stable Methods for Calculating Inertia and Solving Symmetric Linear
//! Systems*, Math. Comp. 31 (1977). `L` is unit lower triangular, `B` has blocks of size 1 and 2.

use crate::cholesky::allocate;
use crate::refine::solve_refined;
use crate::{LinearError, LinearStats, Refinement, SymbolicCholesky, SymmetricMatrix};
use abf_control::Checkpoint;
use faer::dyn_stack::MemStack;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{IntranodeLbltRef, SymbolicCholeskyRaw, supernodal::SupernodalIntranodeLbltRef};
use faer::{Conj, MatMut, Par, Side};
use std::sync::Arc;

/// Factors `P A Pᵀ = L B Lᵀ` of one symmetric matrix, definite or not.
///
/// `P` moves unknowns only within supernodes, so the analysis of the pattern stays valid. The price:
/// a pivot that vanishes with nothing beside it in its supernode to pivot with cannot be avoided,
/// even where the matrix is regular. Such a factorisation is refused.
///
/// A saddle point system `[Λ Jᵀ; J 0]` runs into this in most orders. Two ways around:
///
/// * Factorise `[Λ Jᵀ; J −εI]`, with `ε` some `1e-8` of the diagonal of `Λ`, and [`Indefinite::solve`]
///   with the true matrix: refinement takes the `ε` away in a step or two. With a positive definite
///   `Λ` this works in any order of elimination (Vanderbei, *Symmetric Quasidefinite Matrices*,
///   SIAM J. Optim. 5, 1995), so in one of least fill.
/// * Eliminate every multiplier right after an unknown that it acts on: an order for
///   [`Permutation::from_elimination_order`](crate::Permutation::from_elimination_order).
#[derive(Debug)]
pub struct Indefinite {
    symbolic: Arc<SymbolicCholesky>,
    /// `L` below the diagonal and the diagonal of `B`, by supernodes.
    factor: Vec<f64>,
    /// The entries of `B` below its diagonal; zero where a block has size 1.
    subdiagonal: Vec<f64>,
    new_to_old: Vec<u32>,
    old_to_new: Vec<u32>,
}

impl SymbolicCholesky {
    /// Factorises one symmetric matrix of this pattern, definite or not.
    ///
    /// Runs on the calling thread, like [`SymbolicCholesky::factorise`].
    ///
    /// # Errors
    /// [`LinearError::Singular`] if a pivot vanishes (also for NaN), [`LinearError::OutOfMemory`].
    ///
    /// # Panics
    /// If the matrix has another pattern.
    pub fn factorise_indefinite(self: &Arc<Self>, matrix: &SymmetricMatrix<f64>) -> Result<Indefinite, LinearError> {
        assert!(Arc::ptr_eq(&self.pattern, matrix.pattern()), "a matrix of the analysed pattern");
        let size = self.pattern.size();
        let scratch = self.symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = allocate(scratch, size)?;
        let mut factors = Indefinite {
            symbolic: Arc::clone(self),
            factor: vec![0.0; self.factor_len()],
            subdiagonal: vec![0.0; size],
            new_to_old: vec![0; size],
            old_to_new: vec![0; size],
        };
        self.symbolic.factorize_numeric_intranode_lblt(
            &mut factors.factor,
            &mut factors.subdiagonal,
            &mut factors.new_to_old,
            &mut factors.old_to_new,
            matrix.lower(),
            Side::Lower,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        let mut regular = factors.factor.iter().all(|v| v.is_finite());
        factors.for_each_block(|first, below, second| regular &= first * second != below * below);
        if regular { Ok(factors) } else { Err(LinearError::Singular { size }) }
    }
}

impl Indefinite {
    /// Overwrites `rhs` (columns of length [`SymmetricPattern::size`](crate::SymmetricPattern::size),
    /// one after the other) with `A⁻¹ rhs`, as far as the factors know. Nothing is checked.
    ///
    /// # Errors
    /// [`LinearError::OutOfMemory`].
    ///
    /// # Panics
    /// If the length is not a multiple of the size.
    pub fn apply_inverse(&self, rhs: &mut [f64]) -> Result<(), LinearError> {
        let size = self.symbolic.pattern.size();
        if size == 0 {
            return Ok(());
        }
        assert_eq!(rhs.len() % size, 0, "whole columns");
        let columns = rhs.len() / size;
        let symbolic = &self.symbolic.symbolic;
        let mut memory = allocate(symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq), size)?;
        IntranodeLbltRef::new(symbolic, &self.factor, &self.subdiagonal, self.permutation()).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, size, columns),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        Ok(())
    }

    /// Solves `A x = b`, `rhs` being `b` on entry and `x` on return; refined until the true
    /// residual meets `refinement.tolerance` or no longer falls. The residual is that of `matrix`,
    /// which may differ a little from the one factorised.
    ///
    /// # Errors
    /// [`LinearError::NoSolution`] when what came out is not finite or no better than `x = 0`.
    ///
    /// # Panics
    /// If `rhs` is not as long as the matrix is wide.
    pub fn solve(
        &self,
        matrix: &SymmetricMatrix<f64>,
        rhs: &mut [f64],
        refinement: Refinement,
    ) -> Result<LinearStats, LinearError> {
        self.solve_asking(matrix, rhs, refinement, &mut || Ok(()))
    }

    /// [`Indefinite::solve`] that asks before every refinement whether to go on.
    ///
    /// # Errors
    /// As `solve`, and [`LinearError::Cancelled`].
    ///
    /// # Panics
    /// As `solve`.
    pub fn solve_asking(
        &self,
        matrix: &SymmetricMatrix<f64>,
        rhs: &mut [f64],
        refinement: Refinement,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<LinearStats, LinearError> {
        let inverse = |x: &mut [f64]| self.apply_inverse(x);
        solve_refined(rhs, refinement, inverse, |x, b, out| matrix.residual(x, b, out), checkpoint)
    }

    /// How many eigenvalues of `B` are negative, and so, by Sylvester's law of inertia, of the matrix.
    #[must_use]
    pub fn negative_pivots(&self) -> usize {
        let mut negative = 0;
        self.for_each_block(|first, below, second| {
            // A block of size 2 with a negative determinant has one eigenvalue of either sign;
            // with a positive one both have the sign of its entries.
            negative += if first * second < below * below { 1 } else { 2 * usize::from(first < 0.0) };
        });
        negative
    }

    /// Visits the blocks `[first below; below second]` of `B`. One of size 1 is shown as
    /// `[first 0; 0 1]`: it has the same sign, and the same determinant.
    fn for_each_block(&self, mut visit: impl FnMut(f64, f64, f64)) {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.symbolic.raw() else {
            // Only a matrix without unknowns has no supernodes.
            return;
        };
        let factors = SupernodalIntranodeLbltRef::new(symbolic, &self.factor, &self.subdiagonal, self.permutation());
        for index in 0..symbolic.n_supernodes() {
            let supernode = factors.supernode(index);
            let columns = supernode.val();
            let mut k = 0;
            while k < columns.ncols() {
                let below = self.subdiagonal[supernode.start() + k];
                if below == 0.0 {
                    visit(columns[(k, k)], 0.0, 1.0);
                    k += 1;
                } else {
                    visit(columns[(k, k)], below, columns[(k + 1, k + 1)]);
                    k += 2;
                }
            }
        }
    }

    fn permutation(&self) -> PermRef<'_, u32> {
        PermRef::new_checked(&self.new_to_old, &self.old_to_new, self.new_to_old.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{Random, grid_matrix, ordered, saddle_point, symmetric};
    use crate::{Graph, LinOp, Permutation};

    fn factorise(a: &SymmetricMatrix<f64>) -> Result<Indefinite, LinearError> {
        SymbolicCholesky::analyse(Arc::clone(a.pattern())).expect("an analysis").factorise_indefinite(a)
    }

    /// Solves for a planted solution and returns the largest error.
    fn error_of_planted(factors: &Indefinite, a: &SymmetricMatrix<f64>) -> f64 {
        let planted = Random::new(21).vector(a.size());
        let mut x = vec![0.0; a.size()];
        LinOp::apply(a, &planted, &mut x);
        let stats = factors.solve(a, &mut x, Refinement::default()).expect("a solution");
        assert!(stats.relative_residual < 1e-12, "{stats:?}");
        x.iter().zip(&planted).fold(0.0, |m, (u, v)| f64::max(m, (u - v).abs()))
    }

    #[test]
    fn a_matrix_without_a_diagonal_by_hand() {
        // [0 1 2; 1 0 3; 2 3 0] (1, 2, 3) = (8, 10, 8); its eigenvalues are one positive, two negative.
        let a = symmetric(3, &[(1, 0, 1.0), (2, 0, 2.0), (2, 1, 3.0)]);
        let factors = factorise(&a).expect("regular");
        let mut x = [8.0, 10.0, 8.0];
        factors.solve(&a, &mut x, Refinement::default()).expect("a solution");
        assert!(x.iter().zip([1.0, 2.0, 3.0]).all(|(u, v)| (u - v).abs() < 1e-14), "{x:?}");
        assert_eq!(factors.negative_pivots(), 2);
    }

    #[test]
    fn recovers_a_planted_solution_of_an_indefinite_grid() {
        let a = grid_matrix(20, 0.3, -1.0);
        assert!(error_of_planted(&factorise(&a).expect("regular"), &a) < 1e-9);
    }

    #[test]
    fn columns_are_solved_together() {
        let a = grid_matrix(6, 0.3, -1.0);
        let factors = factorise(&a).expect("regular");
        let columns = Random::new(2).vector(72);
        let mut both = columns.clone();
        factors.apply_inverse(&mut both).expect("memory");
        for k in [0, 36] {
            let mut one = columns[k..k + 36].to_vec();
            factors.apply_inverse(&mut one).expect("memory");
            assert!(one.iter().zip(&both[k..]).all(|(u, v)| (u - v).abs() < 1e-10));
        }
    }

    #[test]
    fn the_inertia_of_a_diagonal_is_its_signs() {
        for signs in 0..64_u32 {
            let entry = |i: usize| if signs >> i & 1 == 1 { -1.0 - i as f64 } else { 1.0 + i as f64 };
            let a = symmetric(6, &(0..6).map(|i| (i, i, entry(i))).collect::<Vec<_>>());
            let factors = factorise(&a).expect("regular");
            assert_eq!(factors.negative_pivots(), signs.count_ones() as usize);
        }
    }

    #[test]
    fn the_inertia_of_a_shifted_grid_counts_its_eigenvalues() {
        let (n, diagonal) = (9_u32, 1.3);
        let frequency = |i: u32| 2.0 * (std::f64::consts::PI * f64::from(i) / f64::from(n + 1)).cos();
        let below = (1..=n).flat_map(|i| (1..=n).map(move |j| diagonal - frequency(i) - frequency(j)));
        let factors = factorise(&grid_matrix(9, diagonal, -1.0)).expect("regular");
        assert_eq!(factors.negative_pivots(), below.filter(|&v| v < 0.0).count());
    }

    #[test]
    fn a_positive_definite_matrix_has_no_negative_pivot() {
        let a = grid_matrix(12, 4.5, -1.0);
        assert_eq!(factorise(&a).expect("regular").negative_pivots(), 0);
    }

    /// For every constraint its first unknown, then its multiplier; the other unknowns last.
    fn pairs_first(primal: usize, constraints: usize) -> Permutation {
        let pairs = (0..constraints).flat_map(|k| [k, primal + k]);
        Permutation::from_elimination_order(pairs.chain(constraints..primal).map(|i| i as u32).collect())
    }

    #[test]
    fn a_saddle_point_is_solved_in_an_order_that_feeds_its_pivots() {
        let (primal, constraints) = (60, 25);
        for seed in 0..20 {
            let lower = saddle_point(primal, constraints, seed);
            let a = ordered(primal + constraints, &lower, &pairs_first(primal, constraints));
            let factors = factorise(&a).expect("regular");
            assert_eq!(factors.negative_pivots(), constraints);
            assert!(error_of_planted(&factors, &a) < 1e-8);
        }
    }

    #[test]
    fn factors_of_a_regularised_saddle_point_solve_it_in_any_order() {
        let (primal, constraints) = (400, 150);
        let size = primal + constraints;
        for seed in 0..20 {
            let lower = saddle_point(primal, constraints, seed);
            let order = Graph::from_edges(size, lower.iter().map(|&(i, j, _)| (i as u32, j as u32))).amd();
            let order = order.expect("an ordering");
            let a = ordered(size, &lower, &order);
            let mut regularised = a.clone();
            for k in primal..size {
                regularised.add(order.new_index(k), order.new_index(k), -1e-8);
            }
            let factors = factorise(&regularised).expect("regular");
            assert_eq!(factors.negative_pivots(), constraints);
            assert!(error_of_planted(&factors, &a) < 1e-8);
        }
    }

    #[test]
    fn a_singular_matrix_and_a_nan_are_refused() {
        let singular = symmetric(3, &[(0, 0, 1.0), (1, 1, 1.0), (1, 0, 1.0), (2, 2, 5.0)]);
        assert!(matches!(factorise(&singular), Err(LinearError::Singular { size: 3 })));
        let mut a = grid_matrix(5, 0.5, -1.0);
        a.values[3] = f64::NAN;
        assert!(matches!(factorise(&a), Err(LinearError::Singular { size: 25 })));
    }

    #[test]
    fn a_system_without_unknowns_is_solved() {
        let a = symmetric(0, &[]);
        let factors = factorise(&a).expect("nothing to do");
        assert!(factors.solve(&a, &mut [], Refinement::default()).is_ok());
        assert_eq!(factors.negative_pivots(), 0);
    }
}
