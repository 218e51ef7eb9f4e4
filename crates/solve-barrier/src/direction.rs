//! The direction of a step: a Newton step on the barrier problem.

use crate::curvature::convex;
use crate::dual::BoundMultipliers;
use crate::iterate::Iterate;
use crate::slack;
use crate::system::StepSystem;
use abf_constraints::AngleProblem;
use abf_control::Checkpoint;
use abf_solve_core::{Hessian, KktVector, LinearError, LinearStats};

/// What every eigenvalue of a triangle's form keeps of that of `2w + z_lo/x + z_hi/(π − x)`.
const CONVEXITY: f64 = 1e-2;

/// A direction and what a line search needs to know of it.
#[derive(Debug)]
pub(crate) struct Direction {
    /// `δ` and `Δλ`.
    pub(crate) step: KktVector,
    /// `Λ`, with which the system can be solved again.
    pub(crate) lambda: Vec<f64>,
    /// `dφ/dx + Jᵀ λ`.
    pub(crate) gradient: Vec<f64>,
    /// `⟨dφ/dx, δ⟩`.
    pub(crate) slope: f64,
    /// How many entries of `Λ` were negative before it was made convex.
    pub(crate) negative: usize,
    pub(crate) linear: LinearStats,
}

impl Direction {
    /// Solves `[Λ Jᵀ; J 0] [δ; Δλ] = −[dφ/dx + Jᵀλ; h]`.
    pub(crate) fn new(
        problem: &AngleProblem<'_>,
        system: &mut StepSystem,
        hessian: Hessian,
        (iterate, multipliers, bounds, barrier): (&Iterate, &[f64], &BoundMultipliers, f64),
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let (lambda, negative) = diagonal(problem, hessian, iterate, multipliers, bounds);
        let of_objective = iterate.gradient(problem, barrier);
        let mut gradient = of_objective.clone();
        slack::add_transposed(problem, &iterate.wheel, multipliers, &mut gradient);
        let mut step = KktVector::default();
        let linear = system.solve(problem, iterate, &lambda, &gradient, &mut step, checkpoint)?;
        let slope = of_objective.iter().zip(&step.delta).map(|(g, d)| g * d).sum();
        Ok(Self { step, lambda, gradient, slope, negative, linear })
    }
}

/// `Λ = 2w + z_lo/x + z_hi/(π − x)`, with the exact Hessian `− m/sin²x` and made convex; and how many entries were negative.
fn diagonal(
    problem: &AngleProblem<'_>,
    hessian: Hessian,
    iterate: &Iterate,
    multipliers: &[f64],
    bounds: &BoundMultipliers,
) -> (Vec<f64>, usize) {
    let (x, weight) = (&iterate.angles, problem.weight());
    let mut lambda: Vec<f64> =
        (0..x.len()).map(|c| weight.get(c).map_or(0.0, |w| 2.0 * w) + bounds.curvature(c, x[c])).collect();
    if hessian == Hessian::GaussNewton {
        return (lambda, 0);
    }
    let m = wheel_multipliers(problem, multipliers);
    let mut negative = 0;
    let triangles = lambda.chunks_exact_mut(3).zip(m.chunks_exact(3)).zip(x.chunks_exact(3));
    for ((lambda, m), x) in triangles {
        let metric = [lambda[0], lambda[1], lambda[2]];
        let exact = [0, 1, 2].map(|k| metric[k] - m[k] / x[k].sin().powi(2));
        negative += exact.iter().filter(|&&l| l < 0.0).count();
        let diagonal = convex(exact, metric, [x[0], x[1], x[2]], CONVEXITY).unwrap_or(exact);
        lambda.copy_from_slice(&diagonal);
    }
    (lambda, negative)
}

/// `m` per corner: the wheel multipliers where it is `next` minus those where it is `prev` (VMV04 §6).
fn wheel_multipliers(problem: &AngleProblem<'_>, multipliers: &[f64]) -> Vec<f64> {
    let rows = problem.rows();
    let mut m = vec![0.0; problem.topology().corner_count()];
    for i in 0..rows.interior_count() {
        let of_wheel = multipliers[rows.wheel(i)];
        for hub in rows.hubs(i) {
            m[hub.next().index()] += of_wheel;
            m[hub.prev().index()] -= of_wheel;
        }
    }
    m
}
