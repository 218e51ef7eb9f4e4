//! What the solver and the layout did.

use super::{Asked, as_text};
use abf::{AngleSolution, Flattening, Hessian, IterationRecord, LayoutKind, Pipeline, Termination, WheelForm};
use serde::Serialize;

/// What was asked of the solver and the layout, and what they did.
///
/// `None` where no angles are solved for, if nothing else is said.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Run {
    /// What it was asked.
    pub(crate) settings: Asked,
    /// How it ended.
    #[serde(serialize_with = "as_text")]
    pub(crate) termination: Termination,
    /// `max |h|` of its angles, log form, rad.
    pub(crate) constraint_residual: Option<f64>,
    /// Angles not inside (0, π).
    pub(crate) angles_out_of_range: Option<usize>,
    /// `Σ w (x − a)²` at the end; `None` too where the target moves.
    pub(crate) energy: Option<f64>,
    /// Outer iterations or passes.
    pub(crate) iterations: usize,
    /// Inner iterations of all of them; refinement steps where the solve is direct.
    pub(crate) inner_iterations: usize,
    /// `‖b − Ax‖ / ‖b‖` of the last linear solve, computed.
    pub(crate) inner_residual: Option<f64>,
    /// The largest of all solves.
    pub(crate) inner_residual_worst: Option<f64>,
    /// The last estimate of it by the inner method, where that has one.
    pub(crate) inner_estimate: Option<f64>,
    /// Inner solves that ended before their tolerance.
    pub(crate) inner_unconverged: usize,
    /// The most negative entries of a diagonal Hessian met in one iteration; `None` too for the exact
    /// Hessian of the product wheel, whose signs its diagonal does not tell.
    pub(crate) negative_curvature: Option<usize>,
    /// Iterations that gave up the exact Hessian.
    pub(crate) fallbacks: Option<usize>,
    /// Angles moved into their bounds: between passes by the solver, and before the layout.
    pub(crate) moved_angles: usize,
    /// Rings that started from their target angles.
    pub(crate) switched_rings: usize,
    /// The layout that was used; never `auto`.
    #[serde(serialize_with = "as_text")]
    pub(crate) layout: LayoutKind,
    /// The largest disagreement between the two sides of an edge; `None` where nothing was
    /// integrated.
    pub(crate) closing_error: Option<f64>,
}

impl Run {
    /// The report of a flattening.
    pub(crate) fn new(pipeline: &Pipeline, flat: &Flattening) -> Self {
        let solution = flat.solution.as_ref();
        let history = solution.map_or(&[][..], AngleSolution::history);
        let last = history.last();
        let settings = Asked::new(pipeline);
        let is_diagonal = (settings.wheel, settings.hessian) != (Some(WheelForm::Product), Some(Hessian::Exact));
        Self {
            settings,
            termination: flat.termination,
            constraint_residual: solution.map(AngleSolution::constraint_residual),
            angles_out_of_range: solution.map(AngleSolution::angles_out_of_range),
            energy: solution.filter(|_| pipeline.newton_settings().is_some()).map(AngleSolution::energy),
            iterations: solution.map_or(0, AngleSolution::iterations),
            inner_iterations: solution.map_or(0, AngleSolution::inner_iterations),
            inner_residual: last.map(|record| record.inner_residual),
            inner_residual_worst: history.iter().map(|record| record.inner_residual).reduce(worse),
            inner_estimate: last.and_then(|record| record.inner_estimate),
            inner_unconverged: history.iter().filter(|record: &&IterationRecord| !record.inner_converged).count(),
            negative_curvature: solution.filter(|_| is_diagonal).map(AngleSolution::negative_curvature),
            fallbacks: solution.map(AngleSolution::fallbacks),
            moved_angles: solution.map_or(0, AngleSolution::moved_angles) + flat.layout.moved_angles,
            switched_rings: flat.switched_rings,
            layout: flat.layout.kind,
            closing_error: flat.layout.closing_error,
        }
    }
}

/// The larger of two, NaN being the largest.
fn worse(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}
