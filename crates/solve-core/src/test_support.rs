//! A step to solve, for the tests of this crate.

use crate::KktSystem;
use abf_constraints::{ConstraintRows, Jacobian, WheelDerivative, WheelForm};
use abf_mesh::Topology;
use abf_shapes::Shape;
use nalgebra::DMatrix;

/// A step on a bumpy sheet with waves for its right-hand side. Every 17th entry of Λ is negative.
pub(crate) struct Planted {
    topology: Topology,
    rows: ConstraintRows,
    wheel: WheelDerivative,
    lambda: Vec<f64>,
    gauss_newton: Vec<f64>,
    gradient: Vec<f64>,
    residual: Vec<f64>,
}

impl Planted {
    pub(crate) fn new(triangles: usize) -> Self {
        let mesh = Shape::BumpySheet.mesh(triangles);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let rows = ConstraintRows::new(&topology);
        let angles = mesh.corner_angles();
        let wheel = WheelDerivative::new(WheelForm::Log, &topology, &rows, &angles);
        let gauss_newton: Vec<f64> = angles.iter().map(|x| 2.0 / (x * x)).collect();
        let sign = |c: usize| if c % 17 == 3 { -0.7 } else { 1.0 };
        let lambda = gauss_newton.iter().enumerate().map(|(c, l)| sign(c) * l).collect();
        let gradient = (0..angles.len()).map(|c| (0.9 * c as f64).cos()).collect();
        let residual = (0..rows.len()).map(|r| 0.1 * (1.3 * r as f64).sin()).collect();
        Self { topology, rows, wheel, lambda, gauss_newton, gradient, residual }
    }

    pub(crate) fn kkt(&self) -> KktSystem<'_> {
        KktSystem {
            topology: &self.topology,
            rows: &self.rows,
            lambda: &self.lambda,
            gauss_newton: &self.gauss_newton,
            off_diagonal: None,
            wheel: &self.wheel,
            gradient: &self.gradient,
            residual: &self.residual,
        }
    }

    /// The angles that `J` belongs to: `Λ = 2/x²`.
    pub(crate) fn angles(&self) -> Vec<f64> {
        self.gauss_newton.iter().map(|l| (2.0 / l).sqrt()).collect()
    }

    /// `J`, dense.
    pub(crate) fn jacobian(&self) -> DMatrix<f64> {
        let mut jacobian = Jacobian::new(&self.topology, &self.rows);
        jacobian.update(&self.topology, &self.rows, &self.wheel);
        let mut dense = DMatrix::zeros(self.rows.len(), self.lambda.len());
        for (value, (row, column)) in &jacobian.view() {
            dense[(row as usize, column as usize)] = *value;
        }
        dense
    }
}

/// A wave of this length.
pub(crate) fn wave(len: usize) -> Vec<f64> {
    (0..len).map(|i| (0.7 * i as f64 + 0.3).sin()).collect()
}

/// The largest absolute difference.
pub(crate) fn apart<'a>(a: impl IntoIterator<Item = &'a f64>, b: impl IntoIterator<Item = &'a f64>) -> f64 {
    a.into_iter().zip(b).fold(0.0, |max, (x, y)| (x - y).abs().max(max))
}
