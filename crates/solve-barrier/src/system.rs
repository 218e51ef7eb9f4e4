//! The linear system of a step, factorised once and solved for several right-hand sides.

use crate::iterate::Iterate;
use crate::slack;
use abf_constraints::AngleProblem;
use abf_control::Checkpoint;
use abf_linalg::{Cholesky, LinearError, LinearStats, Refinement, SymbolicCholesky, SymmetricMatrix};
use abf_solve_core::{BoundaryTerms, KktSystem, KktVector, ReducedSystem};
use std::sync::Arc;

/// `[Λ Jᵀ; J 0] [δ; Δλ] = −[g; h]`, `Λ > 0`, by a Cholesky factorisation of the reduced system. `DirectStep` factorises at
/// every call; a second-order correction differs from its step in `h` only.
#[derive(Debug)]
pub(crate) struct StepSystem {
    reduced: ReducedSystem,
    symbolic: Arc<SymbolicCholesky>,
    matrix: SymmetricMatrix<f64>,
    rhs: Vec<f64>,
    factors: Option<Cholesky<f64>>,
    /// Which rows of the boundary there are.
    active: Vec<bool>,
}

impl StepSystem {
    pub(crate) fn new(problem: &AngleProblem<'_>, checkpoint: &mut Checkpoint<'_>) -> Result<Self, LinearError> {
        let reduced = ReducedSystem::with_boundary(problem.topology(), problem.rows(), problem.boundary(), checkpoint)?;
        checkpoint()?;
        let symbolic = SymbolicCholesky::analyse(Arc::clone(reduced.pattern()))?;
        checkpoint()?;
        let matrix = SymmetricMatrix::zeros(Arc::clone(reduced.pattern()));
        let rhs = vec![0.0; matrix.size()];
        let dropped = |j| problem.boundary().is_some_and(|conditions| conditions.dropped() == Some(j));
        let active =
            (0..problem.boundary().map_or(0, abf_constraints::BoundaryConditions::len)).map(|j| !dropped(j)).collect();
        Ok(Self { reduced, symbolic, matrix, rhs, factors: None, active })
    }

    /// Factorises for a new `Λ` and iterate, and solves.
    pub(crate) fn solve(
        &mut self,
        problem: &AngleProblem<'_>,
        iterate: &Iterate,
        lambda: &[f64],
        gradient: &[f64],
        out: &mut KktVector,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<LinearStats, LinearError> {
        self.factors = None;
        self.solve_asking(problem, iterate, lambda, gradient, &iterate.residual, out, checkpoint)
    }

    /// Solves with the factors at hand for other `g` and `h`; iterate and `Λ` must be those of the last
    /// [`StepSystem::solve`].
    pub(crate) fn solve_again(
        &mut self,
        problem: &AngleProblem<'_>,
        iterate: &Iterate,
        lambda: &[f64],
        gradient: &[f64],
        residual: &[f64],
        out: &mut KktVector,
    ) -> Result<LinearStats, LinearError> {
        self.solve_asking(problem, iterate, lambda, gradient, residual, out, &mut || Ok(()))
    }

    #[allow(clippy::too_many_arguments, reason = "a step is made of these")]
    fn solve_asking(
        &mut self,
        problem: &AngleProblem<'_>,
        iterate: &Iterate,
        lambda: &[f64],
        gradient: &[f64],
        residual: &[f64],
        out: &mut KktVector,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<LinearStats, LinearError> {
        let corners = slack::corner_count(problem);
        let (left, compliance) = slack::eliminated(problem, lambda, gradient, residual);
        let terms = problem.boundary().map(|conditions| BoundaryTerms {
            conditions,
            active: &self.active,
            residual: &left,
            compliance: &compliance,
        });
        let kkt = KktSystem {
            topology: problem.topology(),
            rows: problem.rows(),
            lambda: &lambda[..corners],
            gauss_newton: &lambda[..corners],
            off_diagonal: None,
            wheel: &iterate.wheel,
            gradient,
            residual,
        };
        self.reduced.assemble_bounded(&kkt, terms.as_ref(), &mut self.matrix, &mut self.rhs, checkpoint)?;
        let factors = match self.factors.take() {
            Some(factors) => factors,
            None => self.symbolic.factorise(&self.matrix)?,
        };
        checkpoint()?;
        let stats = factors.solve_asking(&self.matrix, &mut self.rhs, Refinement::default(), checkpoint)?;
        self.factors = Some(factors);
        checkpoint()?;
        self.reduced.back_substitute_bounded(&kkt, terms.as_ref(), &self.rhs, out);
        if let Some(conditions) = problem.boundary() {
            let changes = self.reduced.of_boundary(problem.rows(), conditions, &self.rhs);
            slack::append_steps(problem, lambda, gradient, &changes, &mut out.delta);
            out.multipliers.extend(changes);
        }
        Ok(stats)
    }
}
