//! What the descent minimises, as a function of the angles.

use abf_constraints::AngleProblem;
use std::f64::consts::PI;

/// An angle with a target below 1e-3 rad weighs no more than one of that: weights of `1/a²` without a bound are beyond
/// the digits of the linear solves, and hold every step back for the sake of slivers.
const LARGEST_WEIGHT: f64 = 1e6;

/// `E(x) = Σ w (x − a)² − μ Σ [log x + log(π − x)]`: the energy of ABF (Sheffer, de Sturler 2001) with a logarithmic
/// barrier at both ends of (0, π).
#[derive(Clone, Copy)]
pub(crate) struct Objective<'p, 'a> {
    pub(crate) problem: &'p AngleProblem<'a>,
    /// μ.
    pub(crate) barrier: f64,
}

impl Objective<'_, '_> {
    /// `E`; not finite when an angle has left (0, π).
    pub(crate) fn value(&self, angles: &[f64]) -> f64 {
        let barrier: f64 = angles.iter().map(|x| (x * (PI - x)).ln()).sum();
        self.energy(angles) - self.barrier * barrier
    }

    /// `Σ w (x − a)²` with the weights as they are used.
    fn energy(&self, angles: &[f64]) -> f64 {
        let terms = self.problem.weight().iter().zip(self.problem.target()).zip(angles);
        terms.map(|((w, a), x)| w.min(LARGEST_WEIGHT) * (x - a) * (x - a)).sum()
    }

    /// `w (x − a)²` of one corner.
    #[inline]
    pub(crate) fn corner_energy(&self, corner: usize, x: f64) -> f64 {
        let (w, a) = (self.problem.weight()[corner].min(LARGEST_WEIGHT), self.problem.target()[corner]);
        w * (x - a) * (x - a)
    }

    /// `dE/dx` and `d²E/dx²` at one corner; the second is positive.
    #[inline]
    pub(crate) fn derivatives(&self, corner: usize, x: f64) -> (f64, f64) {
        let (w, a) = (self.problem.weight()[corner].min(LARGEST_WEIGHT), self.problem.target()[corner]);
        let (low, high) = (1.0 / x, 1.0 / (PI - x));
        let slope = 2.0 * w * (x - a) - self.barrier * (low - high);
        (slope, 2.0 * w + self.barrier * (low * low + high * high))
    }

    /// The size of what `E` is made of, without the cancellation between its parts: what a decrease is small against.
    pub(crate) fn scale(&self, angles: &[f64]) -> f64 {
        self.energy(angles) + self.barrier * angles.len() as f64
    }
}
