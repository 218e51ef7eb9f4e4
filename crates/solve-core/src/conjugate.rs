//! The reduced system by conjugate gradients with frozen block factors.

use crate::preconditioner::{Blocks, REFACTOR_AFTER};
use crate::{KktStep, KktSystem, KktVector, LinearError, ReducedSystem, StepError, StepReport, Watch};
use abf_constraints::ConstraintRows;
use abf_linalg::{KrylovEnd, KrylovParams, Refinement, SingleCholesky, SymbolicCholesky, SymmetricMatrix, cg};
use abf_mesh::Topology;
use std::sync::Arc;

/// Solves a step with `Λ > 0` inexactly, for methods that take several steps from nearby angles.
///
/// The coupling between vertex and wheel multipliers is weak, so factors of the V–V and W–W blocks of
/// the *first* `S` precondition every later one. The two have the pattern of a Laplacian: together they
/// cost about a quarter of a factorisation of `S`, which this step never makes unless conjugate gradients
/// fail. The factors are kept in single precision.
pub struct ConjugateStep {
    system: ReducedSystem,
    symbolic: Arc<SymbolicCholesky>,
    matrix: SymmetricMatrix<f64>,
    rhs: Vec<f64>,
    blocks: Option<Blocks<SingleCholesky>>,
}

impl ConjugateStep {
    /// Orders and analyses the blocks of a topology.
    ///
    /// # Errors
    /// [`LinearError`] when that does not fit in memory or in 32-bit indices.
    pub fn new(topology: &Topology, rows: &ConstraintRows) -> Result<Self, LinearError> {
        let system = ReducedSystem::new(topology, rows)?;
        let symbolic = SymbolicCholesky::analyse(Arc::new(system.vertex_pattern()))?;
        let matrix = SymmetricMatrix::zeros(Arc::clone(system.pattern()));
        let rhs = vec![0.0; matrix.size()];
        Ok(Self { system, symbolic, matrix, rhs, blocks: None })
    }

    /// Conjugate gradients from `x`; the report says whether the tolerance was met.
    fn iterate(&mut self, tolerance: f64, watch: &mut Watch<'_>, x: &mut [f64]) -> Result<StepReport, StepError> {
        if self.blocks.is_none() {
            self.blocks = Some(factorise_blocks(&self.symbolic, &self.matrix)?);
        }
        let blocks = self.blocks.as_ref().expect("factorised above");
        let params = KrylovParams { relative_tolerance: tolerance, max_iterations: REFACTOR_AFTER };
        let stats = cg(&self.matrix, blocks, &self.rhs, x, &params, &mut |i, estimate| watch.inner(i, estimate));
        match stats.end {
            KrylovEnd::Interrupted => Err(StepError::Interrupted),
            end => Ok(StepReport {
                iterations: stats.iterations,
                relative_residual: stats.relative_residual,
                estimate: Some(stats.estimate),
                inner_converged: end == KrylovEnd::Converged,
                ..StepReport::default()
            }),
        }
    }

    /// The way out when conjugate gradients fail: one factorisation of `S` itself.
    fn factorise(&self, x: &mut [f64]) -> Result<StepReport, StepError> {
        x.copy_from_slice(&self.rhs);
        let factors = SymbolicCholesky::analyse(Arc::clone(self.system.pattern()))?.factorise(&self.matrix)?;
        Ok(factors.solve(&self.matrix, x, Refinement::default())?.into())
    }
}

impl KktStep for ConjugateStep {
    fn step(
        &mut self,
        kkt: &KktSystem<'_>,
        tolerance: f64,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<StepReport, StepError> {
        self.system.assemble(kkt, &mut self.matrix, &mut self.rhs);
        let mut x = vec![0.0; self.rhs.len()];
        let was_frozen = self.blocks.is_some();
        let mut report = self.iterate(tolerance, watch, &mut x)?;
        if !report.inner_converged && was_frozen {
            self.blocks = None;
            let tried = report.iterations;
            report = self.iterate(tolerance, watch, &mut x)?;
            report.iterations += tried;
        }
        if !report.inner_converged {
            let tried = report.iterations;
            report = self.factorise(&mut x)?;
            report.iterations += tried;
        }
        self.system.back_substitute(kkt, &x, out);
        Ok(report)
    }
}

/// The two blocks of `S`, factorised side by side and rounded.
fn factorise_blocks(
    symbolic: &Arc<SymbolicCholesky>,
    s: &SymmetricMatrix<f64>,
) -> Result<Blocks<SingleCholesky>, LinearError> {
    let block = |part| Ok(SingleCholesky::of(&symbolic.factorise(&s.every_second(symbolic.pattern(), part))?));
    let (vertex, wheel) = rayon::join(|| block(0), || block(1));
    Ok(Blocks { vertex: vertex?, wheel: wheel? })
}
