//! LinABF with conditions on the boundary.
//!
//! A pass minimises `Σ (e/α)²` subject to `J e = −h` and to the conditions on the sums at the boundary after it. Upper
//! bounds are met by a primal–dual active set: a row whose multiplier is not positive becomes free, and one that the solve
//! would violate becomes active, until neither happens. Every change of the set is one solve.
//!
//! Conditions ask for large changes. A pass takes no angle further than a part of its way to 0 or π, so most of the passes are
//! steps of less than the whole length; the last ones are whole.
//!
//! Passes re-centre, so what comes out meets the conditions and is not the optimum of ABF under them; multipliers of the
//! last pass are near zero and say nothing of which rows bind. The interior point method finds the optimum.

use crate::passes::{Pass, SoFar};
use crate::{LinAbf, metric};
use abf_constraints::{AngleProblem, BoundaryConditions, WheelDerivative, largest, linearise};
use abf_control::{IterationRecord, Observer, StopCriteria, Watch};
use abf_solve_core::{
    AngleSolution, BoundaryTerms, BoundedStep, KktSystem, KktVector, SolveError, StepError, StepReport,
    constraint_residual,
};
use std::f64::consts::PI;

/// At most so many solves in a pass: a set that changes still is one that comes back to where it was. The next pass starts
/// from the angles of the last solve.
const SOLVES: usize = 30;

/// An upper bound may be exceeded by this part of the tolerance before its row becomes active.
const SLACK: f64 = 0.1;

/// No pass takes an angle further than this part of its way to 0 or π: what is beyond would be cut off, and the constraints
/// with it.
const NEAREST: f64 = 0.9;

/// Solves a problem that has conditions on its boundary.
pub(crate) fn solve(
    linabf: &LinAbf,
    problem: &AngleProblem<'_>,
    conditions: &BoundaryConditions,
    stop: &StopCriteria,
    observer: &mut dyn Observer,
) -> Result<AngleSolution, SolveError> {
    let mut watch = Watch::start(stop, observer);
    let run = BoundedRun::new(problem, conditions, stop, &mut watch)?;
    run.so_far.start(problem, &mut watch)?;
    linabf.make_passes(run, problem, stop, &mut watch)
}

/// The workspace of one solve.
struct BoundedRun<'p, 'a> {
    problem: &'p AngleProblem<'a>,
    conditions: &'p BoundaryConditions,
    step: BoundedStep,
    active: Vec<bool>,
    slack: f64,
    so_far: SoFar,
}

impl<'p, 'a> BoundedRun<'p, 'a> {
    fn new(
        problem: &'p AngleProblem<'a>,
        conditions: &'p BoundaryConditions,
        stop: &StopCriteria,
        watch: &mut Watch<'_>,
    ) -> Result<Self, SolveError> {
        let step = BoundedStep::new(problem.topology(), problem.rows(), conditions, &mut || watch.checkpoint())?;
        let is_active = |j| conditions.are_equations() && conditions.dropped() != Some(j);
        Ok(Self {
            problem,
            conditions,
            step,
            active: (0..conditions.len()).map(is_active).collect(),
            slack: SLACK * stop.tolerance,
            so_far: SoFar::new(problem),
        })
    }

    /// The least-norm correction under the conditions, and how many solves it took. It is not converged where the set of
    /// active rows was still changing.
    fn correction(&mut self, watch: &mut Watch<'_>) -> Result<(StepReport, Vec<f64>, usize), StepError> {
        let (residual, wheel) = linearise(self.problem.rows(), &self.so_far.angles);
        let off = self.conditions.residual(self.problem.topology(), &self.so_far.angles);
        let mut out = KktVector::default();
        let mut solves = 0;
        loop {
            let (report, multipliers) = self.solve(&residual, &wheel, &off, watch, &mut out)?;
            solves += 1;
            let is_settled = self.conditions.are_equations() || !self.update(&off, &multipliers, &out.delta);
            if is_settled || solves == SOLVES {
                let inner_converged = report.inner_converged && is_settled;
                return Ok((StepReport { inner_converged, ..report }, std::mem::take(&mut out.delta), solves));
            }
        }
    }

    fn solve(
        &mut self,
        residual: &[f64],
        wheel: &WheelDerivative,
        off: &[f64],
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<(StepReport, Vec<f64>), StepError> {
        let lambda = metric(&self.so_far.angles);
        let kkt = KktSystem {
            topology: self.problem.topology(),
            rows: self.problem.rows(),
            lambda: &lambda,
            gauss_newton: &lambda,
            off_diagonal: None,
            wheel,
            gradient: &vec![0.0; lambda.len()],
            residual,
        };
        let terms = BoundaryTerms { conditions: self.conditions, active: &self.active, residual: off, compliance: &[] };
        self.step.step(&kkt, &terms, watch, out)
    }

    /// Changes the set of active rows; whether there was anything to change.
    fn update(&mut self, off: &[f64], multipliers: &[f64], delta: &[f64]) -> bool {
        let topology = self.problem.topology();
        let mut has_changed = false;
        for (j, &v) in self.conditions.vertices().iter().enumerate() {
            let active = match self.active[j] {
                true => multipliers[j] > 0.0,
                false => off[j] + topology.fan(v).map(|c| delta[c.index()]).sum::<f64>() > self.slack,
            };
            has_changed |= active != self.active[j];
            self.active[j] = active;
        }
        has_changed
    }
}

/// The part of a step, at most all of it, that takes no angle further than [`NEAREST`] of its way to 0 or π.
fn share_inside(angles: &[f64], step: &[f64]) -> f64 {
    let share = |(x, e): (&f64, &f64)| NEAREST * (if *e < 0.0 { *x } else { PI - x }) / e.abs();
    angles.iter().zip(step).map(share).fold(1.0, f64::min)
}

impl Pass for BoundedRun<'_, '_> {
    fn so_far(&mut self) -> &mut SoFar {
        &mut self.so_far
    }

    /// One pass: from the last angles, kept inside the bounds, to the least-norm correction.
    fn pass(&mut self, watch: &mut Watch<'_>) -> Result<bool, StepError> {
        let [_, clamped_angles] = self.so_far.clamp(self.problem);
        let (report, correction, solves) = self.correction(watch)?;
        let angles = &mut self.so_far.angles;
        let share = share_inside(angles, &correction);
        angles.iter_mut().zip(&correction).for_each(|(x, e)| *x += share * e);
        let (residual, _) = linearise(self.problem.rows(), angles);
        let off = self.conditions.violation(self.problem.topology(), angles);
        let record = IterationRecord {
            constraint_residual: constraint_residual(self.problem, angles, &residual).max(off),
            step: share * largest(&correction),
            step_length: share,
            inner_iterations: solves,
            inner_residual: report.relative_residual,
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

    #[test]
    fn the_share_of_a_step_leaves_every_angle_a_tenth_of_its_way_to_the_ends() {
        let (angles, step) = ([1.0, 0.2, 3.0], [-0.5, -0.4, 0.7]);
        let share = share_inside(&angles, &step);
        let after: Vec<f64> = angles.iter().zip(step).map(|(x, e)| x + share * e).collect();
        assert!((PI - after[2] - 0.1 * (PI - 3.0)).abs() < 1e-12 && after[1] > 0.02, "{after:?}");
        assert_eq!(share_inside(&angles, &[0.1, -0.1, 0.0]), 1.0);
        assert_eq!(share_inside(&[], &[]), 1.0);
    }
}
