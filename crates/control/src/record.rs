//! How a solve goes and how it ends.

use std::fmt;

/// How a solve ended. Each of these is a result, not an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Termination {
    /// The stopping criteria are met.
    Converged,
    /// The one pass that was asked for is done: one of LinABF, or the one linear solve of LSCM. To limit a solver to one
    /// iteration is another thing, [`Termination::MaxIterations`].
    OnePass,
    /// The largest number of iterations or passes is done.
    MaxIterations,
    /// The time is up.
    TimeLimit,
    /// The residual stopped falling.
    Stalled,
    /// The observer cancelled.
    Cancelled,
}

impl Termination {
    /// Whether the solver did what it was asked to do.
    #[must_use]
    pub fn is_as_asked(self) -> bool {
        matches!(self, Self::Converged | Self::OnePass)
    }

    /// Whether it was ended from outside, and would have gone on.
    #[must_use]
    pub fn is_interruption(self) -> bool {
        matches!(self, Self::TimeLimit | Self::Cancelled)
    }
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::OnePass => "one-pass",
            Self::MaxIterations => "max-iterations",
            Self::TimeLimit => "time-limit",
            Self::Stalled => "stalled",
            Self::Cancelled => "cancelled",
        })
    }
}

/// Why a step with the exact Hessian was made with the Gauss–Newton one instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Fallback {
    /// The line search found no descent along the exact step.
    LineSearch,
    /// The inner method met `⟨p, h⟩ ≤ 0`, which conjugate directions cannot pass.
    NegativeCurvature,
}

/// One outer iteration, or one pass of LinABF.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IterationRecord {
    /// Counted from 1.
    pub iteration: usize,
    /// `max |h|` after it, log form, rad.
    pub constraint_residual: f64,
    /// `max |δ|` of the full step, rad.
    pub step: f64,
    /// What its linear solve was asked for; `None` for a solve that is always exact. LinABF: the largest
    /// linearised constraint that may be left, `max |h + J e|`; otherwise a relative residual.
    pub inner_tolerance: Option<f64>,
    /// Inner iterations it took (refinement steps of a direct solve).
    pub inner_iterations: usize,
    /// `‖b − Ax‖ / ‖b‖` of its linear solve.
    pub inner_residual: f64,
    /// The inner method's own estimate of that residual, where it has one. The papers stop on it.
    pub inner_estimate: Option<f64>,
    /// Whether the inner solve met the tolerance it was given.
    pub inner_converged: bool,
    /// How many angles were clamped to the angle bounds before it.
    pub clamped_angles: usize,
    /// `Σ w (x − a)²` after it; `None` for methods that have no fixed target.
    pub energy: Option<f64>,
    /// The share of the full step that was taken; 0 when no share of it led anywhere.
    pub step_length: f64,
    /// How many entries of Λ were negative.
    pub negative_curvature: usize,
    /// Whether the exact Hessian was given up for 2w in this step, and by whom.
    pub fallback: Option<Fallback>,
}

impl IterationRecord {
    /// The residual of its linear solve, where there was one: an iteration whose right-hand side is within the tolerance
    /// as it stands solves nothing, and its relative residual of 1 means nothing.
    #[must_use]
    pub fn solved_to(&self) -> Option<f64> {
        let has_solved = self.inner_iterations > 0 || self.inner_residual != 1.0;
        has_solved.then_some(self.inner_residual)
    }
}
