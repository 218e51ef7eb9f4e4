//! What a kind of solver can do.

use abf::{Pipeline, SolverKind};

/// Whether a solver solves for angles at all.
pub(crate) fn finds_angles(solver: SolverKind) -> bool {
    solver != SolverKind::Lscm
}

/// Whether a solver keeps angles to constraints that have to be met.
pub(crate) fn keeps_constraints(solver: SolverKind) -> bool {
    finds_angles(solver) && solver != SolverKind::Descent
}

/// Whether a solver makes passes, with a target that moves.
pub(crate) fn makes_passes(solver: SolverKind) -> bool {
    matches!(solver, SolverKind::Auto | SolverKind::LinAbf)
}

/// Whether a barrier keeps a solver away from angles of 0 and π.
pub(crate) fn has_a_barrier(solver: SolverKind) -> bool {
    matches!(solver, SolverKind::Auto | SolverKind::Barrier | SolverKind::Descent)
}

/// Whether a solver's steps are solved by iterations.
pub(crate) fn iterates_inside(solver: SolverKind) -> bool {
    matches!(solver, SolverKind::Uzawa | SolverKind::Minres)
}

/// Whether a solver minimises an energy with a fixed target.
pub(crate) fn has_a_fixed_target(solver: SolverKind) -> bool {
    Pipeline { solver, ..Pipeline::default() }.newton_settings().is_some()
}
