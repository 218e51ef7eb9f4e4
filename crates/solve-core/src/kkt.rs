//! One quadratic step, and the seam behind which it is solved.

use crate::{LinearError, LinearStats, Watch};
use abf_constraints::{ConstraintRows, WheelDerivative};
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
    /// The part of J that depends on the angles.
    pub wheel: &'a WheelDerivative,
    /// g, length 3 nt.
    pub gradient: &'a [f64],
    /// h, length nt + 2 ni.
    pub residual: &'a [f64],
}

/// The solution of a [`KktSystem`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KktVector {
    /// δ, length 3 nt.
    pub delta: Vec<f64>,
    /// μ, length nt + 2 ni: triangle, vertex and wheel multipliers.
    pub multipliers: Vec<f64>,
}

/// Why a step was not taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// The linear system could not be solved.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// The [`Watch`] said stop.
    #[error("interrupted")]
    Interrupted,
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
    ) -> Result<LinearStats, StepError>;
}
