//! The three constraint families, stacked.

use crate::{ConstraintRows, WheelForm};
use abf_mesh::{CornerId, Topology};
use std::f64::consts::{PI, TAU};

/// Angles are kept this far from 0 and π, in radians, when a residual is reported: outside, the
/// logarithm of the sine does not exist.
pub const RESIDUAL_CLAMP: f64 = 1e-9;

/// All constraints at these angles, in the order of [`ConstraintRows`], length `nt + 2 ni`:
///
/// * triangle `t`: `Σ x − π` over its corners (LinABF eq. (2))
/// * vertex `v`: `Σ x − 2π` over the corners at `v` (LinABF eq. (1))
/// * wheel `v`: [`WheelForm::value`] (LinABF eq. (3))
#[must_use]
pub fn residual(form: WheelForm, topology: &Topology, rows: &ConstraintRows, angles: &[f64]) -> Vec<f64> {
    let mut h = Vec::with_capacity(rows.len());
    h.extend(angles.chunks_exact(3).map(|x| x[0] + x[1] + x[2] - PI));
    let ring = |&v| topology.fan(v).map(CornerId::index).map(|c| angles[c]).sum::<f64>() - TAU;
    h.extend(rows.interior().iter().map(ring));
    match form {
        // Every corner is in two wheels: its logarithm is taken once.
        WheelForm::Log => {
            let log_sines: Vec<f64> = angles.iter().map(|x| x.sin().ln()).collect();
            let ratio = |c: CornerId| log_sines[c.next().index()] - log_sines[c.prev().index()];
            h.extend(rows.interior().iter().map(|&v| topology.fan(v).map(ratio).sum::<f64>()));
        }
        WheelForm::Product => h.extend(rows.interior().iter().map(|&v| form.value(topology, v, angles))),
    }
    h
}

/// `max |h|` in the log form, the angles clamped to `[1e-9, π − 1e-9]`: the residual that every
/// report of this project speaks of. Infinite when an angle is NaN.
#[must_use]
pub fn max_residual(topology: &Topology, rows: &ConstraintRows, angles: &[f64]) -> f64 {
    if angles.iter().any(|x| x.is_nan()) {
        return f64::INFINITY;
    }
    let clamped: Vec<f64> = angles.iter().map(|x| x.clamp(RESIDUAL_CLAMP, PI - RESIDUAL_CLAMP)).collect();
    largest(&residual(WheelForm::Log, topology, rows, &clamped))
}

/// `max |h|` of constraints already computed.
#[must_use]
pub fn largest(h: &[f64]) -> f64 {
    h.iter().fold(0.0, |max, h| h.abs().max(max))
}

/// How many angles are not inside `(0, π)`.
#[must_use]
pub fn angles_out_of_range(angles: &[f64]) -> usize {
    angles.iter().filter(|&&x| !(x > 0.0 && x < PI)).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_shapes::Shape;

    #[test]
    fn the_angles_of_a_developable_sheet_satisfy_every_constraint() {
        let mesh = Shape::FoldedSheet.mesh(400);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let rows = ConstraintRows::new(&topology);
        let angles = mesh.corner_angles();
        assert_eq!(residual(WheelForm::Log, &topology, &rows, &angles).len(), rows.len());
        assert!(max_residual(&topology, &rows, &angles) < 1e-13);
    }

    #[test]
    fn a_nan_has_an_infinite_residual() {
        let mesh = Shape::Obtuse.mesh(3);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let rows = ConstraintRows::new(&topology);
        let mut angles = mesh.corner_angles();
        angles[0] = f64::NAN;
        assert_eq!(max_residual(&topology, &rows, &angles), f64::INFINITY);
        assert_eq!(angles_out_of_range(&angles), 1);
    }
}
