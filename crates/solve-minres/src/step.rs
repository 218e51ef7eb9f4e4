//! One quadratic step by MINRES, on the whole `M` or on the reduced `S`.

use abf_constraints::ConstraintRows;
use abf_control::{Checkpoint, Watch};
use abf_linalg::{SymmetricMatrix, minres};
use abf_mesh::Topology;
use abf_solve_core::{
    ConstraintProducts, IterativeSettings, KktStep, KktSystem, KktVector, LinearError, Preconditioning, ReducedSystem,
    Reduction, SchurComplement, StepError, StepReport,
};
use std::sync::Arc;

/// Solves a step, `Λ` of any sign, by MINRES with a positive definite preconditioner.
pub struct MinresStep {
    settings: IterativeSettings,
    system: System,
    preconditioning: Preconditioning,
}

/// What is solved.
enum System {
    /// `M μ = h − J Λ⁻¹ g`, matrix free.
    Whole(Box<ConstraintProducts>),
    /// `S μ_R = r`, assembled.
    Reduced(Arc<ReducedSystem>),
}

impl MinresStep {
    /// Prepares what the settings need of a topology.
    ///
    /// # Errors
    /// [`LinearError`] when that does not fit in memory or in 32-bit indices.
    pub fn new(topology: &Topology, rows: &ConstraintRows, settings: IterativeSettings) -> Result<Self, LinearError> {
        Self::asking(topology, rows, settings, &mut || Ok(()))
    }

    /// [`MinresStep::new`] that asks between its parts whether to go on.
    ///
    /// # Errors
    /// As `new`, and [`LinearError::Cancelled`].
    pub fn asking(
        topology: &Topology,
        rows: &ConstraintRows,
        settings: IterativeSettings,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let system = match settings.reduction {
            Reduction::None => System::Whole(Box::new(ConstraintProducts::whole(topology, rows))),
            Reduction::Triangles => System::Reduced(Arc::new(ReducedSystem::asking(topology, rows, checkpoint)?)),
        };
        let reduced = match &system {
            System::Whole(_) => None,
            System::Reduced(reduced) => Some(reduced),
        };
        let preconditioning = Preconditioning::asking(settings.preconditioner, topology, rows, reduced, checkpoint)?;
        Ok(Self { settings, system, preconditioning })
    }

    /// How often the blocks of the preconditioner were factorised.
    #[must_use]
    pub fn factorisations(&self) -> usize {
        self.preconditioning.factorisations()
    }
}

impl KktStep for MinresStep {
    fn step(
        &mut self,
        kkt: &KktSystem<'_>,
        tolerance: f64,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<StepReport, StepError> {
        let preconditioner = self.preconditioning.prepare(kkt, &mut || watch.checkpoint())?;
        let params = self.settings.krylov(tolerance);
        let stats = match &mut self.system {
            System::Whole(products) => {
                products.update(kkt);
                let m = SchurComplement::new(products, kkt);
                out.multipliers = vec![0.0; kkt.rows.len()];
                let b = m.right_hand_side();
                let mut go_on = |iteration, estimate| watch.inner(iteration, estimate).unwrap_or(false);
                let stats = minres(&m, preconditioner, &b, &mut out.multipliers, &params, &mut go_on);
                watch.aborted()?;
                m.back_substitute(&out.multipliers, &mut out.delta);
                stats
            }
            System::Reduced(system) => {
                let mut s = SymmetricMatrix::zeros(Arc::clone(system.pattern()));
                let (mut r, mut solution) = (vec![0.0; s.size()], vec![0.0; s.size()]);
                system.assemble_asking(kkt, &mut s, &mut r, &mut || watch.checkpoint())?;
                let mut go_on = |iteration, estimate| watch.inner(iteration, estimate).unwrap_or(false);
                let stats = minres(&s, preconditioner, &r, &mut solution, &params, &mut go_on);
                watch.aborted()?;
                system.back_substitute(kkt, &solution, out);
                stats
            }
        };
        self.preconditioning.used(stats.iterations);
        StepReport::from_krylov(stats)
    }
}
