//! The Jacobian of all constraints as a sparse matrix with a fixed pattern.

use crate::{ConstraintRows, WheelDerivative};
use abf_mesh::{CornerId, Topology};
use sprs::{CsMatI, CsMatViewI};

/// `J = dh/dx`, `(nt + 2 ni) × 3 nt`, by rows. The pattern is built once; [`Jacobian::update`]
/// rewrites the wheel values, the only ones that depend on the angles.
#[derive(Clone, Debug)]
pub struct Jacobian {
    matrix: CsMatI<f64, u32>,
}

impl Jacobian {
    /// The pattern, with ones in the triangle and vertex rows and zeros in the wheel rows.
    #[must_use]
    pub fn new(topology: &Topology, rows: &ConstraintRows) -> Self {
        let corners = topology.corner_count();
        let mut start: Vec<u32> = Vec::with_capacity(rows.len() + 1);
        let mut columns: Vec<u32> = Vec::new();
        let mut values: Vec<f64> = Vec::new();
        start.push(0);
        columns.extend(0..corners as u32);
        values.resize(corners, 1.0);
        start.extend((1..=rows.triangle_count()).map(|t| 3 * t as u32));
        let mut ring: Vec<u32> = Vec::new();
        let mut push_row = |ring: &mut Vec<u32>, value: f64| {
            ring.sort_unstable();
            columns.append(ring);
            values.resize(columns.len(), value);
            start.push(u32::try_from(columns.len()).expect("fewer than 2³² Jacobian entries"));
        };
        for &v in rows.interior() {
            ring.extend(topology.fan(v).map(|c| c.index() as u32));
            push_row(&mut ring, 1.0);
        }
        for &v in rows.interior() {
            ring.extend(topology.fan(v).flat_map(|c| [c.next().index() as u32, c.prev().index() as u32]));
            push_row(&mut ring, 0.0);
        }
        Self { matrix: CsMatI::new((rows.len(), corners), start, columns, values) }
    }

    /// Writes the wheel derivative into the wheel rows.
    pub fn update(&mut self, topology: &Topology, rows: &ConstraintRows, wheel: &WheelDerivative) {
        let mut entries: Vec<(CornerId, f64)> = Vec::new();
        for (i, &v) in rows.interior().iter().enumerate() {
            entries.clear();
            for hub in topology.fan(v) {
                let (next, prev) = wheel.coefficients(i, hub);
                entries.extend([(hub.next(), next), (hub.prev(), prev)]);
            }
            entries.sort_unstable_by_key(|e| e.0);
            let mut row = self.matrix.outer_view_mut(rows.wheel(i)).expect("one row per constraint");
            for ((_, value), (_, new)) in row.iter_mut().zip(&entries) {
                *value = *new;
            }
        }
    }

    /// The matrix, by rows.
    #[must_use]
    pub fn view(&self) -> CsMatViewI<'_, f64, u32> {
        self.matrix.view()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{WheelForm, residual};
    use abf_shapes::Shape;
    use proptest::prelude::*;

    /// Angles near those of a bumpy sheet, moved by a planted pseudo-random amount.
    fn disturbed(angles: &[f64], seed: u64) -> Vec<f64> {
        let phase = seed as f64;
        angles.iter().enumerate().map(|(c, x)| x * (1.0 + 0.1 * (1.7 * c as f64 + phase).sin())).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn jacobian_matches_finite_differences_in_both_wheel_forms(seed in 0_u64..1000, product in any::<bool>()) {
            let form = if product { WheelForm::Product } else { WheelForm::Log };
            let mesh = Shape::BumpySheet.mesh(80);
            let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
            let rows = ConstraintRows::new(&topology);
            let angles = disturbed(&mesh.corner_angles(), seed);
            let mut jacobian = Jacobian::new(&topology, &rows);
            jacobian.update(&topology, &rows, &WheelDerivative::new(form, &topology, &rows, &angles));
            let step = 1e-6;
            for c in 0..angles.len() {
                let moved = |by: f64| {
                    let mut x = angles.clone();
                    x[c] += by;
                    residual(form, &topology, &rows, &x)
                };
                let (up, down) = (moved(step), moved(-step));
                for row in 0..rows.len() {
                    let difference = (up[row] - down[row]) / (2.0 * step);
                    let entry = jacobian.view().get(row, c).copied().unwrap_or(0.0);
                    prop_assert!((difference - entry).abs() < 1e-7 * (1.0 + entry.abs()), "row {row} corner {c}: {difference} {entry}");
                }
            }
        }
    }
}
