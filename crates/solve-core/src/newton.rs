//! The one outer loop.
//!
//! Minimise `Σ w (x − a)²` over the angles that satisfy `h(x) = 0`. At `x` with multipliers `μ`, the
//! step and the change of the multipliers solve
//!
//! ```text
//! [ Λ  Jᵀ ] [ δ  ]     [ 2w(x − a) + Jᵀμ ]
//! [ J  0  ] [ Δμ ] = − [ h               ],        x ← x + sδ,  μ ← μ + sΔμ.
//! ```
//!
//! Written for `Δμ` and not for `μ + Δμ`, the right-hand side vanishes at the solution, so an inner
//! method that stops at a *relative* residual gains digits in every outer step.
//!
//! Every solver of the papers but LinABF is a point of the grid [`NewtonSettings`] spans, with one
//! of the inner solves behind [`KktStep`].

use crate::constraints::add_transposed_product;
use crate::hessian::{exact_diagonal, gauss_newton};
use crate::line_search::{Accepted, Merit};
use crate::{
    AngleSolution, BoundRule, Hessian, KktStep, KktSystem, KktVector, LineSearch, LinearError, ProductCurvature,
    SolveError, StepError,
};
use abf_constraints::{AngleProblem, WheelDerivative, WheelForm, max_residual, residual};
use abf_control::{
    Cancelled, Checkpoint, Fallback, IterationRecord, Observer, SettingError, StopCriteria, Termination, Watch,
};

/// How exactly an inner method solves.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum InnerTolerance {
    /// Always to this relative residual.
    Fixed(f64),
    /// To the constraint residual of the outer iteration, kept within these two: no digits are
    /// computed that the next linearisation makes worthless (inexact Newton).
    Inexact {
        /// The smallest relative residual asked for.
        tightest: f64,
        /// The largest.
        loosest: f64,
    },
}

impl Default for InnerTolerance {
    fn default() -> Self {
        Self::Inexact { tightest: 1e-10, loosest: 1e-3 }
    }
}

impl InnerTolerance {
    fn at(self, constraint_residual: f64) -> f64 {
        match self {
            Self::Fixed(tolerance) => tolerance,
            Self::Inexact { tightest, loosest } => constraint_residual.clamp(tightest, loosest),
        }
    }
}

/// A point of the grid: what every solver with a fixed target may be told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct NewtonSettings {
    /// The form of the wheel condition.
    pub wheel: WheelForm,
    /// The second derivatives used.
    pub hessian: Hessian,
    /// How the length of a step is chosen.
    pub line_search: LineSearch,
    /// How angles are kept inside (0, π).
    pub bounds: BoundRule,
    /// How exactly iterative inner methods solve.
    pub inner_tolerance: InnerTolerance,
}

impl NewtonSettings {
    /// [`NewtonSettings::solve`] with a step that is prepared after the clock has started: orderings and
    /// analyses are part of the time limit.
    ///
    /// # Errors
    /// As `solve`, and what `prepare` returns.
    pub fn solve_with<S: KktStep>(
        &self,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
        prepare: impl FnOnce(&mut Watch<'_>) -> Result<S, LinearError>,
    ) -> Result<AngleSolution, SolveError> {
        stop.check()?;
        self.check()?;
        let mut watch = Watch::start(stop, observer);
        start(problem, &mut watch)?;
        let mut step = prepare(&mut watch)?;
        watch.checkpoint()?;
        self.run(problem, stop, &mut watch, &mut step)
    }

    /// Iterates from the initial guess of the problem until the criteria are met: the constraint residual
    /// *and* a last full step small.
    ///
    /// # Errors
    /// [`SolveError`] when a setting is out of range or the very first step has no solution. Later
    /// failures end the solve with the best angles so far.
    pub fn solve(
        &self,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
        step: &mut dyn KktStep,
    ) -> Result<AngleSolution, SolveError> {
        stop.check()?;
        self.check()?;
        let mut watch = Watch::start(stop, observer);
        start(problem, &mut watch)?;
        self.run(problem, stop, &mut watch, step)
    }

    fn run(
        &self,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        watch: &mut Watch<'_>,
        step: &mut dyn KktStep,
    ) -> Result<AngleSolution, SolveError> {
        let mut run = NewtonRun::new(problem, *self);
        let termination = loop {
            match run.iterate(step, watch) {
                Ok(true) => {}
                Ok(false) => break Termination::Stalled,
                Err(StepError::Linear(error)) if run.history.is_empty() => return Err(error.into()),
                Err(StepError::Linear(_)) => break Termination::Stalled,
                Err(StepError::Cancelled(cancelled)) => return Err(cancelled.into()),
                Err(StepError::Interrupted) => break watch.interruption().unwrap_or(Termination::Cancelled),
            }
            if run.is_converged(stop) {
                break Termination::Converged;
            }
            if let Some(interruption) = watch.interruption() {
                break interruption;
            }
            if run.history.len() >= stop.max_iterations {
                break Termination::MaxIterations;
            }
        };
        // Who limits a solve to one iteration wants to see that iteration, if its own solve was finished.
        let is_one = stop.max_iterations == 1 && run.history.last().is_some_and(|last| last.inner_converged);
        let is_shown = is_one && termination == Termination::MaxIterations;
        let angles = if termination.is_as_asked() || is_shown { run.angles } else { run.best };
        Ok(AngleSolution::measure(problem, angles, termination, run.history))
    }

    /// Checks that every setting is in its range; a solve does so first.
    ///
    /// # Errors
    /// [`SolveError::Setting`] naming the setting and its range.
    pub fn check(&self) -> Result<(), SolveError> {
        let positive = |name, value: f64| match value > 0.0 && value < 1.0 {
            true => Ok(()),
            false => Err(SettingError::new(name, "in (0, 1)", value).into()),
        };
        match self.bounds {
            BoundRule::Clamp(bound) => positive("bounds", bound)?,
            BoundRule::Fraction(share) => positive("bounds", share)?,
        }
        match self.inner_tolerance {
            InnerTolerance::Fixed(tolerance) => positive("inner_tolerance", tolerance),
            InnerTolerance::Inexact { tightest, loosest } => {
                positive("inner_tolerance", loosest)?;
                positive("inner_tolerance", tightest)?;
                if tightest > loosest {
                    let allowed = "at most the loosest inner tolerance";
                    return Err(SettingError::new("inner_tolerance", allowed, tightest).into());
                }
                Ok(())
            }
        }
    }
}

/// Reports the initial guess.
fn start(problem: &AngleProblem<'_>, watch: &mut Watch<'_>) -> Result<(), Cancelled> {
    let guess = problem.initial_guess();
    let residual = max_residual(problem.topology(), problem.rows(), guess);
    watch.start_from(guess.len(), residual, Some(problem.energy(guess)))
}

/// The workspace of one solve.
struct NewtonRun<'p, 'a> {
    problem: &'p AngleProblem<'a>,
    settings: NewtonSettings,
    merit: Merit<'p, 'a>,
    gauss_newton: Vec<f64>,
    angles: Vec<f64>,
    multipliers: Vec<f64>,
    best: Vec<f64>,
    best_residual: f64,
    history: Vec<IterationRecord>,
}

/// Everything that is evaluated at the current angles.
struct Linearisation {
    wheel: WheelDerivative,
    residual: Vec<f64>,
    energy_gradient: Vec<f64>,
    lagrangian_gradient: Vec<f64>,
    constraint_residual: f64,
}

/// A step that was taken or not.
struct Attempt {
    accepted: Option<Accepted>,
    record: IterationRecord,
    out: KktVector,
}

impl<'p, 'a> NewtonRun<'p, 'a> {
    fn new(problem: &'p AngleProblem<'a>, settings: NewtonSettings) -> Self {
        let angles = problem.initial_guess().to_vec();
        Self {
            problem,
            settings,
            merit: Merit::new(problem, settings.wheel),
            gauss_newton: gauss_newton(problem),
            multipliers: vec![0.0; problem.rows().len()],
            best: angles.clone(),
            best_residual: max_residual(problem.topology(), problem.rows(), &angles),
            angles,
            history: Vec::new(),
        }
    }

    /// One outer iteration; `false` when no step could be taken.
    fn iterate(&mut self, step: &mut dyn KktStep, watch: &mut Watch<'_>) -> Result<bool, StepError> {
        let here = self.linearise();
        watch.checkpoint()?;
        let mut attempt = self.attempt(&here, self.settings.hessian, step, watch)?;
        // Without multipliers the exact Hessian is 2w already.
        let is_other = self.settings.hessian == Hessian::Exact && self.multipliers.iter().any(|&m| m != 0.0);
        if attempt.accepted.is_none() && is_other {
            let tried = attempt.record;
            attempt = self.attempt(&here, Hessian::GaussNewton, step, watch)?;
            attempt.record.fallback = Some(Fallback::LineSearch);
            attempt.record.negative_curvature = tried.negative_curvature;
            attempt.record.inner_iterations += tried.inner_iterations;
        }
        let Attempt { accepted, mut record, out } = attempt;
        // An attempt that found no descent stays where it is, and is in the history all the same.
        let accepted = accepted.unwrap_or_else(|| Accepted { angles: self.angles.clone(), share: 0.0, clamped: 0 });

        self.angles = accepted.angles;
        self.multipliers.iter_mut().zip(&out.multipliers).for_each(|(m, d)| *m += accepted.share * d);
        record.iteration = self.history.len() + 1;
        record.constraint_residual = max_residual(self.problem.topology(), self.problem.rows(), &self.angles);
        record.energy = Some(self.problem.energy(&self.angles));
        record.step_length = accepted.share;
        record.clamped_angles =
            accepted.clamped + if self.history.is_empty() { self.problem.clamped_angles() } else { 0 };
        if record.constraint_residual <= self.best_residual {
            self.best_residual = record.constraint_residual;
            self.best.clone_from(&self.angles);
        }
        self.history.push(record);
        watch.iteration(&record)?;
        Ok(accepted.share > 0.0)
    }

    /// A small residual, and a last step that was small, full and solved to its tolerance: a step that
    /// is short because its solve broke off says nothing.
    fn is_converged(&self, stop: &StopCriteria) -> bool {
        self.history.last().is_some_and(|last| {
            let is_small = last.constraint_residual <= stop.tolerance && last.step <= stop.step_tolerance;
            is_small && last.step_length == 1.0 && last.inner_converged
        })
    }

    fn linearise(&self) -> Linearisation {
        let (topology, rows) = (self.problem.topology(), self.problem.rows());
        let wheel = WheelDerivative::new(self.settings.wheel, topology, rows, &self.angles);
        let residual = residual(self.settings.wheel, topology, rows, &self.angles);
        let (target, weight) = (self.problem.target(), self.problem.weight());
        let energy_gradient: Vec<f64> =
            (0..self.angles.len()).map(|c| 2.0 * weight[c] * (self.angles[c] - target[c])).collect();
        let mut lagrangian_gradient = energy_gradient.clone();
        add_transposed_product(topology, rows, &wheel, &self.multipliers, &mut lagrangian_gradient);
        let constraint_residual = max_residual(topology, rows, &self.angles);
        Linearisation { wheel, residual, energy_gradient, lagrangian_gradient, constraint_residual }
    }

    /// Solves for a step and searches along it.
    fn attempt(
        &mut self,
        here: &Linearisation,
        hessian: Hessian,
        step: &mut dyn KktStep,
        watch: &mut Watch<'_>,
    ) -> Result<Attempt, StepError> {
        let exact = match hessian {
            Hessian::GaussNewton => None,
            Hessian::Exact => Some(exact_diagonal(
                self.problem,
                &self.gauss_newton,
                self.settings.wheel,
                &self.angles,
                &self.multipliers,
            )),
        };
        let is_product = self.settings.wheel == WheelForm::Product;
        let curvature = ProductCurvature { angles: &self.angles, multipliers: &self.multipliers };
        let kkt = KktSystem {
            topology: self.problem.topology(),
            rows: self.problem.rows(),
            lambda: exact.as_ref().map_or(&self.gauss_newton, |(lambda, _)| lambda),
            gauss_newton: &self.gauss_newton,
            off_diagonal: (is_product && exact.is_some()).then_some(curvature),
            wheel: &here.wheel,
            gradient: &here.lagrangian_gradient,
            residual: &here.residual,
        };
        let mut out = KktVector::default();
        let tolerance = self.settings.inner_tolerance.at(here.constraint_residual);
        let report = step.step(&kkt, tolerance, watch, &mut out)?;
        watch.checkpoint()?;
        let accepted = self.choose_length(here, &out, &mut || watch.checkpoint())?;
        let record = IterationRecord {
            step: out.delta.iter().fold(0.0, |max: f64, d| max.max(d.abs())),
            inner_tolerance: Some(tolerance),
            inner_iterations: report.iterations,
            inner_residual: report.relative_residual,
            inner_estimate: report.estimate,
            inner_converged: report.inner_converged,
            negative_curvature: exact.map_or(0, |(_, negative)| negative),
            fallback: report.fallback,
            ..IterationRecord::default()
        };
        Ok(Attempt { accepted, record, out })
    }

    fn choose_length(
        &mut self,
        here: &Linearisation,
        out: &KktVector,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Option<Accepted>, Cancelled> {
        let rule = self.settings.bounds;
        match self.settings.line_search {
            LineSearch::Full => {
                let share = rule.longest_step(&self.angles, &out.delta);
                let (angles, clamped) = rule.advance(&self.angles, &out.delta, share);
                Ok(angles.iter().all(|x| x.is_finite()).then_some(Accepted { angles, share, clamped }))
            }
            LineSearch::Merit => {
                let next: Vec<f64> = self.multipliers.iter().zip(&out.multipliers).map(|(m, d)| m + d).collect();
                let Linearisation { residual, energy_gradient, .. } = here;
                self.merit.search(rule, &self.angles, &out.delta, residual, energy_gradient, &next, checkpoint)
            }
        }
    }
}
