//! What a solver did, in numbers.

use crate::{Flattening, SolverKind};
use abf_control::IterationRecord;
use abf_solve_core::AngleSolution;

/// What a solver did on one disk, in numbers: [`Flattening`] without its map and its angles.
///
/// The default is that of a map without angles and without a solver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SolveReport {
    /// `max |h|` of its angles, log form, rad; `None` where no angles were solved for.
    pub constraint_residual: Option<f64>,
    /// Angles not inside (0, π).
    pub angles_out_of_range: Option<usize>,
    /// `Σ w (x − a)²` at the end; `None` too where the target moves from pass to pass.
    pub energy: Option<f64>,
    /// Outer iterations or passes.
    pub iterations: usize,
    /// Inner iterations of all of them; refinement steps where the solve is direct.
    pub inner_iterations: usize,
    /// `‖b − Ax‖ / ‖b‖` of the last linear solve, computed; `None` where there was nothing left to solve.
    pub inner_residual: Option<f64>,
    /// The largest of all solves; NaN if one of them is.
    pub inner_residual_worst: Option<f64>,
    /// The last estimate of it by the inner method, where that has one.
    pub inner_estimate: Option<f64>,
    /// Inner solves that ended before their tolerance.
    pub inner_unconverged: usize,
    /// The most negative entries of a diagonal Hessian met in one iteration.
    pub negative_curvature: Option<usize>,
    /// Iterations that gave up the exact Hessian.
    pub fallbacks: Option<usize>,
    /// Angles clamped to their bounds: between passes by the solver, and before the layout.
    pub clamped_angles: usize,
    /// Rings that started from their target angles because of their deficit.
    pub switched_rings: usize,
    /// Triangles without a shape, solved for as thin ones.
    pub shapeless_faces: usize,
}

impl Flattening {
    /// What the solver did, in numbers.
    #[must_use]
    pub fn solve_report(&self) -> SolveReport {
        let solution = self.solution.as_ref();
        let history = solution.map_or(&[][..], AngleSolution::history);
        let last = history.last();
        let moves_its_target = self.solver.makes_passes() || self.solver == SolverKind::HLinAbf;
        let has_a_fixed_target = self.solver.finds_angles() && !moves_its_target;
        SolveReport {
            constraint_residual: solution.map(AngleSolution::constraint_residual),
            angles_out_of_range: solution.map(AngleSolution::angles_out_of_range),
            energy: solution.filter(|_| has_a_fixed_target).map(AngleSolution::energy),
            iterations: solution.map_or(0, AngleSolution::iterations),
            inner_iterations: solution.map_or(0, AngleSolution::inner_iterations),
            inner_residual: last.and_then(IterationRecord::solved_to),
            inner_residual_worst: history.iter().filter_map(IterationRecord::solved_to).reduce(worse),
            inner_estimate: last.and_then(|record| record.inner_estimate),
            inner_unconverged: history.iter().filter(|record| !record.inner_converged).count(),
            negative_curvature: solution.map(AngleSolution::negative_curvature),
            fallbacks: solution.map(AngleSolution::fallbacks),
            clamped_angles: solution.map_or(0, AngleSolution::clamped_angles) + self.layout.clamped_angles,
            switched_rings: self.switched_rings,
            shapeless_faces: self.shapeless_faces,
        }
    }
}

/// The larger of two, NaN being the largest.
fn worse(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}
