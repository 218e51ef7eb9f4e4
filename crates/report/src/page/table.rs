//! The tables of one mesh: its runs and their settings.

use std::borrow::Cow;

use super::html::{Html, NOTHING, sort_attribute};
use super::judge::{Judgement, Outcome, validity};
use super::{Cell, MESH_NUMBER};

/// A column of the table of runs.
struct Column<'a> {
    head: &'a str,
    /// Whether some run has a number there.
    is_number: bool,
}

/// Every run in a row, with its outcome and the columns it came with.
pub(crate) fn runs_table(judgement: &Judgement<'_>) -> String {
    let columns = columns(judgement);
    let mut heads = vec![(Cow::Borrowed("Solver"), false), (Cow::Borrowed("UV map"), false)];
    heads.extend(columns.iter().map(|column| (Cow::Borrowed(column.head), column.is_number)));
    let rows: String = (0..judgement.outcomes.len()).map(|run| row(judgement, run, &columns)).collect();
    let mut html = Html::default();
    html.table(&format!("Runs on {}", judgement.section.name), &heads, &rows);
    html.finish()
}

/// The columns of all runs, each once.
fn columns<'a>(judgement: &'a Judgement<'_>) -> Vec<Column<'a>> {
    let runs = &judgement.section.runs;
    let has_number = |head: &str| {
        runs.iter().flat_map(|run| &run.columns).any(|(h, cell)| h == head && matches!(cell, Cell::Number { .. }))
    };
    let heads = union(runs.iter().map(|run| &run.columns));
    heads.into_iter().map(|head| Column { head, is_number: has_number(head) }).collect()
}

/// The row of a run.
fn row(judgement: &Judgement<'_>, run: usize, columns: &[Column<'_>]) -> String {
    let mut html = Html::default();
    html.raw(&format!("<tr id=\"mesh-{MESH_NUMBER}-run-{}\"{}>", run + 1, row_class(judgement, run)));
    html.raw("<th scope=\"row\">");
    html.text(&judgement.labels[run]);
    if judgement.is_lowest(run) {
        html.raw(" <span class=\"badge\">lowest F</span>");
    }
    html.raw("</th>");
    html.raw(&outcome_cell(&judgement.outcomes[run]));
    let cells = &judgement.section.runs[run].columns;
    for column in columns {
        let cell = cells.iter().find(|(head, _)| head == column.head).map_or(&Cell::Missing, |(_, cell)| cell);
        html.raw(&table_cell(cell, column.is_number));
    }
    html.raw("</tr>\n");
    html.finish()
}

fn row_class(judgement: &Judgement<'_>, run: usize) -> &'static str {
    match &judgement.outcomes[run] {
        Outcome::Failed(_) => " class=\"failed\"",
        Outcome::Judged(metrics) if !metrics.valid() => " class=\"invalid\"",
        _ if judgement.is_lowest(run) => " class=\"best\"",
        _ => "",
    }
}

/// How the layout lies, or why there is none.
fn outcome_cell(outcome: &Outcome) -> String {
    let mut html = Html::default();
    match outcome {
        Outcome::Judged(metrics) => html.element("td", "", &validity(metrics)),
        Outcome::Failed(reason) => html.element("td", "class=\"reason\"", &format!("failed: {reason}")),
        Outcome::Unseen => html.raw(&table_cell(&Cell::Missing, false)),
    }
    html.finish()
}

/// A cell, on the right in a column of numbers.
fn table_cell(cell: &Cell, in_numbers: bool) -> String {
    let class = if in_numbers { "class=\"number\"" } else { "" };
    let mut html = Html::default();
    match cell {
        Cell::Text(text) => html.element("td", class, text),
        Cell::Number { value, shown } => html.element("td", &format!("{class} {}", sort_attribute(*value)), shown),
        Cell::Missing => html.raw(&format!("<td {class} data-missing>{NOTHING}</td>")),
    }
    html.finish()
}

/// The settings of every run, folded away.
pub(crate) fn settings(judgement: &Judgement<'_>) -> String {
    let runs = &judgement.section.runs;
    let heads = union(runs.iter().map(|run| &run.settings));
    if heads.is_empty() {
        return String::new();
    }
    // Settings downwards: there are more of them than solvers.
    let mut columns = vec![(Cow::Borrowed("Setting"), false)];
    columns.extend(judgement.labels.iter().map(|label| (Cow::Borrowed(label.as_str()), false)));
    let mut rows = Html::default();
    for head in &heads {
        rows.raw("<tr>");
        rows.element("th", "scope=\"row\"", head);
        for run in runs {
            let value = run.settings.iter().find(|(name, _)| name == head).map(|(_, value)| value);
            rows.raw(&table_cell(&value.map_or(Cell::Missing, |value| Cell::Text(value.clone())), false));
        }
        rows.raw("</tr>\n");
    }
    let mut html = Html::default();
    html.raw("<details>\n<summary>Settings of the runs</summary>\n");
    html.table(&format!("Settings of the runs on {}", judgement.section.name), &columns, &rows.finish());
    html.raw("</details>\n");
    html.finish()
}

/// The names in several lists, each once, in the order in which they first occur.
fn union<'a, T: 'a>(lists: impl Iterator<Item = &'a Vec<(String, T)>>) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in lists.flatten() {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names
}
