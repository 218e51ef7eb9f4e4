//! What every solver shares: the trait, stopping, observing, one quadratic step and the solution
//! that measures itself.
//!
//! Every solver of the papers repeats one quadratic step at its current angles,
//!
//! ```text
//! [ Λ  Jᵀ ] [ δ ]     [ g ]
//! [ J  0  ] [ μ ] = − [ h ]
//! ```
//!
//! and the solvers differ in where they take it ([`KktSystem`] holds the switches) and in how it is
//! solved ([`KktStep`] is the seam). [`ReducedSystem`] eliminates the triangle rows, leaving a
//! symmetric system of two unknowns per interior vertex; [`DirectStep`] solves that by sparse
//! Cholesky. Iterative methods take it or the whole [`SchurComplement`] with a [`Preconditioning`].
//!
//! A solver cannot grade its own work: [`AngleSolution::measure`] is the only way to make a
//! solution, and it computes the constraint residual from the angles.

mod bounded;
mod constraints;
mod correction;
mod direct;
mod hessian;
mod iterative;
mod kkt;
mod line_search;
mod newton;
mod preconditioner;
mod reduced;
mod schur;
mod solution;
mod solver;
#[cfg(test)]
mod test_support;
mod wheels;

pub use abf_linalg::{LinearError, LinearStats};
pub use bounded::BoundedStep;
pub use constraints::{add_transposed_product, constraint_residual};
pub use correction::{FrozenStep, LeastCorrection, Linearisation};
pub use direct::DirectStep;
pub use hessian::Hessian;
pub use iterative::{IterativeSettings, PreconditionerKind, Reduction};
pub use kkt::{KktStep, KktSystem, KktVector, ProductCurvature, StepError, StepReport};
pub use line_search::{BoundRule, LineSearch};
pub use newton::{InnerTolerance, NewtonSettings};
pub use preconditioner::Preconditioning;
pub use reduced::{BoundaryTerms, ReducedSystem};
pub use schur::{ConstraintProducts, SchurComplement};
pub use solution::AngleSolution;
pub use solver::{AngleSolver, SolveError};
