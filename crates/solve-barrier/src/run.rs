//! The outer loop.

use crate::Barrier;
use crate::direction::Direction;
use crate::dual::BoundMultipliers;
use crate::filter::Filter;
use crate::iterate::Iterate;
use crate::path::nearer_end;
use crate::restore::restored;
use crate::search::{Search, entry};
use crate::slack;
use crate::system::StepSystem;
use abf_constraints::{AngleProblem, largest};
use abf_control::{Cancelled, Checkpoint, Fallback, IterationRecord, StopCriteria, Termination, Watch};
use abf_solve_core::{LinearError, SolveError, constraint_residual};
use std::f64::consts::PI;

/// How far from 0 and π a start keeps, rad: nothing is known yet that would justify less.
const START_DISTANCE: f64 = 1e-2;

/// `μ` is lowered once the optimality error is below this multiple of it (Wächter, Biegler 2006, eq. (7)).
const CENTRED: f64 = 10.0;

/// … and not only by the factor of the settings but to this power of itself (ibid.): faster, the smaller it is.
const SUPERLINEAR: f64 = 1.5;

/// The filter refuses violations above this multiple of the first one …
const TOO_LARGE: f64 = 1e4;

/// … and descent is insisted on below this multiple.
const SMALL: f64 = 1e-4;

/// A restoration is done when it has brought the violation below this part of what it was.
const RESTORED: f64 = 0.9;

/// At most so many steps of restoration in a row.
const RESTORATIONS: usize = 20;

/// A run that is stuck starts again from the middle with this multiple of its first `μ` …
const RECENTRING: f64 = 100.0;

/// … at most so often.
const RECENTRINGS: usize = 2;

/// The workspace of one solve.
pub(crate) struct BarrierRun<'p, 'a> {
    settings: Barrier,
    problem: &'p AngleProblem<'a>,
    system: StepSystem,
    iterate: Iterate,
    multipliers: Vec<f64>,
    bounds: BoundMultipliers,
    barrier: f64,
    /// The last μ: that of the settings, or where angles would vanish below it.
    floor: f64,
    filter: Filter,
    first_violation: f64,
    /// The angles with the smallest residual.
    best: Vec<f64>,
    best_residual: f64,
    history: Vec<IterationRecord>,
    recentred: usize,
    /// Angles clamped away from 0 and π since the last record.
    clamped: usize,
}

/// How far an iterate is from the solution for one `μ`.
struct Errors {
    /// `max |x dL/dx|`, the change of the Lagrangian per relative change of a distance.
    dual: f64,
    /// Of the multipliers of the bounds.
    complementarity: f64,
    /// `max |h|`.
    primal: f64,
}

impl<'p, 'a> BarrierRun<'p, 'a> {
    pub(crate) fn new(
        settings: Barrier,
        problem: &'p AngleProblem<'a>,
        mut angles: Vec<f64>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let clamped = problem.clamped_angles() + pushed_inside(&mut angles);
        slack::append(problem, &mut angles);
        pushed_inside(&mut angles);
        let system = StepSystem::new(problem, checkpoint)?;
        let iterate = Iterate::new(problem, angles);
        let barrier = settings.barrier_start;
        Ok(Self {
            settings,
            problem,
            system,
            multipliers: vec![0.0; slack::row_count(problem)],
            bounds: BoundMultipliers::centred(&iterate.angles, barrier),
            barrier,
            floor: settings.barrier_floor,
            filter: Filter::new(TOO_LARGE * iterate.violation.max(1.0)),
            first_violation: iterate.violation,
            best: iterate.angles.clone(),
            best_residual: f64::INFINITY,
            iterate,
            history: Vec::new(),
            recentred: 0,
            clamped,
        })
    }

    /// Iterates until the criteria are met. The angles are those reached if that is what was asked for, else those
    /// with the smallest residual.
    pub(crate) fn solve(
        mut self,
        stop: &StopCriteria,
        watch: &mut Watch<'_>,
    ) -> Result<(Vec<f64>, Termination, Vec<IterationRecord>), SolveError> {
        let residual = constraint_residual(self.problem, &self.iterate.angles, &self.iterate.residual);
        watch.start_from(slack::corner_count(self.problem), residual, Some(self.iterate.energy))?;
        let termination = loop {
            // A factorisation cannot be interrupted, so ask before it.
            if watch.interruption().is_some() || !watch.inner(0, f64::NAN)? {
                break watch.interruption().unwrap_or(Termination::Cancelled);
            }
            let made = self.iterate(stop, watch);
            watch.aborted()?;
            let end = match made {
                Err(error) if self.history.is_empty() => return Err(error.into()),
                Ok(true) => self.verdict(stop, watch),
                Ok(false) | Err(_) => watch.interruption().or_else(|| self.recentre()),
            };
            if let Some(end) = end {
                break end;
            }
        };
        let mut angles = if termination.is_as_asked() { self.iterate.angles } else { self.best };
        angles.truncate(slack::corner_count(self.problem));
        Ok((angles, termination, self.history))
    }

    /// One step, or steps of restoration where that fails; `false` when neither leads anywhere.
    fn iterate(&mut self, stop: &StopCriteria, watch: &mut Watch<'_>) -> Result<bool, LinearError> {
        if !self.history.is_empty() {
            self.lower_barrier();
        }
        let at = (&self.iterate, self.multipliers.as_slice(), &self.bounds, self.barrier);
        let direction =
            Direction::new(self.problem, &mut self.system, self.settings.hessian, at, &mut || watch.checkpoint())?;
        let search = Search {
            problem: self.problem,
            system: &mut self.system,
            iterate: &self.iterate,
            direction: &direction,
            filter: &self.filter,
            barrier: self.barrier,
            fraction: self.settings.fraction,
            small_violation: SMALL * self.first_violation.max(1.0),
        };
        let Some(found) = search.run() else {
            self.filter.add(entry(&self.iterate, self.barrier));
            return self.restore(stop, watch);
        };
        if let Some(entry) = found.entry {
            self.filter.add(entry);
        }
        let record = IterationRecord {
            step: largest(&direction.step.delta),
            inner_iterations: direction.linear.iterations + found.corrections,
            inner_residual: direction.linear.relative_residual,
            inner_converged: true,
            step_length: found.share,
            negative_curvature: direction.negative,
            ..IterationRecord::default()
        };
        let (from, delta) = (&self.iterate.angles, &direction.step.delta);
        self.bounds.advance(from, delta, &found.iterate.angles, self.barrier, self.settings.fraction);
        let changes = self.multipliers.iter_mut().zip(&direction.step.multipliers);
        changes.for_each(|(m, d)| *m += found.share * d);
        self.iterate = found.iterate;
        self.record(record, watch)?;
        Ok(true)
    }

    /// Whether the steps so far are enough.
    fn verdict(&mut self, stop: &StopCriteria, watch: &Watch<'_>) -> Option<Termination> {
        let last = self.history.last()?;
        let made = self.history.len();
        let is_last = last.step <= stop.step_tolerance && last.step_length == 1.0 && last.fallback.is_none();
        if self.barrier <= self.floor && is_last {
            let errors = self.errors();
            let is_optimal = errors.dual.max(errors.complementarity) <= self.settings.optimality_tolerance;
            if is_optimal && errors.primal <= stop.tolerance {
                // Angles below the clamp of the residual that is reported: more steps would not mend that.
                let is_met = last.constraint_residual <= stop.tolerance;
                return Some(if is_met { Termination::Converged } else { Termination::Stalled });
            }
        }
        if let Some(interruption) = watch.interruption() {
            return Some(interruption);
        }
        (made >= stop.max_iterations).then_some(Termination::MaxIterations)
    }

    fn errors(&self) -> Errors {
        let x = &self.iterate.angles;
        let (target, weight) = (self.problem.target(), self.problem.weight());
        let of = |c: usize| 2.0 * weight[c] * (x[c] - target[c]) + self.bounds.gradient(c);
        let mut gradient: Vec<f64> = (0..target.len()).map(of).collect();
        gradient.extend((target.len()..x.len()).map(|s| self.bounds.gradient(s)));
        slack::add_transposed(self.problem, &self.iterate.wheel, &self.multipliers, &mut gradient);
        let dual = gradient.iter().zip(x).fold(0.0, |most: f64, (g, &x)| most.max((g * nearer_end(x)).abs()));
        let complementarity = self.bounds.complementarity(x, self.barrier);
        Errors { dual, complementarity, primal: largest(&self.iterate.residual) }
    }

    /// Lowers `μ` as long as the iterate is near the solution for it (Fiacco–McCormick).
    fn lower_barrier(&mut self) {
        while self.barrier > self.floor {
            let errors = self.errors();
            if errors.dual.max(errors.complementarity).max(errors.primal) > CENTRED * self.barrier {
                return;
            }
            self.floor = self.floor.max((self.barrier / self.room()).min(self.barrier));
            let lower = (self.settings.barrier_reduction * self.barrier).min(self.barrier.powf(SUPERLINEAR));
            self.barrier = lower.max(self.floor);
            // Objectives for another μ cannot be compared with the old ones.
            self.filter = Filter::new(TOO_LARGE * self.first_violation.max(1.0));
        }
    }

    /// By how much the angle that is the closest to vanishing may still shrink: at a degenerate optimum angles are about
    /// proportional to μ, or fall faster.
    fn room(&self) -> f64 {
        /// An angle has vanished only if it is below this part of its target, too.
        const SHRUNK: f64 = 0.1;
        let least = |a: f64| self.settings.smallest_angle.min(SHRUNK * a);
        let pairs = self.iterate.angles.iter().zip(self.problem.target());
        pairs.fold(f64::INFINITY, |room, (x, &a)| room.min(x / least(a)))
    }

    /// Steps towards the constraints until the filter accepts the iterate; `false` if that fails.
    fn restore(&mut self, stop: &StopCriteria, watch: &mut Watch<'_>) -> Result<bool, LinearError> {
        let start = self.iterate.violation;
        for _ in 0..RESTORATIONS {
            let (system, fraction) = (&mut self.system, self.settings.fraction);
            let restored = restored(self.problem, system, &self.iterate, fraction, &mut || watch.checkpoint())?;
            let Some((iterate, record)) = restored else {
                return Ok(false);
            };
            self.iterate = iterate;
            self.record(IterationRecord { fallback: Some(Fallback::LineSearch), ..record }, watch)?;
            let reached = (self.iterate.violation, self.iterate.objective(self.barrier));
            if reached.0 <= RESTORED * start && self.filter.accepts(reached) {
                self.forget_multipliers();
                return Ok(true);
            }
            if self.history.len() >= stop.max_iterations {
                return Ok(true);
            }
            if watch.interruption().is_some() || !watch.inner(0, f64::NAN)? {
                return Ok(false);
            }
        }
        Ok(false)
    }

    /// Starts again from the middle with a larger `μ`, unless that was done before; `Some` if it was.
    fn recentre(&mut self) -> Option<Termination> {
        if self.recentred == RECENTRINGS || self.history.is_empty() {
            return Some(Termination::Stalled);
        }
        self.recentred += 1;
        let mut angles = self.iterate.angles.clone();
        // Behind the angles there are the slacks of conditions on the boundary, which are none.
        let (own, slacks) = angles.split_at_mut(self.problem.initial_guess().len());
        self.clamped += pushed_inside(own);
        pushed_inside(slacks);
        self.iterate = Iterate::new(self.problem, angles);
        self.barrier = self.settings.barrier_start * RECENTRING.powi(self.recentred as i32);
        self.floor = self.settings.barrier_floor;
        self.filter = Filter::new(TOO_LARGE * self.iterate.violation.max(1.0));
        self.first_violation = self.iterate.violation;
        self.forget_multipliers();
        None
    }

    /// The next step finds them anew.
    fn forget_multipliers(&mut self) {
        self.multipliers.fill(0.0);
        self.bounds = BoundMultipliers::centred(&self.iterate.angles, self.barrier);
    }

    fn record(&mut self, mut record: IterationRecord, watch: &mut Watch<'_>) -> Result<(), Cancelled> {
        record.iteration = self.history.len() + 1;
        record.constraint_residual = constraint_residual(self.problem, &self.iterate.angles, &self.iterate.residual);
        record.energy = Some(self.iterate.energy);
        record.clamped_angles = std::mem::take(&mut self.clamped);
        if record.constraint_residual <= self.best_residual {
            self.best_residual = record.constraint_residual;
            self.best.clone_from(&self.iterate.angles);
        }
        self.history.push(record);
        watch.iteration(&record)
    }
}

/// Clamps every angle to at least [`START_DISTANCE`] from 0 and π; how many were clamped.
fn pushed_inside(angles: &mut [f64]) -> usize {
    let mut clamped = 0;
    for x in angles {
        let inside = x.clamp(START_DISTANCE, PI - START_DISTANCE);
        clamped += usize::from(inside != *x);
        *x = inside;
    }
    clamped
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_constraints::GuessSettings;
    use abf_control::Silent;
    use abf_mesh::Topology;
    use abf_shapes::Shape;

    /// Runs a problem whose angles want to leave, and shows every iterate to `look`.
    fn step_by_step(steps: usize, mut look: impl FnMut(&mut BarrierRun<'_, '_>)) {
        let mesh = Shape::Spike.mesh(600);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
        let stop = StopCriteria::default();
        let mut silent = Silent;
        let mut watch = Watch::start(&stop, &mut silent);
        let settings = Barrier { barrier_floor: 1e-8, smallest_angle: 0.0, ..Barrier::default() };
        let mut run =
            BarrierRun::new(settings, &problem, vec![1e-12; 3 * mesh.face_count()], &mut || Ok(())).expect("fits");
        for _ in 0..steps {
            assert_eq!(run.iterate(&stop, &mut watch), Ok(true));
            look(&mut run);
        }
    }

    #[test]
    fn every_place_is_strictly_inside() {
        step_by_step(25, |run| {
            assert!(run.iterate.angles.iter().all(|&x| x > 0.0 && x < PI));
        });
    }

    #[test]
    fn restoration_reduces_the_violation() {
        step_by_step(1, |run| {
            let before = run.iterate.violation;
            let stop = StopCriteria::default();
            let mut silent = Silent;
            let mut watch = Watch::start(&stop, &mut silent);
            assert_eq!(run.restore(&stop, &mut watch), Ok(true));
            assert!(run.iterate.violation <= RESTORED * before);
            assert!(run.multipliers.iter().all(|&m| m == 0.0));
            assert!(run.history.last().is_some_and(|last| last.fallback == Some(Fallback::LineSearch)));
        });
    }

    #[test]
    fn a_run_is_recentred_so_often_and_no_more() {
        step_by_step(3, |run| {
            run.iterate = Iterate::new(run.problem, vec![1e-9; run.iterate.angles.len()]);
            let barrier = run.settings.barrier_start;
            if run.recentred < RECENTRINGS {
                assert_eq!(run.recentre(), None);
                assert!(run.barrier > barrier && run.iterate.angles.iter().all(|&x| x >= START_DISTANCE));
            } else {
                assert_eq!(run.recentre(), Some(Termination::Stalled));
            }
        });
    }
}
