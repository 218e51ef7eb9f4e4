//! What a solver returns, graded by the constraints and not by the solver.

use abf_constraints::{AngleProblem, angles_out_of_range, max_residual};
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
    /// How many angles were moved to the angle bounds before it.
    pub moved_angles: usize,
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

/// The angles a solver found, with their true state.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleSolution {
    angles: Vec<f64>,
    termination: Termination,
    history: Vec<IterationRecord>,
    constraint_residual: f64,
    angles_out_of_range: usize,
    energy: f64,
}

impl AngleSolution {
    /// Takes the angles of a solver and measures them: the only constructor.
    ///
    /// # Panics
    /// If there is not one angle per corner.
    #[must_use]
    pub fn measure(
        problem: &AngleProblem<'_>,
        angles: Vec<f64>,
        termination: Termination,
        history: Vec<IterationRecord>,
    ) -> Self {
        assert_eq!(angles.len(), problem.topology().corner_count(), "one angle per corner");
        let constraint_residual = max_residual(problem.topology(), problem.rows(), &angles);
        let angles_out_of_range = angles_out_of_range(&angles);
        let energy = problem.energy(&angles);
        Self { angles, termination, history, constraint_residual, angles_out_of_range, energy }
    }

    /// The angles, one per corner, rad.
    #[must_use]
    pub fn angles(&self) -> &[f64] {
        &self.angles
    }

    /// How the solve ended.
    #[must_use]
    pub fn termination(&self) -> Termination {
        self.termination
    }

    /// `max |h|` of the angles in the log form, rad, measured.
    #[must_use]
    pub fn constraint_residual(&self) -> f64 {
        self.constraint_residual
    }

    /// How many angles are not inside `(0, π)`, measured.
    #[must_use]
    pub fn angles_out_of_range(&self) -> usize {
        self.angles_out_of_range
    }

    /// `Σ w (x − a)²` of the angles, measured.
    #[must_use]
    pub fn energy(&self) -> f64 {
        self.energy
    }

    /// Every outer iteration.
    #[must_use]
    pub fn history(&self) -> &[IterationRecord] {
        &self.history
    }

    /// How many outer iterations or passes were done.
    #[must_use]
    pub fn iterations(&self) -> usize {
        self.history.len()
    }

    /// How many inner iterations were done, all together.
    #[must_use]
    pub fn inner_iterations(&self) -> usize {
        self.history.iter().map(|r| r.inner_iterations).sum()
    }

    /// The largest number of negative entries of Λ met in one iteration.
    #[must_use]
    pub fn negative_curvature(&self) -> usize {
        self.history.iter().map(|r| r.negative_curvature).max().unwrap_or(0)
    }

    /// How many iterations gave up the exact Hessian.
    #[must_use]
    pub fn fallbacks(&self) -> usize {
        self.history.iter().filter(|r| r.fallback.is_some()).count()
    }

    /// How many times an angle was moved to the angle bounds, all passes together, the estimate
    /// included.
    #[must_use]
    pub fn moved_angles(&self) -> usize {
        self.history.iter().map(|r| r.moved_angles).sum()
    }
}
