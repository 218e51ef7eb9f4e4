//! Charts and their atlas, in lines.

use crate::record::number::{count, significant};
use crate::record::{Atlas, Narrow, Repacked};
use std::collections::BTreeMap;

/// Sizes matter, not digits.
const DIGITS: usize = 3;

/// But for the size of a sheet, which is to be compared with a stock size.
const SIZE_DIGITS: usize = 6;

/// A line for each matter.
pub(super) fn lines(solver: &str, atlas: &Atlas) -> Vec<(&'static str, String)> {
    let mut lines = vec![("solver", solver_line(solver, atlas))];
    if !atlas.repairs.is_empty() {
        lines.push(("repaired", atlas.repairs.join(", ")));
    }
    lines.push(("charts", charts_line(atlas)));
    lines.push(("seams", seams_line(atlas)));
    lines.push(place_line(atlas));
    lines.extend(narrow_line(&atlas.narrow, ["chart", "charts"]).map(|line| ("narrow", line)));
    if atlas.under_a_texel > 0 {
        lines.push(("thin", format!("{} less than a texel wide", count(atlas.under_a_texel, "chart", "charts"))));
    }
    lines
}

/// The same for islands that were packed anew.
pub(super) fn lines_of_islands(repacked: &Repacked) -> Vec<(&'static str, String)> {
    let mut islands = vec![count(repacked.islands, "island", "islands")];
    if repacked.overlapping > 0 {
        islands.push(format!("{} over others, kept together with them", repacked.overlapping));
    }
    if repacked.stacked > 0 {
        islands.push(format!("{} upon others of their shape, each shape judged once", repacked.stacked));
    }
    let texels = significant(repacked.texels_per_unit, DIGITS);
    let atlas = format!(
        "{}, {}% covered, {texels} texels per unit of the UVs before at {} × {}, margin {}",
        count(repacked.pages, "page", "pages"),
        (100.0 * repacked.coverage).round(),
        repacked.page[0],
        repacked.page[1],
        repacked.margin
    );
    let mut lines = vec![("islands", islands.join(", ")), ("atlas", atlas)];
    lines.extend(narrow_line(&repacked.narrow, ["island", "islands"]).map(|line| ("narrow", line)));
    lines
}

fn narrow_line(narrow: &Narrow, [one, several]: [&str; 2]) -> Option<String> {
    let Narrow { places, charts, least } = narrow;
    let least = significant((*least)?, DIGITS);
    Some(format!(
        "{} of {} nearer to themselves than the margin, the narrowest {least} texels",
        count(*places, "place", "places"),
        count(*charts, one, several)
    ))
}

fn place_line(atlas: &Atlas) -> (&'static str, String) {
    let covered = format!("{}% covered", (100.0 * atlas.coverage).round());
    if let Some(size) = atlas.sheet {
        let [width, height] = size.map(|x| significant(x, SIZE_DIGITS));
        return ("sheet", format!("{width} × {height} units of the mesh, {covered}"));
    }
    let mut parts = vec![count(atlas.pages, "page", "pages"), covered];
    if let (Some(texels), Some([width, height])) = (atlas.texels_per_unit, atlas.page) {
        parts.push(format!("{} texels per unit at {width} × {height}", significant(texels, DIGITS)));
    }
    parts.extend(atlas.margin.map(|margin| format!("margin {margin}")));
    ("atlas", parts.join(", "))
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
