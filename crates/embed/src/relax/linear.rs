//! The linear map of one triangle, and its singular values.

use abf_mesh::Vector2;

/// The Jacobian `[a b; c d]` of the map of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Linear {
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) c: f64,
    pub(crate) d: f64,
}

/// `J = U diag(values) Vᵀ`, the columns of `U` and `V`, and `values[0] ≥ values[1] > 0`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Singular {
    pub(crate) values: [f64; 2],
    pub(crate) u: [Vector2<f64>; 2],
    pub(crate) v: [Vector2<f64>; 2],
}

impl Linear {
    /// `(s₁ − s₂)²`.
    pub(crate) fn difference_squared(&self) -> f64 {
        let (f, g) = (self.a - self.d, self.b + self.c);
        f * f + g * g
    }

    /// The singular value decomposition of a map that does not turn the triangle over.
    pub(crate) fn singular(&self) -> Singular {
        let Self { a, b, c, d } = *self;
        let (e, f, g, h) = (0.5 * (a + d), 0.5 * (a - d), 0.5 * (b + c), 0.5 * (c - b));
        let (q, r) = (e.hypot(h), f.hypot(g));
        let largest = q + r;
        // The difference q − r cancels where one value is much smaller.
        let least = ((a * d - b * c) / largest).max(f64::MIN_POSITIVE);
        let (one, two) = (g.atan2(f), h.atan2(e));
        let (phi, theta) = (0.5 * (two + one), 0.5 * (two - one));
        let (sin_phi, cos_phi) = phi.sin_cos();
        let (sin_theta, cos_theta) = theta.sin_cos();
        Singular {
            values: [largest, least.min(largest)],
            u: [Vector2::new(cos_phi, sin_phi), Vector2::new(-sin_phi, cos_phi)],
            v: [Vector2::new(cos_theta, -sin_theta), Vector2::new(sin_theta, cos_theta)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn singular_values_give_the_jacobian_back() {
        for [a, b, c, d] in [[1.0, 0.2, -0.3, 0.8], [2.0, 0.0, 0.0, 2.0], [1e3, 1.0, 0.0, 1e-9], [0.1, -3.0, 2.0, 0.4]]
        {
            let Singular { values, u, v } = Linear { a, b, c, d }.singular();
            let back = u[0] * v[0].transpose() * values[0] + u[1] * v[1].transpose() * values[1];
            for (given, got) in [(a, back.m11), (b, back.m12), (c, back.m21), (d, back.m22)] {
                assert!((given - got).abs() <= 1e-15 * values[0] * 4.0, "{given} {got}");
            }
            assert!((values[0] * values[1] - (a * d - b * c)).abs() <= 1e-15 * (a * d - b * c).abs() * 4.0);
        }
    }
}
