//! One quadratic step, and the seam behind which it is solved.

use crate::{LinearError, LinearStats};

use abf_constraints::{ConstraintRows, WheelDerivative};
use abf_control::{Cancelled, Fallback, Watch};
use abf_mesh::Topology;

/// The system `[Λ Jᵀ; J 0] [δ; μ] = −[g; h]` at one set of angles, `Λ` diagonal.
#[derive(Clone, Copy, Debug)]
pub struct KktSystem<'a> {
    /// Who meets whom.
    pub topology: &'a Topology,
    /// Which constraint is which row.
    pub rows: &'a ConstraintRows,
    /// Λ, length 3 nt. May have negative entries.
    pub lambda: &'a [f64],
    /// 2w, length 3 nt: the positive Λ of the Gauss–Newton Hessian, which preconditioners are built
    /// with and which an iterative method may fall back to.
    pub gauss_newton: &'a [f64],
    /// What a diagonal Λ leaves out of the exact Hessian: nothing in the log form.
    pub off_diagonal: Option<ProductCurvature<'a>>,
    /// The part of J that depends on the angles.
    pub wheel: &'a WheelDerivative,
    /// g, length 3 nt.
    pub gradient: &'a [f64],
    /// h, length nt + 2 ni.
    pub residual: &'a [f64],
}

/// The second derivative of the product wheels, which is not diagonal (ABF 2001). With
/// `N = Π sin x[next]` around an interior vertex of wheel multiplier `m`, it has, for corners `i ≠ j`
/// of that ring, `m N cot xᵢ cot xⱼ` and `−m N` on the diagonal; likewise `−m` for `prev`.
#[derive(Clone, Copy, Debug)]
pub struct ProductCurvature<'a> {
    /// x, length 3 nt.
    pub angles: &'a [f64],
    /// μ, length nt + 2 ni.
    pub multipliers: &'a [f64],
}

/// The solution of a [`KktSystem`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KktVector {
    /// δ, length 3 nt.
    pub delta: Vec<f64>,
    /// μ, length nt + 2 ni: triangle, vertex and wheel multipliers.
    pub multipliers: Vec<f64>,
}

/// What a step took and reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Inner iterations; refinement steps of a direct solve.
    pub iterations: usize,
    /// `‖b − Ax‖ / ‖b‖` of the linear system, computed with the operator.
    pub relative_residual: f64,
    /// The method's own estimate of it, where it has one.
    pub estimate: Option<f64>,
    /// Whether the exact Λ had to be given up for 2w.
    pub fallback: Option<Fallback>,
    /// Whether an inner iteration met its tolerance. A step that did not may still be worth taking,
    /// but that it is short says nothing about how far the optimum is.
    pub inner_converged: bool,
}

impl Default for StepReport {
    fn default() -> Self {
        Self { iterations: 0, relative_residual: 0.0, estimate: None, fallback: None, inner_converged: true }
    }
}

/// A direct solve whose true relative residual is above this did not solve the system.
const SOLVED: f64 = 1e-6;

impl From<LinearStats> for StepReport {
    /// The report of a direct solve.
    fn from(stats: LinearStats) -> Self {
        Self {
            iterations: stats.iterations,
            relative_residual: stats.relative_residual,
            inner_converged: stats.relative_residual <= SOLVED,
            ..Self::default()
        }
    }
}

/// Why a step was not taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// The linear system could not be solved.
    #[error(transparent)]
    Linear(LinearError),
    /// The observer aborted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The [`Watch`] said stop.
    #[error("interrupted")]
    Interrupted,
}

impl From<LinearError> for StepError {
    fn from(error: LinearError) -> Self {
        match error {
            LinearError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Linear(other),
        }
    }
}

/// A way to solve a [`KktSystem`]: direct, Uzawa and MINRES differ only here.
pub trait KktStep {
    /// Solves to a relative residual of `tolerance` where the method is iterative, and reports the
    /// true one. Asks `watch` at every inner iteration.
    ///
    /// # Errors
    /// [`StepError`] when there is no solution or the watch interrupts.
    fn step(
        &mut self,
        kkt: &KktSystem<'_>,
        tolerance: f64,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<StepReport, StepError>;
}
