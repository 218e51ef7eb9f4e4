//! What all forms of LinABF have in common: pass after pass until there are enough of them.

use crate::{IMPROVEMENT, LinAbf, Passes};
use abf_constraints::{AngleProblem, max_residual};
use abf_control::{Cancelled, IterationRecord, StopCriteria, Termination, Watch};
use abf_solve_core::{AngleSolution, SolveError, StepError};

/// Where the passes of one solve are.
pub(crate) struct SoFar {
    /// The result of the last pass; before the first, the initial guess.
    pub(crate) angles: Vec<f64>,
    pub(crate) history: Vec<IterationRecord>,
    /// The result with the smallest residual.
    best: Vec<f64>,
    best_residual: f64,
    passes_without_improvement: usize,
}

impl SoFar {
    pub(crate) fn new(problem: &AngleProblem<'_>) -> Self {
        let angles = problem.initial_guess().to_vec();
        Self {
            best: angles.clone(),
            angles,
            history: Vec::new(),
            best_residual: f64::INFINITY,
            passes_without_improvement: 0,
        }
    }

    /// Reports the initial guess.
    pub(crate) fn start(&self, problem: &AngleProblem<'_>, watch: &mut Watch<'_>) -> Result<(), Cancelled> {
        let residual = max_residual(problem.topology(), problem.rows(), &self.angles);
        watch.start_from(self.angles.len(), residual, None)
    }

    /// Keeps the angles inside the bounds, before a pass. How many were moved now, and how many the pass is told to have
    /// begun with: for the first one, those of the initial guess.
    pub(crate) fn clamp(&mut self, problem: &AngleProblem<'_>) -> [usize; 2] {
        let clamped = problem.clamp(&mut self.angles);
        [clamped, if self.history.is_empty() { problem.clamped_angles() } else { clamped }]
    }

    /// A pass has led to these angles. `record` has what is known of it but for its number.
    pub(crate) fn add(&mut self, record: IterationRecord, watch: &mut Watch<'_>) -> Result<(), StepError> {
        let record = IterationRecord { iteration: self.history.len() + 1, ..record };
        let residual = record.constraint_residual;
        let improved = residual < IMPROVEMENT * self.best_residual;
        self.passes_without_improvement = if improved { 0 } else { self.passes_without_improvement + 1 };
        if residual < self.best_residual {
            self.best_residual = residual;
            self.best.clone_from(&self.angles);
        }
        self.history.push(record);
        Ok(watch.iteration(&record)?)
    }
}

/// One form of a pass, with its workspace.
pub(crate) trait Pass {
    fn so_far(&mut self) -> &mut SoFar;

    /// One pass, which ends with [`SoFar::add`]; `false` when it leads nowhere, and the angles stay as they are.
    fn pass(&mut self, watch: &mut Watch<'_>) -> Result<bool, StepError>;
}

impl LinAbf {
    /// Makes passes until there are enough.
    pub(crate) fn make_passes(
        &self,
        mut run: impl Pass,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        watch: &mut Watch<'_>,
    ) -> Result<AngleSolution, SolveError> {
        let termination = loop {
            match run.pass(watch) {
                Ok(true) => {}
                Ok(false) => break Termination::Stalled,
                Err(StepError::Linear(error)) if run.so_far().history.is_empty() => return Err(error.into()),
                // The angles so far are usable; the next guess was not.
                Err(StepError::Linear(_)) => break Termination::Stalled,
                Err(StepError::Cancelled(cancelled)) => return Err(cancelled.into()),
                Err(_) => break watch.interruption().unwrap_or(Termination::Cancelled),
            }
            let SoFar { history, best_residual, passes_without_improvement, .. } = run.so_far();
            let standing = (history.len(), *best_residual, *passes_without_improvement);
            if let Some(end) = self.verdict(standing, stop).or(watch.interruption()) {
                break end;
            }
        };
        let SoFar { angles, best, history, .. } = run.so_far();
        let angles = std::mem::take(if self.passes == Passes::Auto { best } else { angles });
        Ok(AngleSolution::measure(problem, angles, termination, std::mem::take(history)))
    }
}
