//! What may be asked of a flattening. Nothing in here runs anything.

mod ladder;
mod memory;
mod pipeline;
mod solver;
mod solver_kind;
mod zero_area;

pub use ladder::Ladder;
pub use memory::predict_memory;
pub use pipeline::Pipeline;
pub(crate) use solver::Method;
pub use solver::{Solver, SolverParts};
pub use solver_kind::{SolverKind, UnknownSolver};
pub use zero_area::ZeroArea;
