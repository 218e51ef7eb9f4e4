//! What may be asked of a flattening. Nothing in here runs anything.

mod growth;
mod injective;
mod ladder;
mod memory;
mod pipeline;
mod solver;
mod solver_kind;
mod solver_parts;
mod solver_settings;
mod zero_area;

pub use injective::Injective;
pub use ladder::Ladder;
pub use memory::predict_memory;
pub use pipeline::Pipeline;
pub(crate) use solver::Method;
// The solvers and their settings: a new one is named in solver.rs alone.
pub use solver::*;
pub use solver_kind::SolverKind;
pub use solver_parts::SolverParts;
pub use solver_settings::{SolverSettings, VoidSetting};
pub use zero_area::ZeroArea;
