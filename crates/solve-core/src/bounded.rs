//! A step with rows of boundary vertices, by sparse Cholesky.

use crate::{BoundaryTerms, KktSystem, KktVector, LinearError, ReducedSystem, StepError, StepReport};
use abf_constraints::{BoundaryConditions, ConstraintRows};
use abf_control::{Checkpoint, Watch};
use abf_linalg::{Refinement, SymbolicCholesky, SymmetricMatrix};
use abf_mesh::Topology;
use std::sync::Arc;

/// Solves steps of one problem with conditions on its boundary: analysed once for all rows, factorised in every step with
/// those that are active.
#[derive(Debug)]
pub struct BoundedStep {
    system: ReducedSystem,
    symbolic: Arc<SymbolicCholesky>,
    matrix: SymmetricMatrix<f64>,
    rhs: Vec<f64>,
}

impl BoundedStep {
    /// Orders and analyses the system.
    ///
    /// # Errors
    /// [`LinearError`] when that does not fit in memory or in 32-bit indices, or the checkpoint ends it.
    pub fn new(
        topology: &Topology,
        rows: &ConstraintRows,
        boundary: &BoundaryConditions,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let system = ReducedSystem::with_boundary(topology, rows, Some(boundary), checkpoint)?;
        checkpoint()?;
        let symbolic = SymbolicCholesky::analyse(Arc::clone(system.pattern()))?;
        checkpoint()?;
        let matrix = SymmetricMatrix::zeros(Arc::clone(system.pattern()));
        let rhs = vec![0.0; matrix.size()];
        Ok(Self { system, symbolic, matrix, rhs })
    }

    /// Writes the step into `out` and returns the multipliers of the rows of the boundary: zero where a row is not active.
    ///
    /// # Errors
    /// [`StepError`] when there is no solution or the watch interrupts.
    pub fn step(
        &mut self,
        kkt: &KktSystem<'_>,
        boundary: &BoundaryTerms<'_>,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<(StepReport, Vec<f64>), StepError> {
        let Self { system, symbolic, matrix, rhs } = self;
        system.assemble_bounded(kkt, Some(boundary), matrix, rhs, &mut || watch.checkpoint())?;
        // A factorisation cannot be interrupted, so ask before it.
        if !watch.inner(0, f64::NAN)? {
            return Err(StepError::Interrupted);
        }
        let factors = symbolic.factorise(matrix)?;
        watch.checkpoint()?;
        let stats = factors.solve_asking(matrix, rhs, Refinement::default(), &mut || watch.checkpoint())?;
        system.back_substitute_bounded(kkt, Some(boundary), rhs, out);
        Ok((stats.into(), system.of_boundary(kkt.rows, boundary.conditions, rhs)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Planted;
    use abf_constraints::Jacobian;
    use abf_control::{Silent, StopCriteria};
    use std::f64::consts::PI;

    /// All three block rows of the system, by explicit multiplication with J and B.
    #[test]
    fn the_step_satisfies_the_rows_of_the_boundary_too() {
        let planted = Planted::new(500);
        let kkt = planted.kkt();
        let kkt = KktSystem { lambda: kkt.gauss_newton, ..kkt };
        let conditions = BoundaryConditions::at_most(kkt.topology, PI);
        let n = conditions.len();
        let active: Vec<bool> = (0..n).map(|j| j % 3 != 1).collect();
        let residual: Vec<f64> = (0..n).map(|j| 0.1 * (0.7 * j as f64).sin()).collect();
        let compliance: Vec<f64> = (0..n).map(|j| if j % 2 == 0 { 0.0 } else { 0.3 }).collect();
        let terms =
            BoundaryTerms { conditions: &conditions, active: &active, residual: &residual, compliance: &compliance };
        let (mut silent, mut out) = (Silent, KktVector::default());
        let mut watch = Watch::start(&StopCriteria::default(), &mut silent);
        let mut step = BoundedStep::new(kkt.topology, kkt.rows, &conditions, &mut || Ok(())).expect("fits");
        let (_, multipliers) = step.step(&kkt, &terms, &mut watch, &mut out).expect("a solution");

        let mut jacobian = Jacobian::new(kkt.topology, kkt.rows);
        jacobian.update(kkt.topology, kkt.rows, kkt.wheel);
        let mut left = kkt.residual.to_vec();
        let mut force: Vec<f64> =
            kkt.lambda.iter().zip(&out.delta).zip(kkt.gradient).map(|((l, d), g)| l * d + g).collect();
        for (&value, (row, column)) in &jacobian.view() {
            left[row as usize] += value * out.delta[column as usize];
            force[column as usize] += value * out.multipliers[row as usize];
        }
        for (j, &v) in conditions.vertices().iter().enumerate() {
            let sum: f64 = kkt.topology.fan(v).map(|c| out.delta[c.index()]).sum();
            kkt.topology.fan(v).for_each(|c| force[c.index()] += multipliers[j]);
            match active[j] {
                true => assert!((sum + residual[j] - compliance[j] * multipliers[j]).abs() < 1e-9),
                false => assert_eq!(multipliers[j], 0.0),
            }
        }
        let largest = |v: &[f64]| v.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        assert!(largest(&left) < 1e-9 && largest(&force) < 1e-7, "{} {}", largest(&left), largest(&force));
    }
}
