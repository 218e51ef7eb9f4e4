//! LinABF with bounds on the error (LinABF §4).
//!
//! A pass minimises `Σ (e/α)²` subject to `J e = −h` and to
//!
//! ```text
//! −B α ≤ e ≤ B (π − α),        B = LinAbf::error_bound,
//! ```
//!
//! so that no angle leaves (0, π), by a primal–dual active set: a corner beyond its bound is fixed there, with `Λ⁻¹ = 0`, and
//! one that would rather come back is freed. The paper names such bounds for very small and very large angles and then takes
//! weights. The bounds and the linearised constraints can contradict each other, and then the set goes around in circles: the
//! solve ends as [`Termination::Stalled`], with the angles of the last pass that settled.

use crate::passes::{Pass, SoFar};
use crate::{LinAbf, metric};
use abf_constraints::{AngleProblem, TriangleRows, WheelDerivative, largest, linearise};
use abf_control::{IterationRecord, Observer, StopCriteria, Watch};
use abf_mesh::FaceId;
use abf_solve_core::{
    AngleSolution, DirectStep, KktStep, KktSystem, KktVector, SolveError, StepError, StepReport,
    add_transposed_product, constraint_residual,
};
use std::f64::consts::PI;

/// A set that has not settled after so many solves goes around in circles.
const SOLVES: usize = 60;

/// An error may exceed its bound by this part of it before its corner is fixed.
const ROUNDING: f64 = 1e-9;

/// Solves with `error_bound`.
pub(crate) fn solve(
    linabf: &LinAbf,
    error_bound: f64,
    problem: &AngleProblem<'_>,
    stop: &StopCriteria,
    observer: &mut dyn Observer,
) -> Result<AngleSolution, SolveError> {
    let mut watch = Watch::start(stop, observer);
    let step = DirectStep::asking(problem.topology(), problem.rows(), &mut || watch.checkpoint())?;
    let run = BoxedRun::new(problem, error_bound, step);
    run.so_far.start(problem, &mut watch)?;
    linabf.make_passes(run, problem, stop, &mut watch)
}

/// Where a corner is held.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    Free,
    Low,
    High,
}

/// The workspace of one solve.
struct BoxedRun<'p, 'a> {
    problem: &'p AngleProblem<'a>,
    error_bound: f64,
    step: DirectStep,
    held: Vec<Held>,
    so_far: SoFar,
}

/// The linearisation of a pass.
struct Here {
    lambda: Vec<f64>,
    residual: Vec<f64>,
    wheel: WheelDerivative,
    /// The least and the greatest error of each corner, rad.
    limits: Vec<[f64; 2]>,
}

impl Here {
    fn allows_at(&self, c: usize, error: f64) -> bool {
        let [least, most] = self.limits[c].map(|limit| (1.0 + ROUNDING) * limit);
        (least..=most).contains(&error)
    }

    fn allows(&self, errors: &[f64]) -> bool {
        errors.iter().enumerate().all(|(c, &error)| self.allows_at(c, error))
    }
}

impl<'p, 'a> BoxedRun<'p, 'a> {
    fn new(problem: &'p AngleProblem<'a>, error_bound: f64, step: DirectStep) -> Self {
        let so_far = SoFar::new(problem);
        Self { problem, error_bound, step, held: vec![Held::Free; so_far.angles.len()], so_far }
    }

    /// The errors with the corners held as they are, and `Λ e + Jᵀ μ`: what holds them.
    fn errors(&mut self, here: &Here, watch: &mut Watch<'_>) -> Result<(StepReport, Vec<f64>, Vec<f64>), StepError> {
        let (topology, rows) = (self.problem.topology(), self.problem.rows());
        let fixed: Vec<f64> =
            self.held.iter().zip(&here.limits).map(|(&held, &limits)| error_of(held, limits)).collect();
        // An infinite entry has no inverse to move by.
        let entry = |(&held, &l): (&Held, &f64)| if held == Held::Free { l } else { f64::INFINITY };
        let lambda: Vec<f64> = self.held.iter().zip(&here.lambda).map(entry).collect();
        let mut residual = here.residual.clone();
        for face in topology.faces().filter(|face| self.held_in(*face) > 0) {
            let errors = face.corners().map(|c| fixed[c.index()]);
            let local = TriangleRows::new(topology, rows, &here.wheel, face);
            let (vertex, wheel) = local.apply(errors);
            residual[rows.triangle(face)] += errors.iter().sum::<f64>();
            for (k, i) in local.interior.into_iter().enumerate() {
                let Some(i) = i else { continue };
                residual[rows.vertex(i)] += vertex[k];
                residual[rows.wheel(i)] += wheel[k];
            }
        }
        let kkt = KktSystem {
            topology,
            rows,
            lambda: &lambda,
            gauss_newton: &lambda,
            off_diagonal: None,
            wheel: &here.wheel,
            gradient: &vec![0.0; lambda.len()],
            residual: &residual,
        };
        let mut out = KktVector::default();
        let report = self.step.step(&kkt, crate::TIGHTEST, watch, &mut out)?;
        let errors: Vec<f64> = out.delta.iter().zip(&fixed).map(|(d, f)| d + f).collect();
        let mut force: Vec<f64> = errors.iter().zip(&here.lambda).map(|(e, l)| e * l).collect();
        add_transposed_product(topology, rows, &here.wheel, &out.multipliers, &mut force);
        Ok((report, errors, force))
    }

    fn held_in(&self, face: FaceId) -> usize {
        face.corners().into_iter().filter(|c| self.held[c.index()] != Held::Free).count()
    }

    fn is_free(&self) -> bool {
        self.held.iter().all(|&held| held == Held::Free)
    }

    /// Changes the set; whether there was anything to change.
    fn update(&mut self, here: &Here, errors: &[f64], force: &[f64]) -> bool {
        let mut has_changed = false;
        for c in self.problem.topology().corners() {
            let (i, face) = (c.index(), c.face());
            let now = match self.held[i] {
                // One corner of each triangle has to give.
                Held::Free if here.allows_at(i, errors[i]) || self.held_in(face) == 2 => Held::Free,
                Held::Free if errors[i] > 0.0 => Held::High,
                Held::Free => Held::Low,
                Held::High if force[i] > 0.0 => Held::Free,
                Held::Low if force[i] < 0.0 => Held::Free,
                held => held,
            };
            has_changed |= now != self.held[i];
            self.held[i] = now;
        }
        has_changed
    }
}

impl Pass for BoxedRun<'_, '_> {
    fn so_far(&mut self) -> &mut SoFar {
        &mut self.so_far
    }

    /// One pass; `false` when its set does not settle, or leaves no solution.
    fn pass(&mut self, watch: &mut Watch<'_>) -> Result<bool, StepError> {
        let [_, clamped_angles] = self.so_far.clamp(self.problem);
        let angles = &self.so_far.angles;
        let (residual, wheel) = linearise(self.problem.rows(), angles);
        let limits = angles.iter().map(|x| [-self.error_bound * x, self.error_bound * (PI - x)]).collect();
        let here = Here { lambda: metric(angles), residual, wheel, limits };
        self.held.fill(Held::Free);
        let mut solves = 0;
        let (report, errors) = loop {
            let (report, errors, force) = match self.errors(&here, watch) {
                // With nothing held it is the mesh that has no solution.
                Err(StepError::Linear(_)) if !self.is_free() => return Ok(false),
                found => found?,
            };
            solves += 1;
            let has_changed = self.update(&here, &errors, &force);
            if !has_changed && here.allows(&errors) {
                break (report, errors);
            }
            if !has_changed || solves == SOLVES {
                return Ok(false);
            }
        };
        let angles = &mut self.so_far.angles;
        angles.iter_mut().zip(&errors).for_each(|(x, e)| *x += e);
        let (residual, _) = linearise(self.problem.rows(), angles);
        let record = IterationRecord {
            constraint_residual: constraint_residual(self.problem, angles, &residual),
            step: largest(&errors),
            step_length: 1.0,
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

fn error_of(held: Held, [least, most]: [f64; 2]) -> f64 {
    match held {
        Held::Free => 0.0,
        Held::Low => least,
        Held::High => most,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Passes;
    use abf_constraints::GuessSettings;
    use abf_control::{Silent, Termination};
    use abf_mesh::Topology;
    use abf_shapes::Shape;
    use abf_solve_core::AngleSolver;

    fn with_problem(shape: Shape, look: impl FnOnce(&AngleProblem<'_>)) {
        let mesh = shape.mesh(400);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        look(&AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk"));
    }

    /// The first pass: the largest part of a distance that an angle moves by, and how many solves it took.
    fn first_pass(problem: &AngleProblem<'_>, error_bound: f64) -> (f64, usize) {
        let (stop, mut silent) = (StopCriteria::default(), Silent);
        let mut watch = Watch::start(&stop, &mut silent);
        let step = DirectStep::new(problem.topology(), problem.rows()).expect("fits");
        let mut run = BoxedRun::new(problem, error_bound, step);
        let before = run.so_far.angles.clone();
        assert_eq!(run.pass(&mut watch), Ok(true));
        let share = |(x, y): (&f64, &f64)| if y < x { 1.0 - y / x } else { (y - x) / (PI - x) };
        (before.iter().zip(&run.so_far.angles).map(share).fold(0.0, f64::max), run.so_far.history[0].inner_iterations)
    }

    #[test]
    fn no_error_of_a_pass_exceeds_its_bound_and_some_reach_it() {
        with_problem(Shape::Hemisphere, |problem| {
            let (free, solves) = first_pass(problem, 0.999);
            assert!(free < 0.999 && solves == 1, "{free} {solves}");
            let bound = 0.9 * free;
            let (most, solves) = first_pass(problem, bound);
            assert!((most - bound).abs() < 1e-6 && solves > 1, "{most} {bound} {solves}");
        });
    }

    #[test]
    fn a_bound_that_nothing_reaches_gives_the_passes_without_one() {
        with_problem(Shape::Hemisphere, |problem| {
            let passes = Passes::Exactly(2.try_into().expect("not zero"));
            let angles = |error_bound| {
                let solver = LinAbf { passes, error_bound };
                solver.solve(problem, &StopCriteria::default(), &mut Silent).expect("angles")
            };
            let (bounded, free) = (angles(Some(0.999)), angles(None));
            let apart = bounded.angles().iter().zip(free.angles()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-10, "{apart}");
        });
    }

    #[test]
    fn bounds_that_contradict_the_constraints_stall() {
        with_problem(Shape::Spike, |problem| {
            let solver = LinAbf { error_bound: Some(1e-4), ..LinAbf::default() };
            let solution = solve(&solver, 1e-4, problem, &StopCriteria::default(), &mut Silent).expect("angles");
            assert_eq!(solution.termination(), Termination::Stalled);
            assert!(solution.angles().iter().all(|x| x.is_finite()));
        });
    }
}
