//! The stopping rules of `krylov`, on MINRES.

use super::*;
use crate::test_support::{Random, grid_matrix, symmetric, with_threads};
use crate::{Identity, Jacobi, SymbolicCholesky, SymmetricMatrix, minres};
use std::sync::Arc;

fn params(relative_tolerance: f64) -> KrylovParams {
    KrylovParams { relative_tolerance, max_iterations: 5000 }
}

fn product(a: &dyn LinOp, x: &[f64]) -> Vec<f64> {
    let mut b = vec![0.0; x.len()];
    a.apply(x, &mut b);
    b
}

/// A positive definite grid whose unknowns are scaled by up to `contrast`.
fn scaled_grid(n: usize, contrast: f64) -> (SymmetricMatrix<f64>, Vec<f64>) {
    let mut a = grid_matrix(n, 4.01, -1.0);
    let mut random = Random::new(3);
    let scale: Vec<f64> = (0..n * n).map(|_| contrast.powf((random.next() + 1.0) / 2.0)).collect();
    for j in 0..n * n {
        for k in a.pattern().column(j) {
            a.values[k] *= scale[j] * scale[a.pattern().rows[k] as usize];
        }
    }
    let diagonal = scale.iter().map(|s| 4.01 * s * s).collect();
    (a, diagonal)
}

#[test]
fn three_unknowns_by_hand() {
    let a = symmetric(3, &[(0, 0, 2.0), (1, 1, 2.0), (2, 2, 2.0), (1, 0, -1.0), (2, 1, -1.0)]);
    let mut x = [0.0; 3];
    let stats = minres(&a, &Identity, &[1.0, 0.0, 1.0], &mut x, &params(1e-12), &mut |_, _| true);
    assert_eq!(stats.end, KrylovEnd::Converged);
    // Two eigenvectors are in b: two steps.
    assert!(stats.iterations <= 2, "{stats:?}");
    assert!(x.iter().all(|v| (v - 1.0).abs() < 1e-12), "{x:?}");
}

#[test]
fn recovers_a_planted_solution_from_any_start() {
    let a = grid_matrix(30, 4.1, -1.0);
    let planted = Random::new(5).vector(900);
    let b = product(&a, &planted);
    for mut x in [vec![0.0; 900], Random::new(6).vector(900), vec![1e6; 900]] {
        let stats = minres(&a, &Identity, &b, &mut x, &params(1e-10), &mut |_, _| true);
        assert_eq!(stats.end, KrylovEnd::Converged);
        assert!(stats.relative_residual <= 2e-10);
        assert!(x.iter().zip(&planted).all(|(u, v)| (u - v).abs() < 1e-7));
    }
}

#[test]
fn the_solution_is_that_of_a_factorisation() {
    let (a, diagonal) = scaled_grid(25, 10.0);
    let c = Jacobi::new(&diagonal).expect("positive");
    let b = Random::new(8).vector(625);
    let mut x = vec![0.0; 625];
    let stats = minres(&a, &c, &b, &mut x, &params(1e-12), &mut |_, _| true);
    assert_eq!(stats.end, KrylovEnd::Converged, "{stats:?}");
    let factor = SymbolicCholesky::analyse(Arc::clone(a.pattern())).expect("fits").factorise(&a).expect("positive");
    let mut y = vec![0.0; 625];
    factor.apply(&b, &mut y);
    let largest = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    assert!(x.iter().zip(&y).all(|(u, v)| (u - v).abs() < 1e-8 * largest));
}

#[test]
fn a_preconditioner_saves_iterations_and_an_exact_one_nearly_all() {
    let (a, diagonal) = scaled_grid(25, 100.0);
    let jacobi = Jacobi::new(&diagonal).expect("positive");
    let symbolic = SymbolicCholesky::analyse(Arc::clone(a.pattern())).expect("an analysis");
    let exact = symbolic.factorise(&a).expect("positive definite");
    let b = product(&a, &Random::new(9).vector(625));
    let solve = |c: &dyn Preconditioner| {
        let stats = minres(&a, c, &b, &mut vec![0.0; 625], &params(1e-8), &mut |_, _| true);
        assert_eq!(stats.end, KrylovEnd::Converged, "{stats:?}");
        stats.iterations
    };
    let (none, some, all) = (solve(&Identity), solve(&jacobi), solve(&exact));
    assert!(some * 3 < none, "{some} of {none}");
    assert!(all <= 2, "{all}");
}

#[test]
fn go_on_is_called_once_per_iteration_and_can_stop() {
    let a = grid_matrix(20, 4.01, -1.0);
    let b = Random::new(4).vector(400);
    let mut seen = Vec::new();
    let mut x = vec![0.0; 400];
    let stats = minres(&a, &Identity, &b, &mut x, &params(1e-12), &mut |iteration, estimate| {
        seen.push((iteration, estimate));
        iteration < 7
    });
    assert_eq!((stats.end, stats.iterations), (KrylovEnd::Interrupted, 7));
    assert!(seen.iter().map(|s| s.0).eq(1..=7));
    assert_eq!(stats.estimate, seen[6].1);
    assert!(stats.relative_residual < 1.0 && stats.relative_residual > 1e-12);
}

#[test]
fn iterations_run_out() {
    let a = grid_matrix(20, 4.01, -1.0);
    let b = Random::new(4).vector(400);
    for max_iterations in [0, 5] {
        let few = KrylovParams { relative_tolerance: 1e-12, max_iterations };
        let stats = minres(&a, &Identity, &b, &mut vec![0.0; 400], &few, &mut |_, _| true);
        assert_eq!((stats.end, stats.iterations), (KrylovEnd::MaxIterations, max_iterations));
    }
}

#[test]
fn an_unreachable_tolerance_ends_without_a_claim() {
    let (a, _) = scaled_grid(10, 1e3);
    let b = Random::new(2).vector(100);
    let stats = minres(&a, &Identity, &b, &mut vec![0.0; 100], &params(1e-30), &mut |_, _| true);
    assert_ne!(stats.end, KrylovEnd::Converged);
    assert!(stats.relative_residual > 1e-30 && stats.relative_residual < 1e-9, "{stats:?}");
}

#[test]
fn a_nan_breaks_down_and_leaves_the_start() {
    let mut a = grid_matrix(5, 4.5, -1.0);
    a.values[7] = f64::NAN;
    let mut x = vec![0.25; 25];
    let stats = minres(&a, &Identity, &[1.0; 25], &mut x, &params(1e-8), &mut |_, _| true);
    assert_eq!((stats.end, stats.iterations), (KrylovEnd::Breakdown, 0));
    assert!(stats.relative_residual.is_nan());
    assert_eq!(x, [0.25; 25]);
}

#[test]
fn a_nan_on_the_right_breaks_down() {
    let a = grid_matrix(5, 4.5, -1.0);
    let mut b = vec![1.0; 25];
    b[3] = f64::NAN;
    let mut x = vec![0.0; 25];
    let stats = minres(&a, &Identity, &b, &mut x, &params(1e-8), &mut |_, _| true);
    assert_eq!((stats.end, x), (KrylovEnd::Breakdown, vec![0.0; 25]));
}

#[test]
fn a_preconditioner_that_is_not_positive_definite_breaks_down() {
    struct Negative;
    impl Preconditioner for Negative {
        fn apply(&self, r: &[f64], out: &mut [f64]) {
            out.iter_mut().zip(r).for_each(|(o, r)| *o = -r);
        }
    }
    let a = grid_matrix(5, 4.5, -1.0);
    let stats = minres(&a, &Negative, &[1.0; 25], &mut [0.0; 25], &params(1e-8), &mut |_, _| true);
    assert_eq!((stats.end, stats.relative_residual), (KrylovEnd::Breakdown, 1.0));
}

#[test]
fn a_zero_right_hand_side_has_the_zero_solution() {
    let a = grid_matrix(5, 4.5, -1.0);
    let mut x = vec![1.0; 25];
    let stats = minres(&a, &Identity, &[0.0; 25], &mut x, &params(1e-8), &mut |_, _| true);
    assert_eq!((stats.end, stats.iterations, stats.relative_residual), (KrylovEnd::Converged, 0, 0.0));
    assert_eq!(x, [0.0; 25]);
}

#[test]
fn a_start_that_is_the_solution_takes_no_iteration() {
    let a = grid_matrix(5, 4.5, -1.0);
    let planted = Random::new(1).vector(25);
    let b = product(&a, &planted);
    let mut x = planted.clone();
    let stats = minres(&a, &Identity, &b, &mut x, &params(1e-12), &mut |_, _| true);
    assert_eq!((stats.end, stats.iterations), (KrylovEnd::Converged, 0));
    assert_eq!(x, planted);
}

#[test]
fn a_system_without_unknowns_is_solved() {
    let a = symmetric(0, &[]);
    let stats = minres(&a, &Identity, &[], &mut [], &params(1e-8), &mut |_, _| true);
    assert_eq!((stats.end, stats.iterations), (KrylovEnd::Converged, 0));
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    // Long enough for sums and updates to be shared among threads.
    let n = 270;
    let a = grid_matrix(n, 4.01, -1.0);
    let b = Random::new(11).vector(n * n);
    let few = KrylovParams { relative_tolerance: 1e-12, max_iterations: 15 };
    let solve = || {
        let mut x = vec![0.0; n * n];
        let stats = minres(&a, &Identity, &b, &mut x, &few, &mut |_, _| true);
        (stats, x)
    };
    let one = with_threads(1, solve);
    assert!([2, 3].iter().all(|&threads| with_threads(threads, solve) == one));
}
