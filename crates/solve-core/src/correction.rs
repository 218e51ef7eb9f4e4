//! The smallest change of the angles that meets linearised constraints, several times in one metric.
//!
//! ```text
//! minimise eᵀ Λ e   subject to   J e = −h,        Λ > 0 the same every time, J and h new.
//! ```
//!
//! The reduced system is `S = [A B; Bᵀ D]`, vertex rows first. `A` depends on `Λ` alone, so its factor is
//! exact as long as the metric stays; and with `A⁻¹` at hand the vertex multipliers are eliminated:
//!
//! ```text
//! (D − Bᵀ A⁻¹ B) μ_w = r_w − Bᵀ A⁻¹ r_v,        μ_v = A⁻¹ (r_v − B μ_w).
//! ```
//!
//! Conjugate gradients on this half-sized system, preconditioned by a factor of the *first* `D`, take half
//! as many iterations as on `S` with both factors (Reid 1972 on matrices with property A), and the
//! eliminated half never has a residual. The rest of the residual of `S` is that of the linearised
//! constraints themselves, so it is known at every iteration how well `e` will meet them.

mod solve;

use crate::wheels::{Block, Given, Spokes, back_substitute, vertex_block, wheel_blocks};
use crate::{DirectStep, KktStep, KktSystem, KktVector, LinearError, StepError, StepReport};
use abf_constraints::{ConstraintRows, WheelDerivative};
use abf_control::{Checkpoint, Watch};
use abf_linalg::{Analysis, Parts, Permutation, SingleCholesky, SymbolicCholesky};
use abf_mesh::Topology;
use abf_parallel::prelude::*;
use solve::{Room, Solve};
use std::sync::Arc;

/// Fewer corners are not worth a thread.
const PER_TASK: usize = 1 << 13;

/// A solve that needed more iterations than this has an outdated preconditioner.
const REFACTOR_AFTER: usize = 40;

/// A new factor of `D` is made when it promises to save so many iterations. It costs as much as 3 on a million triangles and
/// as 6 on a few thousand; the rest is because conjugate gradients become faster as they go.
const WORTH_A_FACTOR: f64 = 20.0;

/// The relative residual of a direct solve.
const EXACT: f64 = 1e-12;

/// Even below its floor a [`FrozenStep`] brings the residual to this part of what it was, and of what the
/// constraints are off by: otherwise it would be no step at all, and a line search would find no descent.
const LEAST: f64 = 0.03;

/// Linearised constraints, and a gradient where the change is not to be least by itself.
#[derive(Clone, Copy, Debug)]
pub struct Linearisation<'a> {
    /// Who meets whom.
    pub topology: &'a Topology,
    /// Which constraint is which row.
    pub rows: &'a ConstraintRows,
    /// The part of `J` that depends on the angles, in the log form.
    pub wheel: &'a WheelDerivative,
    /// h, length nt + 2 ni.
    pub residual: &'a [f64],
    /// g, length 3 nt; empty for zero: the change minimises `½ eᵀΛe + gᵀe`.
    pub gradient: &'a [f64],
}

/// Solves for least corrections in one metric.
#[derive(Debug)]
pub struct LeastCorrection {
    /// `Λ⁻¹`.
    inverse: Vec<f64>,
    spokes: Spokes,
    order: Permutation,
    parts: Parts,
    symbolic: Arc<SymbolicCholesky>,
    /// `A`, `B`, `Bᵀ` and `D`, by rows.
    a: Block,
    b: Block,
    c: Block,
    d: Block,
    vertex_factor: Option<SingleCholesky>,
    wheel_factor: Option<SingleCholesky>,
    /// What an iteration gains with a factor of the `D` that is solved with: the fall of the logarithm of the residual.
    gain_when_fresh: f64,
    room: Room,
}

impl LeastCorrection {
    /// Orders and analyses the blocks of a topology for the metric `Λ = diag(lambda)`, one positive entry
    /// per corner.
    ///
    /// # Errors
    /// [`LinearError`] when that does not fit in memory or in 32-bit indices, or the checkpoint ends it.
    pub fn new(
        topology: &Topology,
        rows: &ConstraintRows,
        lambda: Vec<f64>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let mut inverse = lambda;
        inverse.par_iter_mut().with_min_len(PER_TASK).for_each(|l| *l = 1.0 / *l);
        let spokes = Spokes::new(topology, rows);
        let graph = spokes.graph(rows);
        checkpoint()?;
        let blocks = || {
            let mut blocks = [(); 4].map(|()| Block::zeros(rows));
            vertex_block(rows, &inverse, &mut blocks[0]);
            blocks
        };
        let (analysis, [a, b, c, d]) = Analysis::cheaper(&graph, blocks, checkpoint)?;
        let Analysis { order, parts, symbolic } = analysis;
        Ok(Self {
            inverse,
            spokes,
            order,
            parts,
            symbolic,
            a,
            b,
            c,
            d,
            vertex_factor: None,
            wheel_factor: None,
            gain_when_fresh: 0.0,
            room: Room::default(),
        })
    }

    /// Writes the correction (rad) and the multipliers into `out`. Stops when no linearised constraint is off
    /// by more than `target`, `max |h + J e|` in rad; triangle and vertex conditions are then met better than that.
    ///
    /// # Errors
    /// [`StepError`] when there is no solution or the watch interrupts.
    pub fn solve(
        &mut self,
        here: &Linearisation<'_>,
        target: f64,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<StepReport, StepError> {
        self.solve_to(here, |_| target, watch, out)
    }

    /// The same with a target that depends on the largest entry of the right-hand side.
    fn solve_to(
        &mut self,
        here: &Linearisation<'_>,
        target: impl Fn(f64) -> f64,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<StepReport, StepError> {
        wheel_blocks(here.rows, &self.inverse, here.wheel, [&mut self.b, &mut self.c, &mut self.d]);
        let mut tried = 0;
        let mut was_frozen = true;
        while was_frozen {
            was_frozen = self.wheel_factor.is_some();
            watch.checkpoint()?;
            if self.factorise(here.rows).is_err() {
                break;
            }
            watch.checkpoint()?;
            let room = std::mem::take(&mut self.room);
            let mut solve = Solve::start(self, here, was_frozen, room);
            let begin = solve.largest_left();
            let converged = solve.rounds(target(begin), watch)?;
            tried += solve.iterations;
            if converged {
                let report = solve.report(tried);
                let gain = (begin / solve.largest_left()).ln() / solve.iterations as f64;
                let room = solve.room;
                let Room { vertices, wheels, .. } = &room;
                if !was_frozen && gain.is_finite() {
                    self.gain_when_fresh = gain;
                }
                let (nt, ni) = (here.rows.triangle_count(), here.rows.interior_count());
                out.delta.resize(self.inverse.len(), 0.0);
                out.multipliers.resize(here.rows.len(), 0.0);
                let (triangles, others) = out.multipliers.split_at_mut(nt);
                others[..ni].copy_from_slice(&vertices[..ni]);
                others[ni..].copy_from_slice(&wheels[..ni]);
                let multipliers = [&vertices[..], &wheels[..]];
                back_substitute(here.topology, here.rows, &self.given(here), multipliers, &mut out.delta, triangles);
                self.room = room;
                return Ok(report);
            }
            self.room = solve.room;
            self.wheel_factor = None;
        }
        self.directly(here, watch, out, tried)
    }

    /// Factors of `A` and of the current `D`, where there are none.
    fn factorise(&mut self, rows: &ConstraintRows) -> Result<(), LinearError> {
        let Self { spokes, symbolic, order, parts, .. } = &*self;
        let factor =
            |block: &Block| symbolic.factorise_single(&spokes.symmetric(rows, block, symbolic.pattern(), order), parts);
        let (vertex, wheel) = abf_parallel::join(
            || self.vertex_factor.is_none().then(|| factor(&self.a)).transpose(),
            || self.wheel_factor.is_none().then(|| factor(&self.d)).transpose(),
        );
        let (vertex, wheel) = (vertex?, wheel?);
        self.vertex_factor = vertex.or(self.vertex_factor.take());
        self.wheel_factor = wheel.or(self.wheel_factor.take());
        Ok(())
    }

    /// The way out when conjugate gradients fail: one factorisation of `S` itself.
    fn directly(
        &self,
        here: &Linearisation<'_>,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
        tried: usize,
    ) -> Result<StepReport, StepError> {
        let zero = if here.gradient.is_empty() { vec![0.0; self.inverse.len()] } else { Vec::new() };
        let lambda: Vec<f64> = self.inverse.iter().map(|d| 1.0 / d).collect();
        let kkt = KktSystem {
            topology: here.topology,
            rows: here.rows,
            lambda: &lambda,
            gauss_newton: &lambda,
            off_diagonal: None,
            wheel: here.wheel,
            gradient: if here.gradient.is_empty() { &zero } else { here.gradient },
            residual: here.residual,
        };
        let mut report =
            DirectStep::asking(here.topology, here.rows, &mut || watch.checkpoint())?.step(&kkt, EXACT, watch, out)?;
        report.iterations += tried;
        Ok(report)
    }

    fn given<'a>(&'a self, here: &Linearisation<'a>) -> Given<'a> {
        Given { inverse: &self.inverse, gradient: here.gradient, residual: here.residual, wheel: here.wheel }
    }
}

/// A [`KktStep`] for methods whose `Λ` is positive and never changes, wheels in the log form: the
/// Gauss–Newton Hessian of an energy with a fixed target.
#[derive(Debug)]
pub struct FrozenStep {
    solver: LeastCorrection,
    lambda: Vec<f64>,
    floor: f64,
}

impl FrozenStep {
    /// Orders and analyses the blocks of a topology for the metric `Λ = diag(lambda)`. A step never meets a
    /// linearised constraint better than `floor`: whatever its multipliers are, the step is stationary with
    /// them, so that what is left in the constraints is all that is wrong with it.
    ///
    /// # Errors
    /// [`LinearError`] when that does not fit in memory or in 32-bit indices, or the checkpoint ends it.
    pub fn new(
        topology: &Topology,
        rows: &ConstraintRows,
        lambda: Vec<f64>,
        floor: f64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        Ok(Self { solver: LeastCorrection::new(topology, rows, lambda.clone(), checkpoint)?, lambda, floor })
    }
}

impl KktStep for FrozenStep {
    /// Every entry of the residual of `S` comes below `tolerance` times the largest one of its right-hand
    /// side, or below the floor.
    ///
    /// # Panics
    /// If `Λ` is not that of [`FrozenStep::new`].
    fn step(
        &mut self,
        kkt: &KktSystem<'_>,
        tolerance: f64,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<StepReport, StepError> {
        assert!(kkt.lambda == self.lambda, "the metric this step was made for");
        let KktSystem { topology, rows, wheel, residual, gradient, .. } = *kkt;
        let here = Linearisation { topology, rows, wheel, residual, gradient };
        let floor = self.floor.min(LEAST * largest(residual));
        self.solver.solve_to(&here, |goal| (tolerance * goal).max(floor.min(LEAST * goal)), watch, out)
    }
}

/// `max |v|`; NaN counts as infinite.
fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |max: f64, x| {
        if x.abs() <= max {
            max
        } else if x.is_nan() {
            f64::INFINITY
        } else {
            x.abs()
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{Planted, apart};
    use abf_constraints::WheelForm;
    use abf_control::{Silent, StopCriteria};

    /// Correction and multipliers of one solve, and how many iterations it took.
    fn solve(
        solver: &mut LeastCorrection,
        kkt: &KktSystem<'_>,
        wheel: &WheelDerivative,
        target: f64,
    ) -> (KktVector, StepReport) {
        let KktSystem { topology, rows, residual, gradient, .. } = *kkt;
        let here = Linearisation { topology, rows, wheel, residual, gradient };
        let (mut silent, mut out) = (Silent, KktVector::default());
        let mut watch = Watch::start(&StopCriteria::default(), &mut silent);
        let report = solver.solve(&here, target, &mut watch, &mut out).expect("a solution");
        (out, report)
    }

    fn directly(kkt: &KktSystem<'_>, wheel: &WheelDerivative) -> KktVector {
        let (mut silent, mut out) = (Silent, KktVector::default());
        let mut watch = Watch::start(&StopCriteria::default(), &mut silent);
        let mut step = DirectStep::new(kkt.topology, kkt.rows).expect("fits");
        step.step(&KktSystem { wheel, ..*kkt }, 1e-14, &mut watch, &mut out).expect("a solution");
        out
    }

    /// With fresh factors and with those of other angles: what a factorisation of the whole system gives.
    #[test]
    fn corrections_are_those_of_the_whole_system() {
        let planted = Planted::new(700);
        let kkt = planted.kkt();
        let kkt = KktSystem { lambda: kkt.gauss_newton, ..kkt };
        let mut solver =
            LeastCorrection::new(kkt.topology, kkt.rows, kkt.lambda.to_vec(), &mut || Ok(())).expect("fits");
        let wobble = |(c, x): (usize, f64)| x * (1.0 + 0.02 * (c as f64).sin());
        let moved: Vec<f64> = planted.angles().into_iter().enumerate().map(wobble).collect();
        let other = WheelDerivative::new(WheelForm::Log, kkt.topology, kkt.rows, &moved);
        for wheel in [kkt.wheel, &other] {
            let (out, report) = solve(&mut solver, &kkt, wheel, 1e-12);
            let exact = directly(&kkt, wheel);
            assert!(report.iterations > 0 && report.iterations <= REFACTOR_AFTER, "{report:?}");
            assert!(apart(&out.delta, &exact.delta) < 1e-9);
            assert!(apart(&out.multipliers, &exact.multipliers) < 1e-7);
        }
    }

    /// The target is that of the linearised constraints: `max |h + J e|`.
    #[test]
    fn the_target_is_met_by_the_linearised_constraints() {
        let planted = Planted::new(700);
        let kkt = planted.kkt();
        let kkt = KktSystem { lambda: kkt.gauss_newton, ..kkt };
        let mut solver =
            LeastCorrection::new(kkt.topology, kkt.rows, kkt.lambda.to_vec(), &mut || Ok(())).expect("fits");
        let mut before = 0;
        for target in [1e-2, 1e-5, 1e-9] {
            let (out, report) = solve(&mut solver, &kkt, kkt.wheel, target);
            let mut jacobian = abf_constraints::Jacobian::new(kkt.topology, kkt.rows);
            jacobian.update(kkt.topology, kkt.rows, kkt.wheel);
            let mut left = kkt.residual.to_vec();
            for (&value, (row, column)) in &jacobian.view() {
                left[row as usize] += value * out.delta[column as usize];
            }
            assert!(largest(&left) <= target * 1.001 + 1e-12, "{} for {target}", largest(&left));
            assert!(report.iterations >= before);
            before = report.iterations;
        }
    }

    #[test]
    fn corrections_have_the_same_bits_for_any_number_of_threads() {
        let planted = Planted::new(12_000);
        let kkt = planted.kkt();
        let kkt = KktSystem { lambda: kkt.gauss_newton, ..kkt };
        let run = |threads: usize| {
            abf_parallel::with_threads(threads, || {
                let mut solver =
                    LeastCorrection::new(kkt.topology, kkt.rows, kkt.lambda.to_vec(), &mut || Ok(())).expect("fits");
                solve(&mut solver, &kkt, kkt.wheel, 1e-9).0
            })
            .expect("threads")
        };
        assert_eq!(run(1), run(2));
    }
}
