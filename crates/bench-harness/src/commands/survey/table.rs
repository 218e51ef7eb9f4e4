//! The table of a survey.

use crate::record::Quality;
use crate::record::number::{count, seconds};
use crate::record::surveyed::Surveyed;
use crate::show::table::{Cell, Column, Columns, DIGITS, aligned};

/// The rows of a survey, in the order given.
pub(super) fn of_survey(rows: &[&Surveyed]) -> String {
    aligned(COLUMNS, rows)
}

/// Many meshes, one solver.
const COLUMNS: Columns<Surveyed> = &[&[
    Column::text("mesh", "mesh", |row| Cell::Text(row.record.mesh.clone())),
    Column::number("triangles", "triangles", |row| row.record.size.map(|size| Cell::Count(size.triangles)).into()),
    Column::text("solver", "solver", |row| method(row).map(Cell::Text).into()),
    Column::text("result", "result", |row| Cell::Text(row.result.clone())),
    Column::number("flips", "flips", |row| of(row, |q| Cell::Count(q.flips))),
    Column::number("collapsed", "collapsed", |row| of(row, |q| Cell::Count(q.collapsed))),
    Column::number("wound", "wound", |row| of(row, |q| Cell::Count(q.wound))),
    Column::number("overlaps", "overlaps", |row| of(row, |q| Cell::Count(q.overlaps))),
    Column::number("F/3nt", "f", |row| of(row, |q| Cell::Figure(q.f, DIGITS))),
    Column::number("L2", "stretch_l2", |row| of(row, |q| Cell::Figure(q.stretch_l2, DIGITS))),
    Column::number("time", "total_s", |row| row.record.timings_s.map(|t| Cell::Seconds(t.total)).into()),
    Column::text("time of each method tried", "rungs", |row| rungs(row).map(Cell::Text).into()),
]];

fn of(row: &Surveyed, cell: impl Fn(&Quality) -> Cell) -> Cell {
    row.record.quality.as_ref().map(cell).into()
}

/// The solver, and what it came down to where it has several methods.
fn method(row: &Surveyed) -> Option<String> {
    let solver = row.record.solver.as_deref()?;
    Some(match (&row.record.run, &row.record.atlas) {
        (Some(run), Some(atlas)) => {
            format!("{solver}: {} by {}", count(atlas.charts.len(), "chart", "charts"), run.solved_by)
        }
        (Some(run), None) if run.solved_by != solver => format!("{solver}: {}", run.solved_by),
        _ => solver.to_owned(),
    })
}

/// How long each of the methods that were tried took, where a solver tries several.
fn rungs(row: &Surveyed) -> Option<String> {
    let rungs = &row.record.run.as_ref().filter(|run| !run.rungs.is_empty())?.rungs;
    let times = rungs.iter().filter_map(|rung| Some(format!("{} {}", rung.solver, seconds(rung.time_s?))));
    Some(times.collect::<Vec<_>>().join(", "))
}
