//! Angles with everything that is evaluated at them.

use crate::slack;
use abf_constraints::{AngleProblem, WheelDerivative, linearise};
use std::f64::consts::PI;

/// Angles strictly inside (0, π), the constraints there and what they cost.
#[derive(Clone, Debug)]
pub(crate) struct Iterate {
    /// The angles, and the slacks of the boundary behind them.
    pub(crate) angles: Vec<f64>,
    /// h, wheels in the log form, and the rows of the boundary behind it.
    pub(crate) residual: Vec<f64>,
    pub(crate) wheel: WheelDerivative,
    /// `θ = ‖h‖₁`, rad.
    pub(crate) violation: f64,
    /// `Σ w (x − a)²`.
    pub(crate) energy: f64,
    /// `Σ log x + log(π − x)`.
    pub(crate) logarithms: f64,
}

impl Iterate {
    pub(crate) fn new(problem: &AngleProblem<'_>, angles: Vec<f64>) -> Self {
        let (mut residual, wheel) = linearise(problem.rows(), &angles[..slack::corner_count(problem)]);
        residual.extend(slack::residual(problem, &angles));
        Self {
            violation: residual.iter().map(|h| h.abs()).sum(),
            energy: problem.energy(&angles),
            logarithms: angles.iter().map(|x| (x * (PI - x)).ln()).sum(),
            residual,
            wheel,
            angles,
        }
    }

    /// `φ = Σ w (x − a)² − μ Σ [log x + log(π − x)]`.
    pub(crate) fn objective(&self, barrier: f64) -> f64 {
        self.energy - barrier * self.logarithms
    }

    /// Whether a line search may compare with it.
    pub(crate) fn is_finite(&self) -> bool {
        self.violation.is_finite() && self.energy.is_finite() && self.logarithms.is_finite()
    }

    /// `dφ/dx`.
    pub(crate) fn gradient(&self, problem: &AngleProblem<'_>, barrier: f64) -> Vec<f64> {
        let (target, weight) = (problem.target(), problem.weight());
        let of_bounds = |&x: &f64| -barrier / x + barrier / (PI - x);
        let mut gradient: Vec<f64> = self.angles.iter().map(of_bounds).collect();
        let of = |(c, &x): (usize, &f64)| 2.0 * weight[c] * (x - target[c]) - barrier / x + barrier / (PI - x);
        let corners = self.angles.iter().enumerate().take(target.len());
        gradient.iter_mut().zip(corners.map(of)).for_each(|(g, own)| *g = own);
        gradient
    }
}
