//! One record for people, in full.

use crate::record::number::{count, megabytes, seconds, significant};
use crate::record::{InnerAccuracy, Kkt, MadeInjective, Pinned, Quality, Record, Relaxed, RunRecord, Size, Timings};
use crate::show::findings::{ending, lost_in_single};
use abf::{Boundary, LinAbf, Metrics, Precision, Solver, SolverKind};
use std::f64::consts::PI;
use std::fmt::Write;

/// How many digits errors and stretch are shown with.
const DIGITS: usize = 4;
/// How many digits residuals are shown with: their size matters, not their value.
const RESIDUAL_DIGITS: usize = 2;

/// Everything about one mesh, a line for each matter.
pub(crate) fn in_full(record: &Record) -> String {
    let mut lines: Vec<(&str, String)> = Vec::new();
    if let Some(size) = &record.size {
        lines.push(("size", size_line(size)));
    }
    match (&record.solver, &record.run, &record.atlas) {
        (Some(solver), _, Some(atlas)) => lines.extend(super::atlas::lines(solver, atlas)),
        (Some(solver), Some(run), None) => lines.extend(run_lines(solver, run)),
        _ => {}
    }
    if let Some(repacked) = &record.repacked {
        lines.extend(super::atlas::lines_of_islands(repacked));
    }
    if let Some(quality) = &record.quality {
        lines.push(("valid", valid_line(quality)));
        lines.push(("injective", injective_line(quality)));
        if quality.charts > 1 && record.atlas.is_none() && record.repacked.is_none() {
            lines.push(("charts", quality.charts.to_string()));
        }
        lines.extend(distortion_lines(quality));
    }
    lines.extend(record.kkt.map(|kkt| ("KKT matrix", kkt_line(kkt))));
    if let Some(timings) = &record.timings_s {
        lines.push(("time", time_line(timings)));
    }
    if let Some(bytes) = record.peak_memory_bytes {
        lines.push(("memory", format!("{} MB at most", megabytes(bytes))));
    }
    lines.extend(record.written.iter().map(|path| ("written", path.clone())));
    if let Some(failure) = &record.error {
        lines.push(("error", failure.kind.to_string()));
    }
    let mut out = format!("{}\n", record.mesh);
    for (label, text) in lines {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "  {label:<13}{text}");
    }
    out
}

pub(super) fn size_line(size: &Size) -> String {
    let mut parts = vec![count(size.triangles, "triangle", "triangles"), count(size.vertices, "vertex", "vertices")];
    if let Some(interior) = size.interior_vertices {
        parts.push(format!("{interior} of them interior"));
    }
    if let Some(loops) = size.boundary_loops {
        parts.push(count(loops, "boundary loop", "boundary loops"));
    }
    parts.join(", ")
}

/// What the solver was asked and what it did.
fn run_lines(solver: &str, run: &RunRecord) -> Vec<(&'static str, String)> {
    let mut lines = vec![("solver", solver_line(solver, run))];
    let asked = run.settings.solver();
    lines.extend(asked.as_ref().and_then(newton_line).map(|line| ("step", line)));
    lines.extend(asked.as_ref().and_then(inner_settings_line).map(|line| ("inner solve", line)));
    lines.push(("ended", ended_line(run)));
    lines.extend(accuracy_line(run).map(|line| ("accuracy", line)));
    lines.extend(asked.and_then(|asked| curvature_line(&asked, run)).map(|line| ("curvature", line)));
    lines.extend(boundary_line(run).map(|line| ("boundary", line)));
    lines.extend(hierarchy_line(run).map(|line| ("levels", line)));
    lines.extend(run.relaxed.as_ref().map(|relaxed| ("relaxed", relaxed_line(relaxed))));
    lines.extend(run.made_injective.as_ref().map(|made| ("overlaps", made_injective_line(made))));
    lines.extend(run.pins.as_ref().map(|pins| ("pins", pins_line(pins))));
    lines.push(("layout", layout_line(run)));
    lines
}

fn solver_line(solver: &str, run: &RunRecord) -> String {
    let mut parts = vec![solver.to_owned()];
    if !run.rungs.is_empty() {
        parts.push(format!("by {}", run.solved_by));
    }
    parts.extend(run.settings.solver().and_then(|asked| asked.passes()).map(|passes| format!("passes {passes}")));
    if let Some(Solver::LinAbf(LinAbf { error_bound: Some(bound), .. })) = run.settings.solver() {
        parts.push(format!("error bound {bound}"));
    }
    let Some(asked) = run.settings.pipeline() else { return parts.join(", ") };
    // A method without angles takes none of these; a solver of someone's own finds angles.
    if solver.parse().map_or(true, SolverKind::keeps_constraints) {
        parts.push(match asked.initial_guess.ring_switch {
            Some(threshold) => format!("ring switch {threshold} rad ({} switched)", run.switched_rings),
            None => "ring switch off".to_owned(),
        });
        parts.push(format!("tolerance {:e} rad", asked.stop.tolerance));
    }
    if asked.normalize {
        parts.push("normalized".to_owned());
    }
    parts.join(", ")
}

/// The levels of a hierarchical solver, or why there are none.
fn hierarchy_line(run: &RunRecord) -> Option<String> {
    let hierarchy = run.hierarchy.as_ref()?;
    if let Some(reason) = &hierarchy.fallback {
        return Some(format!("none, solved as a whole: {reason}"));
    }
    let sizes: Vec<String> = hierarchy.levels.iter().map(|level| level.triangles.to_string()).collect();
    let moved: usize = hierarchy.levels.iter().map(|level| level.moved).sum();
    match sizes.len() {
        0 => Some("none, the mesh is small enough to be solved as a whole".to_owned()),
        _ => Some(format!(
            "{} triangles, {} put in a place of their own",
            sizes.join(", "),
            count(moved, "vertex", "vertices")
        )),
    }
}

/// What was asked of the boundary, and what it is like.
fn boundary_line(run: &RunRecord) -> Option<String> {
    let (met, asked) = (run.boundary.as_ref()?, run.settings.pipeline()?.boundary);
    let mut parts = vec![asked.to_string()];
    if let (Some(corners), Boundary::Rectangle(None)) = (met.corners, &asked) {
        parts.push(format!("corners {}", corners.map(|corner| corner.to_string()).join(", ")));
    }
    if let Some(sides) = met.sides {
        parts.push(format!("sides {}", sides.map(|side| significant(side, DIGITS)).join(", ")));
    }
    if let (Some(spread), Boundary::Circle) = (met.radius_spread, &asked) {
        parts.push(format!(
            "radii differ by {:.2} % after {}",
            100.0 * (spread - 1.0),
            count(met.rounds, "round", "rounds")
        ));
    }
    parts.push(format!("off by {} rad", significant(met.violation, RESIDUAL_DIGITS)));
    parts.push(format!("largest angle {}π", significant(met.largest_angle / PI, DIGITS)));
    if met.injective_by_convexity {
        parts.push("injective by convexity".to_owned());
    }
    Some(parts.join(", "))
}

/// What relaxing did.
fn relaxed_line(relaxed: &Relaxed) -> String {
    let (before, after) = (significant(relaxed.before, DIGITS), significant(relaxed.after, DIGITS));
    let start = if relaxed.from_tutte { ", from Tutte's embedding" } else { "" };
    let steps = count(relaxed.steps, "step", "steps");
    let progressive = match relaxed.progressive_steps {
        0 => String::new(),
        some => format!(", {some} of them progressive"),
    };
    format!("energy {}: {before} → {after} in {steps}{progressive}{start}", relaxed.energy)
}

/// What was done about overlaps.
fn made_injective_line(made: &MadeInjective) -> String {
    let overlaps = count(made.overlaps, "overlap", "overlaps");
    if let Some(error) = &made.error {
        return format!("{overlaps}, left as they are: {error}");
    }
    let mut parts = vec![format!("{overlaps} before, rule {}", made.rule)];
    if made.parts > 1 {
        parts.push(count(made.parts, "part", "parts"));
    }
    if let (Some(energy), Some(after)) = (made.energy, made.after) {
        let before = made.before.map_or_else(|| "unknown".to_owned(), |before| significant(before, DIGITS));
        let steps = count(made.steps, "step", "steps");
        parts.push(format!("energy {energy}: {before} → {} in {steps}", significant(after, DIGITS)));
    }
    parts.extend(made.gap.map(|gap| format!("smallest gap {}", significant(gap, RESIDUAL_DIGITS))));
    parts.join(", ")
}

/// What became of pins.
fn pins_line(pins: &Pinned) -> String {
    let all = count(pins.residuals.len(), "pin", "pins");
    let steps = count(pins.steps, "step", "steps");
    let farthest = pins.residuals.iter().max_by(|a, b| a.distance.total_cmp(&b.distance));
    let far = match farthest {
        Some(pin) if pin.distance != 0.0 => {
            format!(
                ", vertex {} is farthest from its place, by {}",
                pin.vertex,
                significant(pin.distance, RESIDUAL_DIGITS)
            )
        }
        _ => ", all in their places".to_owned(),
    };
    let missed = if pins.missed == 0 { String::new() } else { format!(", {} not reached", pins.missed) };
    format!("{all}{missed} after {steps}{far}")
}

fn newton_line(asked: &Solver) -> Option<String> {
    let newton = asked.newton_settings()?;
    Some(format!("{} wheel, {} Hessian, line search {}", newton.wheel, newton.hessian, newton.line_search))
}

fn inner_settings_line(asked: &Solver) -> Option<String> {
    let (iterative, newton) = (asked.iterative_settings()?, asked.newton_settings()?);
    Some(format!(
        "reduction {}, preconditioner {}, tolerance {}, at most {} iterations",
        iterative.reduction,
        iterative.preconditioner,
        InnerAccuracy(newton.inner_tolerance),
        iterative.max_inner_iterations
    ))
}

/// How exactly the linear systems were solved.
fn accuracy_line(run: &RunRecord) -> Option<String> {
    let figure = |x| significant(x, RESIDUAL_DIGITS);
    let mut text = format!(
        "relative residual of the linear solves {} at worst, {} at last",
        figure(run.inner_residual_worst?),
        figure(run.inner_residual?)
    );
    if let Some(estimate) = run.inner_estimate {
        let _ = write!(text, " (estimated {})", figure(estimate));
    }
    if run.inner_unconverged > 0 {
        let _ = write!(text, ", {} short of its tolerance", count(run.inner_unconverged, "solve", "solves"));
    }
    Some(text)
}

/// What the exact Hessian did; nothing where it is positive by construction.
fn curvature_line(asked: &Solver, run: &RunRecord) -> Option<String> {
    let (negative, fallbacks) = (run.negative_curvature?, run.fallbacks?);
    if asked.newton_settings()?.hessian != abf::Hessian::Exact {
        return None;
    }
    let entries = match negative {
        0 => "no entry of the Hessian negative".to_owned(),
        n => format!("at most {} of the Hessian negative", count(n, "entry", "entries")),
    };
    Some(match fallbacks {
        0 => entries,
        n => format!("{entries}, {} made with the Gauss–Newton one instead", count(n, "step", "steps")),
    })
}

fn kkt_line(kkt: Kkt) -> String {
    let Kkt { unknowns, nonzeros_log, nonzeros_product } = kkt;
    let ratio = significant(nonzeros_product as f64 / nonzeros_log as f64, DIGITS - 1);
    format!("{unknowns} unknowns, nonzeros: log wheel {nonzeros_log}, product wheel {nonzeros_product} ({ratio} times)")
}

fn ended_line(run: &RunRecord) -> String {
    let mut parts = vec![ending(run)];
    if let Some(residual) = run.constraint_residual {
        parts.push(format!("constraint residual {}", significant(residual, RESIDUAL_DIGITS)));
    }
    if let Some(outside) = run.angles_out_of_range.filter(|&n| n > 0) {
        parts.push(count(outside, "angle outside (0, π)", "angles outside (0, π)"));
    }
    if run.clamped_angles > 0 {
        parts.push(count(run.clamped_angles, "angle clamped to its bounds", "angles clamped to their bounds"));
    }
    parts.join(", ")
}

fn layout_line(run: &RunRecord) -> String {
    let Some(kind) = run.layout else {
        let mut text = "none: the positions are what was solved for".to_owned();
        if !run.scaled {
            text += ", at the scale that doubles hold them at";
        }
        return text;
    };
    match run.closing_error {
        Some(error) => format!("{kind}, closing error {}", significant(error, RESIDUAL_DIGITS)),
        None => kind.to_string(),
    }
}

fn valid_line(quality: &Quality) -> String {
    let m = quality;
    let mut text = if quality.valid {
        "yes: no flipped and no collapsed triangle, no vertex wound around twice".to_owned()
    } else {
        let wound = if m.wound > 0 { format!(", {} wound around twice", m.wound) } else { String::new() };
        format!("no: {} flipped, {} collapsed{wound}", m.flips, m.collapsed)
    };
    let faces: Vec<usize> = m.flipped_faces.iter().chain(&m.collapsed_faces).copied().collect();
    let named: Vec<String> =
        [listed("triangles", &faces, m.flips + m.collapsed), listed("vertices", &m.wound_vertices, m.wound)]
            .into_iter()
            .flatten()
            .collect();
    if !named.is_empty() {
        let _ = write!(text, " ({}, counted from 0)", named.join("; "));
    }
    if m.near_collapsed > 0 {
        let _ = write!(text, "; {} collapsed but for rounding", m.near_collapsed);
    }
    if m.uv_precision == Precision::Single {
        text += "; stored in single precision";
    }
    text
}

/// The first of some numbers, if there are any.
fn listed(what: &str, numbers: &[usize], count: usize) -> Option<String> {
    let shown: Vec<String> = numbers.iter().take(Metrics::LISTED).map(usize::to_string).collect();
    let more = if count > shown.len() { ", …" } else { "" };
    (!shown.is_empty()).then(|| format!("{what} {}{more}", shown.join(", ")))
}

fn injective_line(m: &Quality) -> String {
    /// More pairs of faces would not fit into a line.
    const PAIRS: usize = 3;
    if m.overlaps == 0 {
        let text = if m.valid { "yes: no overlap" } else { "no: not valid; its boundary does not cross itself" };
        return text.to_owned();
    }
    let kinds =
        [(m.crossings, "crossing", "crossings"), (m.meetings, "meeting", "meetings"), (m.nested, "nested", "nested")];
    let kinds: Vec<String> =
        kinds.into_iter().filter(|kind| kind.0 > 0).map(|(n, one, all)| count(n, one, all)).collect();
    let pairs: Vec<String> = m.overlapping_faces.iter().take(PAIRS).map(|[a, b]| format!("{a} over {b}")).collect();
    let more = if m.overlaps > pairs.len() { ", …" } else { "" };
    let named = if pairs.is_empty() {
        String::new()
    } else {
        format!(" (triangles {}{more}, counted from 0)", pairs.join(", "))
    };
    let least = if m.overlaps_are_least { "at least " } else { "" };
    format!("no: {least}{} ({}){named}", count(m.overlaps, "overlap", "overlaps"), kinds.join(", "))
}

fn distortion_lines(m: &Quality) -> Vec<(&'static str, String)> {
    let figure = |x| significant(x, DIGITS);
    let degrees = significant(m.max_angle_error.to_degrees(), DIGITS - 1);
    let mut lines = vec![
        ("angle error", format!("F/3nt {}, weighted {}, largest {degrees}°", figure(m.f), figure(m.f_weighted))),
        ("stretch", format!("L2 {}, L∞ {}", significant(m.stretch_l2, DIGITS + 1), figure(m.stretch_linf))),
        ("area error", format!("L2 of the logarithm {}", figure(m.area_l2))),
    ];
    if m.turned > 0 || m.shared > 0 {
        let turned = count(m.turned, "triangle turned around", "triangles turned around");
        let shared = count(m.shared, "shares the texels of another", "share the texels of others");
        let said: Vec<String> =
            [(m.turned, turned), (m.shared, shared)].into_iter().filter(|s| s.0 > 0).map(|s| s.1).collect();
        lines.push(("as repaired", said.join(", ")));
    }
    if m.lost > 0 {
        lines.push(("lost", lost_in_single(m)));
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
        ("topology", t.stages.topology),
        ("solve", t.stages.solve),
        ("layout", t.stages.layout),
        ("charts", t.charts),
        ("atlas", t.atlas),
        ("certificate", t.certificate),
        ("metrics", t.metrics),
        ("write", t.write),
    ];
    let parts: Vec<String> =
        stages.into_iter().filter(|&(_, s)| s > 0.0).map(|(name, s)| format!("{name} {}", seconds(s))).collect();
    format!("{} ({})", seconds(t.total), parts.join(", "))
}
