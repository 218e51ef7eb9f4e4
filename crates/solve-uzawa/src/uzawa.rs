//! The algorithm of VMV04 §7.2, as it should be read.
//!
//! ```text
//! A x + Bᵀ λ = f        solved with A⁻¹ and products with B and Bᵀ only.
//! B x        = g
//! ```
//!
//! The listing, with `C = I` where the paper has no preconditioner:
//!
//! ```text
//! x = A⁻¹(f − Bᵀλ);  q = g − Bx;  d = −C⁻¹q
//! repeat:  p = Bᵀd;  h = A⁻¹p;  α = ⟨q, C⁻¹q⟩ / ⟨p, h⟩
//!          λ ← λ + αd;  x ← x − αh;  q⁺ = g − Bx
//!          β = ⟨q⁺, C⁻¹q⁺⟩ / ⟨q, C⁻¹q⟩;  d ← −C⁻¹q⁺ + βd
//! ```
//!
//! It differs from the printed one in three slips of the print:
//!
//! * `d₀ = Bu₀ − g` is printed; there is no `u`, and `x₀` is meant.
//! * `d_{k+1} = −q_{k+1} − β_k d_k` is printed. The directions `Bᵀd` are conjugate in `A⁻¹` with `+β_k`
//!   only; with the minus the method creeps.
//! * Equation (8) factors the saddle-point matrix with `M = BA⁻¹Bᵀ`. The factorisation holds with
//!   `M = −BA⁻¹Bᵀ`, which is why the whole matrix is indefinite even where `A` and `BA⁻¹Bᵀ` are positive.
//!
//! It is conjugate gradients on `BA⁻¹Bᵀ λ = BA⁻¹f − g`, whose residual is `−q`. So it needs that
//! matrix positive definite: `⟨p, h⟩ = ⟨d, BA⁻¹Bᵀ d⟩ ≤ 0` ends it.

use abf_linalg::{KrylovEnd, KrylovParams, KrylovStats, Preconditioner};

/// A saddle-point matrix `[A Bᵀ; B 0]`, `A` symmetric and easy to invert.
pub trait SaddlePoint {
    /// The lengths of `x` and of `λ`.
    fn sizes(&self) -> (usize, usize);
    /// `out = A⁻¹ p`.
    fn solve_a(&self, p: &[f64], out: &mut [f64]);
    /// `out = B x`.
    fn multiply_b(&self, x: &[f64], out: &mut [f64]);
    /// `out = Bᵀ λ`.
    fn multiply_b_transposed(&self, lambda: &[f64], out: &mut [f64]);
}

/// What the two block rows shall be equal to.
#[derive(Clone, Copy, Debug)]
pub struct RightHandSide<'a> {
    /// `A x + Bᵀ λ`.
    pub f: &'a [f64],
    /// `B x`.
    pub g: &'a [f64],
}

/// The two parts of a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknowns {
    /// `x`.
    pub x: Vec<f64>,
    /// `λ`.
    pub lambda: Vec<f64>,
}

/// The result counts as converged up to this multiple of the tolerance: the last bits of a residual
/// are not worth another start.
const SLACK: f64 = 2.0;

/// A new start must leave at most this part of the true residual, or it is the last.
const PROGRESS: f64 = 0.5;

/// Solves a saddle-point system by conjugate directions from `λ = 0`, with a positive definite
/// preconditioner `c` of `BA⁻¹Bᵀ` ([`abf_linalg::Identity`] as published).
///
/// Stops when `‖q‖ / ‖q₀‖`, `q = g − Bx`, is at most the tolerance. On return `x` is computed from `λ`
/// anew, so the first block row holds to rounding, and [`KrylovStats::relative_residual`] is that of
/// this `x`; the `x` carried along may have drifted from it, and where that cost the tolerance the
/// method starts anew. [`KrylovStats::estimate`] is what the carried `x` claimed first, which is the
/// paper's test. `go_on(iteration, estimate)` is called once per iteration; `false` stops.
///
/// # Panics
/// If a vector is not of the length the system asks for.
pub fn uzawa(
    system: &dyn SaddlePoint,
    c: &dyn Preconditioner,
    rhs: RightHandSide<'_>,
    params: &KrylovParams,
    go_on: &mut dyn FnMut(usize, f64) -> bool,
) -> (Unknowns, KrylovStats) {
    let mut run = UzawaRun::new(system, c, rhs);
    let scale = run.start();
    let mut stats = KrylovStats { iterations: 0, relative_residual: 0.0, estimate: 0.0, end: KrylovEnd::Converged };
    if scale == 0.0 {
        return (run.unknowns, stats);
    }
    (stats.relative_residual, stats.estimate) = (1.0, 1.0);
    let mut first_claim = None;
    loop {
        let before = stats.relative_residual;
        stats.end = run.sweep(scale, params, &mut stats, go_on);
        stats.relative_residual = run.start() / scale;
        let has_claimed = stats.end == KrylovEnd::Converged;
        if has_claimed {
            first_claim.get_or_insert(stats.estimate);
        }
        if stats.relative_residual <= SLACK * params.relative_tolerance {
            stats.end = KrylovEnd::Converged;
            break;
        }
        if !has_claimed {
            break;
        }
        // NaN compares false and is no progress.
        if !(stats.relative_residual <= PROGRESS * before) {
            stats.end = KrylovEnd::Breakdown;
            break;
        }
    }
    stats.estimate = first_claim.unwrap_or(stats.estimate);
    (run.unknowns, stats)
}

/// The vectors of the listing.
struct UzawaRun<'a> {
    system: &'a dyn SaddlePoint,
    c: &'a dyn Preconditioner,
    rhs: RightHandSide<'a>,
    unknowns: Unknowns,
    /// `g − Bx`.
    q: Vec<f64>,
    /// `C⁻¹ q`.
    z: Vec<f64>,
    /// The direction in `λ`.
    d: Vec<f64>,
    /// `Bᵀ d`.
    p: Vec<f64>,
    /// `A⁻¹ p`, the direction in `x`.
    h: Vec<f64>,
    /// `⟨q, C⁻¹ q⟩`.
    qz: f64,
}

impl<'a> UzawaRun<'a> {
    fn new(system: &'a dyn SaddlePoint, c: &'a dyn Preconditioner, rhs: RightHandSide<'a>) -> Self {
        let (n, m) = system.sizes();
        assert!(rhs.f.len() == n && rhs.g.len() == m, "a right-hand side of this system");
        let ([x, p, h], [lambda, q, z, d]) = ([0; 3].map(|_| vec![0.0; n]), [0; 4].map(|_| vec![0.0; m]));
        Self { system, c, rhs, unknowns: Unknowns { x, lambda }, q, z, d, p, h, qz: 0.0 }
    }

    /// The first line of the listing: everything from `λ` alone. Returns `‖q‖`.
    fn start(&mut self) -> f64 {
        self.system.multiply_b_transposed(&self.unknowns.lambda, &mut self.p);
        self.p.iter_mut().zip(self.rhs.f).for_each(|(p, f)| *p = f - *p);
        self.system.solve_a(&self.p, &mut self.unknowns.x);
        self.measure();
        self.d.iter_mut().zip(&self.z).for_each(|(d, z)| *d = -z);
        dot(&self.q, &self.q).sqrt()
    }

    /// `q = g − Bx` and what is derived from it.
    fn measure(&mut self) {
        self.system.multiply_b(&self.unknowns.x, &mut self.q);
        self.q.iter_mut().zip(self.rhs.g).for_each(|(q, g)| *q = g - *q);
        self.c.apply(&self.q, &mut self.z);
        self.qz = dot(&self.q, &self.z);
    }

    /// Steps until the carried `x` claims convergence or something ends it.
    fn sweep(
        &mut self,
        scale: f64,
        params: &KrylovParams,
        stats: &mut KrylovStats,
        go_on: &mut dyn FnMut(usize, f64) -> bool,
    ) -> KrylovEnd {
        while stats.iterations < params.max_iterations {
            if let Err(end) = self.step() {
                return end;
            }
            stats.iterations += 1;
            stats.estimate = dot(&self.q, &self.q).sqrt() / scale;
            let is_wanted = go_on(stats.iterations, stats.estimate);
            if stats.estimate <= params.relative_tolerance {
                return KrylovEnd::Converged;
            }
            if !is_wanted {
                return KrylovEnd::Interrupted;
            }
        }
        KrylovEnd::MaxIterations
    }

    /// One round of the listing; changes nothing when it fails.
    fn step(&mut self) -> Result<(), KrylovEnd> {
        self.system.multiply_b_transposed(&self.d, &mut self.p);
        self.system.solve_a(&self.p, &mut self.h);
        let curvature = dot(&self.p, &self.h);
        if !(self.qz > 0.0 && self.qz.is_finite() && curvature.is_finite()) {
            return Err(KrylovEnd::Breakdown);
        }
        if curvature <= 0.0 {
            return Err(KrylovEnd::NegativeCurvature);
        }
        let alpha = self.qz / curvature;
        self.unknowns.lambda.iter_mut().zip(&self.d).for_each(|(l, d)| *l += alpha * d);
        self.unknowns.x.iter_mut().zip(&self.h).for_each(|(x, h)| *x -= alpha * h);
        let before = self.qz;
        self.measure();
        let beta = self.qz / before;
        self.d.iter_mut().zip(&self.z).for_each(|(d, z)| *d = beta * *d - z);
        Ok(())
    }
}

/// `Σ xᵢ yᵢ`, summed in one run. `abf_linalg::vector::dot` sums in chunks: other bits from 4097 elements on.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_linalg::{Identity, Jacobi};
    use nalgebra::{DMatrix, DVector};

    /// Dense `A⁻¹` and `B`.
    struct Dense {
        a_inverse: DMatrix<f64>,
        b: DMatrix<f64>,
    }

    impl Dense {
        fn new(a: DMatrix<f64>, b: DMatrix<f64>) -> Self {
            Self { a_inverse: a.try_inverse().expect("regular"), b }
        }
    }

    fn multiply(matrix: &DMatrix<f64>, x: &[f64], out: &mut [f64]) {
        out.copy_from_slice((matrix * DVector::from_column_slice(x)).as_slice());
    }

    impl SaddlePoint for Dense {
        fn sizes(&self) -> (usize, usize) {
            (self.b.ncols(), self.b.nrows())
        }

        fn solve_a(&self, p: &[f64], out: &mut [f64]) {
            multiply(&self.a_inverse, p, out);
        }

        fn multiply_b(&self, x: &[f64], out: &mut [f64]) {
            multiply(&self.b, x, out);
        }

        fn multiply_b_transposed(&self, lambda: &[f64], out: &mut [f64]) {
            multiply(&self.b.transpose(), lambda, out);
        }
    }

    /// `minimise x₁² + 2x₂² − 2x₁ subject to x₁ + x₂ = 3`: the matrix is 3 × 3. The multiplier makes
    /// `2x₁ + λ = 2` and `4x₂ + λ = 0`, so `x = (7/3, 2/3)`, `λ = −8/3`.
    #[test]
    fn a_three_by_three_matrix_is_solved_in_one_step() {
        let system =
            Dense::new(DMatrix::from_diagonal(&DVector::from_vec(vec![2.0, 4.0])), DMatrix::from_element(1, 2, 1.0));
        let rhs = RightHandSide { f: &[2.0, 0.0], g: &[3.0] };
        let mut seen = Vec::new();
        let (solution, stats) = uzawa(&system, &Identity, rhs, &KrylovParams::default(), &mut |i, estimate| {
            seen.push((i, estimate));
            true
        });
        assert_eq!((stats.iterations, stats.end), (1, KrylovEnd::Converged));
        assert_eq!(seen.len(), 1);
        assert!((solution.x[0] - 7.0 / 3.0).abs() < 1e-15 && (solution.x[1] - 2.0 / 3.0).abs() < 1e-15);
        assert!((solution.lambda[0] + 8.0 / 3.0).abs() < 1e-15);
    }

    /// `n` unknowns under `m` constraints; `A` is diagonal with these entries or full around them.
    fn planted(
        n: usize,
        m: usize,
        a: impl Fn(usize) -> f64,
        coupling: f64,
    ) -> (Dense, Vec<f64>, Vec<f64>, DVector<f64>) {
        let entry = |i: usize, k: usize| (1.7 * i as f64 + 0.6 * (i * k) as f64 + 2.3 * k as f64).sin();
        let a = DMatrix::from_fn(n, n, |i, k| if i == k { a(i) } else { coupling * entry(i.min(k), i.max(k)) });
        let b = DMatrix::from_fn(m, n, |i, k| entry(i + 40, k));
        let mut kkt = DMatrix::zeros(n + m, n + m);
        kkt.view_mut((0, 0), (n, n)).copy_from(&a);
        kkt.view_mut((n, 0), (m, n)).copy_from(&b);
        kkt.view_mut((0, n), (n, m)).copy_from(&b.transpose());
        let rhs = DVector::from_fn(n + m, |i, _| (0.9 * i as f64).cos());
        let (f, g) = (rhs.rows(0, n).as_slice().to_vec(), rhs.rows(n, m).as_slice().to_vec());
        let solution = kkt.lu().solve(&rhs).expect("regular");
        (Dense::new(a, b), f, g, solution)
    }

    #[test]
    fn agrees_with_a_dense_solve_with_and_without_preconditioner() {
        for (n, m, coupling) in [(5, 3, 0.0), (12, 7, 0.1), (30, 12, 0.05)] {
            let (system, f, g, expected) = planted(n, m, |i| 2.0 + i as f64, coupling);
            let diagonal = (&system.b * &system.a_inverse * system.b.transpose()).diagonal();
            let jacobi = Jacobi::new(diagonal.as_slice()).expect("positive");
            let params = KrylovParams { relative_tolerance: 1e-13, max_iterations: 200 };
            for c in [&Identity as &dyn Preconditioner, &jacobi] {
                let (solution, stats) = uzawa(&system, c, RightHandSide { f: &f, g: &g }, &params, &mut |_, _| true);
                assert_eq!(stats.end, KrylovEnd::Converged);
                assert!(stats.relative_residual <= 2e-13);
                assert!(stats.iterations <= 2 * m, "conjugate directions end after {m} steps but for rounding");
                let found = solution.x.iter().chain(&solution.lambda);
                assert!(found.zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9));
            }
        }
    }

    #[test]
    fn the_residual_reported_is_that_of_the_result() {
        let (system, f, g, _) = planted(30, 12, |i| 1e-3 + i as f64, 0.0);
        let params = KrylovParams { relative_tolerance: 1e-10, max_iterations: 5 };
        let (solution, stats) = uzawa(&system, &Identity, RightHandSide { f: &f, g: &g }, &params, &mut |_, _| true);
        assert_eq!((stats.iterations, stats.end), (5, KrylovEnd::MaxIterations));
        let residual = |x: &[f64]| (DVector::from_column_slice(&g) - &system.b * DVector::from_column_slice(x)).norm();
        let mut start = vec![0.0; 30];
        system.solve_a(&f, &mut start);
        assert!((stats.relative_residual - residual(&solution.x) / residual(&start)).abs() < 1e-12);
    }

    #[test]
    fn negative_curvature_is_detected() {
        let (system, f, g, _) = planted(6, 4, |i| if i == 2 { -0.5 } else { 1.0 }, 0.0);
        let (solution, stats) =
            uzawa(&system, &Identity, RightHandSide { f: &f, g: &g }, &KrylovParams::default(), &mut |_, _| true);
        assert_eq!(stats.end, KrylovEnd::NegativeCurvature);
        assert!(solution.x.iter().all(|x| x.is_finite()));
    }

    #[test]
    fn an_interruption_ends_at_once() {
        let (system, f, g, _) = planted(30, 12, |i| 1.0 + i as f64, 0.0);
        let (_, stats) =
            uzawa(&system, &Identity, RightHandSide { f: &f, g: &g }, &KrylovParams::default(), &mut |i, _| i < 3);
        assert_eq!((stats.iterations, stats.end), (3, KrylovEnd::Interrupted));
    }

    #[test]
    fn constraints_that_hold_need_no_step() {
        let (system, f, _, _) = planted(5, 3, |_| 1.0, 0.0);
        let (mut x, mut g) = ([0.0; 5], [0.0; 3]);
        system.solve_a(&f, &mut x);
        system.multiply_b(&x, &mut g);
        let (solution, stats) =
            uzawa(&system, &Identity, RightHandSide { f: &f, g: &g }, &KrylovParams::default(), &mut |_, _| true);
        assert_eq!((stats.iterations, stats.end), (0, KrylovEnd::Converged));
        assert_eq!(solution.lambda, [0.0; 3]);
    }

    #[test]
    fn a_nan_is_a_breakdown() {
        let (system, f, _, _) = planted(5, 3, |_| 1.0, 0.0);
        let g = [0.0, f64::NAN, 0.0];
        let (_, stats) =
            uzawa(&system, &Identity, RightHandSide { f: &f, g: &g }, &KrylovParams::default(), &mut |_, _| true);
        assert_eq!(stats.end, KrylovEnd::Breakdown);
    }
}
