//! The settings of a solver by what they are about.

use abf_embed::Descent;
use abf_solve_barrier::Barrier;
use abf_solve_core::{IterativeSettings, NewtonSettings};
use abf_solve_linabf::LinAbf;

/// The settings of a [`Solver`](crate::Solver) by what they are about; `None` where it has none such.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct SolverParts<'s> {
    /// The passes of LinABF.
    pub linabf: Option<&'s mut LinAbf>,
    /// The point of the grid. The ladder keeps its own.
    pub newton: Option<&'s mut NewtonSettings>,
    /// The inner method of Uzawa and MINRES.
    pub iterative: Option<&'s mut IterativeSettings>,
    /// The interior point method.
    pub barrier: Option<&'s mut Barrier>,
    /// The descent.
    pub descent: Option<&'s mut Descent>,
}
