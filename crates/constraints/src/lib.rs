//! The angle problem: targets, weights, constraints, Jacobians and their local reduction.
//!
//! Pure functions of angles. A disk has `nt` triangles, `ni` interior vertices and `3 nt` corners;
//! the unknowns are the corner angles `x` of the flat mesh. Angles inside `(0, π)` that satisfy
//! all constraints *are* a planar drawing without flips, up to similarity.
//!
//! | symbol | name here | meaning | shape |
//! | --- | --- | --- | --- |
//! | α° | [`AngleProblem::mesh_angles`] | angles of the surface, rad | 3 nt |
//! | a | [`AngleProblem::target`] | target angles: α° · 2π / Σα° around an interior vertex, α° on the boundary | 3 nt |
//! | α | [`AngleProblem::initial_guess`] | the initial guess, where LinABF linearises: α°, but the target on rings of large deficit | 3 nt |
//! | w | [`AngleProblem::weight`] | 1/a² | 3 nt |
//! | x | `angles` | the unknowns, rad | 3 nt |
//! | h | [`residual`] | the constraints: triangle rows, vertex rows, wheel rows | nt + 2 ni |
//! | J | [`Jacobian`] | dh/dx | (nt + 2 ni) × 3 nt |
//! | μ | `multipliers` | Lagrange multipliers, in the order of `h` | nt + 2 ni |
//!
//! Where things are: `problem.rs` targets and the initial guess · `rows.rs` which constraint is which row
//! · `boundary/` what is asked of the boundary · `residual.rs` the three families · `wheel.rs` the wheel condition and its derivative ·
//! `jacobian.rs` all of `J` as a sparse matrix · `reduction.rs` the elimination of a triangle's own
//! row that every method shares.
//!
//! Sources: ABF = Sheffer, de Sturler 2001; ZRS05 = Zayer, Rössl, Seidel, *Variations of Angle
//! Based Flattening*; VMV04 = the same, *Efficient Iterative Solvers for Angle Based Flattening*;
//! LinABF = Zayer, Lévy, Seidel 2007.

mod boundary;
mod counts;
mod jacobian;
mod per_corner;
mod problem;
mod reduction;
mod residual;
mod rows;
mod wheel;

pub use boundary::{
    BadAngle, BadAngleCause, Boundary, BoundaryAngle, BoundaryConditions, BoundaryError, DEFAULT_BELOW, boundary_loop,
};
pub use counts::KktCounts;
pub use jacobian::Jacobian;
pub use problem::{AngleProblem, GuessSettings, ProblemError};
pub use reduction::{TriangleReduction, TriangleRows};
pub use residual::{RESIDUAL_CLAMP, angles_out_of_range, largest, linearise, linearise_into, max_residual, residual};
pub use rows::ConstraintRows;
pub use wheel::{WheelDerivative, WheelForm};
