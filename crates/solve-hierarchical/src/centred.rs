//! LinABF from a start that is not its own guess.
//!
//! LinABF looks for the smallest change of its guess `α` of the angles, and linearises there. From closed angles `x₀` that
//! is no change at all. So `α` stays what the result has to be near, and `x₀` is only where the constraints are linearised:
//!
//! ```text
//! minimise Σ ((y − α) / α)²   subject to   J(x₀) (y − x₀) = −h(x₀),
//! ```
//!
//! one quadratic step with `Λ = 2/α²` and `g = Λ (x₀ − α)`. The passes after it are those of LinABF, `g = 0`, but that `g`
//! stays as long as the constraints are far off.

use crate::PER_TASK;
use abf_constraints::{AngleProblem, WheelDerivative, largest, linearise};
use abf_control::{IterationRecord, Observer, StopCriteria, Termination, Watch};
use abf_parallel::prelude::*;
use abf_solve_core::{
    AngleSolution, KktVector, LeastCorrection, Linearisation, SolveError, StepError, constraint_residual,
};

/// As long as the constraints are off by more, rad, a pass keeps to `α`: without that camelhead and horse stall.
const FAR: f64 = 0.3;

/// How well the first pass meets its linearised constraints, rad: its linearisation is off by more.
const FIRST_TARGET: f64 = 1e-4;

/// The passes after it bring them to this part of their square.
const PART: f64 = 0.03;

/// A last pass aims this far below the tolerance.
const SAFETY: f64 = 0.5;

/// So many passes in a row that do not halve the residual are enough.
const PATIENCE: usize = 4;

/// The angles nearest to the initial guess of the problem, `Σ ((y − α) / α)²`, linearised at `start`.
pub(crate) fn solve(
    problem: &AngleProblem<'_>,
    start: Vec<f64>,
    stop: &StopCriteria,
    observer: &mut dyn Observer,
) -> Result<AngleSolution, SolveError> {
    let mut watch = Watch::start(stop, observer);
    let lambda: Vec<f64> = problem.initial_guess().iter().map(|a| 2.0 / (a * a)).collect();
    let (topology, rows) = (problem.topology(), problem.rows());
    let inner = LeastCorrection::new(topology, rows, lambda.clone(), &mut || watch.checkpoint())?;
    let (residual, wheel) = linearise(rows, &start);
    watch.start_from(start.len(), constraint_residual(problem, &start, &residual), None)?;
    let mut passes = Passes { problem, stop, lambda, inner, angles: start, residual, wheel, history: Vec::new() };
    let (mut best, mut best_residual, mut in_vain) = (Vec::new(), f64::INFINITY, 0);
    let termination = loop {
        match passes.pass(&mut watch) {
            Ok(()) => {}
            Err(StepError::Linear(error)) if passes.history.is_empty() => return Err(error.into()),
            Err(StepError::Linear(_)) => break Termination::Stalled,
            Err(StepError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(_) => break watch.interruption().unwrap_or(Termination::Cancelled),
        }
        let residual = passes.history.last().map_or(f64::INFINITY, |record| record.constraint_residual);
        in_vain = if residual < 0.5 * best_residual { 0 } else { in_vain + 1 };
        if residual < best_residual {
            best_residual = residual;
            best.clone_from(&passes.angles);
        }
        if best_residual <= stop.tolerance {
            break Termination::Converged;
        } else if passes.history.len() >= stop.max_iterations {
            break Termination::MaxIterations;
        } else if in_vain >= PATIENCE {
            break Termination::Stalled;
        } else if let Some(interruption) = watch.interruption() {
            break interruption;
        }
    };
    let angles = if best.is_empty() { passes.angles } else { best };
    Ok(AngleSolution::measure(problem, angles, termination, passes.history))
}

/// The workspace of the passes.
struct Passes<'p, 'a> {
    problem: &'p AngleProblem<'a>,
    stop: &'p StopCriteria,
    lambda: Vec<f64>,
    inner: LeastCorrection,
    angles: Vec<f64>,
    /// The constraints at the angles and their derivative.
    residual: Vec<f64>,
    wheel: WheelDerivative,
    history: Vec<IterationRecord>,
}

impl Passes<'_, '_> {
    fn pass(&mut self, watch: &mut Watch<'_>) -> Result<(), StepError> {
        let Self { problem, stop, .. } = *self;
        let clamped = problem.clamp(&mut self.angles);
        if clamped > 0 {
            (self.residual, self.wheel) = linearise(problem.rows(), &self.angles);
        }
        let off = largest(&self.residual);
        let is_first = self.history.is_empty();
        let last = SAFETY * stop.tolerance;
        let target = if is_first { FIRST_TARGET.max(last) } else { last.max(PART * off.min(off * off)) };
        let gradient = if is_first || off > FAR { self.pull() } else { Vec::new() };
        let here = Linearisation {
            topology: problem.topology(),
            rows: problem.rows(),
            wheel: &self.wheel,
            residual: &self.residual,
            gradient: &gradient,
        };
        let mut out = KktVector::default();
        let report = self.inner.solve(&here, target, watch, &mut out)?;
        self.angles.par_iter_mut().with_min_len(PER_TASK).zip(&out.delta).for_each(|(x, e)| *x += e);
        (self.residual, self.wheel) = linearise(problem.rows(), &self.angles);
        let record = IterationRecord {
            iteration: self.history.len() + 1,
            constraint_residual: constraint_residual(problem, &self.angles, &self.residual),
            step: largest(&out.delta),
            step_length: 1.0,
            inner_tolerance: Some(target),
            inner_iterations: report.iterations,
            inner_residual: report.relative_residual,
            inner_estimate: report.estimate,
            inner_converged: report.inner_converged,
            clamped_angles: clamped,
            ..IterationRecord::default()
        };
        self.history.push(record);
        Ok(watch.iteration(&record)?)
    }

    /// `Λ (x − α)`.
    fn pull(&self) -> Vec<f64> {
        let terms = self.lambda.iter().zip(&self.angles).zip(self.problem.initial_guess());
        terms.map(|((l, x), a)| l * (x - a)).collect()
    }
}
