//! The exact second derivative, made convex triangle by triangle.
//!
//! Changes that meet a triangle's own row keep its sum, so of its three entries of `Λ` only the form
//! `Q(δ) = Σ Λ δ²` on `Σ δ = 0` counts, and every symmetric form on that plane is one diagonal. With two of the three
//! changes as coordinates it is
//!
//! ```text
//! M = [ Λᵢ + Λₖ   Λₖ     ]
//!     [ Λₖ        Λⱼ + Λₖ ].
//! ```
//!
//! `P` of the reduction is its inverse, so `S` is positive definite when every `M` is: `Λ` itself may have negative entries,
//! one per triangle. Raising them to zero instead throws away what the three have in common. On a thin triangle whose
//! angles want to shrink together (a cap) the positive entry then stands alone, 1e3 times too large, and steps become that
//! much too short: the cut dino of Zayer, Lévy, Seidel (2007) took several times as many of them.

/// The diagonal whose form `M` is `exact`'s with every eigenvalue, measured in `metric > 0`, raised to at least `share`;
/// `None` where `exact` is that convex already.
pub(crate) fn convex(exact: [f64; 3], metric: [f64; 3], angles: [f64; 3], share: f64) -> Option<[f64; 3]> {
    // Coordinates: the changes of the two smaller angles, which on a thin triangle are of another size than the third.
    let k = (0..3).max_by(|&a, &b| angles[a].total_cmp(&angles[b])).unwrap_or(0);
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let form = |l: [f64; 3]| Form { ii: l[i] + l[k], ij: l[k], jj: l[j] + l[k] };
    let root = form(metric).root();
    let raised = form(exact).seen_from(&root).raised(share)?.seen_in(&root);
    let mut diagonal = [0.0; 3];
    (diagonal[i], diagonal[j], diagonal[k]) = (raised.ii - raised.ij, raised.jj - raised.ij, raised.ij);
    for (l, g) in diagonal.iter_mut().zip(metric) {
        // An entry of zero has no inverse, however convex the form.
        if l.abs() < NOT_ZERO * g {
            *l = NOT_ZERO * g;
        }
    }
    Some(diagonal)
}

/// How far from zero an entry of `Λ` is kept, as a share of the metric.
const NOT_ZERO: f64 = 1e-6;

/// A symmetric 2 × 2 matrix.
#[derive(Clone, Copy, Debug)]
struct Form {
    ii: f64,
    ij: f64,
    jj: f64,
}

/// A lower triangular 2 × 2 matrix.
struct Root {
    ii: f64,
    ji: f64,
    jj: f64,
}

impl Form {
    /// Its Cholesky factor `L`; it must be positive definite.
    fn root(self) -> Root {
        let ii = self.ii.sqrt();
        let ji = self.ij / ii;
        Root { ii, ji, jj: (self.jj - ji * ji).sqrt() }
    }

    /// `L⁻¹ M L⁻ᵀ`.
    fn seen_from(self, root: &Root) -> Self {
        let ii = self.ii / (root.ii * root.ii);
        let ij = self.ij / root.ii - root.ji * ii;
        let jj = self.jj - 2.0 * root.ji * (self.ij / root.ii) + root.ji * root.ji * ii;
        Self { ii, ij: ij / root.jj, jj: jj / (root.jj * root.jj) }
    }

    /// `L M Lᵀ`.
    fn seen_in(self, root: &Root) -> Self {
        let ij = root.ji * self.ii + root.jj * self.ij;
        Self {
            ii: root.ii * root.ii * self.ii,
            ij: root.ii * ij,
            jj: root.ji * (ij + root.jj * self.ij) + root.jj * root.jj * self.jj,
        }
    }

    /// With every eigenvalue at least `least`; `None` if that is so already.
    fn raised(self, least: f64) -> Option<Self> {
        let (mean, half) = (0.5 * (self.ii + self.jj), 0.5 * (self.ii - self.jj));
        let radius = half.hypot(self.ij);
        if mean - radius >= least {
            return None;
        }
        let (low, high) = ((mean - radius).max(least), (mean + radius).max(least));
        // Where both eigenvalues are one, there is no direction to keep.
        let stretch = if radius > 0.0 { 0.5 * (high - low) / radius } else { 0.0 };
        let mean = 0.5 * (high + low);
        Some(Self { ii: mean + stretch * half, ij: stretch * self.ij, jj: mean - stretch * half })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANGLES: [f64; 3] = [4e-4, 3.13, 8.9e-3];
    const METRIC: [f64; 3] = [6.32e3, 11.7, 13.0];

    /// `Q(δ)` on changes that keep the sum.
    fn quadratic(l: [f64; 3], a: f64, b: f64) -> f64 {
        l[0] * a * a + l[1] * (a + b) * (a + b) + l[2] * b * b
    }

    #[test]
    fn a_convex_form_is_left_alone() {
        assert_eq!(convex([-1.0, 5.0, 6.0], [2.0; 3], [1.0, 1.1, 1.04], 1e-2), None);
    }

    #[test]
    fn what_is_made_convex_is_at_least_the_share_of_the_metric() {
        let cases = [
            ([-3.87e5, 1.46e4, -1.51e4], METRIC, ANGLES),
            ([-1.0, 0.5, -2.0], [1.0, 2.0, 3.0], [1.0, 1.1, 1.04]),
            ([-1.0; 3], [1.0; 3], [1.0, 1.1, 1.04]),
        ];
        for (exact, metric, angles) in cases {
            let raised = convex(exact, metric, angles, 1e-2).expect("not convex");
            for turn in 0..60 {
                let (b, a) = (0.1 * f64::from(turn)).sin_cos();
                let (a, b) = (a * angles[0], b * angles[2]);
                let (q, g) = (quadratic(raised, a, b), quadratic(metric, a, b));
                assert!(q >= 0.99e-2 * g, "{exact:?}: {q} against {g}");
                assert!(q >= quadratic(exact, a, b) - 1e-9 * q.abs().max(g), "{exact:?}");
            }
        }
    }

    /// The direction in which a cap shrinks as a whole keeps a small curvature; raising entries to zero would leave the
    /// one positive entry, 1.16 here.
    #[test]
    fn the_shared_direction_of_a_cap_stays_soft() {
        let raised = convex([-3.87e5, 1.46e4, -1.51e4], METRIC, ANGLES, 1e-2).expect("not convex");
        assert!(quadratic(raised, ANGLES[0], ANGLES[2]) < 0.05);
    }
}
