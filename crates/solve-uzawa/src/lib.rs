//! Conjugate-direction Uzawa: Zayer, Rössl, Seidel, *Efficient Iterative Solvers for Angle Based
//! Flattening*, 2004 (VMV04), §7.2.
//!
//! A step is a saddle point: angles `x` that minimise a quadratic under linear constraints with
//! multipliers `λ`. Uzawa's method climbs in `λ`, each time with the best `x` for it; with conjugate
//! directions it is conjugate gradients on the Schur complement that never forms it, and carries `x`
//! along. `uzawa.rs` is the algorithm, over any [`SaddlePoint`]; `step.rs` the saddle point of a step,
//! and what happens when the exact Hessian is not positive.
//!
//! As published that is `IterativeSettings::as_published()`: all `nt + 2 ni` multipliers, no
//! preconditioner. By default the triangle rows are eliminated and the blocks of `S` precondition.

mod step;
mod uzawa;

use abf_constraints::AngleProblem;
use abf_control::{Observer, StopCriteria, Watch};
use abf_solve_core::{AngleSolution, AngleSolver, Hessian, IterativeSettings, NewtonSettings, SolveError};

pub use step::UzawaStep;
pub use uzawa::{RightHandSide, SaddlePoint, Unknowns, uzawa};

/// The outer loop with Uzawa as its inner method.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Uzawa {
    /// The point of the grid.
    pub newton: NewtonSettings,
    /// The system, the preconditioner and the limit of the inner method.
    pub iterative: IterativeSettings,
}

impl Default for Uzawa {
    /// Log wheel and exact Hessian, as in VMV04; reduced, preconditioned by blocks.
    fn default() -> Self {
        let newton = NewtonSettings { hessian: Hessian::Exact, ..NewtonSettings::default() };
        Self { newton, iterative: IterativeSettings::default() }
    }
}

impl AngleSolver for Uzawa {
    fn name(&self) -> &'static str {
        "uzawa"
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
            UzawaStep::asking(problem.topology(), problem.rows(), self.iterative, &mut || watch.checkpoint())
        };
        self.newton.solve_with(problem, stop, observer, prepare)
    }
}
