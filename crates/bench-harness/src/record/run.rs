//! What the solver and the layout did.

use super::figure::{self, known};
use super::settings::Asked;
use super::text;
use crate::record::failure::chain;
use abf::{
    AngleSolution, Flattening, Hessian, IterationRecord, LayoutKind, Pipeline, RungReport, Termination, WheelForm,
};
use serde::{Deserialize, Serialize};

/// What was asked of the solver and the layout, and what they did.
///
/// `None` where no angles are solved for, if nothing else is said.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Run {
    /// What it was asked.
    pub(crate) settings: Asked,
    /// Whose result it is: with `auto` the solver it came to.
    pub(crate) solved_by: String,
    /// What `auto` tried, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) rungs: Vec<Rung>,
    /// How it ended.
    #[serde(with = "text::ending")]
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
    /// `‖b − Ax‖ / ‖b‖` of the last linear solve, computed; `None` where there was nothing left to solve.
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
    /// Triangles without a shape, solved for as thin ones.
    pub(crate) shapeless_faces: usize,
    /// The layout that was used; never `auto`. `None` for the descent, whose unknowns are the UVs.
    #[serde(with = "text::optional")]
    pub(crate) layout: Option<LayoutKind>,
    /// The largest disagreement between the two sides of an edge; `None` where nothing was
    /// integrated.
    pub(crate) closing_error: Option<f64>,
    /// Whether the first pin is at the origin and the second on the positive x-axis.
    pub(crate) pinned: bool,
    /// Whether the UVs have the scale that was asked for.
    pub(crate) scaled: bool,
    /// How near the UVs are to what doubles can hold; `None` where there is room to spare.
    pub(crate) precision_limits: Option<Limits>,
}

/// What one solver of the ladder came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Rung {
    /// Which solver.
    pub(crate) solver: String,
    /// How it ended; `None` when it found nothing.
    #[serde(with = "text::ending::optional")]
    pub(crate) termination: Option<Termination>,
    /// Passes, iterations or steps.
    pub(crate) iterations: usize,
    /// Whether its UVs are valid.
    pub(crate) valid: bool,
    /// Its flipped triangles.
    pub(crate) flips: usize,
    /// Its collapsed triangles.
    pub(crate) collapsed: usize,
    /// Interior vertices that are wound around twice.
    pub(crate) wound: usize,
    /// `F / 3nt` of its UVs, rad²; `None` where there was nothing to compare it with.
    pub(crate) f: Option<f64>,
    /// How long it took with its layout and its certificate, seconds.
    pub(crate) time_s: f64,
    /// Why it found nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<String>,
}

impl Rung {
    fn new(report: &RungReport, time_s: f64) -> Self {
        Self {
            solver: report.solver.to_string(),
            termination: report.termination,
            iterations: report.iterations,
            valid: report.valid,
            flips: report.flips,
            collapsed: report.collapsed,
            wound: report.wound,
            f: finite(report.f),
            time_s,
            error: report.error.as_ref().map(|error| chain(error)),
        }
    }
}

/// Why double precision is what UVs suffer from: see [`abf::PrecisionLimits`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Limits {
    /// Triangles that another rounding could turn over.
    pub(crate) near_collapsed: usize,
    /// The first of them, counted from 0.
    pub(crate) near_collapsed_faces: Vec<usize>,
    /// Triangles that the descent held in place.
    pub(crate) held_faces: usize,
    /// The first of them.
    pub(crate) first_held_faces: Vec<usize>,
    /// How much more lengths shrink in one place than in another.
    #[serde(with = "figure")]
    pub(crate) spread: f64,
}

impl Run {
    /// The report of a flattening; the rungs took so long.
    pub(crate) fn new(pipeline: &Pipeline, flat: &Flattening, rung_seconds: &[f64]) -> Self {
        let solution = flat.solution.as_ref();
        let history = solution.map_or(&[][..], AngleSolution::history);
        let last = history.last();
        let settings = Asked::new(pipeline);
        let has_a_fixed_target = flat.solver.finds_angles() && !flat.solver.makes_passes();
        let seconds = rung_seconds.iter().copied().chain(std::iter::repeat(0.0));
        let is_diagonal = (settings.wheel, settings.hessian) != (Some(WheelForm::Product), Some(Hessian::Exact));
        Self {
            settings,
            solved_by: flat.solver.to_string(),
            rungs: flat.rungs.iter().zip(seconds).map(|(rung, time_s)| Rung::new(rung, time_s)).collect(),
            termination: flat.termination,
            constraint_residual: finite(solution.map(AngleSolution::constraint_residual)),
            angles_out_of_range: solution.map(AngleSolution::angles_out_of_range),
            energy: finite(solution.filter(|_| has_a_fixed_target).map(AngleSolution::energy)),
            iterations: solution.map_or(0, AngleSolution::iterations),
            inner_iterations: solution.map_or(0, AngleSolution::inner_iterations),
            inner_residual: finite(last.and_then(IterationRecord::solved_to)),
            inner_residual_worst: finite(history.iter().filter_map(IterationRecord::solved_to).reduce(worse)),
            inner_estimate: finite(last.and_then(|record| record.inner_estimate)),
            inner_unconverged: history.iter().filter(|record: &&IterationRecord| !record.inner_converged).count(),
            negative_curvature: solution.filter(|_| is_diagonal).map(AngleSolution::negative_curvature),
            fallbacks: solution.map(AngleSolution::fallbacks),
            moved_angles: solution.map_or(0, AngleSolution::moved_angles) + flat.layout.moved_angles,
            switched_rings: flat.switched_rings,
            shapeless_faces: flat.shapeless_faces,
            layout: flat.layout.kind,
            closing_error: finite(flat.layout.closing_error),
            pinned: flat.layout.pinned,
            scaled: flat.layout.scaled,
            precision_limits: flat.precision_limits.as_ref().map(|limits| Limits {
                near_collapsed: limits.near_collapsed,
                near_collapsed_faces: limits.near_collapsed_faces.iter().map(|face| face.index()).collect(),
                held_faces: limits.held_faces,
                first_held_faces: limits.first_held_faces.iter().map(|face| face.index()).collect(),
                spread: known(limits.spread),
            }),
        }
    }
}

/// The larger of two, NaN being the largest.
fn worse(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// What JSON can say of a number; one that is not finite says nothing.
fn finite(x: Option<f64>) -> Option<f64> {
    x.filter(|x| x.is_finite())
}
