//! Linear angle-based flattening: Zayer, Lévy, Seidel, *Linear Angle Based Parameterization*, SGP 2007.
//!
//! Instead of the angles themselves, LinABF looks for the error `e` of an initial guess `α` of them.
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
//! they take the result, kept inside the angle bounds, as the next guess (end of §6).
//!
//! Where the solution is expected near other angles, the first pass linearises there and still asks for the angles nearest
//! to α: the linearisation is off by the square of a smaller error.
//!
//! Conditions on the boundary are kept by an active set in every pass: `bounded.rs`; bounds on the error (§4) by another:
//! `boxed.rs`.

mod bounded;
mod boxed;
mod passes;

use abf_constraints::{AngleProblem, WheelDerivative, largest, linearise, linearise_into};
use abf_control::{IterationRecord, Observer, SettingError, StopCriteria, Termination, Watch};
use abf_parallel::prelude::*;
use abf_solve_core::{
    AngleSolution, AngleSolver, DirectStep, KktStep, KktSystem, KktVector, LeastCorrection, Linearisation, SolveError,
    StepError, StepReport, constraint_residual,
};
use passes::{Pass, SoFar};
use std::fmt;
use std::num::NonZeroUsize;
use std::str::FromStr;

/// How many passes to make.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Passes {
    /// Until the constraint residual meets the tolerance or stops improving.
    #[default]
    Auto,
    /// Exactly so many; fewer only when the tolerance is met before.
    #[cfg_attr(feature = "serde", serde(untagged))]
    Exactly(NonZeroUsize),
}

impl FromStr for Passes {
    type Err = SettingError;

    fn from_str(s: &str) -> Result<Self, SettingError> {
        match s {
            "auto" => Ok(Self::Auto),
            _ => s
                .parse()
                .map(Self::Exactly)
                .map_err(|_| SettingError::new("passes", "'auto' or at least 1", format_args!("'{s}'"))),
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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct LinAbf {
    /// How many passes to make.
    pub passes: Passes,
    /// How far an angle may move in a pass at most, as a part `B` of its way to 0 or π: `−B α ≤ e ≤ B (π − α)`, in (0, 1);
    /// `None` bounds nothing. See `boxed.rs` for where it helps and where it stalls. With conditions on the boundary it is refused.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub error_bound: Option<f64>,
}

/// The paper's own method.
const ONE_PASS: Passes = Passes::Exactly(NonZeroUsize::MIN);

/// With [`Passes::Auto`]: how many passes in a row may fail to improve before giving up.
const PATIENCE: usize = 4;

/// With [`Passes::Auto`]: a pass improves when it brings the residual below this fraction of the best.
const IMPROVEMENT: f64 = 0.5;

/// The relative residual asked of the solve of a pass that is one of a number.
const TIGHTEST: f64 = 1e-11;

/// The first pass brings the linearised constraints to this part of what they were: how far its
/// linearisation is off is not known yet, but it is more than this.
const FIRST: f64 = 0.03;

/// A last pass aims this far below the tolerance, because its linearisation is a little off.
const SAFETY: f64 = 0.5;

/// When the linearisation of a pass is expected to be off by at most this multiple of the tolerance, the
/// pass aims to be the last.
const HOPE: f64 = 0.5;

impl AngleSolver for LinAbf {
    fn name(&self) -> &'static str {
        "linabf"
    }

    fn check(&self) -> Result<(), SolveError> {
        match self.error_bound {
            Some(bound) if !(bound > 0.0 && bound < 1.0) => {
                Err(SettingError::new("error_bound", "in (0, 1)", bound).into())
            }
            _ => Ok(()),
        }
    }

    /// Not with a bound on the error.
    fn keeps_boundary(&self) -> bool {
        self.error_bound.is_none()
    }

    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<AngleSolution, SolveError> {
        stop.check()?;
        self.check()?;
        if let Some(conditions) = problem.boundary() {
            if !self.keeps_boundary() {
                return Err(Self::BOUND_AND_BOUNDARY);
            }
            return bounded::solve(self, problem, conditions, stop, observer);
        }
        if let Some(bound) = self.error_bound {
            return boxed::solve(self, bound, problem, stop, observer);
        }
        let mut watch = Watch::start(stop, observer);
        let inner = self.inner(problem, stop, &mut watch)?;
        let run = LinAbfRun::new((problem, stop), inner);
        watch.checkpoint()?;
        let run = run.at_expected();
        let angles = &run.so_far.angles;
        watch.start_from(angles.len(), constraint_residual(problem, angles, &run.residual), None)?;
        self.make_passes(run, problem, stop, &mut watch)
    }
}

impl LinAbf {
    /// The refusal of a bound on the error together with conditions on the boundary.
    pub const BOUND_AND_BOUNDARY: SolveError =
        SolveError::Unsupported("an error bound does not go with conditions on the boundary");

    /// A number of passes is that many factorisations of `S`, each in the metric of its own guess. Passes
    /// until the residual is met start close to each other: they keep the metric of the first, and each
    /// computes no more digits than the next can use.
    fn inner(
        &self,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        watch: &mut Watch<'_>,
    ) -> Result<Inner, SolveError> {
        let (topology, rows) = (problem.topology(), problem.rows());
        Ok(match self.passes {
            Passes::Auto if stop.max_iterations > 1 => {
                let lambda = metric(problem.initial_guess());
                Inner::Inexact(Box::new(LeastCorrection::new(topology, rows, lambda, &mut || watch.checkpoint())?))
            }
            _ => Inner::Direct(Box::new(DirectStep::asking(topology, rows, &mut || watch.checkpoint())?)),
        })
    }

    /// Whether the passes so far are enough: how many there were, their smallest residual, and how many of the last did
    /// not improve it.
    fn verdict(&self, (done, best, in_vain): (usize, f64, usize), stop: &StopCriteria) -> Option<Termination> {
        let limit = match self.passes {
            Passes::Auto => stop.max_iterations,
            Passes::Exactly(n) => n.get(),
        };
        if best <= stop.tolerance {
            Some(Termination::Converged)
        } else if done >= limit {
            // One pass is a method of its own; a limit that happens to be 1 is a limit.
            Some(if self.passes == ONE_PASS { Termination::OnePass } else { Termination::MaxIterations })
        } else if self.passes == Passes::Auto && in_vain >= PATIENCE {
            Some(Termination::Stalled)
        } else {
            None
        }
    }
}

/// Fewer corners are not worth a thread.
const PER_TASK: usize = 1 << 13;

/// `Λ = 2/α²` (LinABF eq. (12)).
fn metric(guess: &[f64]) -> Vec<f64> {
    guess.par_iter().with_min_len(PER_TASK).map(|x| 2.0 / (x * x)).collect()
}

/// What solves for the correction of a pass.
enum Inner {
    Direct(Box<DirectStep>),
    Inexact(Box<LeastCorrection>),
}

/// The workspace of one solve.
struct LinAbfRun<'p, 'a> {
    problem: &'p AngleProblem<'a>,
    stop: &'p StopCriteria,
    inner: Inner,
    so_far: SoFar,
    /// `Λ (x − α)` at angles x that no pass has led to; empty for zero.
    gradient: Vec<f64>,
    /// How far the constraints are off at the initial guess.
    residual_of_guess: f64,
    /// The constraints at the angles so far and their derivative.
    residual: Vec<f64>,
    wheel: WheelDerivative,
    /// How far the constraints were off where the last pass started.
    residual_before: f64,
    /// The correction of the last pass, until its memory is room for sines.
    out: KktVector,
}

impl<'p, 'a> LinAbfRun<'p, 'a> {
    fn new((problem, stop): (&'p AngleProblem<'a>, &'p StopCriteria), inner: Inner) -> Self {
        let mut run = Self {
            problem,
            stop,
            inner,
            so_far: SoFar::new(problem),
            gradient: Vec::new(),
            residual_of_guess: f64::NAN,
            residual: Vec::new(),
            wheel: WheelDerivative::default(),
            residual_before: f64::NAN,
            out: KktVector::default(),
        };
        run.linearise();
        run.residual_of_guess = largest(&run.residual);
        run
    }

    /// The constraints at the angles so far and their derivative.
    fn linearise(&mut self) {
        let linearised = (&mut self.residual, &mut self.wheel);
        linearise_into(self.problem.rows(), &self.so_far.angles, linearised, &mut self.out.delta);
    }

    /// Linearises at the angles that are expected, where there are some that meet the constraints better than the initial
    /// guess α. The first pass still leads to the angles nearest to α: from x it minimises `Σ ((x + e − α)/α)²`.
    fn at_expected(mut self) -> Self {
        let Some(expected) = self.problem.expected() else { return self };
        let Inner::Inexact(_) = self.inner else { return self };
        let (residual, wheel) = linearise(self.problem.rows(), expected);
        let squares = |residual: &[f64]| residual.iter().map(|h| h * h).sum::<f64>();
        if squares(&residual) < squares(&self.residual) {
            let guess = self.problem.initial_guess();
            self.gradient = metric(guess).iter().zip(expected).zip(guess).map(|((l, x), a)| l * (x - a)).collect();
            self.so_far.angles = expected.to_vec();
            (self.residual, self.wheel) = (residual, wheel);
        }
        self
    }

    /// The least-norm correction `e` of the angles: `J e = −h`.
    fn correction(&mut self, target: f64, watch: &mut Watch<'_>) -> Result<StepReport, StepError> {
        let out = &mut self.out;
        let (topology, rows) = (self.problem.topology(), self.problem.rows());
        match &mut self.inner {
            Inner::Inexact(inner) => {
                let (wheel, residual, gradient) = (&self.wheel, &self.residual, &self.gradient);
                let here = Linearisation { topology, rows, wheel, residual, gradient };
                inner.solve(&here, target, watch, out)
            }
            Inner::Direct(inner) => {
                let lambda = metric(&self.so_far.angles);
                let kkt = KktSystem {
                    topology,
                    rows,
                    lambda: &lambda,
                    gauss_newton: &lambda,
                    off_diagonal: None,
                    wheel: &self.wheel,
                    gradient: &vec![0.0; lambda.len()],
                    residual: &self.residual,
                };
                inner.step(&kkt, TIGHTEST, watch, out)
            }
        }
    }

    /// How well the linearised constraints must be met, `max |h + J e|`, when they are off by `now`.
    ///
    /// What a linearisation leaves out falls with the square of what it starts from, so the last pass tells
    /// how far this one can get. It need not get further: the next one starts from there. Where that is about
    /// the tolerance, this one is to be the last.
    fn target(&self, now: f64) -> f64 {
        let (stop, history) = (self.stop, &self.so_far.history);
        let last = SAFETY * stop.tolerance;
        let is_last = history.len() + 1 >= stop.max_iterations;
        let Some(record) = history.last().filter(|_| !is_last) else {
            // From angles that are expected, too, the way is as far as from the guess.
            let now = now.max(self.residual_of_guess);
            return if is_last { last } else { last.max(FIRST * now.min(now * now)) };
        };
        let reach = record.constraint_residual * (now / self.residual_before).powi(2);
        if reach <= HOPE * stop.tolerance { last } else { reach.min(0.05 * now).max(last) }
    }
}

impl Pass for LinAbfRun<'_, '_> {
    fn so_far(&mut self) -> &mut SoFar {
        &mut self.so_far
    }

    /// One pass: from the last angles, kept inside the bounds, to the least-norm correction.
    fn pass(&mut self, watch: &mut Watch<'_>) -> Result<bool, StepError> {
        let [clamped, clamped_angles] = self.so_far.clamp(self.problem);
        if clamped > 0 {
            self.linearise();
        }
        let before = largest(&self.residual);
        let target = self.target(before);
        let report = self.correction(target, watch)?;
        self.gradient = Vec::new();

        let (angles, correction) = (&mut self.so_far.angles, &self.out.delta);
        angles.par_iter_mut().with_min_len(PER_TASK).zip(correction).for_each(|(x, e)| *x += e);
        let step = largest(correction);
        self.linearise();
        let angles = &self.so_far.angles;
        self.residual_before = before;
        let record = IterationRecord {
            constraint_residual: constraint_residual(self.problem, angles, &self.residual),
            step,
            step_length: 1.0,
            inner_tolerance: matches!(self.inner, Inner::Inexact(_)).then_some(target),
            inner_iterations: report.iterations,
            inner_residual: report.relative_residual,
            inner_estimate: report.estimate,
            inner_converged: report.inner_converged,
            clamped_angles,
            ..IterationRecord::default()
        };
        self.so_far.add(record, watch)?;
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_constraints::GuessSettings;
    use abf_control::Silent;
    use abf_mesh::Topology;
    use abf_shapes::Shape;

    fn solved(problem: &AngleProblem<'_>) -> AngleSolution {
        LinAbf::default().solve(problem, &StopCriteria::default(), &mut Silent).expect("angles")
    }

    #[test]
    fn passes_from_expected_angles_end_no_farther_from_the_guess_and_worse_ones_are_not_used() {
        let mesh = Shape::Hemisphere.mesh(2000);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
        let plain = solved(&problem);
        // What is expected is about right.
        let mut expected = plain.angles().to_vec();
        expected.iter_mut().enumerate().for_each(|(c, x)| *x *= 1.0 + 1e-4 * (c as f64).sin());
        let informed = solved(&problem.clone().with_expected(expected));
        assert_eq!(informed.termination(), Termination::Converged);
        assert_ne!(informed.angles(), plain.angles(), "it is another way");
        let guess = problem.initial_guess();
        let away = |solution: &AngleSolution| {
            solution.angles().iter().zip(guess).map(|(x, a)| ((x - a) / a).powi(2)).sum::<f64>()
        };
        assert!(away(&informed) < 1.001 * away(&plain), "{} after {}", away(&informed), away(&plain));
        let worse = vec![1.0; guess.len()];
        assert_eq!(solved(&problem.clone().with_expected(worse)).angles(), plain.angles(), "the guess is better");
    }
}
