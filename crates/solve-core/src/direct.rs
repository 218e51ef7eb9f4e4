//! The reduced system by sparse Cholesky, or LBLᵀ where it is indefinite.

use crate::{KktStep, KktSystem, KktVector, LinearError, ReducedSystem, StepError, StepReport};

use abf_constraints::ConstraintRows;
use abf_control::{Checkpoint, Watch};
use abf_linalg::{Refinement, SymbolicCholesky, SymmetricMatrix};
use abf_mesh::Topology;
use std::sync::Arc;

/// Solves a step by a Cholesky factorisation of `S`: analysed once, factorised in every step, refined
/// when the true residual is above the tolerance. Where the exact Hessian makes `S` indefinite, by a
/// symmetric indefinite factorisation with the same analysis.
#[derive(Debug)]
pub struct DirectStep {
    system: ReducedSystem,
    symbolic: Arc<SymbolicCholesky>,
    matrix: SymmetricMatrix<f64>,
    rhs: Vec<f64>,
}

impl DirectStep {
    /// Orders and analyses the system of a topology.
    ///
    /// # Errors
    /// [`LinearError`] when that does not fit in memory or in 32-bit indices.
    pub fn new(topology: &Topology, rows: &ConstraintRows) -> Result<Self, LinearError> {
        Self::asking(topology, rows, &mut || Ok(()))
    }

    /// [`DirectStep::new`] that asks between its parts whether to go on.
    ///
    /// # Errors
    /// As `new`, and [`LinearError::Cancelled`].
    pub fn asking(
        topology: &Topology,
        rows: &ConstraintRows,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let system = ReducedSystem::asking(topology, rows, checkpoint)?;
        checkpoint()?;
        let symbolic = SymbolicCholesky::analyse(Arc::clone(system.pattern()))?;
        checkpoint()?;
        let matrix = SymmetricMatrix::zeros(Arc::clone(system.pattern()));
        let rhs = vec![0.0; matrix.size()];
        Ok(Self { system, symbolic, matrix, rhs })
    }
}

impl KktStep for DirectStep {
    fn step(
        &mut self,
        kkt: &KktSystem<'_>,
        tolerance: f64,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<StepReport, StepError> {
        self.system.assemble_asking(kkt, &mut self.matrix, &mut self.rhs, &mut || watch.checkpoint())?;
        // A factorisation cannot be interrupted, so ask before it.
        if !watch.inner(0, f64::NAN)? {
            return Err(StepError::Interrupted);
        }
        let refinement =
            Refinement { tolerance: tolerance.min(Refinement::default().tolerance), ..Refinement::default() };
        let stats = match self.symbolic.factorise(&self.matrix) {
            Ok(factors) => {
                watch.checkpoint()?;
                factors.solve_asking(&self.matrix, &mut self.rhs, refinement, &mut || watch.checkpoint())?
            }
            // Negative entries of Λ may, but need not, make S indefinite.
            Err(LinearError::NotPositiveDefinite { .. }) if kkt.lambda.iter().any(|&l| l < 0.0) => {
                watch.checkpoint()?;
                let factors = self.symbolic.factorise_indefinite(&self.matrix)?;
                watch.checkpoint()?;
                factors.solve_asking(&self.matrix, &mut self.rhs, refinement, &mut || watch.checkpoint())?
            }
            Err(error) => return Err(error.into()),
        };
        watch.checkpoint()?;
        self.system.back_substitute(kkt, &self.rhs, out);
        Ok(stats.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_constraints::{Jacobian, WheelDerivative, WheelForm};
    use abf_control::{Silent, StopCriteria};
    use abf_shapes::Shape;

    /// Both block rows of the KKT system, by explicit multiplication with J.
    #[test]
    fn the_step_satisfies_both_block_rows() {
        let mesh = Shape::BumpySheet.mesh(600);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let rows = ConstraintRows::new(&topology);
        let angles = mesh.corner_angles();
        let wheel = WheelDerivative::new(WheelForm::Log, &topology, &rows, &angles);
        let lambda: Vec<f64> = angles.iter().map(|x| 2.0 / (x * x)).collect();
        let gradient: Vec<f64> = (0..angles.len()).map(|c| (0.9 * c as f64).cos()).collect();
        let residual: Vec<f64> = (0..rows.len()).map(|r| 0.1 * (1.3 * r as f64).sin()).collect();
        let kkt = KktSystem {
            topology: &topology,
            rows: &rows,
            lambda: &lambda,
            gauss_newton: &lambda,
            off_diagonal: None,
            wheel: &wheel,
            gradient: &gradient,
            residual: &residual,
        };
        let mut out = KktVector::default();
        let mut silent = Silent;
        let mut watch = Watch::start(&StopCriteria::default(), &mut silent);
        let mut step = DirectStep::new(&topology, &rows).expect("fits");
        let stats = step.step(&kkt, 1e-12, &mut watch, &mut out).expect("positive definite");
        assert!(stats.relative_residual < 1e-12);

        let mut jacobian = Jacobian::new(&topology, &rows);
        jacobian.update(&topology, &rows, &wheel);
        let mut top: Vec<f64> = (0..angles.len()).map(|c| lambda[c] * out.delta[c] + gradient[c]).collect();
        let mut bottom = residual.clone();
        for (&value, (row, column)) in &jacobian.view() {
            let (row, column) = (row as usize, column as usize);
            top[column] += value * out.multipliers[row];
            bottom[row] += value * out.delta[column];
        }
        let largest = |v: &[f64]| v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!(largest(&top) < 1e-9 && largest(&bottom) < 1e-10, "{} {}", largest(&top), largest(&bottom));
    }
}
