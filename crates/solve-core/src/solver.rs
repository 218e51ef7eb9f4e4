//! The trait behind which all solvers stand.

use crate::{AngleSolution, LinearError};

use abf_constraints::AngleProblem;
use abf_control::{Cancelled, Observer, SettingError, StopCriteria};

/// A method that finds the angles of the flat mesh.
///
/// Settings live in `self`; the workspace lives in [`AngleSolver::solve`]. Not converged, out of
/// range, cancelled: all of that is in the [`AngleSolution`]. `Err` only where there are no usable
/// angles.
///
/// ```
/// use abf_constraints::AngleProblem;
/// use abf_solve_core::{AngleSolution, AngleSolver, SolveError};
/// use abf_control::{Observer, StopCriteria, Termination};
///
/// /// Believes the targets without solving anything.
/// struct Trusting;
///
/// impl AngleSolver for Trusting {
///     fn name(&self) -> &'static str {
///         "trusting"
///     }
///
///     fn solve(
///         &self,
///         problem: &AngleProblem<'_>,
///         stop: &StopCriteria,
///         _: &mut dyn Observer,
///     ) -> Result<AngleSolution, SolveError> {
///         let angles = problem.target().to_vec();
///         let solution = AngleSolution::measure(problem, angles, Termination::Stalled, Vec::new());
///         assert!(solution.constraint_residual() >= 0.0, "measured, whatever the solver believes");
///         # let _ = stop;
///         Ok(solution)
///     }
/// }
/// let solver: Box<dyn AngleSolver> = Box::new(Trusting);
/// assert_eq!(solver.name(), "trusting");
/// ```
pub trait AngleSolver: Send + Sync {
    /// The name on the command line and in reports.
    fn name(&self) -> &'static str;

    /// Checks the settings of the solver before any work is done, with the error that [`AngleSolver::solve`] would give.
    ///
    /// # Errors
    /// [`SolveError`] when a setting is out of range, or settings do not go together.
    fn check(&self) -> Result<(), SolveError> {
        Ok(())
    }

    /// Whether it keeps the conditions on the boundary that a problem may have.
    fn keeps_boundary(&self) -> bool {
        false
    }

    /// Solves one problem.
    ///
    /// # Errors
    /// [`SolveError`] when a setting is out of range or no angles could be computed at all.
    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<AngleSolution, SolveError>;
}

/// Why a solver returned no angles.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// A setting outside its range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// The observer aborted it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Settings that do not go together.
    #[error("{0}")]
    Unsupported(&'static str),
    /// The first linear system could not be solved.
    #[error("the linear system of the first step has no usable solution")]
    Linear(#[source] LinearError),
}

impl From<LinearError> for SolveError {
    fn from(error: LinearError) -> Self {
        match error {
            LinearError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Linear(other),
        }
    }
}
