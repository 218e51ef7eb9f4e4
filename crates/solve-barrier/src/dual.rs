//! The multipliers of the bounds.

use std::f64::consts::PI;

/// They are kept within this factor of `μ` over the distance (Wächter, Biegler 2006, eq. (16), with a smaller factor: what
/// an exponential step leaves behind is not far off).
const SPREAD: f64 = 2.0;

/// `z_lo` of `0 < x` and `z_hi` of `x < π`: positive, with `z_lo x = z_hi (π − x) = μ` at the solution.
#[derive(Clone, Debug)]
pub(crate) struct BoundMultipliers {
    low: Vec<f64>,
    high: Vec<f64>,
}

impl BoundMultipliers {
    /// Those that satisfy complementarity.
    pub(crate) fn centred(angles: &[f64], barrier: f64) -> Self {
        let low = angles.iter().map(|x| barrier / x).collect();
        let high = angles.iter().map(|x| barrier / (PI - x)).collect();
        Self { low, high }
    }

    /// `z_lo/x + z_hi/(π − x)`: what the bounds add to `Λ`.
    pub(crate) fn curvature(&self, c: usize, x: f64) -> f64 {
        self.low[c] / x + self.high[c] / (PI - x)
    }

    /// `−z_lo + z_hi`: what they add to the gradient of the Lagrangian.
    pub(crate) fn gradient(&self, c: usize) -> f64 {
        self.high[c] - self.low[c]
    }

    /// `max |z_lo x − μ|`, `|z_hi (π − x) − μ|`.
    pub(crate) fn complementarity(&self, angles: &[f64], barrier: f64) -> f64 {
        let pairs = angles.iter().zip(self.low.iter().zip(&self.high));
        pairs.fold(0.0, |most: f64, (x, (low, high))| {
            most.max((low * x - barrier).abs()).max((high * (PI - x) - barrier).abs())
        })
    }

    /// After the primal step `delta` from `angles` to `to`: a step of their own, no longer than leaves each a share
    /// `1 − fraction` of itself (Wächter, Biegler 2006, eqs. (12), (15b), (16)).
    pub(crate) fn advance(&mut self, angles: &[f64], delta: &[f64], to: &[f64], barrier: f64, fraction: f64) {
        let low = |z: f64, x: f64, d: f64| barrier / x - z - z / x * d;
        let high = |z: f64, x: f64, d: f64| barrier / (PI - x) - z + z / (PI - x) * d;
        let mut share: f64 = 1.0;
        for (c, (&x, &d)) in angles.iter().zip(delta).enumerate() {
            for (z, change) in [(self.low[c], low(self.low[c], x, d)), (self.high[c], high(self.high[c], x, d))] {
                if change < -fraction * z {
                    share = share.min(-fraction * z / change);
                }
            }
        }
        let near = |z: f64, centre: f64| z.clamp(centre / SPREAD, centre * SPREAD);
        for (c, (&x, &d)) in angles.iter().zip(delta).enumerate() {
            self.low[c] = near(self.low[c] + share * low(self.low[c], x, d), barrier / to[c]);
            self.high[c] = near(self.high[c] + share * high(self.high[c], x, d), barrier / (PI - to[c]));
        }
    }
}
