//! Charts and their atlas, in lines.

use crate::record::Atlas;
use crate::record::number::{count, significant};
use std::collections::BTreeMap;

/// Sizes matter, not digits.
const DIGITS: usize = 3;

/// A line for each matter.
pub(super) fn lines(solver: &str, atlas: &Atlas) -> Vec<(&'static str, String)> {
    let mut lines = vec![("solver", solver_line(solver, atlas))];
    if !atlas.repairs.is_empty() {
        lines.push(("repaired", atlas.repairs.join(", ")));
    }
    lines.push(("charts", charts_line(atlas)));
    lines.push(("seams", seams_line(atlas)));
    let texels = significant(atlas.texels_per_unit, DIGITS);
    lines.push((
        "atlas",
        format!(
            "{}, {}% covered, {texels} texels per unit at {} × {}, margin {}",
            count(atlas.pages, "page", "pages"),
            (100.0 * atlas.coverage).round(),
            atlas.resolution,
            atlas.resolution,
            atlas.margin
        ),
    ));
    lines
}

fn solver_line(solver: &str, atlas: &Atlas) -> String {
    let mut by: BTreeMap<(&str, String), usize> = BTreeMap::new();
    for chart in &atlas.charts {
        *by.entry((chart.solved_by.as_str(), chart.termination.to_string())).or_default() += 1;
    }
    let parts: Vec<String> =
        by.into_iter().map(|((name, end), n)| format!("{} by {name} ({end})", count(n, "chart", "charts"))).collect();
    format!("{solver}: {}", parts.join(", "))
}

fn charts_line(atlas: &Atlas) -> String {
    let charts = &atlas.charts;
    let components = charts.iter().map(|chart| chart.component).max().map_or(0, |last| last + 1);
    let mut parts =
        vec![format!("{} of {}", count(charts.len(), "chart", "charts"), count(components, "component", "components"))];
    let invalid = charts.iter().filter(|chart| !chart.valid).count();
    if invalid > 0 {
        parts.push(format!("{invalid} not valid"));
    }
    let filled = atlas.holes_filled();
    if filled > 0 {
        parts.push(format!("{} closed while solving", count(filled, "hole", "holes")));
    }
    let worst = charts.iter().map(|chart| chart.stretch_l2).fold(0.0, f64::max);
    let aim = if worst > atlas.max_stretch { format!(" (aimed at {})", atlas.max_stretch) } else { String::new() };
    parts.push(format!("largest L2 stretch of one {}{aim}", significant(worst, DIGITS + 1)));
    parts.join(", ")
}

fn seams_line(atlas: &Atlas) -> String {
    if atlas.seam_edges == 0 {
        return "none".to_owned();
    }
    format!(
        "{}, {} diagonals long",
        count(atlas.seam_edges, "edge", "edges"),
        significant(atlas.seam_length / atlas.diagonal, DIGITS)
    )
}
