//! MINRES: Paige and Saunders, *Solution of Sparse Indefinite Systems of Linear Equations*, SIAM J.
//! Numer. Anal. 12 (1975); preconditioned as in Elman, Silvester, Wathen, *Finite Elements and Fast
//! Iterative Solvers* (2005).

use crate::krylov::{self, KrylovParams, KrylovStats, Recursion, Step};
use crate::vector::{axpy, dot, scale};
use crate::{LinOp, Preconditioner};
use std::mem::swap;

/// Solves `A x = b` for a symmetric `A`, indefinite or singular if `b` is in its range, by MINRES
/// with a positive definite preconditioner.
///
/// `x` is the start on entry (zeros will do) and the result on return. `go_on(iteration, estimate)`
/// is called once per iteration; `false` stops. Every iterate has the least `‖b − Ax‖_C⁻¹` over the
/// Krylov space so far; the estimate is that norm by recursion, relative to `b` in the same norm.
///
/// The estimate is not the residual. It is what the method would stop by if left alone, and can be
/// orders of magnitude below `‖b − Ax‖ / ‖b‖`: that norm weighs the residual by `C⁻¹`, and a long
/// recursion drifts. [`KrylovEnd::Converged`](crate::KrylovEnd::Converged) is returned only if the
/// true residual meets the tolerance; [`KrylovStats`] holds both numbers. A zero right-hand side has
/// the solution zero, whatever the start.
///
/// # Panics
/// If a vector is not as long as the operator is wide.
pub fn minres(
    a: &dyn LinOp,
    c: &dyn Preconditioner,
    b: &[f64],
    x: &mut [f64],
    params: &KrylovParams,
    go_on: &mut dyn FnMut(usize, f64) -> bool,
) -> KrylovStats {
    krylov::solve::<MinimalResidual>(a, c, b, x, params, go_on)
}

/// The Lanczos process turns `A` into a tridiagonal `T` with diagonal `δ` and off-diagonal `γ`;
/// plane rotations turn `T` into a triangle with three diagonals, one column per step; and the
/// columns of `Z R⁻¹` are the directions `w` in which `x` moves.
struct MinimalResidual {
    /// The last two Lanczos vectors, each `γ` times a unit vector in the norm of `C⁻¹`.
    v: [Vec<f64>; 2],
    /// `C⁻¹` of the last Lanczos vector.
    z: Vec<f64>,
    /// The norms `‖v‖_C⁻¹` of these two.
    gamma: [f64; 2],
    /// The last two directions.
    w: [Vec<f64>; 2],
    /// Cosines and sines of the last two rotations.
    c: [f64; 2],
    s: [f64; 2],
    /// The component of the rotated right-hand side that is still to be removed: up to its sign
    /// the residual in the norm of `C⁻¹`.
    eta: f64,
    /// Room for the next Lanczos vector, and for `C⁻¹` of it.
    next: Vec<f64>,
    next_z: Vec<f64>,
}

impl Recursion for MinimalResidual {
    fn start(c: &dyn Preconditioner, residual: &[f64]) -> Self {
        let zeros = vec![0.0; residual.len()];
        let mut z = zeros.clone();
        c.apply(residual, &mut z);
        let gamma = dot(residual, &z).sqrt();
        Self {
            v: [zeros.clone(), residual.to_vec()],
            z,
            gamma: [1.0, gamma],
            w: [zeros.clone(), zeros.clone()],
            c: [1.0; 2],
            s: [0.0; 2],
            eta: gamma,
            next: zeros.clone(),
            next_z: zeros,
        }
    }

    fn step(&mut self, a: &dyn LinOp, c: &dyn Preconditioner, x: &mut [f64]) -> Step {
        let [gamma_before, gamma] = self.gamma;
        if !(gamma > 0.0 && gamma.is_finite()) {
            return Step::Broken;
        }
        // Lanczos: the next vector is A z made orthogonal to the two before.
        scale(1.0 / gamma, &mut self.z);
        a.apply(&self.z, &mut self.next);
        let delta = dot(&self.next, &self.z);
        axpy(-gamma / gamma_before, &self.v[0], &mut self.next);
        axpy(-delta / gamma, &self.v[1], &mut self.next);

        // The new column of T: the two old rotations, then one that removes what is below the diagonal.
        c.apply(&self.next, &mut self.next_z);
        let gamma_next = dot(&self.next, &self.next_z).sqrt();
        let above_2 = self.s[0] * gamma;
        let above_1 = self.s[1] * delta + self.c[0] * self.c[1] * gamma;
        let unrotated = self.c[1] * delta - self.c[0] * self.s[1] * gamma;
        let diagonal = unrotated.hypot(gamma_next);
        if !(diagonal > 0.0 && diagonal.is_finite()) {
            return Step::Broken;
        }
        let (cosine, sine) = (unrotated / diagonal, gamma_next / diagonal);

        // w = (z − above₂ w₋₂ − above₁ w₋₁) / diagonal, and x moves along it.
        let [w_0, w_1] = &mut self.w;
        scale(-above_2, w_0);
        axpy(-above_1, w_1, w_0);
        axpy(1.0, &self.z, w_0);
        scale(1.0 / diagonal, w_0);
        axpy(cosine * self.eta, w_0, x);
        swap(w_0, w_1);

        self.eta *= -sine;
        self.c = [self.c[1], cosine];
        self.s = [self.s[1], sine];
        self.gamma = [gamma, gamma_next];
        swap(&mut self.z, &mut self.next_z);
        self.v.swap(0, 1);
        swap(&mut self.v[1], &mut self.next);
        Step::Taken
    }

    fn residual_norm(&self) -> f64 {
        self.eta.abs()
    }

    fn norm(c: &dyn Preconditioner, v: &[f64]) -> f64 {
        let mut z = vec![0.0; v.len()];
        c.apply(v, &mut z);
        dot(v, &z).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{Random, grid_matrix, mirrored, saddle_point, symmetric};
    use crate::{Identity, Jacobi, KrylovEnd};

    const PARAMS: KrylovParams = KrylovParams { relative_tolerance: 1e-9, max_iterations: 5000 };

    fn product(a: &dyn LinOp, x: &[f64]) -> Vec<f64> {
        let mut b = vec![0.0; x.len()];
        a.apply(x, &mut b);
        b
    }

    /// The Laplacian of a path: singular, with the constants as its kernel.
    fn path_laplacian(size: usize) -> crate::SymmetricMatrix<f64> {
        let end = |i| if i == 0 || i == size - 1 { 1.0 } else { 2.0 };
        let diagonal = (0..size).map(|i| (i, i, end(i)));
        symmetric(size, &diagonal.chain((1..size).map(|i| (i, i - 1, -1.0))).collect::<Vec<_>>())
    }

    #[test]
    fn an_indefinite_system_by_hand() {
        // [0 1 0; 1 0 0; 0 0 −2] (1, 2, 3) = (2, 1, −6)
        let a = symmetric(3, &[(0, 0, 0.0), (1, 0, 1.0), (2, 2, -2.0)]);
        let mut x = [0.0; 3];
        let stats = minres(&a, &Identity, &[2.0, 1.0, -6.0], &mut x, &PARAMS, &mut |_, _| true);
        assert_eq!(stats.end, KrylovEnd::Converged);
        assert!(stats.iterations <= 3);
        assert!(x.iter().zip([1.0, 2.0, 3.0]).all(|(u, v)| (u - v).abs() < 1e-12), "{x:?}");
    }

    #[test]
    fn recovers_a_planted_solution_of_an_indefinite_grid() {
        let a = grid_matrix(20, 1.7, -1.0);
        let planted = Random::new(3).vector(400);
        let mut x = vec![0.0; 400];
        let stats = minres(&a, &Identity, &product(&a, &planted), &mut x, &PARAMS, &mut |_, _| true);
        assert_eq!(stats.end, KrylovEnd::Converged, "{stats:?}");
        assert!(x.iter().zip(&planted).all(|(u, v)| (u - v).abs() < 1e-5));
    }

    #[test]
    fn solves_a_saddle_point_system() {
        let a = mirrored(280, &saddle_point(200, 80, 17));
        let planted = Random::new(3).vector(280);
        // Λ for the unknowns, the diagonal of J Λ⁻¹ Jᵀ roughly for the multipliers.
        let c = Jacobi::new(&[vec![1.5; 200], vec![10.0; 80]].concat()).expect("positive");
        let mut x = vec![0.0; 280];
        let stats = minres(&a, &c, &product(&a, &planted), &mut x, &PARAMS, &mut |_, _| true);
        assert_eq!(stats.end, KrylovEnd::Converged, "{stats:?}");
        assert!(x.iter().zip(&planted).all(|(u, v)| (u - v).abs() < 1e-6));
    }

    #[test]
    fn solves_a_singular_system_whose_right_hand_side_is_in_its_range() {
        let a = path_laplacian(60);
        let planted = Random::new(3).vector(60);
        let b = product(&a, &planted);
        for c in [&Identity as &dyn Preconditioner, &Jacobi::new(&[2.0; 60]).expect("positive")] {
            let mut x = vec![0.0; 60];
            let stats = minres(&a, c, &b, &mut x, &PARAMS, &mut |_, _| true);
            assert_eq!(stats.end, KrylovEnd::Converged, "{stats:?}");
            let shift = x[0] - planted[0];
            assert!(x.iter().zip(&planted).all(|(u, v)| (u - v - shift).abs() < 1e-6));
        }
    }

    #[test]
    fn a_right_hand_side_outside_the_range_is_never_converged() {
        let a = path_laplacian(60);
        let mut x = vec![0.0; 60];
        let stats = minres(&a, &Identity, &Random::new(3).vector(60), &mut x, &PARAMS, &mut |_, _| true);
        assert_ne!(stats.end, KrylovEnd::Converged, "{stats:?}");
        assert!(stats.relative_residual > 1e-3 && x.iter().all(|v| v.is_finite()), "{stats:?}");
    }

    #[test]
    fn the_estimate_never_rises() {
        let a = grid_matrix(20, 2.0, -1.0);
        let mut last = f64::INFINITY;
        minres(&a, &Identity, &Random::new(3).vector(400), &mut vec![0.0; 400], &PARAMS, &mut |_, estimate| {
            assert!(estimate <= last);
            last = estimate;
            true
        });
    }

    /// A preconditioner that hides half of the residual: its entries differ by `contrast`.
    fn lopsided(size: usize, contrast: f64) -> Jacobi {
        let diagonal: Vec<f64> = (0..size).map(|i| if i % 2 == 0 { 1.0 } else { contrast }).collect();
        Jacobi::new(&diagonal).expect("positive")
    }

    #[test]
    fn an_estimate_below_the_tolerance_is_not_convergence() {
        let a = grid_matrix(8, 4.01, -1.0);
        let c = lopsided(64, 1e8);
        let b = Random::new(5).vector(64);
        let tolerance = PARAMS.relative_tolerance;

        // Stopped where the recursion alone would stop.
        let mut x = vec![0.0; 64];
        let naive = minres(&a, &c, &b, &mut x, &PARAMS, &mut |_, estimate| estimate > tolerance);
        assert_eq!(naive.end, KrylovEnd::Interrupted);
        assert!(naive.estimate <= tolerance && naive.relative_residual > 100.0 * tolerance, "{naive:?}");

        // Left to itself it goes on, and remembers what it believed.
        let mut x = vec![0.0; 64];
        let stats = minres(&a, &c, &b, &mut x, &PARAMS, &mut |_, _| true);
        assert_eq!(stats.end, KrylovEnd::Converged, "{stats:?}");
        assert_eq!(stats.estimate, naive.estimate);
        assert!(stats.iterations > naive.iterations && stats.relative_residual <= 2.0 * tolerance);
    }

    #[test]
    fn no_preconditioner_buys_a_false_convergence() {
        let a = grid_matrix(8, 4.01, -1.0);
        let b = Random::new(5).vector(64);
        for exponent in 0..=30 {
            let c = lopsided(64, 10_f64.powi(exponent));
            let mut x = vec![0.0; 64];
            let stats = minres(&a, &c, &b, &mut x, &PARAMS, &mut |_, _| true);
            let mut truth = product(&a, &x);
            truth.iter_mut().zip(&b).for_each(|(t, b)| *t -= b);
            let truth = (dot(&truth, &truth) / dot(&b, &b)).sqrt();
            assert!((truth - stats.relative_residual).abs() <= 1e-12, "{stats:?}");
            assert!(stats.end != KrylovEnd::Converged || truth <= 2.0 * PARAMS.relative_tolerance, "{stats:?}");
        }
    }
}
