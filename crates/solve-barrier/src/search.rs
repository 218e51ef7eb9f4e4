//! The filter line search (Wächter, Biegler 2006, §2.3 and §2.4).

use crate::direction::Direction;
use crate::filter::Filter;
use crate::iterate::Iterate;
use crate::path::{advance, longest, nearer_end};
use crate::system::StepSystem;
use abf_constraints::AngleProblem;
use abf_solve_core::KktVector;

// The constants of Wächter, Biegler 2006, §4, by their names there.
const GAMMA_THETA: f64 = 1e-5;
const GAMMA_PHI: f64 = 1e-8;
const ETA_PHI: f64 = 1e-4;
const S_THETA: f64 = 1.1;
const S_PHI: f64 = 2.3;

/// No share of a step below this part of the longest is tried: the constraints are to be restored first.
const SHORTEST: f64 = 1e-4;

/// At most so many second-order corrections of a step …
const CORRECTIONS: usize = 4;

/// … each of which has to bring the violation below this part of the last one's.
const CORRECTED: f64 = 0.9;

/// Objectives are told apart down to this many roundings.
const ROUNDINGS: f64 = 10.0;

/// A step that changes no distance to 0 and π by more than this part of it is taken as it is: objectives no longer tell it
/// from another.
const NEGLIGIBLE: f64 = 1e-8;

/// What a line search looks at.
pub(crate) struct Search<'s, 'p, 'a> {
    pub(crate) problem: &'p AngleProblem<'a>,
    pub(crate) system: &'s mut StepSystem,
    pub(crate) iterate: &'s Iterate,
    pub(crate) direction: &'s Direction,
    pub(crate) filter: &'s Filter,
    pub(crate) barrier: f64,
    /// No angle loses more than this share of its distance to 0 or π.
    pub(crate) fraction: f64,
    /// Below this violation a descent of the objective must not be given up for less of it.
    pub(crate) small_violation: f64,
}

/// Where a step led.
#[derive(Debug)]
pub(crate) struct Found {
    pub(crate) iterate: Iterate,
    pub(crate) share: f64,
    /// What the filter refuses from now on, if the step was not a mere descent of the objective.
    pub(crate) entry: Option<(f64, f64)>,
    /// How many second-order corrections were solved for.
    pub(crate) corrections: usize,
}

/// What must not be come back to after leaving an iterate: its violation and objective, each less a margin.
pub(crate) fn entry(iterate: &Iterate, barrier: f64) -> (f64, f64) {
    ((1.0 - GAMMA_THETA) * iterate.violation, iterate.objective(barrier) - GAMMA_PHI * iterate.violation)
}

impl Search<'_, '_, '_> {
    /// Halves the share of the step until a trial is acceptable; the first one is corrected before it is given up.
    pub(crate) fn run(mut self) -> Option<Found> {
        let (angles, delta) = (&self.iterate.angles, &self.direction.step.delta);
        let first = longest(angles, delta, self.fraction);
        let negligible = angles.iter().zip(delta).all(|(&x, d)| d.abs() <= NEGLIGIBLE * nearer_end(x));
        let mut corrections = 0;
        let mut share = first;
        while share > SHORTEST * first {
            let trial = Iterate::new(self.problem, advance(angles, delta, share));
            if negligible && trial.is_finite() {
                return Some(Found { iterate: trial, share, entry: None, corrections });
            }
            if let Some(entry) = self.judge(&trial, share) {
                return Some(Found { iterate: trial, share, entry, corrections });
            }
            if share == first && trial.is_finite() {
                let corrected = self.correct(trial, share, &mut corrections);
                if let Some((iterate, entry)) = corrected {
                    return Some(Found { iterate, share, entry, corrections });
                }
            }
            share *= 0.5;
        }
        None
    }

    /// `None` for a trial to refuse; else what the filter has to learn from leaving.
    fn judge(&self, trial: &Iterate, share: f64) -> Option<Option<(f64, f64)>> {
        let (violation, objective) = (self.iterate.violation, self.iterate.objective(self.barrier));
        let rounding = ROUNDINGS * f64::EPSILON * objective.abs();
        let reached = (trial.violation, trial.objective(self.barrier) - rounding);
        if !trial.is_finite() || !self.filter.accepts(reached) {
            return None;
        }
        let slope = self.direction.slope;
        let promises = slope < 0.0 && share * (-slope).powf(S_PHI) > violation.powf(S_THETA);
        let descends = reached.1 <= objective + ETA_PHI * share * slope;
        let is_descent = promises && descends;
        if promises && violation <= self.small_violation {
            return is_descent.then_some(None);
        }
        let (most_violation, most_objective) = entry(self.iterate, self.barrier);
        let improves = reached.0 <= most_violation || reached.1 <= most_objective;
        improves.then(|| (!is_descent).then_some((most_violation, most_objective)))
    }

    /// Second-order corrections: `J e` is to take back what the trial left of the constraints.
    fn correct(&mut self, trial: Iterate, share: f64, solves: &mut usize) -> Option<(Iterate, Option<(f64, f64)>)> {
        let mut scale = share;
        let mut residual = self.iterate.residual.clone();
        let mut last = trial;
        while *solves < CORRECTIONS {
            residual.iter_mut().zip(&last.residual).for_each(|(r, h)| *r = scale * *r + h);
            let mut step = KktVector::default();
            let Direction { lambda, gradient, .. } = self.direction;
            self.system.solve_again(self.problem, self.iterate, lambda, gradient, &residual, &mut step).ok()?;
            *solves += 1;
            scale = longest(&self.iterate.angles, &step.delta, self.fraction);
            let trial = Iterate::new(self.problem, advance(&self.iterate.angles, &step.delta, scale));
            if let Some(entry) = self.judge(&trial, share) {
                return Some((trial, entry));
            }
            if !(trial.violation <= CORRECTED * last.violation) {
                return None;
            }
            last = trial;
        }
        None
    }
}
