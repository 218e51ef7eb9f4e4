//! Conjugate gradients on the wheel multipliers, until the true residual meets the target.

use super::{LeastCorrection, Linearisation, REFACTOR_AFTER, WORTH_A_FACTOR, largest};
use crate::wheels::right_hand_side;
use crate::{StepError, StepReport};
use abf_constraints::ConstraintRows;
use abf_control::Watch;
use abf_linalg::vector;

/// The factor of `A` is in single precision: what it leaves over is solved for again, at most so often.
const ROUNDS: usize = 4;

/// A round is worth another if it brings the residual below this part of what it was.
const PROGRESS: f64 = 0.5;

/// The iteration aims this far below the target: rounding adds the rest.
const CAUTION: f64 = 0.8;

/// After so many iterations their speed is known: before, the largest entry of the residual goes up and down.
const SPEED_AFTER: usize = 16;

/// What the vertex rows are off by is left alone below this part of the target.
const NEGLIGIBLE: f64 = 0.1;

/// One solve: multipliers so far, and what they leave.
pub(super) struct Solve<'a> {
    system: &'a LeastCorrection,
    rows: &'a ConstraintRows,
    /// The multipliers, with a zero for the boundary at the end.
    pub(super) vertices: Vec<f64>,
    pub(super) wheels: Vec<f64>,
    /// The right-hand side.
    goal: [Vec<f64>; 2],
    /// The true residual of `S`.
    left: [Vec<f64>; 2],
    pub(super) iterations: usize,
    /// Whether the factor of `D` is that of an earlier solve.
    is_frozen: bool,
}

impl<'a> Solve<'a> {
    /// Nothing solved yet: what is left is the right-hand side.
    pub(super) fn start(system: &'a LeastCorrection, here: &Linearisation<'a>, is_frozen: bool) -> Self {
        let ni = here.rows.interior_count();
        let mut goal = [vec![0.0; ni], vec![0.0; ni]];
        right_hand_side(here.rows, &system.given(here), goal.each_mut().map(|v| &mut v[..]));
        let left = goal.clone();
        Self {
            system,
            rows: here.rows,
            vertices: vec![0.0; ni + 1],
            wheels: vec![0.0; ni + 1],
            goal,
            left,
            iterations: 0,
            is_frozen,
        }
    }

    /// Solves until the true residual meets the target; `false` when it will not.
    pub(super) fn rounds(&mut self, target: f64, watch: &mut Watch<'_>) -> Result<bool, StepError> {
        let mut before = f64::INFINITY;
        for _ in 0..ROUNDS {
            let now = self.largest_left();
            if now <= target {
                return Ok(true);
            }
            if !(now <= PROGRESS * before) || self.iterations >= REFACTOR_AFTER {
                return Ok(false);
            }
            before = now;
            if !self.round(CAUTION * target, watch)? {
                return Ok(false);
            }
            self.measure();
        }
        Ok(self.largest_left() <= target)
    }

    /// The largest entry of what is left of `S`; at the start that is the whole right-hand side.
    pub(super) fn largest_left(&self) -> f64 {
        self.left.iter().map(|part| largest(part)).fold(0.0, f64::max)
    }

    /// One round of conjugate gradients on the wheel multipliers, from the residual at hand.
    fn round(&mut self, target: f64, watch: &mut Watch<'_>) -> Result<bool, StepError> {
        let Self { system, rows, .. } = *self;
        let ni = rows.interior_count();
        let a_inverse = system.vertex_factor.as_ref().expect("factorised");
        let d_inverse = system.wheel_factor.as_ref().expect("factorised");
        let (mut t, mut q, mut z, mut ap) = (vec![0.0; ni], vec![0.0; ni + 1], vec![0.0; ni], vec![0.0; ni]);
        let mut r = std::mem::take(&mut self.left[1]);
        // Eliminate: the vertex rows are met exactly from here on. They are linear in the angles, so after
        // the first pass they mostly are already.
        if largest(&self.left[0]) > NEGLIGIBLE * target {
            a_inverse.apply_in_order(&system.order, &self.left[0], &mut q[..ni]);
            vector::axpy(1.0, &q, &mut self.vertices);
            system.spokes.multiply(rows, &system.c, &q, &mut t);
            vector::axpy(-1.0, &t, &mut r);
        }

        let (begin, done) = (largest(&r), self.iterations);
        d_inverse.apply_in_order(&system.order, &r, &mut z);
        let mut p = z.clone();
        p.push(0.0);
        let mut rz = vector::dot(&r, &z);
        let mut converged = begin <= target;
        while !converged && self.iterations < REFACTOR_AFTER {
            let (vertices, wheels) = (&mut self.vertices, &mut self.wheels);
            // One way into the pool for all products and solves of an iteration.
            let now = abf_parallel::scope(|_| {
                system.spokes.multiply(rows, &system.b, &p, &mut t);
                a_inverse.apply_in_order(&system.order, &t, &mut q[..ni]);
                system.spokes.multiply_difference(rows, (&system.d, &p), (&system.c, &q), &mut ap);
                let curvature = vector::dot(&p[..ni], &ap);
                let length = rz / curvature;
                if !(rz > 0.0 && curvature > 0.0 && length.is_finite()) {
                    return None;
                }
                vector::axpy(length, &p, wheels);
                vector::axpy(-length, &q, vertices);
                vector::axpy(-length, &ap, &mut r);
                let now = largest(&r);
                if now > target {
                    d_inverse.apply_in_order(&system.order, &r, &mut z);
                    let before = std::mem::replace(&mut rz, vector::dot(&r, &z));
                    vector::xpay(&z, rz / before, &mut p[..ni]);
                }
                Some(now)
            });
            let Some(now) = now else { break };
            self.iterations += 1;
            if !watch.inner(self.iterations, now / begin)? {
                return Err(StepError::Interrupted);
            }
            converged = now <= target;
            if !converged && self.is_outdated(self.iterations - done, [begin, now, target]) {
                break;
            }
        }
        self.left[1] = r;
        Ok(converged)
    }

    /// Whether the rest of the way takes far longer than the whole way with a new factor. The residual came from
    /// `begin` to `now`, and goes to `target`.
    fn is_outdated(&self, iterations: usize, [begin, now, target]: [f64; 3]) -> bool {
        if !self.is_frozen || iterations < SPEED_AFTER {
            return false;
        }
        let gain = (begin / now).ln() / iterations as f64;
        let left = if gain > 0.0 { (now / target).ln() / gain } else { f64::INFINITY };
        left > WORTH_A_FACTOR + (begin / target).ln() / self.system.gain_when_fresh
    }

    /// The true residual, with the matrix.
    fn measure(&mut self) {
        let Self { system, rows, .. } = *self;
        let [vertex, wheel] = &mut self.left;
        let (v, w) = (&self.vertices, &self.wheels);
        for (out, goal, first, second) in [
            (vertex, &self.goal[0], (&system.a, &v[..]), (&system.b, &w[..])),
            (wheel, &self.goal[1], (&system.c, &v[..]), (&system.d, &w[..])),
        ] {
            out.resize(goal.len(), 0.0);
            system.spokes.residual(rows, goal, first, second, out);
        }
    }

    /// What a solve reports after so many iterations, those of earlier attempts included.
    pub(super) fn report(&self, iterations: usize) -> StepReport {
        let size = |parts: &[Vec<f64>; 2]| parts.iter().map(|v| vector::dot(v, v)).sum::<f64>().sqrt();
        let (left, goal) = (size(&self.left), size(&self.goal));
        let relative_residual = if goal > 0.0 { left / goal } else { 0.0 };
        StepReport { iterations, relative_residual, ..StepReport::default() }
    }
}
