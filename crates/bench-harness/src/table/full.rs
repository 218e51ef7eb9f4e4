//! Records for people: one in full, several side by side.

use crate::advice::ending;
use crate::number::{count, megabytes, seconds, significant};
use crate::record::{Quality, Record, Run, Size, Timings};
use abf::Metrics;
use std::fmt::Write;

/// How many digits errors and stretch are shown with.
const DIGITS: usize = 4;
/// How many digits residuals are shown with: their size matters, not their value.
const RESIDUAL_DIGITS: usize = 2;
/// Where there is nothing to show.
const NOTHING: &str = "-";

/// The table of one record or of several.
pub(crate) fn table(records: &[Record]) -> String {
    match records {
        [record] => in_full(record),
        _ => side_by_side(records),
    }
}

/// Everything about one mesh, a line for each matter.
fn in_full(record: &Record) -> String {
    let mut lines: Vec<(&str, String)> = Vec::new();
    if let Some(size) = &record.size {
        lines.push(("size", size_line(size)));
    }
    if let Some(run) = &record.run {
        lines.extend([("solver", solver_line(run)), ("ended", ended_line(run)), ("layout", layout_line(run))]);
    }
    if let Some(quality) = &record.quality {
        lines.push(("valid", valid_line(quality)));
        lines.extend(distortion_lines(quality.metrics()));
    }
    if let Some(timings) = &record.timings_s {
        lines.push(("time", time_line(timings)));
    }
    if let Some(bytes) = record.peak_memory_bytes {
        lines.push(("memory", format!("{} MB at most", megabytes(bytes))));
    }
    lines.extend(record.written.iter().map(|path| ("written", path.clone())));
    if let Some(failure) = &record.error {
        lines.push(("error", failure.kind.to_owned()));
    }
    let mut out = format!("{}\n", record.mesh);
    for (label, text) in lines {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "  {label:<13}{text}");
    }
    out
}

fn size_line(size: &Size) -> String {
    let mut parts = vec![count(size.triangles, "triangle", "triangles"), count(size.vertices, "vertex", "vertices")];
    if let Some(interior) = size.interior_vertices {
        parts.push(format!("{interior} of them interior"));
    }
    if let Some(loops) = size.boundary_loops {
        parts.push(count(loops, "boundary loop", "boundary loops"));
    }
    parts.join(", ")
}

fn solver_line(run: &Run) -> String {
    let asked = &run.settings;
    let mut parts = vec![run.solver.to_owned()];
    // A method without angles takes none of these.
    if run.constraint_residual.is_some() {
        parts.push(format!("passes {}", asked.passes));
        parts.push(match asked.ring_switch {
            Some(threshold) => format!("ring switch {threshold} rad ({} switched)", run.switched_rings),
            None => "ring switch off".to_owned(),
        });
        parts.push(format!("tolerance {:e} rad", asked.tolerance));
    }
    if asked.normalize {
        parts.push("normalized".to_owned());
    }
    parts.join(", ")
}

fn ended_line(run: &Run) -> String {
    let mut parts = vec![ending(run)];
    if let Some(residual) = run.constraint_residual {
        parts.push(format!("constraint residual {}", significant(residual, RESIDUAL_DIGITS)));
    }
    if let Some(outside) = run.angles_out_of_range.filter(|&n| n > 0) {
        parts.push(count(outside, "angle outside (0, π)", "angles outside (0, π)"));
    }
    if run.moved_angles > 0 {
        parts.push(count(run.moved_angles, "angle moved into its bounds", "angles moved into their bounds"));
    }
    parts.join(", ")
}

fn layout_line(run: &Run) -> String {
    match run.closing_error {
        Some(error) => format!("{}, closing error {}", run.layout, significant(error, RESIDUAL_DIGITS)),
        None => run.layout.to_string(),
    }
}

fn valid_line(quality: &Quality) -> String {
    let m = quality.metrics();
    let mut text = if quality.valid {
        "yes: no flipped and no collapsed triangle".to_owned()
    } else {
        format!("no: {} flipped, {} collapsed", m.flips, m.collapsed)
    };
    let offending = m.flipped_faces.iter().chain(&m.collapsed_faces).take(Metrics::LISTED);
    let named: Vec<String> = offending.map(|face| face.index().to_string()).collect();
    if !named.is_empty() {
        let more = if m.flips + m.collapsed > named.len() { ", …" } else { "" };
        let _ = write!(text, " (triangles {}{more}, counted from 0)", named.join(", "));
    }
    if m.near_collapsed > 0 {
        let _ = write!(text, "; {} collapsed but for rounding", m.near_collapsed);
    }
    text
}

fn distortion_lines(m: &Metrics) -> Vec<(&'static str, String)> {
    let figure = |x| significant(x, DIGITS);
    let degrees = significant(m.max_angle_error.to_degrees(), DIGITS - 1);
    let mut lines = vec![
        ("angle error", format!("F/3nt {}, weighted {}, largest {degrees}°", figure(m.f), figure(m.f_weighted))),
        ("stretch", format!("L2 {}, L∞ {}", significant(m.stretch_l2, DIGITS + 1), figure(m.stretch_linf))),
        ("area error", format!("L2 of the logarithm {}", figure(m.area_l2))),
    ];
    if m.charts > 1 {
        lines.push(("charts", m.charts.to_string()));
    }
    if m.degenerate_3d > 0 {
        let one = "triangle without area on the surface, not in these figures";
        let many = "triangles without area on the surface, not in these figures";
        lines.push(("left out", count(m.degenerate_3d, one, many)));
    }
    lines
}

fn time_line(t: &Timings) -> String {
    let stages = [
        ("read", t.read),
        ("topology", t.topology),
        ("solve", t.solve),
        ("layout", t.layout),
        ("metrics", t.metrics),
        ("write", t.write),
    ];
    let parts: Vec<String> =
        stages.into_iter().filter(|&(_, s)| s > 0.0).map(|(name, s)| format!("{name} {}", seconds(s))).collect();
    format!("{} ({})", seconds(t.total), parts.join(", "))
}

/// One row for each mesh.
fn side_by_side(records: &[Record]) -> String {
    let with_solver = records.iter().any(|record| record.run.is_some());
    let columns: Vec<&Column> = COLUMNS.iter().filter(|column| with_solver || !column.of_solver).collect();
    let mut rows = vec![columns.iter().map(|column| column.head.to_owned()).collect::<Vec<_>>()];
    for record in records {
        rows.push(columns.iter().map(|column| (column.cell)(record).unwrap_or_else(|| NOTHING.to_owned())).collect());
    }
    let widths: Vec<usize> =
        (0..columns.len()).map(|k| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0)).collect();
    let mut out = String::new();
    for row in &rows {
        let cells = row.iter().zip(&widths).zip(&columns).map(|((cell, &width), column)| {
            if column.is_text { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        out.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        out.push('\n');
    }
    out
}

/// One column: its head, and the cell of a record if it has one.
struct Column {
    head: &'static str,
    is_text: bool,
    /// Whether it speaks of the solver, which judged files do not have.
    of_solver: bool,
    cell: fn(&Record) -> Option<String>,
}

impl Column {
    const fn text(head: &'static str, cell: fn(&Record) -> Option<String>) -> Self {
        Self { head, is_text: true, of_solver: false, cell }
    }

    const fn number(head: &'static str, cell: fn(&Record) -> Option<String>) -> Self {
        Self { head, is_text: false, of_solver: false, cell }
    }

    const fn of_solver(self) -> Self {
        Self { of_solver: true, ..self }
    }
}

const COLUMNS: [Column; 13] = [
    Column::text("mesh", |r| Some(r.mesh.clone())),
    Column::number("triangles", |r| r.size.map(|s| s.triangles.to_string())),
    Column::text("result", |r| Some(result_word(r))),
    Column::number("passes", |r| r.run.as_ref().map(|run| run.iterations.to_string())).of_solver(),
    Column::number("residual", |r| r.run.as_ref()?.constraint_residual.map(|x| significant(x, RESIDUAL_DIGITS)))
        .of_solver(),
    Column::text("layout", |r| r.run.as_ref().map(|run| run.layout.to_string())).of_solver(),
    Column::number("flips", |r| metrics(r).map(|m| m.flips.to_string())),
    Column::number("collapsed", |r| metrics(r).map(|m| m.collapsed.to_string())),
    Column::number("F/3nt", |r| metrics(r).map(|m| significant(m.f, DIGITS))),
    Column::number("stretch L2", |r| metrics(r).map(|m| significant(m.stretch_l2, DIGITS + 1))),
    Column::number("L∞", |r| metrics(r).map(|m| significant(m.stretch_linf, DIGITS))),
    Column::number("time", |r| r.timings_s.map(|t| seconds(t.total))),
    Column::number("MB", |r| r.peak_memory_bytes.map(megabytes)),
];

fn metrics(record: &Record) -> Option<&Metrics> {
    record.quality.as_ref().map(Quality::metrics)
}

/// One word, or two, on how it went.
fn result_word(record: &Record) -> String {
    if let Some(failure) = &record.error {
        return format!("error: {}", failure.kind);
    }
    let valid = record.quality.as_ref().is_some_and(|quality| quality.valid);
    let termination = record.run.as_ref().map(|run| run.termination.to_string());
    match (termination, valid) {
        (Some(word), true) => word,
        (Some(word), false) => format!("{word}, not valid"),
        (None, true) => "valid".to_owned(),
        (None, false) => "not valid".to_owned(),
    }
}
