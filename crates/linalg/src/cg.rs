//! Conjugate gradients: Hestenes and Stiefel, *Methods of Conjugate Gradients for Solving Linear
//! Systems*, J. Res. Nat. Bur. Standards 49 (1952).

use crate::krylov::{self, KrylovParams, KrylovStats, Recursion, Step};
use crate::vector::{axpy, dot, norm, xpay};
use crate::{LinOp, Preconditioner};

/// Solves `A x = b` for a symmetric positive definite `A` by preconditioned conjugate gradients.
///
/// `x` is the start on entry (zeros will do) and the result on return. `go_on(iteration, estimate)`
/// is called once per iteration; `false` stops. Every iterate minimises the energy
/// `½⟨x, Ax⟩ − ⟨b, x⟩` over the directions seen so far; the estimate is the 2-norm of the residual's
/// recursion, relative to `b`.
///
/// [`KrylovEnd::Converged`](crate::KrylovEnd::Converged) is returned only if the true residual meets
/// the tolerance: see [`KrylovParams::relative_tolerance`]. A zero right-hand side has the solution
/// zero, whatever the start.
///
/// # Panics
/// If a vector is not as long as the operator is wide.
pub fn cg(
    a: &dyn LinOp,
    c: &dyn Preconditioner,
    b: &[f64],
    x: &mut [f64],
    params: &KrylovParams,
    go_on: &mut dyn FnMut(usize, f64) -> bool,
) -> KrylovStats {
    krylov::solve::<ConjugateGradients>(a, c, b, x, params, go_on)
}

struct ConjugateGradients {
    /// The residual, by recursion.
    r: Vec<f64>,
    /// `z = C⁻¹ r`.
    z: Vec<f64>,
    /// The search direction, `A`-orthogonal to all before.
    p: Vec<f64>,
    /// `A p`.
    ap: Vec<f64>,
    /// `⟨r, z⟩`.
    rz: f64,
}

impl Recursion for ConjugateGradients {
    fn start(c: &dyn Preconditioner, residual: &[f64]) -> Self {
        let r = residual.to_vec();
        let mut z = vec![0.0; r.len()];
        c.apply(&r, &mut z);
        Self { p: z.clone(), ap: vec![0.0; r.len()], rz: dot(&r, &z), r, z }
    }

    fn step(&mut self, a: &dyn LinOp, c: &dyn Preconditioner, x: &mut [f64]) -> Step {
        a.apply(&self.p, &mut self.ap);
        let curvature = dot(&self.p, &self.ap);
        if !(self.rz > 0.0 && curvature.is_finite()) {
            return Step::Broken;
        }
        if curvature <= 0.0 {
            return Step::NegativeCurvature;
        }
        // The length of the step that minimises the energy along p.
        let alpha = self.rz / curvature;
        if !alpha.is_finite() {
            return Step::Broken;
        }
        axpy(alpha, &self.p, x);
        axpy(-alpha, &self.ap, &mut self.r);
        c.apply(&self.r, &mut self.z);
        let before = std::mem::replace(&mut self.rz, dot(&self.r, &self.z));
        xpay(&self.z, self.rz / before, &mut self.p);
        Step::Taken
    }

    fn residual_norm(&self) -> f64 {
        norm(&self.r)
    }

    fn norm(_: &dyn Preconditioner, v: &[f64]) -> f64 {
        norm(v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{grid_matrix, symmetric};
    use crate::{Identity, KrylovEnd};

    const PARAMS: KrylovParams = KrylovParams { relative_tolerance: 1e-10, max_iterations: 1000 };

    #[test]
    fn negative_curvature_is_met_at_once_along_a_negative_eigenvector() {
        let a = symmetric(2, &[(0, 0, 1.0), (1, 1, -1.0)]);
        let mut x = [0.0; 2];
        let stats = cg(&a, &Identity, &[0.0, 1.0], &mut x, &PARAMS, &mut |_, _| true);
        assert_eq!((stats.end, stats.iterations), (KrylovEnd::NegativeCurvature, 0));
        assert_eq!((x, stats.relative_residual), ([0.0; 2], 1.0));
    }

    #[test]
    fn negative_curvature_leaves_the_last_iterate() {
        // The eigenvalues of the grid are 4 − 2cos − 2cos, shifted by −0.5: few are negative, and
        // the first direction does not see them.
        let a = grid_matrix(12, 3.5, -1.0);
        let b: Vec<f64> = (0..144).map(|i| f64::from(i * i % 7) - 3.0).collect();
        let mut iterates = 0;
        let mut x = vec![0.0; 144];
        let stats = cg(&a, &Identity, &b, &mut x, &PARAMS, &mut |iteration, _| {
            iterates = iteration;
            true
        });
        assert_eq!(stats.end, KrylovEnd::NegativeCurvature);
        assert!(stats.iterations > 0 && stats.iterations == iterates, "{stats:?}");

        let mut same = vec![0.0; 144];
        let stop = KrylovParams { max_iterations: iterates, ..PARAMS };
        let stopped = cg(&a, &Identity, &b, &mut same, &stop, &mut |_, _| true);
        assert_eq!(stopped.end, KrylovEnd::MaxIterations);
        assert_eq!(x, same);
        assert_eq!(stopped.relative_residual, stats.relative_residual);
    }
}
