//! MINRES on the Schur complement: Zayer, Rössl, Seidel, *Efficient Iterative Solvers for Angle
//! Based Flattening*, 2004 (VMV04), §7.1.
//!
//! With a diagonal `Λ` the multipliers of a step solve `M μ = h − J Λ⁻¹ g`, `M = J Λ⁻¹ Jᵀ`, and the
//! step follows from them. `M` is symmetric but, with the exact Hessian, not definite, which MINRES
//! does not ask for. As published that is `IterativeSettings::as_published()`: all `nt + 2 ni`
//! multipliers, no preconditioner. By default the triangle rows are eliminated first and the blocks
//! of `S` precondition: ten to a hundred times fewer iterations, whose number does not grow with the
//! mesh.
//!
//! The algorithm is [`abf_linalg::minres`]; `step.rs` says on which system.

mod step;

use abf_constraints::AngleProblem;
use abf_control::{Observer, StopCriteria, Watch};
use abf_solve_core::{AngleSolution, AngleSolver, Hessian, IterativeSettings, NewtonSettings, SolveError};

pub use step::MinresStep;

/// The outer loop with MINRES as its inner method.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Minres {
    /// The point of the grid.
    pub newton: NewtonSettings,
    /// The system, the preconditioner and the limit of the inner method.
    pub iterative: IterativeSettings,
}

impl Default for Minres {
    /// Log wheel and exact Hessian, as in VMV04; reduced, preconditioned by blocks.
    fn default() -> Self {
        let newton = NewtonSettings { hessian: Hessian::Exact, ..NewtonSettings::default() };
        Self { newton, iterative: IterativeSettings::default() }
    }
}

impl AngleSolver for Minres {
    fn name(&self) -> &'static str {
        "minres"
    }

    fn check(&self) -> Result<(), SolveError> {
        self.iterative.check(&self.newton)?;
        self.newton.check()
    }

    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<AngleSolution, SolveError> {
        self.iterative.check(&self.newton)?;
        let prepare = |watch: &mut Watch<'_>| {
            MinresStep::asking(problem.topology(), problem.rows(), self.iterative, &mut || watch.checkpoint())
        };
        self.newton.solve_with(problem, stop, observer, prepare)
    }
}
