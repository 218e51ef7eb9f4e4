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

/// The vectors of a solve, to be used again by the next.
#[derive(Debug, Default)]
pub(super) struct Room {
    /// The multipliers, with a zero for the boundary at the end.
    pub(super) vertices: Vec<f64>,
    pub(super) wheels: Vec<f64>,
    /// The right-hand side.
    goal: [Vec<f64>; 2],
    /// The true residual of `S`.
    left: [Vec<f64>; 2],
    directions: Directions,
}

/// Those of conjugate gradients: the direction `p` and `q = A⁻¹ B p`, both with a zero for the boundary, and what they and the
/// residual are multiplied to.
#[derive(Debug, Default)]
struct Directions {
    p: Vec<f64>,
    q: Vec<f64>,
    t: Vec<f64>,
    z: Vec<f64>,
    ap: Vec<f64>,
}

/// One solve: multipliers so far, and what they leave.
pub(super) struct Solve<'a> {
    system: &'a LeastCorrection,
    rows: &'a ConstraintRows,
    pub(super) room: Room,
    pub(super) iterations: usize,
    /// Whether the factor of `D` is that of an earlier solve.
    is_frozen: bool,
}

impl<'a> Solve<'a> {
    /// Nothing solved yet: what is left is the right-hand side. Of the room only the memory counts.
    pub(super) fn start(
        system: &'a LeastCorrection,
        here: &Linearisation<'a>,
        is_frozen: bool,
        mut room: Room,
    ) -> Self {
        let ni = here.rows.interior_count();
        for multipliers in [&mut room.vertices, &mut room.wheels] {
            multipliers.clear();
            multipliers.resize(ni + 1, 0.0);
        }
        room.goal.iter_mut().for_each(|part| part.resize(ni, 0.0));
        right_hand_side(here.rows, &system.given(here), room.goal.each_mut().map(|v| &mut v[..]));
        room.left.clone_from(&room.goal);
        Self { system, rows: here.rows, room, iterations: 0, is_frozen }
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
        self.room.left.iter().map(|part| largest(part)).fold(0.0, f64::max)
    }

    /// One round of conjugate gradients on the wheel multipliers, from the residual at hand.
    fn round(&mut self, target: f64, watch: &mut Watch<'_>) -> Result<bool, StepError> {
        let Self { system, rows, .. } = *self;
        let ni = rows.interior_count();
        let a_inverse = system.vertex_factor.as_ref().expect("factorised");
        let d_inverse = system.wheel_factor.as_ref().expect("factorised");
        let Room { vertices, wheels, left: [vertices_left, r], directions, .. } = &mut self.room;
        let Directions { p, q, t, z, ap } = directions;
        [&mut *t, &mut *z, &mut *ap].into_iter().for_each(|v| v.resize(ni, 0.0));
        q.resize(ni + 1, 0.0);
        // Eliminate: the vertex rows are met exactly from here on. They are linear in the angles, so after
        // the first pass they mostly are already.
        if largest(vertices_left) > NEGLIGIBLE * target {
            a_inverse.apply_in_order(&system.order, vertices_left, &mut q[..ni]);
            vector::axpy(1.0, q, vertices);
            system.spokes.multiply(rows, &system.c, q, t);
            vector::axpy(-1.0, t, r);
        }

        let (begin, done) = (largest(r), self.iterations);
        d_inverse.apply_in_order(&system.order, r, z);
        p.clone_from(z);
        p.push(0.0);
        let mut rz = vector::dot(r, z);
        let mut converged = begin <= target;
        while !converged && self.iterations < REFACTOR_AFTER {
            // One way into the pool for all products and solves of an iteration.
            let now = abf_parallel::scope(|_| {
                system.spokes.multiply(rows, &system.b, p, t);
                a_inverse.apply_in_order(&system.order, t, &mut q[..ni]);
                system.spokes.multiply_difference(rows, (&system.d, &p[..]), (&system.c, &q[..]), ap);
                let curvature = vector::dot(&p[..ni], ap);
                let length = rz / curvature;
                if !(rz > 0.0 && curvature > 0.0 && length.is_finite()) {
                    return None;
                }
                vector::axpy(length, p, wheels);
                vector::axpy(-length, q, vertices);
                vector::axpy(-length, ap, r);
                let now = largest(r);
                if now > target {
                    d_inverse.apply_in_order(&system.order, r, z);
                    let before = std::mem::replace(&mut rz, vector::dot(r, z));
                    vector::xpay(z, rz / before, &mut p[..ni]);
                }
                Some(now)
            });
            let Some(now) = now else { break };
            self.iterations += 1;
            if !watch.inner(self.iterations, now / begin)? {
                return Err(StepError::Interrupted);
            }
            converged = now <= target;
            if !converged && is_outdated(system, self.is_frozen, self.iterations - done, [begin, now, target]) {
                break;
            }
        }
        Ok(converged)
    }

    /// The true residual, with the matrix.
    fn measure(&mut self) {
        let Self { system, rows, .. } = *self;
        let Room { vertices: v, wheels: w, goal, left: [vertex, wheel], .. } = &mut self.room;
        for (out, goal, first, second) in [
            (vertex, &goal[0], (&system.a, &v[..]), (&system.b, &w[..])),
            (wheel, &goal[1], (&system.c, &v[..]), (&system.d, &w[..])),
        ] {
            system.spokes.residual(rows, goal, first, second, out);
        }
    }

    /// What a solve reports after so many iterations, those of earlier attempts included.
    pub(super) fn report(&self, iterations: usize) -> StepReport {
        let size = |parts: &[Vec<f64>; 2]| parts.iter().map(|v| vector::dot(v, v)).sum::<f64>().sqrt();
        let (left, goal) = (size(&self.room.left), size(&self.room.goal));
        let relative_residual = if goal > 0.0 { left / goal } else { 0.0 };
        StepReport { iterations, relative_residual, ..StepReport::default() }
    }
}

/// Whether the rest of the way takes far longer than the whole way with a new factor, where the factor is `frozen`. The
/// residual came from `begin` to `now`, and goes to `target`.
fn is_outdated(system: &LeastCorrection, is_frozen: bool, iterations: usize, [begin, now, target]: [f64; 3]) -> bool {
    if !is_frozen || iterations < SPEED_AFTER {
        return false;
    }
    let gain = (begin / now).ln() / iterations as f64;
    let left = if gain > 0.0 { (now / target).ln() / gain } else { f64::INFINITY };
    left > WORTH_A_FACTOR + (begin / target).ln() / system.gain_when_fresh
}
