//! The columns of a survey.

use super::row::Row;
use crate::show::table::{Cell, Column, Columns, DIGITS, aligned};

/// The rows of a survey, in the order given.
pub(super) fn of_survey(rows: &[&Row]) -> String {
    aligned(COLUMNS, rows)
}

/// Many meshes, one solver.
const COLUMNS: Columns<Row> = &[&[
    Column::text("mesh", "mesh", |row| Cell::Text(row.mesh.clone())),
    Column::number("triangles", "triangles", |row| row.triangles.map(Cell::Count).into()),
    Column::text("solver", "solver", |row| row.method().map(Cell::Text).into()),
    Column::text("result", "result", |row| Cell::Text(row.result.clone())),
    Column::number("flips", "flips", |row| fault(row, row.flips)),
    Column::number("collapsed", "collapsed", |row| fault(row, row.collapsed)),
    Column::number("wound", "wound", |row| fault(row, row.wound)),
    Column::number("overlaps", "overlaps", |row| fault(row, row.overlaps)),
    Column::number("F/3nt", "f", |row| row.f.map(|f| Cell::Figure(f, DIGITS)).into()),
    Column::number("L2", "stretch_l2", |row| row.stretch_l2.map(|l2| Cell::Figure(l2, DIGITS)).into()),
    Column::number("time", "total_s", |row| row.seconds().map(Cell::Seconds).into()),
    Column::text("time of each method tried", "rungs", |row| row.rungs().map(Cell::Text).into()),
]];

fn fault(row: &Row, count: usize) -> Cell {
    if row.refused.is_some() { Cell::Nothing } else { Cell::Count(count) }
}
