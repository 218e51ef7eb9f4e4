//! What a solver returns, graded by the constraints and not by the solver.

use abf_constraints::{AngleProblem, angles_out_of_range, max_residual};
use abf_control::{IterationRecord, Termination};

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
        let off = problem.boundary().map_or(0.0, |boundary| boundary.violation(problem.topology(), &angles));
        let constraint_residual = max_residual(problem.topology(), problem.rows(), &angles).max(off);
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

    /// `max |h|` of the angles in the log form, rad, measured; the conditions on the boundary are part of it.
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

    /// How many times an angle was clamped to the angle bounds, all passes together, the initial guess
    /// included.
    #[must_use]
    pub fn clamped_angles(&self) -> usize {
        self.history.iter().map(|r| r.clamped_angles).sum()
    }
}
