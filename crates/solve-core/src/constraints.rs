//! What several solvers ask of the constraints at their angles.

use abf_constraints::{
    AngleProblem, ConstraintRows, RESIDUAL_CLAMP, TriangleRows, WheelDerivative, largest, max_residual,
};
use abf_mesh::Topology;
use std::f64::consts::PI;

/// `max |h|` of the constraints in the log form, rad.
///
/// `residual` holds the constraints at these angles. They are evaluated again only where an angle is outside
/// `[1e-9, π − 1e-9]`, because then it is clamped first ([`max_residual`]).
#[must_use]
pub fn constraint_residual(problem: &AngleProblem<'_>, angles: &[f64], residual: &[f64]) -> f64 {
    let inside = RESIDUAL_CLAMP..=PI - RESIDUAL_CLAMP;
    if angles.iter().all(|x| inside.contains(x)) {
        largest(residual)
    } else {
        max_residual(problem.topology(), problem.rows(), angles)
    }
}

/// `out += Jᵀ μ`, triangle by triangle: `μ` has length `nt + 2 ni`, `out` length `3 nt`.
///
/// # Panics
/// If a vector is shorter than that.
pub fn add_transposed_product(
    topology: &Topology,
    rows: &ConstraintRows,
    wheel: &WheelDerivative,
    multipliers: &[f64],
    out: &mut [f64],
) {
    for face in topology.faces() {
        let local = TriangleRows::new(topology, rows, wheel, face);
        let vertex = local.interior.map(|i| i.map_or(0.0, |i| multipliers[rows.vertex(i)]));
        let wheels = local.interior.map(|i| i.map_or(0.0, |i| multipliers[rows.wheel(i)]));
        let product = local.apply_transposed(vertex, wheels);
        for (k, c) in face.corners().into_iter().enumerate() {
            out[c.index()] += product[k] + multipliers[rows.triangle(face)];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Planted;
    use abf_constraints::Jacobian;

    #[test]
    fn the_transposed_product_is_that_of_the_jacobian() {
        let planted = Planted::new(300);
        let kkt = planted.kkt();
        let mut jacobian = Jacobian::new(kkt.topology, kkt.rows);
        jacobian.update(kkt.topology, kkt.rows, kkt.wheel);
        let multipliers: Vec<f64> = (0..kkt.rows.len()).map(|i| (1.3 * i as f64).sin()).collect();
        let mut expected = vec![0.5; kkt.lambda.len()];
        for (&value, (row, column)) in &jacobian.view() {
            expected[column as usize] += value * multipliers[row as usize];
        }
        let mut out = vec![0.5; kkt.lambda.len()];
        add_transposed_product(kkt.topology, kkt.rows, kkt.wheel, &multipliers, &mut out);
        assert!(out.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
