//! The three constraint families, stacked.

use crate::per_corner::{PER_TASK, per_corner};
use crate::{ConstraintRows, WheelDerivative, WheelForm};
use abf_mesh::{CornerId, Topology};
use abf_parallel::prelude::*;
use std::f64::consts::{PI, TAU};

/// Angles are kept this far from 0 and π, in radians, when a residual is reported: outside, the
/// logarithm of the sine does not exist.
pub const RESIDUAL_CLAMP: f64 = 1e-9;

/// So many sine ratios are multiplied before a logarithm is taken: even at the angle bounds their
/// product stays far from the largest and the smallest number.
const RATIOS_PER_LOG: usize = 16;

/// All constraints at these angles, in the order of [`ConstraintRows`], length `nt + 2 ni`:
///
/// * triangle `t`: `Σ x − π` over its corners (LinABF eq. (2))
/// * vertex `v`: `Σ x − 2π` over the corners at `v` (LinABF eq. (1))
/// * wheel `v`: [`WheelForm::value`] (LinABF eq. (3)); in the log form NaN where a sine is not positive
#[must_use]
pub fn residual(form: WheelForm, topology: &Topology, rows: &ConstraintRows, angles: &[f64]) -> Vec<f64> {
    let sines = match form {
        // Every corner is in two wheels: its sine is taken once.
        WheelForm::Log => per_corner(angles, f64::sin),
        WheelForm::Product => Vec::new(),
    };
    let mut h = Vec::new();
    with_sines(rows, angles, &sines, &mut h);
    if form == WheelForm::Product {
        let wheels = h[rows.vertex(rows.interior_count())..].iter_mut().zip(rows.interior());
        wheels.for_each(|(h, &v)| *h = form.value(topology, v, angles));
    }
    h
}

/// The constraints in the log form and the derivative of the wheels, from one sine and one cosine per corner.
#[must_use]
pub fn linearise(rows: &ConstraintRows, angles: &[f64]) -> (Vec<f64>, WheelDerivative) {
    let (mut residual, mut wheel) = (Vec::new(), WheelDerivative::default());
    linearise_into(rows, angles, (&mut residual, &mut wheel), &mut Vec::new());
    (residual, wheel)
}

/// [`linearise`] in the memory of earlier ones. `sines` is room for a number per corner, whatever is in it.
pub fn linearise_into(
    rows: &ConstraintRows,
    angles: &[f64],
    (residual, wheel): (&mut Vec<f64>, &mut WheelDerivative),
    sines: &mut Vec<f64>,
) {
    let cotangents = wheel.cotangents_of_logs();
    sines.resize(angles.len(), 0.0);
    cotangents.resize(angles.len(), 0.0);
    let chunks = sines.par_chunks_mut(PER_TASK).zip(cotangents.par_chunks_mut(PER_TASK));
    chunks.zip(angles.par_chunks(PER_TASK)).for_each(|((sines, cotangents), angles)| {
        for ((sine, cotangent), x) in sines.iter_mut().zip(cotangents).zip(angles) {
            let (s, c) = x.sin_cos();
            *sine = s;
            *cotangent = c / s;
        }
    });
    with_sines(rows, angles, sines, residual);
}

/// The residual, wheels in the log form; they are zero where no sines are given.
fn with_sines(rows: &ConstraintRows, angles: &[f64], sines: &[f64], h: &mut Vec<f64>) {
    let (nt, ni) = (rows.triangle_count(), rows.interior_count());
    h.resize(rows.len(), 0.0);
    let (triangles, others) = h.split_at_mut(nt);
    let (vertices, wheels) = others.split_at_mut(ni);
    triangles.par_chunks_mut(PER_TASK).zip(angles.par_chunks(3 * PER_TASK)).for_each(|(h, angles)| {
        h.iter_mut().zip(angles.chunks_exact(3)).for_each(|(h, x)| *h = x[0] + x[1] + x[2] - PI);
    });
    vertices.par_chunks_mut(PER_TASK).zip(wheels.par_chunks_mut(PER_TASK)).enumerate().for_each(|(task, (v, w))| {
        for (k, (vertex, wheel)) in v.iter_mut().zip(w).enumerate() {
            let hubs = rows.hubs(task * PER_TASK + k);
            *vertex = hubs.iter().map(|c| angles[c.index()]).sum::<f64>() - TAU;
            *wheel = if sines.is_empty() { 0.0 } else { log_ratio_of_sines(hubs, sines) };
        }
    });
}

/// `Σ log sin x[next] − log sin x[prev]` over a ring.
fn log_ratio_of_sines(hubs: &[CornerId], sines: &[f64]) -> f64 {
    let positive = |c: CornerId| if sines[c.index()] > 0.0 { sines[c.index()] } else { f64::NAN };
    let ratio = |c: &CornerId| positive(c.next()) / positive(c.prev());
    hubs.chunks(RATIOS_PER_LOG).map(|hubs| hubs.iter().map(ratio).product::<f64>().ln()).sum()
}

/// `max |h|` in the log form, the angles clamped to `[1e-9, π − 1e-9]`: the residual that every
/// report of this project speaks of. Infinite when an angle is NaN.
#[must_use]
pub fn max_residual(topology: &Topology, rows: &ConstraintRows, angles: &[f64]) -> f64 {
    let all = || angles.par_iter().with_min_len(PER_TASK);
    if all().any(|x| x.is_nan()) {
        return f64::INFINITY;
    }
    let inside = RESIDUAL_CLAMP..=PI - RESIDUAL_CLAMP;
    if all().all(|x| inside.contains(x)) {
        return largest(&residual(WheelForm::Log, topology, rows, angles));
    }
    let clamped: Vec<f64> = all().map(|x| x.clamp(RESIDUAL_CLAMP, PI - RESIDUAL_CLAMP)).collect();
    largest(&residual(WheelForm::Log, topology, rows, &clamped))
}

/// `max |h|` of constraints already computed.
#[must_use]
pub fn largest(h: &[f64]) -> f64 {
    h.par_iter().with_min_len(PER_TASK).map(|h| h.abs()).reduce(|| 0.0, |a, b| b.max(a))
}

/// How many angles are not inside `(0, π)`.
#[must_use]
pub fn angles_out_of_range(angles: &[f64]) -> usize {
    angles.par_iter().with_min_len(PER_TASK).filter(|&&x| !(x > 0.0 && x < PI)).count()
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
