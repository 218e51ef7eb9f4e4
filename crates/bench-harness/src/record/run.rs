//! What the solver and the layout did.

use super::figure::{self, known};
use super::made_injective::MadeInjective;
use super::pins::Pinned;
use super::settings::Asked;
use super::text;
use crate::record::failure::chain;
use abf::hierarchy::LevelReport;
use abf::{
    BoundaryReport, Energy, Flattening, Hessian, HierarchyReport, LayoutKind, LayoutReport, Pipeline, PrecisionLimits,
    RelaxReport, RungReport, SolveReport, SolverKind, Termination, UnwrappedChart, WheelForm,
};
use serde::{Deserialize, Serialize};
use std::ops::Deref;

/// What was asked of the solver and the layout, and what they did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunRecord {
    /// What it was asked.
    pub(crate) settings: Asked,
    /// What it did; of a mesh in charts, all of them together.
    #[serde(flatten)]
    pub(crate) solved: Solved,
}

/// What the solver and the layout did on one disk, or on all charts of a mesh.
///
/// `None` where no angles are solved for, if nothing else is said.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Solved {
    /// Whose result it is: with `auto` the solver it came to; the names of several with commas.
    pub(crate) solved_by: String,
    /// What `auto` tried, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) rungs: Vec<RungRecord>,
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
    /// Angles clamped to their bounds: between passes by the solver, and before the layout.
    pub(crate) clamped_angles: usize,
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
    /// What became of the boundary that was asked for; absent where it was free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) boundary: Option<BoundaryMet>,
    /// The levels of a hierarchical solver; absent of others, and of charts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) hierarchy: Option<Hierarchy>,
    /// What relaxing did; absent where it was not asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) relaxed: Option<Relaxed>,
    /// What was done about overlaps; absent where nothing was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) made_injective: Option<MadeInjective>,
    /// What became of pins; absent where there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) pins: Option<Pinned>,
}

/// The levels of a hierarchical solver: see [`abf::HierarchyReport`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Hierarchy {
    /// Every level, the coarsest first; empty where the mesh was solved without a hierarchy.
    pub(crate) levels: Vec<LevelReport>,
    /// Why it was, where it is not too small for one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) fallback: Option<String>,
}

impl Hierarchy {
    fn new(report: &HierarchyReport) -> Self {
        let fallback = report.fallback.as_ref().map(ToString::to_string);
        Self { levels: report.levels.clone(), fallback }
    }
}

/// What relaxing a map did: see [`abf::RelaxReport`]. Of several charts the largest energies, and all steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Relaxed {
    /// Which energy.
    #[serde(with = "text")]
    pub(crate) energy: Energy,
    /// What it was before.
    #[serde(with = "figure")]
    pub(crate) before: f64,
    /// What it is at the end.
    #[serde(with = "figure")]
    pub(crate) after: f64,
    /// How many steps it took.
    pub(crate) steps: usize,
    /// How many of these went for shapes within reach.
    pub(crate) progressive_steps: usize,
    /// Whether it started from Tutte's embedding.
    pub(crate) from_tutte: bool,
}

impl Relaxed {
    fn new(report: &RelaxReport) -> Self {
        Self {
            energy: report.energy,
            before: known(report.before),
            after: known(report.after),
            steps: report.steps,
            progressive_steps: report.progressive_steps,
            from_tutte: report.from_tutte,
        }
    }

    fn and(self, other: Self) -> Self {
        Self {
            energy: self.energy,
            before: self.before.max(other.before),
            after: self.after.max(other.after),
            steps: self.steps + other.steps,
            progressive_steps: self.progressive_steps + other.progressive_steps,
            from_tutte: self.from_tutte || other.from_tutte,
        }
    }
}

/// What became of the boundary that was asked for: see [`abf::BoundaryReport`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct BoundaryMet {
    /// Solves with new conditions, of a circle.
    pub(crate) rounds: usize,
    /// The corners of a rectangle.
    pub(crate) corners: Option<[u32; 4]>,
    /// The lengths of its sides, UV units.
    pub(crate) sides: Option<[f64; 4]>,
    /// By how much the UVs miss what was asked for, rad.
    #[serde(with = "figure")]
    pub(crate) violation: f64,
    /// The largest angle of the boundary, rad.
    #[serde(with = "figure")]
    pub(crate) largest_angle: f64,
    /// The largest radius over the smallest.
    pub(crate) radius_spread: Option<f64>,
    /// Whether convexity proves that nothing overlaps.
    pub(crate) injective_by_convexity: bool,
}

impl BoundaryMet {
    fn new(report: &BoundaryReport) -> Self {
        Self {
            rounds: report.rounds,
            corners: report.corners,
            sides: report.sides.filter(|sides| sides.iter().all(|side| side.is_finite())),
            violation: known(report.violation),
            largest_angle: known(report.largest_angle),
            radius_spread: finite(report.radius_spread),
            injective_by_convexity: report.injective_by_convexity,
        }
    }
}

/// What one solver of the ladder came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RungRecord {
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
    /// How long it took with its layout and its certificate, seconds; absent of charts, which are worked on side by side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) time_s: Option<f64>,
    /// Why it found nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<String>,
}

impl Deref for RunRecord {
    type Target = Solved;

    fn deref(&self) -> &Solved {
        &self.solved
    }
}

impl RungRecord {
    fn new(report: &RungReport, time_s: Option<f64>) -> Self {
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

impl RunRecord {
    /// The report of a flattening; the rungs took so long.
    pub(crate) fn new(pipeline: &Pipeline, flat: &Flattening, rung_seconds: &[f64]) -> Self {
        let seconds = rung_seconds.iter().copied().map(Some).chain(std::iter::repeat(None));
        let rungs = flat.rungs.iter().zip(seconds).map(|(rung, time_s)| RungRecord::new(rung, time_s)).collect();
        let (report, layout) = (flat.solve_report(), &flat.layout);
        let solved = Solved::new(pipeline, (flat.solver, flat.termination), &report, layout, rungs);
        let precision_limits = flat.precision_limits.as_ref().map(Limits::new);
        let boundary = flat.boundary.as_ref().map(BoundaryMet::new);
        let hierarchy = flat.hierarchy.as_ref().map(Hierarchy::new);
        let relaxed = flat.relaxed.as_ref().map(Relaxed::new);
        let pins = flat.pinned.as_ref().map(Pinned::new);
        let made_injective = flat.injective.as_ref().map(MadeInjective::new);
        let solved = Solved { precision_limits, boundary, hierarchy, relaxed, made_injective, pins, ..solved };
        Self { settings: Asked::new(pipeline), solved }
    }

    /// The report of a mesh in charts; `None` where there are none.
    pub(crate) fn of_charts<'a>(pipeline: &Pipeline, mut charts: impl Iterator<Item = &'a Solved>) -> Option<Self> {
        let first = charts.next()?.clone();
        let solved = charts.fold(first, Solved::and);
        Some(Self { settings: Asked::new(pipeline), solved })
    }
}

impl Limits {
    fn new(limits: &PrecisionLimits) -> Self {
        Self {
            near_collapsed: limits.near_collapsed,
            near_collapsed_faces: limits.near_collapsed_faces.iter().map(|face| face.index()).collect(),
            held_faces: limits.held_faces,
            first_held_faces: limits.first_held_faces.iter().map(|face| face.index()).collect(),
            spread: known(limits.spread),
        }
    }
}

impl Solved {
    /// What became of a chart.
    pub(crate) fn of_chart(pipeline: &Pipeline, chart: &UnwrappedChart) -> Self {
        let rungs = chart.rungs.iter().map(|rung| RungRecord::new(rung, None)).collect();
        let relaxed = chart.relaxed.as_ref().map(Relaxed::new);
        let solved = Self::new(pipeline, (chart.solver, chart.termination), &chart.solve, &chart.layout, rungs);
        let made_injective = chart.injective.as_ref().map(MadeInjective::new);
        Self { relaxed, made_injective, ..solved }
    }

    fn new(
        pipeline: &Pipeline,
        (solver, termination): (SolverKind, Termination),
        report: &SolveReport,
        layout: &LayoutReport,
        rungs: Vec<RungRecord>,
    ) -> Self {
        let newton = pipeline.solver.newton_settings();
        let is_diagonal = newton.is_none_or(|n| (n.wheel, n.hessian) != (WheelForm::Product, Hessian::Exact));
        Self {
            solved_by: solver.to_string(),
            rungs,
            termination,
            constraint_residual: finite(report.constraint_residual),
            angles_out_of_range: report.angles_out_of_range,
            energy: finite(report.energy),
            iterations: report.iterations,
            inner_iterations: report.inner_iterations,
            inner_residual: finite(report.inner_residual),
            inner_residual_worst: finite(report.inner_residual_worst),
            inner_estimate: finite(report.inner_estimate),
            inner_unconverged: report.inner_unconverged,
            negative_curvature: report.negative_curvature.filter(|_| is_diagonal),
            fallbacks: report.fallbacks,
            clamped_angles: report.clamped_angles,
            switched_rings: report.switched_rings,
            shapeless_faces: report.shapeless_faces,
            layout: layout.kind,
            closing_error: finite(layout.closing_error),
            pinned: layout.pinned,
            scaled: layout.scaled,
            precision_limits: None,
            boundary: None,
            hierarchy: None,
            relaxed: None,
            made_injective: None,
            pins: None,
        }
    }

    /// Both together: counts and energies add up, of residuals the larger one counts, and of endings the first that is not
    /// as asked.
    fn and(mut self, other: &Self) -> Self {
        if !self.solved_by.split(", ").any(|name| name == other.solved_by) {
            self.solved_by = format!("{}, {}", self.solved_by, other.solved_by);
        }
        let is_worse = self.termination.is_as_asked() && !other.termination.is_as_asked();
        Self {
            termination: if is_worse { other.termination } else { self.termination },
            solved_by: self.solved_by,
            rungs: Vec::new(),
            constraint_residual: joined(self.constraint_residual, other.constraint_residual, f64::max),
            angles_out_of_range: joined(self.angles_out_of_range, other.angles_out_of_range, |a, b| a + b),
            energy: joined(self.energy, other.energy, |a, b| a + b),
            iterations: self.iterations + other.iterations,
            inner_iterations: self.inner_iterations + other.inner_iterations,
            inner_residual: joined(self.inner_residual, other.inner_residual, f64::max),
            inner_residual_worst: joined(self.inner_residual_worst, other.inner_residual_worst, f64::max),
            inner_estimate: joined(self.inner_estimate, other.inner_estimate, f64::max),
            inner_unconverged: self.inner_unconverged + other.inner_unconverged,
            negative_curvature: joined(self.negative_curvature, other.negative_curvature, usize::max),
            fallbacks: joined(self.fallbacks, other.fallbacks, |a, b| a + b),
            clamped_angles: self.clamped_angles + other.clamped_angles,
            switched_rings: self.switched_rings + other.switched_rings,
            shapeless_faces: self.shapeless_faces + other.shapeless_faces,
            layout: self.layout.filter(|&kind| other.layout == Some(kind)),
            closing_error: joined(self.closing_error, other.closing_error, f64::max),
            pinned: self.pinned && other.pinned,
            scaled: self.scaled && other.scaled,
            precision_limits: None,
            boundary: None,
            hierarchy: None,
            relaxed: joined(self.relaxed, other.relaxed, Relaxed::and),
            made_injective: joined(self.made_injective, other.made_injective.clone(), MadeInjective::and),
            pins: None,
        }
    }
}

/// Of two values both, of one that one.
fn joined<T>(one: Option<T>, other: Option<T>, both: impl FnOnce(T, T) -> T) -> Option<T> {
    match (one, other) {
        (Some(one), Some(other)) => Some(both(one, other)),
        (one, other) => one.or(other),
    }
}

/// What JSON can say of a number; one that is not finite says nothing.
fn finite(x: Option<f64>) -> Option<f64> {
    x.filter(|x| x.is_finite())
}
