//! Conditions on the boundary, as rows and slacks behind those of the disk.
//!
//! An upper bound `Σ x ≤ b` becomes
//!
//! ```text
//! Σ x − b + κ s = 0,        0 < s < π,        κ = b/π,
//! ```
//!
//! so that the slack `s` stands behind the angles as one more unknown in (0, π), without a target: everything that keeps
//! angles inside keeps slacks inside. (`κ s < b` asks for `Σ x > 0`, which angles above 0 have anyway.) With its entry `Λ_s`
//! and its gradient `g_s`, eliminating it leaves
//!
//! ```text
//! B δ − (κ²/Λ_s) Δν = −(Σ x − b + κ s − κ g_s/Λ_s),        δ_s = −(g_s + κ Δν)/Λ_s.
//! ```
//!
//! A given sum has a row and no slack.

use abf_constraints::{AngleProblem, BoundaryConditions, WheelDerivative};
use abf_solve_core::add_transposed_product;
use std::f64::consts::PI;

/// How many of the unknowns are angles; slacks follow.
pub(crate) fn corner_count(problem: &AngleProblem<'_>) -> usize {
    problem.topology().corner_count()
}

/// How many rows there are, those of the boundary included.
pub(crate) fn row_count(problem: &AngleProblem<'_>) -> usize {
    problem.rows().len() + problem.boundary().map_or(0, BoundaryConditions::len)
}

/// The conditions that have slacks.
fn with_slacks<'p>(problem: &'p AngleProblem<'_>) -> Option<&'p BoundaryConditions> {
    problem.boundary().filter(|conditions| !conditions.are_equations())
}

/// Puts the slacks behind angles: what is left to the bounds, within them.
pub(crate) fn append(problem: &AngleProblem<'_>, angles: &mut Vec<f64>) {
    let Some(conditions) = with_slacks(problem) else { return };
    let room = conditions.residual(problem.topology(), angles).into_iter().zip(conditions.bounds());
    let slacks: Vec<f64> = room.map(|(r, b)| (-r * PI / b).clamp(0.0, PI)).collect();
    angles.extend(slacks);
}

/// The rows of the boundary at these unknowns.
pub(crate) fn residual(problem: &AngleProblem<'_>, unknowns: &[f64]) -> Vec<f64> {
    let Some(conditions) = problem.boundary() else { return Vec::new() };
    let (angles, slacks) = unknowns.split_at(corner_count(problem));
    let mut rows = conditions.residual(problem.topology(), angles);
    let shares = slacks.iter().zip(conditions.bounds()).map(|(s, b)| s * b / PI);
    rows.iter_mut().zip(shares).for_each(|(row, share)| *row += share);
    rows
}

/// `out += Jᵀ λ`, the rows of the boundary and the slacks included.
pub(crate) fn add_transposed(
    problem: &AngleProblem<'_>,
    wheel: &WheelDerivative,
    multipliers: &[f64],
    out: &mut [f64],
) {
    add_transposed_product(problem.topology(), problem.rows(), wheel, multipliers, out);
    let Some(conditions) = problem.boundary() else { return };
    let of_boundary = &multipliers[problem.rows().len()..];
    for (&v, multiplier) in conditions.vertices().iter().zip(of_boundary) {
        problem.topology().fan(v).for_each(|c| out[c.index()] += multiplier);
    }
    let slacks = out[corner_count(problem)..].iter_mut();
    slacks.zip(of_boundary).zip(conditions.bounds()).for_each(|((g, m), b)| *g += m * b / PI);
}

/// The rows of the boundary once the slacks are eliminated: what is left of them, and the compliance.
pub(crate) fn eliminated(
    problem: &AngleProblem<'_>,
    lambda: &[f64],
    gradient: &[f64],
    residual: &[f64],
) -> (Vec<f64>, Vec<f64>) {
    let rows = residual[problem.rows().len()..].to_vec();
    let Some(conditions) = with_slacks(problem) else { return (rows, Vec::new()) };
    let (lambda, gradient) = (&lambda[corner_count(problem)..], &gradient[corner_count(problem)..]);
    let share = |j: usize| conditions.bounds()[j] / PI;
    let left = rows.iter().enumerate().map(|(j, r)| r - share(j) * gradient[j] / lambda[j]).collect();
    (left, (0..rows.len()).map(|j| share(j).powi(2) / lambda[j]).collect())
}

/// Puts the steps of the slacks behind those of the angles, from the multipliers' changes.
pub(crate) fn append_steps(
    problem: &AngleProblem<'_>,
    lambda: &[f64],
    gradient: &[f64],
    changes: &[f64],
    delta: &mut Vec<f64>,
) {
    let Some(conditions) = with_slacks(problem) else { return };
    let (lambda, gradient) = (&lambda[corner_count(problem)..], &gradient[corner_count(problem)..]);
    let step = |j: usize| -(gradient[j] + changes[j] * conditions.bounds()[j] / PI) / lambda[j];
    delta.extend((0..conditions.len()).map(step));
}
