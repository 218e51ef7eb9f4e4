//! Histories for programs: JSON, or a row for every iteration.

use super::table::{Cell, Column, Columns, csv};
use crate::record::history::{History, Iteration, to_json};
use std::path::Path;

/// A file with this ending gets rows.
const CSV: &str = "csv";

/// What a file of that name holds: comma-separated values if it ends in `.csv`, else JSON.
pub(crate) fn text(file: Option<&Path>, runs: &[History]) -> String {
    let ending = file.and_then(Path::extension).and_then(|ending| ending.to_str());
    if ending.is_some_and(|ending| ending.eq_ignore_ascii_case(CSV)) { to_csv(runs) } else { to_json(runs) }
}

/// One iteration with the run it is of.
struct Row {
    mesh: String,
    solver: String,
    settings: String,
    done: Iteration,
}

/// The estimates after inner iterations are in the JSON only.
const COLUMNS: Columns<Row> = &[&[
    Column::text("mesh", "mesh", |row| Cell::Text(row.mesh.clone())),
    Column::text("solver", "solver", |row| Cell::Text(row.solver.clone())),
    Column::text("by", "by", |row| Cell::Text(row.done.by.clone())),
    Column::text("stage", "stage", |row| Cell::Text(row.done.stage.name().to_owned())),
    Column::number("start", "start", |row| Cell::Count(row.done.start)),
    Column::number("corners", "corners", |row| Cell::Count(row.done.corners)),
    Column::number("iteration", "iteration", |row| Cell::Count(row.done.iteration)),
    Column::number("time", "time_s", |row| Cell::Seconds(row.done.time_s)),
    Column::number("residual", "constraint_residual", |row| figure(row.done.constraint_residual)),
    Column::number("F", "f", |row| figure(row.done.f)),
    Column::number("flips", "flips", |row| row.done.flips.map_or(Cell::Nothing, Cell::Count)),
    Column::number("energy", "energy", |row| figure(row.done.energy)),
    Column::text("energy of", "energy_of", |row| words(row.done.energy_of.as_ref())),
    Column::number("step", "step", |row| figure(row.done.step)),
    Column::number("length", "step_length", |row| figure(row.done.step_length)),
    Column::number("inner", "inner_iterations", |row| Cell::Count(row.done.inner_iterations)),
    Column::number("inner residual", "inner_residual", |row| figure(row.done.inner_residual)),
    Column::number("estimate", "inner_estimate", |row| figure(row.done.inner_estimate)),
    Column::text("inner converged", "inner_converged", |row| words(row.done.inner_converged.as_ref())),
    Column::number("negative", "negative_curvature", |row| Cell::Count(row.done.negative_curvature)),
    Column::text("fallback", "fallback", |row| words(row.done.fallback.as_ref())),
    Column::number("clamped", "clamped_angles", |row| Cell::Count(row.done.clamped_angles)),
    Column::text("settings", "settings", |row| Cell::Text(row.settings.clone())),
]];

fn figure(x: Option<f64>) -> Cell {
    const DIGITS: usize = 4;
    x.map_or(Cell::Nothing, |x| Cell::Figure(x, DIGITS))
}

fn words(x: Option<&impl ToString>) -> Cell {
    x.map_or(Cell::Nothing, |x| Cell::Text(x.to_string()))
}

fn to_csv(runs: &[History]) -> String {
    let rows: Vec<Row> = runs.iter().flat_map(rows).collect();
    csv(COLUMNS, &rows.iter().collect::<Vec<_>>())
}

fn rows(run: &History) -> impl Iterator<Item = Row> {
    let settings = run.settings.listed().into_iter().map(|(name, value)| format!("{name}={value}"));
    let settings = settings.collect::<Vec<_>>().join("; ");
    run.iterations.iter().map(move |done| Row {
        mesh: run.mesh.clone(),
        solver: run.solver.clone(),
        settings: settings.clone(),
        done: done.clone(),
    })
}
