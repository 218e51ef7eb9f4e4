//! What came of a run, in words.

use crate::record::number::{count, significant};
use crate::record::{Outcome, Quality, Record, RunRecord, RungRecord};
use abf::{SolverKind, Termination};

/// What there is to say about a result that is not as asked: what happened, and what to try.
pub(crate) fn remark(record: &Record) -> Option<String> {
    let error = record.error.as_ref().map(|failure| format!("{}: {}", failure.message, failure.hint));
    let differing = record.repeats.is_some_and(|repeats| !repeats.identical);
    let differing = differing.then(|| "its repeats differ".to_owned());
    let not_run = record.not_run.as_ref().map(|not_run| format!("not run: {}", not_run.message));
    let parts: Vec<String> =
        [error, not_run, record.hint.clone(), climb(record), precision(record), overlap(record), differing]
            .into_iter()
            .flatten()
            .collect();
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// Where the UVs lie over themselves; `None` where they do not.
pub(crate) fn overlap(record: &Record) -> Option<String> {
    let quality = record.quality.as_ref()?;
    if quality.overlaps == 0 {
        return None;
    }
    let places = count(quality.overlaps, "place", "places");
    let example = quality.overlapping_faces.first().map(|[a, b]| format!(", for example triangles {a} and {b}"));
    let counted = if example.is_some() { " (counted from 0)" } else { "" };
    Some(format!("the UVs overlap themselves at {places} of their boundary{}{counted}", example.unwrap_or_default()))
}

/// What the rungs of `auto` came to; `None` where the first was enough.
pub(crate) fn climb(record: &Record) -> Option<String> {
    let run = record.run.as_ref().filter(|run| run.rungs.len() > 1)?;
    let rungs: Vec<String> = run.rungs.iter().map(rung).collect();
    let end = if record.outcome() == Outcome::AsAsked { "" } else { "; none of them both converged and valid" };
    Some(format!("{}{end}", rungs.join(", ")))
}

fn rung(rung: &RungRecord) -> String {
    let Some(termination) = rung.termination else {
        return format!("{} found nothing ({})", rung.solver, rung.error.as_deref().unwrap_or("no reason given"));
    };
    let steps = steps(&rung.solver, rung.iterations);
    let bad = [
        (rung.flips, "flipped triangle", "flipped triangles"),
        (rung.collapsed, "collapsed triangle", "collapsed triangles"),
        (rung.wound, "vertex wound around twice", "vertices wound around twice"),
    ];
    let bad: Vec<String> = bad.into_iter().filter(|b| b.0 > 0).map(|(n, one, many)| count(n, one, many)).collect();
    match (rung.valid, termination.is_as_asked()) {
        (true, true) => format!("{} valid after {steps}", rung.solver),
        (true, false) => format!("{} valid but {termination} after {steps}", rung.solver),
        (false, true) => format!("{} left {} after {steps}", rung.solver, bad.join(" and ")),
        (false, false) => format!("{} {termination} after {steps} with {}", rung.solver, bad.join(" and ")),
    }
}

/// Which triangles a glTF does not hold.
pub(crate) fn lost_in_single(quality: &Quality) -> String {
    let lost = count(quality.lost, "triangle loses its area or a corner", "triangles lose their area or a corner");
    format!("{lost} in the 32-bit numbers of glTF")
}

/// How near the UVs are to what doubles can hold; `None` where there is room to spare.
pub(crate) fn precision(record: &Record) -> Option<String> {
    /// Only the size of such a number matters.
    const DIGITS: usize = 1;
    let limits = record.run.as_ref()?.precision_limits.as_ref()?;
    let mut parts = Vec::new();
    if limits.spread >= 2.0 {
        let spread = significant(limits.spread, DIGITS);
        parts.push(format!("lengths shrink by up to {spread} times more in one place than in another"));
    }
    if limits.near_collapsed > 0 {
        let triangles = count(limits.near_collapsed, "triangle is", "triangles are");
        let named = faces(&limits.near_collapsed_faces, limits.near_collapsed);
        parts.push(format!("{triangles} within the rounding of their coordinates ({named})"));
    }
    if limits.held_faces > 0 {
        let triangles = count(limits.held_faces, "triangle was", "triangles were");
        parts.push(format!("{triangles} held in place ({})", faces(&limits.first_held_faces, limits.held_faces)));
    }
    Some(format!("the UVs are near what double precision holds: {}", parts.join(", ")))
}

/// The first of so many faces, by number.
fn faces(first: &[usize], count: usize) -> String {
    let numbers: Vec<String> = first.iter().map(ToString::to_string).collect();
    let more = if count > first.len() { ", …" } else { "" };
    format!("{} {}{more}", if count == 1 { "face" } else { "faces" }, numbers.join(", "))
}

/// The name of a solver of someone's own is none of ours: it makes iterations.
fn steps(solver: &str, n: usize) -> String {
    let [one, many] = solver.parse().map_or(["iteration", "iterations"], SolverKind::iteration_names);
    count(n, one, many)
}

/// How the solver ended, in words.
pub(crate) fn ending(run: &RunRecord) -> String {
    let after_the_solver = match (&run.made_injective, &run.relaxed) {
        (Some(made), _) => Some((made.steps, "of making a map without overlaps")),
        (None, Some(relaxed)) => Some((relaxed.steps, "of relaxing")),
        (None, None) => None,
    };
    if let Some((n, what)) = after_the_solver.filter(|_| !run.termination.is_as_asked()) {
        let how = match run.termination {
            Termination::MaxIterations => "not converged",
            Termination::TimeLimit => "out of time",
            Termination::Stalled => "not converged: stalled",
            other => &other.to_string(),
        };
        return format!("{how} after {} {what}", count(n, "step", "steps"));
    }
    let steps = steps(&run.solved_by, run.iterations);
    // The refinement of a direct solve is no iteration anyone asked for, and has no estimate.
    let steps = match run.inner_estimate {
        Some(_) => format!("{steps} ({} inner)", run.inner_iterations),
        None => steps,
    };
    match run.termination {
        Termination::OnePass if run.iterations == 0 => "one linear solve, as asked".to_owned(),
        Termination::OnePass => format!("{steps}, as asked"),
        Termination::MaxIterations => format!("not converged after {steps}"),
        Termination::TimeLimit => format!("out of time after {steps}"),
        Termination::Stalled => format!("not converged: stalled after {steps}"),
        other => format!("{other} after {steps}"),
    }
}

/// Inner solves that broke off.
pub(crate) fn inner_shortfall(run: &RunRecord) -> Option<String> {
    let worst = run.inner_residual_worst.filter(|_| run.inner_unconverged > 0)?;
    let solves = count(run.inner_unconverged, "inner solve", "inner solves");
    Some(format!("{solves} short of the tolerance (relative residual {} at worst)", significant(worst, 2)))
}
