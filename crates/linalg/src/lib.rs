//! Sparse linear algebra for angle-based flattening.
//!
//! Everything the solvers and layouts need of a linear system, and nothing about meshes:
//!
//! * [`Graph`] and [`Permutation`]: a fill-reducing ordering of the unknowns.
//! * [`SymmetricPattern`] and [`SymmetricMatrix`]: the lower triangle of a symmetric (real) or
//!   Hermitian (complex) matrix, compressed by columns.
//! * [`SymbolicCholesky`]: the analysis, done once for a pattern; [`Cholesky`]: the numbers, done
//!   many times.
//!
//! Every solve returns [`LinearStats`] with the *true* relative residual `‖b − Ax‖ / ‖b‖`,
//! computed with the matrix itself: a factorisation that returned `Ok` is no proof of a solution.
//!
//! No other crate of the workspace names faer.

mod cholesky;
mod graph;
mod symmetric;

pub use cholesky::{Cholesky, LinearStats, Refinement, Scalar, SymbolicCholesky};
pub use graph::{Graph, Permutation};
pub use num_complex::Complex64;
pub use symmetric::{SymmetricMatrix, SymmetricPattern};

/// Why a linear system could not be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearError {
    /// A pivot was not positive: the matrix is not positive definite, or holds a NaN.
    #[error("the matrix is not positive definite: pivot {pivot} of {size}")]
    NotPositiveDefinite {
        /// The pivot, in the order of elimination.
        pivot: usize,
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
