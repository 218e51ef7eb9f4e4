//! The settings of the solvers that `auto` tries.

use abf_embed::Descent;
use abf_solve_abf_newton::AbfNewton;
use abf_solve_barrier::Barrier;
use abf_solve_linabf::LinAbf;

/// The solvers of [`Solver::Auto`](crate::Solver::Auto), each with its settings, in the order in which they are tried.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Ladder {
    /// The first.
    pub linabf: LinAbf,
    /// The second. It never leaves the valid drawings.
    pub descent: Descent,
    /// The third. It makes 25 iterations at most: if it converges at all, about a dozen are enough.
    pub newton: AbfNewton,
    /// The last.
    pub barrier: Barrier,
}

impl Default for Ladder {
    fn default() -> Self {
        Self {
            linabf: LinAbf::default(),
            descent: Descent::default(),
            newton: AbfNewton::fixed_target(),
            barrier: Barrier::default(),
        }
    }
}
