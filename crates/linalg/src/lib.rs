//! Sparse linear algebra for angle-based flattening.
//!
//! Everything the solvers and layouts need of a linear system, and nothing about meshes:
//!
//! * [`Graph`] and [`Permutation`]: a fill-reducing ordering of the unknowns, by minimum degree or nested dissection;
//!   [`Analysis`] keeps the cheaper.
//! * [`SymmetricPattern`] and [`SymmetricMatrix`]: the lower triangle of a symmetric (real) or
//!   Hermitian (complex) matrix, compressed by columns.
//! * [`SymbolicCholesky`]: the analysis, done once for a pattern; the numbers, done many times, are
//!   [`Cholesky`] for positive definite matrices and [`Indefinite`] for the others.
//! * [`SparseMatrix`], [`SymbolicLu`] and [`Lu`]: the same for square matrices without symmetry.
//! * [`minres`]: a Krylov method that sees a system only as a [`LinOp`] and a [`Preconditioner`].
//!
//! Every solve returns [`LinearStats`] or [`KrylovStats`] with the *true* relative residual
//! `‖b − Ax‖ / ‖b‖`, computed with the matrix itself: a factorisation that returned `Ok` is no proof
//! of a solution, and neither is an iteration that believes to have converged.
//!
//! Factorisations and products run on the calling thread, sums over vectors in chunks of fixed
//! length: results have the same bits for any number of threads.
//!
//! No other crate of the workspace names faer.

mod analysis;
mod bisection;
mod cholesky;
mod graph;
mod indefinite;
mod krylov;
mod lu;
mod minres;
mod operator;
mod refine;
mod scalar;
mod single;
mod sparse;
mod symmetric;
#[cfg(test)]
mod test_support;
pub mod vector;

use abf_control::Cancelled;
pub use analysis::Analysis;
pub use cholesky::{Cholesky, SymbolicCholesky};
pub use graph::{Graph, Parts, Permutation};
pub use indefinite::Indefinite;
pub use krylov::{KrylovEnd, KrylovParams, KrylovStats};
pub use lu::{Lu, SymbolicLu};
pub use minres::minres;
pub use num_complex::Complex64;
pub use operator::{Identity, Jacobi, LinOp, Preconditioner};
pub use refine::{LinearStats, Refinement};
pub use scalar::Scalar;
pub use single::SingleCholesky;
pub use sparse::SparseMatrix;
pub use symmetric::{SymmetricMatrix, SymmetricPattern};

/// Why a linear system could not be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearError {
    /// The observer aborted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A pivot was not positive: the matrix is not positive definite, or holds a NaN.
    #[error("the matrix is not positive definite: pivot {pivot} of {size}")]
    NotPositiveDefinite {
        /// The pivot, in the order of elimination.
        pivot: usize,
        /// The number of unknowns.
        size: usize,
    },
    /// The matrix has no inverse, or none that the pivots allowed could find; or it holds a NaN.
    #[error("the {size} × {size} matrix is singular, or pivots failed")]
    Singular {
        /// The number of unknowns.
        size: usize,
    },
    /// The factors would need more entries than 32-bit indices can name.
    #[error("a factor of this {size} × {size} matrix needs more entries than 32-bit indices can name")]
    TooLarge {
        /// The number of unknowns.
        size: usize,
    },
    /// The allocator refused.
    #[error("not enough memory to factorise a {size} × {size} matrix")]
    OutOfMemory {
        /// The number of unknowns.
        size: usize,
    },
    /// The solution is not a solution: NaN, infinite, or with a residual as large as the right-hand side.
    #[error("the linear solve failed: true relative residual {relative_residual:.1e}")]
    NoSolution {
        /// `‖b − Ax‖ / ‖b‖` of the best attempt.
        relative_residual: f64,
    },
}
