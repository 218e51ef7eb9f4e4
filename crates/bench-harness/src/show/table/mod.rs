//! Records as tables. The columns are defined once; each format supplies its row.

mod atlas;
mod cell;
mod columns;
mod format;
mod full;

use crate::record::{Outcome, Record, Size};
use crate::show::findings::remark;
pub(crate) use cell::Cell;
use columns::{COMPARISON, MESHES, PAGE, REPEATS, SOLVERS};
pub(crate) use columns::{Column, Columns, DIGITS};
pub(crate) use format::{aligned, csv};
use std::cmp::Ordering;

/// The table of the results of one solver, or of none: one in full, several with a row each.
pub(crate) fn of_meshes(records: &[Record]) -> String {
    match records {
        [record] => full::in_full(record),
        _ => format::aligned(MESHES, &refs(records)),
    }
}

/// The table of one mesh and several solvers, the worst first, and below it a sentence for everything
/// that did not go well.
pub(crate) fn of_solvers(records: &[Record]) -> String {
    of_one_mesh(SOLVERS, records)
}

/// The same with the spread of repeated runs, and with what changed since the baseline.
pub(crate) fn of_repeats(records: &[Record]) -> String {
    of_one_mesh(REPEATS, records)
}

/// Every result of a comparison, in the order of the meshes, as Markdown.
pub(crate) fn comparison_markdown(records: &[Record]) -> String {
    format::markdown(COMPARISON, &refs(records))
}

/// Every result of a comparison, in the order of the meshes, as comma-separated values.
pub(crate) fn comparison_csv(records: &[Record]) -> String {
    csv(COMPARISON, &refs(records))
}

/// The cells of a result for a page, which has the mesh and the solver already.
pub(crate) fn page_cells(record: &Record) -> Vec<(String, abf_report::page::Cell)> {
    let cells = PAGE.iter().copied().flatten().map(|column| (column, (column.cell)(record)));
    let shown = cells.filter(|(column, cell)| !column.is_optional || *cell != Cell::Nothing);
    shown.map(|(column, cell)| (column.head.to_owned(), cell.for_page())).collect()
}

fn refs(records: &[Record]) -> Vec<&Record> {
    records.iter().collect()
}

fn of_one_mesh(columns: Columns, records: &[Record]) -> String {
    let [first, ..] = records else { return String::new() };
    let size = first.size.as_ref().map_or_else(String::new, |size: &Size| format!(": {}", full::size_line(size)));
    let mut sorted = refs(records);
    sorted.sort_by(|a, b| worst_first(a, b));
    let said: String = sorted.iter().filter_map(|record| sentence(record)).map(|text| format!("{text}\n")).collect();
    format!("{}{size}\n{}{said}", first.mesh, format::aligned(columns, &sorted))
}

/// No result, then one that is not as asked or not valid, then the rest; among equals the slowest
/// first; last of all what was left out.
fn worst_first(a: &Record, b: &Record) -> Ordering {
    let class = |record: &Record| match record.outcome() {
        _ if record.not_run.is_some() => 3,
        Outcome::Failed => 0,
        Outcome::NotAsAsked => 1,
        Outcome::AsAsked => 2,
    };
    let seconds = |record: &Record| record.timings_s.map_or(0.0, |timings| timings.stages.flatten);
    class(a).cmp(&class(b)).then(seconds(b).total_cmp(&seconds(a)))
}

fn sentence(record: &Record) -> Option<String> {
    let remark = remark(record)?;
    Some(match &record.solver {
        Some(solver) => format!("{solver}: {remark}"),
        None => remark,
    })
}
