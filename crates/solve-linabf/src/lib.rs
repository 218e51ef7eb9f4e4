//! Linear angle-based flattening: Zayer, Lévy, Seidel, *Linear Angle Based Parameterization*, SGP 2007.
//!
//! Instead of the angles themselves, LinABF looks for the error `e` of an estimate `α` of them.
//! Linearised in the error, the wheel condition becomes
//!
//! ```text
//! Σ cot α[next] · e[next] − cot α[prev] · e[prev] = Σ log sin α[prev] − log sin α[next]      (10)
//! ```
//!
//! and with the linear triangle and vertex conditions the flat angles are the least-norm solution of
//! one linear system,
//!
//! ```text
//! minimise Σ (e/α)²   subject to   J(α) e = −h(α),                                      (12)–(16)
//! ```
//!
//! which is one quadratic step of the family with `Λ = 2/α²` and `g = 0`. The linearisation is off
//! by the square of the error, so one pass is often all there is to do; further passes re-centre:
//! they take the result, kept inside the angle bounds, as the next estimate (end of §6).

use abf_constraints::{AngleProblem, RESIDUAL_CLAMP, WheelDerivative, WheelForm, largest, max_residual, residual};
use abf_solve_core::{
    AngleSolution, AngleSolver, ConjugateStep, DirectStep, IterationRecord, KktStep, KktSystem, KktVector, Observer,
    SolveError, StepError, StopCriteria, Termination, Watch,
};
use std::f64::consts::PI;
use std::fmt;
use std::num::NonZeroUsize;
use std::str::FromStr;

/// How many passes to make.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Passes {
    /// Until the constraint residual meets the tolerance or stops improving.
    #[default]
    Auto,
    /// Exactly so many; fewer only when the tolerance is met before.
    Exactly(NonZeroUsize),
}

impl FromStr for Passes {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        match s {
            "auto" => Ok(Self::Auto),
            _ => s.parse().map(Self::Exactly).map_err(|_| format!("passes must be 'auto' or at least 1, got '{s}'")),
        }
    }
}

impl fmt::Display for Passes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Exactly(n) => n.fmt(f),
        }
    }
}

/// The LinABF solver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinAbf {
    /// How many passes to make.
    pub passes: Passes,
}

/// With [`Passes::Auto`]: how many passes in a row may fail to improve before giving up.
const PATIENCE: usize = 4;

/// With [`Passes::Auto`]: a pass improves when it brings the residual below this fraction of the best.
const IMPROVEMENT: f64 = 0.5;

/// The relative residual of a pass that is to be the last: as good as a direct solve gets.
const TIGHTEST: f64 = 1e-11;

/// The relative residual of an early pass: its linearisation is off by more than this.
const LOOSEST: f64 = 1e-2;

/// A last pass aims this far below the tolerance, because it is judged in another norm.
const SAFETY: f64 = 0.1;

impl AngleSolver for LinAbf {
    fn name(&self) -> &'static str {
        "linabf"
    }

    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<AngleSolution, SolveError> {
        stop.check()?;
        let mut watch = Watch::start(stop, observer);
        let mut run = Run::new(problem, self.step(problem, stop)?);
        let termination = loop {
            let tolerance = self.inner_tolerance(&run, stop);
            match run.pass(tolerance, &mut watch) {
                Ok(()) => {}
                Err(StepError::Linear(error)) if run.history.is_empty() => return Err(error.into()),
                // The angles so far are usable; the next estimate was not.
                Err(StepError::Linear(_)) => break Termination::Stalled,
                Err(_) => break watch.interruption().unwrap_or(Termination::Cancelled),
            }
            if let Some(end) = self.verdict(&run, stop).or(watch.interruption()) {
                break end;
            }
        };
        let angles = if self.passes == Passes::Auto { run.best } else { run.angles };
        Ok(AngleSolution::measure(problem, angles, termination, run.history))
    }
}

impl LinAbf {
    /// A single pass is one factorisation of `S`. Several passes start close to each other, and each
    /// needs only the digits that the next one can use: conjugate gradients with the factors of the first.
    fn step(&self, problem: &AngleProblem<'_>, stop: &StopCriteria) -> Result<Box<dyn KktStep>, SolveError> {
        let (topology, rows) = (problem.topology(), problem.rows());
        Ok(match self.passes {
            Passes::Auto if stop.max_iterations > 1 => Box::new(ConjugateStep::new(topology, rows)?),
            _ => Box::new(DirectStep::new(topology, rows)?),
        })
    }

    /// The relative residual for the next pass. After a pass the constraints are off by the square of
    /// its correction, so what is left of them before it says how many digits it can use; and when
    /// fewer are enough to meet the tolerance, fewer are asked for.
    fn inner_tolerance(&self, run: &Run<'_, '_>, stop: &StopCriteria) -> f64 {
        let is_last = run.history.len() + 1 >= stop.max_iterations;
        match (self.passes, run.history.last()) {
            (Passes::Exactly(_), _) => TIGHTEST,
            (Passes::Auto, _) if is_last => TIGHTEST,
            (Passes::Auto, None) => LOOSEST,
            (Passes::Auto, Some(last)) => {
                let residual = last.constraint_residual;
                residual.max(SAFETY * stop.tolerance / residual).clamp(TIGHTEST, LOOSEST)
            }
        }
    }

    /// Whether the passes so far are enough.
    fn verdict(&self, run: &Run<'_, '_>, stop: &StopCriteria) -> Option<Termination> {
        let done = run.history.len();
        let limit = match self.passes {
            Passes::Auto => stop.max_iterations,
            Passes::Exactly(n) => n.get(),
        };
        if run.best_residual <= stop.tolerance {
            Some(Termination::Converged)
        } else if done >= limit {
            Some(if limit == 1 { Termination::OnePass } else { Termination::MaxIterations })
        } else if self.passes == Passes::Auto && run.passes_without_improvement >= PATIENCE {
            Some(Termination::Stalled)
        } else {
            None
        }
    }
}

/// The workspace of one solve.
struct Run<'p, 'a> {
    problem: &'p AngleProblem<'a>,
    step: Box<dyn KktStep>,
    zero_gradient: Vec<f64>,
    /// The result of the last pass; before the first, the estimate.
    angles: Vec<f64>,
    /// The constraints at `angles`.
    residual: Vec<f64>,
    /// The result with the smallest residual.
    best: Vec<f64>,
    best_residual: f64,
    passes_without_improvement: usize,
    history: Vec<IterationRecord>,
}

impl<'p, 'a> Run<'p, 'a> {
    fn new(problem: &'p AngleProblem<'a>, step: Box<dyn KktStep>) -> Self {
        Self {
            problem,
            step,
            zero_gradient: vec![0.0; problem.topology().corner_count()],
            angles: problem.estimate().to_vec(),
            residual: residual(WheelForm::Log, problem.topology(), problem.rows(), problem.estimate()),
            best: problem.estimate().to_vec(),
            best_residual: f64::INFINITY,
            passes_without_improvement: 0,
            history: Vec::new(),
        }
    }

    /// One pass: from the last angles, kept inside the bounds, to the least-norm correction.
    fn pass(&mut self, tolerance: f64, watch: &mut Watch<'_>) -> Result<(), StepError> {
        let (topology, rows) = (self.problem.topology(), self.problem.rows());
        let mut estimate = self.angles.clone();
        let moved = self.problem.settings().clamp(&mut estimate);
        if moved > 0 {
            self.residual = residual(WheelForm::Log, topology, rows, &estimate);
        }
        let moved_angles = if self.history.is_empty() { self.problem.moved_angles() } else { moved };

        let lambda: Vec<f64> = estimate.iter().map(|x| 2.0 / (x * x)).collect();
        let kkt = KktSystem {
            topology,
            rows,
            lambda: &lambda,
            gauss_newton: &lambda,
            off_diagonal: None,
            wheel: &WheelDerivative::new(WheelForm::Log, topology, rows, &estimate),
            gradient: &self.zero_gradient,
            residual: &self.residual,
        };
        let mut out = KktVector::default();
        let stats = self.step.step(&kkt, tolerance, watch, &mut out)?;

        let step = out.delta.iter().fold(0.0, |max: f64, e| max.max(e.abs()));
        estimate.iter_mut().zip(&out.delta).for_each(|(x, e)| *x += e);
        self.angles = estimate;
        self.residual = residual(WheelForm::Log, topology, rows, &self.angles);
        let record = IterationRecord {
            iteration: self.history.len() + 1,
            constraint_residual: self.constraint_residual(),
            step,
            inner_iterations: stats.iterations,
            inner_residual: stats.relative_residual,
            inner_estimate: stats.estimate,
            inner_converged: stats.inner_converged,
            moved_angles,
            step_length: 1.0,
            ..IterationRecord::default()
        };
        self.keep_best(record.constraint_residual);
        self.history.push(record);
        watch.iteration(&record);
        Ok(())
    }

    /// `max |h|`, from the constraints at hand where all angles are inside (0, π).
    fn constraint_residual(&self) -> f64 {
        let inside = RESIDUAL_CLAMP..=PI - RESIDUAL_CLAMP;
        if self.angles.iter().all(|x| inside.contains(x)) {
            largest(&self.residual)
        } else {
            max_residual(self.problem.topology(), self.problem.rows(), &self.angles)
        }
    }

    fn keep_best(&mut self, residual: f64) {
        let improved = residual < IMPROVEMENT * self.best_residual;
        self.passes_without_improvement = if improved { 0 } else { self.passes_without_improvement + 1 };
        if residual < self.best_residual {
            self.best_residual = residual;
            self.best.clone_from(&self.angles);
        }
    }
}
