//! The columns there are, and which table has which.

use super::cell::Cell;
use crate::record::{Change, Quality, Record, RunRecord};
use crate::show::findings::remark;

/// How many digits errors and stretch are shown with.
pub(crate) const DIGITS: usize = 4;
/// How many digits residuals are shown with: their size matters, not their value.
const RESIDUAL_DIGITS: usize = 2;

/// One column: its head, and the cell of a record.
#[derive(Clone, Copy)]
pub(crate) struct Column<R = Record> {
    /// For people.
    pub(crate) head: &'static str,
    /// For programs, with the unit.
    pub(crate) name: &'static str,
    /// Whether its cells are words, which begin at its left edge.
    pub(crate) is_text: bool,
    /// Whether it is left out where no record has a value.
    pub(crate) is_optional: bool,
    /// Reads the cell.
    pub(crate) cell: fn(&R) -> Cell,
}

impl<R> Column<R> {
    pub(crate) const fn text(head: &'static str, name: &'static str, cell: fn(&R) -> Cell) -> Self {
        Self { head, name, is_text: true, is_optional: false, cell }
    }

    pub(crate) const fn number(head: &'static str, name: &'static str, cell: fn(&R) -> Cell) -> Self {
        Self { head, name, is_text: false, is_optional: false, cell }
    }

    pub(crate) const fn optional(self) -> Self {
        Self { is_optional: true, ..self }
    }
}

/// A table: groups of columns, one after the other.
pub(crate) type Columns<R = Record> = &'static [&'static [Column<R>]];

/// How a solver ended.
const ENDED: &[Column] = &[BY.optional(), RESULT, OUTER, INNER, RESIDUAL];
/// What happened on the way.
const STEPS: &[Column] = &[INNER_RESIDUAL, NEGATIVE, FALLBACKS];
/// Whether the map is valid.
const FAULTS: &[Column] = &[FLIPS, COLLAPSED, WOUND, OVERLAPS];
/// How good it is.
const FIGURES: &[Column] = &[F, STRETCH_L2, STRETCH_LINF];
/// The times of several runs, and what changed since the baseline.
const RUNS: &[Column] = &[
    TIME,
    DEVIATION,
    LEAST,
    GREATEST,
    MEMORY,
    WAS.optional(),
    F_CHANGE.optional(),
    L2_CHANGE.optional(),
    FLIPS_CHANGE.optional(),
    TIME_CHANGE.optional(),
];

/// Several meshes, one solver or none.
pub(crate) const MESHES: Columns = &[
    &[MESH, TRIANGLES, BY.optional(), RESULT],
    &[OUTER.optional(), INNER.optional(), RESIDUAL.optional(), LAYOUT.optional()],
    FAULTS,
    FIGURES,
    &[TOTAL, MEMORY],
];

/// One mesh, several solvers.
pub(crate) const SOLVERS: Columns = &[&[SOLVER], ENDED, STEPS, &[FLIPS, OVERLAPS, F, STRETCH_L2], &[TIME, MEMORY]];

/// One mesh, several solvers, several runs.
pub(crate) const REPEATS: Columns = &[&[SOLVER], ENDED, &[FLIPS, OVERLAPS, F, STRETCH_L2], RUNS];

/// One mesh on a page, which names mesh and solver and counts flips by itself.
pub(crate) const PAGE: Columns = &[ENDED, STEPS, FIGURES, RUNS, &[REMARK.optional()]];

/// Several meshes, several solvers, several runs.
pub(crate) const COMPARISON: Columns = &[&[MESH, TRIANGLES, SOLVER], ENDED, STEPS, FAULTS, FIGURES, RUNS, &[REMARK]];

const MESH: Column = Column::text("mesh", "mesh", |r| Cell::Text(r.mesh.clone()));
const TRIANGLES: Column =
    Column::number("triangles", "triangles", |r| r.size.map(|size| Cell::Count(size.triangles)).into());
const SOLVER: Column = Column::text("solver", "solver", |r| r.solver.clone().map(Cell::Text).into());
const RESULT: Column = Column::text("result", "result", |r| Cell::Text(r.result_word()));
const OUTER: Column = Column::number("outer", "outer_iterations", |r| run(r, |run| Some(Cell::Count(run.iterations))));
const INNER: Column =
    Column::number("inner", "inner_iterations", |r| run(r, |run| Some(Cell::Count(run.inner_iterations))));
const RESIDUAL: Column =
    Column::number("residual", "constraint_residual_rad", |r| run(r, |run| residual(run.constraint_residual)));
const INNER_RESIDUAL: Column =
    Column::number("worst inner", "inner_residual_worst", |r| run(r, |run| residual(run.inner_residual_worst)));
const NEGATIVE: Column =
    Column::number("negative", "negative_curvature", |r| run(r, |run| run.negative_curvature.map(Cell::Count)));
const FALLBACKS: Column = Column::number("fallbacks", "fallbacks", |r| run(r, |run| run.fallbacks.map(Cell::Count)));
const LAYOUT: Column =
    Column::text("layout", "layout", |r| run(r, |run| run.layout.map(|kind| Cell::Text(kind.to_string()))));
const BY: Column = Column::text("by", "solved_by", |r| {
    run(r, |run| (!run.rungs.is_empty()).then(|| Cell::Text(run.solved_by.clone())))
});
const FLIPS: Column = Column::number("flips", "flips", |r| metrics(r, |m| Cell::Count(m.flips)));
const COLLAPSED: Column = Column::number("collapsed", "collapsed", |r| metrics(r, |m| Cell::Count(m.collapsed)));
const WOUND: Column = Column::number("wound", "wound", |r| metrics(r, |m| Cell::Count(m.wound)));
const OVERLAPS: Column = Column::number("overlaps", "overlaps", |r| metrics(r, |m| Cell::Count(m.overlaps)));
const F: Column = Column::number("F/3nt", "f_rad2", |r| metrics(r, |m| Cell::Figure(m.f, DIGITS)));
const STRETCH_L2: Column =
    Column::number("stretch L2", "stretch_l2", |r| metrics(r, |m| Cell::Figure(m.stretch_l2, DIGITS + 1)));
const STRETCH_LINF: Column =
    Column::number("L∞", "stretch_linf", |r| metrics(r, |m| Cell::Figure(m.stretch_linf, DIGITS)));
const TOTAL: Column = Column::number("time", "total_s", |r| r.timings_s.map(|t| Cell::Seconds(t.total)).into());
const TIME: Column =
    Column::number("time", "flatten_s", |r| r.timings_s.map(|t| Cell::Seconds(t.stages.flatten)).into());
const DEVIATION: Column =
    Column::number("±", "flatten_deviation_s", |r| r.repeats.map(|t| Cell::Seconds(t.deviation_s.flatten)).into());
const LEAST: Column =
    Column::number("least", "flatten_min_s", |r| r.repeats.map(|t| Cell::Seconds(t.min_s.flatten)).into());
const GREATEST: Column =
    Column::number("greatest", "flatten_max_s", |r| r.repeats.map(|t| Cell::Seconds(t.max_s.flatten)).into());
const MEMORY: Column = Column::number("MB", "peak_memory_bytes", |r| r.peak_memory_bytes.map(Cell::Bytes).into());
const WAS: Column = Column::text("was", "baseline_result", |r| change(r, |c| Some(Cell::Text(c.result.clone()))));
const F_CHANGE: Column = Column::number("F new/old", "baseline_f_ratio", |r| change(r, |c| c.f_ratio.map(Cell::Ratio)));
const L2_CHANGE: Column =
    Column::number("L2 new/old", "baseline_stretch_l2_ratio", |r| change(r, |c| c.stretch_l2_ratio.map(Cell::Ratio)));
const FLIPS_CHANGE: Column =
    Column::number("flips ±", "baseline_flips_change", |r| change(r, |c| c.flips_change.map(Cell::Change)));
const TIME_CHANGE: Column =
    Column::number("time new/old", "baseline_time_ratio", |r| change(r, |c| c.time_ratio.map(Cell::Ratio)));
const REMARK: Column = Column::text("remark", "remark", |r| remark(r).map(Cell::Text).into());

fn run(record: &Record, cell: impl Fn(&RunRecord) -> Option<Cell>) -> Cell {
    record.run.as_ref().and_then(cell).into()
}

fn residual(residual: Option<f64>) -> Option<Cell> {
    residual.map(|residual| Cell::Figure(residual, RESIDUAL_DIGITS))
}

fn metrics(record: &Record, cell: impl Fn(&Quality) -> Cell) -> Cell {
    record.quality.as_ref().map(cell).into()
}

fn change(record: &Record, cell: impl Fn(&Change) -> Option<Cell>) -> Cell {
    record.baseline.as_ref().and_then(cell).into()
}
