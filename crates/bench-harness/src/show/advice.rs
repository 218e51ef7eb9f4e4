//! What to try next when a result is not what was hoped for.

use crate::record::hints::{OR, TRY};
use crate::record::number::{count, significant};
use crate::record::{Outcome, Record, RunRecord};
use crate::show::findings::{ending, inner_shortfall, lost_in_single};
use abf::{
    Boundary, Energy, Hessian, Injective, IterativeSettings, LayoutKind, LinAbf, LineSearch, Passes, Pipeline,
    PreconditionerKind, Reduction, Solver, SolverKind, Termination,
};

/// The threshold that the paper recommends (§4.2), rad.
const USUAL_RING_SWITCH: f64 = 1.0;
/// A threshold that helps where the usual one does not, rad.
const EAGER_RING_SWITCH: f64 = 0.5;
/// More suggestions would be a manual.
const SUGGESTIONS: usize = 2;

/// What went wrong in a few words, and options that have not been tried yet; `None` where nothing
/// went wrong, or where the error says it. `may_cut` says whether the command takes the options of charts.
pub(crate) fn next_to_try(record: &Record, may_cut: bool) -> Option<String> {
    let (run, quality, solver) = (record.run.as_ref()?, record.quality.as_ref()?, record.solver.as_deref()?);
    if record.outcome() == Outcome::AsAsked {
        return stretched(record, may_cut).or_else(|| overlapping(record));
    }
    let mut what = Vec::new();
    if !run.termination.is_as_asked() {
        match run.pins.as_ref().map_or(0, |pins| pins.missed) {
            0 => what.push(ending(run)),
            missed => what.push(count(missed, "pin not reached", "pins not reached")),
        }
        what.extend(inner_shortfall(run));
    }
    if !quality.valid {
        what.push(format!("{} flipped and {} collapsed triangles", quality.flips, quality.collapsed));
        if quality.wound > 0 {
            what.push(count(quality.wound, "vertex wound around twice", "vertices wound around twice"));
        }
    }
    if what.is_empty() {
        // As asked and valid, but a file could not be written.
        return None;
    }
    let is_missed = run.pins.as_ref().is_some_and(|pins| pins.missed > 0);
    let mut tries = if is_missed { vec!["soft pins, or fewer".to_owned()] } else { tries(solver, run, may_cut) };
    tries.truncate(SUGGESTIONS);
    let what = what.join(", ");
    Some(if tries.is_empty() { what } else { format!("{what}{TRY}{}", tries.join(OR)) })
}

const CUT_DISKS: &str = "--cut-disks, which cuts disks, too, where they stretch";

/// What to try next with charts that are not as asked. In an atlas, disks are cut, too: nothing more is to be cut there.
pub(crate) fn next_for_charts(record: &Record) -> Option<String> {
    if let Some(lost) = lost(record) {
        return Some(lost);
    }
    let atlas = record.atlas.as_ref()?;
    let termination = record.termination()?;
    let what = match termination {
        Termination::Cancelled => return None,
        Termination::TimeLimit => "out of time",
        _ if atlas.charts.iter().any(|chart| !chart.valid) || record.quality.as_ref().is_some_and(|q| !q.valid) => {
            "not valid"
        }
        _ if !termination.is_as_asked() => "not converged",
        _ if !atlas.settings.cuts_disks() && atlas.charts.iter().any(|chart| chart.stretch_l2 > atlas.max_stretch) => {
            return Some(format!("a chart stretches more than asked{TRY}{CUT_DISKS}"));
        }
        _ => return stretched(record, true),
    };
    // Beside a very wide gap charts are within rounding.
    let are_spoilt_on_sheet = atlas.sheet.is_some() && atlas.charts.iter().all(|chart| chart.valid);
    if what == "not valid" && are_spoilt_on_sheet {
        return Some(format!("{what} on a sheet as large as this{TRY}a smaller --gap"));
    }
    let mut tries = match termination {
        Termination::TimeLimit => vec!["a longer --time-limit, which is one for all charts"],
        _ if what == "not valid" => vec!["an obj or ply, which hold doubles: a glTF does not"],
        Termination::MaxIterations => vec!["more --max-iterations"],
        _ => vec!["--solver auto", "a smaller --max-stretch"],
    };
    if termination != Termination::TimeLimit && !atlas.settings.cuts_disks() {
        tries.insert(0, CUT_DISKS);
    }
    Some(format!("{what}{TRY}{}", tries.join(OR)))
}

/// What to try where a glTF does not hold all triangles.
pub(crate) fn lost(record: &Record) -> Option<String> {
    let quality = record.quality.as_ref().filter(|quality| quality.lost > 0)?;
    let way_out = "an obj or ply, which hold doubles, or a mesh of another size near the origin";
    Some(format!("{}{TRY}{way_out}", lost_in_single(quality)))
}

/// What to try with a map that is valid and of little use.
fn stretched(record: &Record, may_cut: bool) -> Option<String> {
    /// A texture that is stretched this much has one texel where it should have a hundred.
    const OF_LITTLE_USE: f64 = 10.0;
    let stretch = record.quality.as_ref()?.stretch_l2;
    // Relaxing is for maps of a free boundary, once.
    let asked = record.run.as_ref().and_then(|run| run.settings.pipeline());
    let may_relax = asked.as_ref().is_some_and(|asked| asked.relax.is_none() && asked.boundary.is_free());
    (stretch > OF_LITTLE_USE).then(|| {
        let stretch = significant(stretch, 2);
        let is_cut = record.atlas.as_ref().is_some_and(|atlas| atlas.settings.cuts_disks());
        let is_smaller = record.atlas.as_ref().is_some_and(|atlas| atlas.charts.iter().any(|chart| chart.scale < 1.0));
        // A rule for the boundary, and pins, are for a mesh that is not cut.
        let stays_whole = asked.as_ref().and_then(|asked| match (asked.boundary.is_free(), &asked.pins) {
            (false, _) => Some("to leave out --boundary"),
            (true, Some(_)) => Some("to leave out --pins"),
            (true, None) => None,
        });
        let cutting = match (may_cut, is_cut) {
            (true, true) if is_smaller => "--max-chart-length inf, which makes no chart smaller than the others",
            (true, false) => "--cut-disks, which cuts the mesh where it stretches",
            (true, true) => "a smaller --max-stretch",
            (false, _) => "to cut the mesh where it stretches",
        };
        let way_out = stays_whole.unwrap_or(cutting);
        let relaxing = if may_relax {
            format!("--energy {}, which keeps areas within bounds{OR}", Energy::USABLE)
        } else {
            String::new()
        };
        // What the coarse mesh does not have, the fine one does not get.
        let levels = [SolverKind::HabfPlusPlus, SolverKind::HLinAbf].map(SolverKind::name);
        let is_by_levels = record.solver.as_deref().is_some_and(|solver| levels.contains(&solver));
        let on_the_whole = if is_by_levels { format!("--solver {}{OR}", SolverKind::LinAbf) } else { String::new() };
        format!("an L2 stretch of {stretch} is of little use{TRY}{on_the_whole}{relaxing}{way_out}")
    })
}

/// What to try with a map that is valid and lies over itself.
fn overlapping(record: &Record) -> Option<String> {
    let lies_over_itself = record.quality.as_ref().is_some_and(|quality| quality.overlaps > 0);
    let asked = record.run.as_ref()?.settings.pipeline()?;
    // The rules go with neither of these.
    let may_change = asked.injective == Injective::Off && asked.boundary.is_free() && asked.pins.is_none();
    (lies_over_itself && may_change).then(|| {
        let [deform, split] = [Injective::Deform, Injective::Split].map(|rule| format!("--injective {}", rule.name()));
        format!(
            "a map that lies over itself{TRY}{deform}, which makes another that does not{OR}{split}, which parts it"
        )
    })
}

/// Options that differ from what was asked, the most promising first.
fn tries(solver: &str, run: &RunRecord, may_cut: bool) -> Vec<String> {
    let Some(asked) = run.settings.pipeline() else { return Vec::new() };
    let is_out_of_time = run.termination.is_interruption();
    if let Some(made) = run.made_injective.as_ref().filter(|_| !is_out_of_time) {
        let gap = (asked.boundary_gap > 0.0).then(|| "a smaller --boundary-gap".to_owned());
        let other = match made.rule {
            Injective::Split => format!("--injective {}", Injective::Deform.name()),
            _ => format!("--injective {}, which parts the map", Injective::Split.name()),
        };
        return gap.into_iter().chain([other]).collect();
    }
    // The steps of relaxing have a limit of their own.
    if run.relaxed.is_some() && run.termination == Termination::MaxIterations {
        return vec![if may_cut { CUT_DISKS.to_owned() } else { longer_seam() }];
    }
    if run.relaxed.is_some() && run.termination == Termination::Stalled {
        let pins = asked.pins.as_ref().filter(|pins| pins.pins.iter().any(|pin| !pin.is_hard()));
        let weights = pins.map(|_| "smaller weights of soft pins".to_owned());
        let energy = asked.relax.map(|_| "another --energy".to_owned());
        return weights.into_iter().chain(energy).chain([longer_seam()]).collect();
    }
    // A solver of someone's own takes none of the options of ours.
    let own = run.settings.solver();
    if solver == SolverKind::Lscm.name() {
        return vec![format!("--solver {}", SolverKind::Auto)];
    }
    let iterative = own.as_ref().and_then(Solver::iterative_settings);
    if let Some(iterative) = iterative.filter(|_| run.inner_unconverged > 0 && !run.termination.is_as_asked()) {
        return stronger_inner_solve(iterative);
    }
    let is_stuck =
        !matches!(run.termination, Termination::TimeLimit | Termination::MaxIterations | Termination::Cancelled);
    if !asked.boundary.is_free() && is_stuck {
        return other_boundaries(&asked.boundary, solver);
    }
    if let Some(Solver::LinAbf(LinAbf { error_bound: Some(_), .. })) = own.as_ref().filter(|_| is_stuck) {
        return vec!["a larger --error-bound".to_owned(), "to leave out --error-bound".to_owned()];
    }
    let passes = own.as_ref().and_then(Solver::passes);
    let makes_exact_passes = passes.is_some_and(|passes| passes != Passes::Auto);
    match run.termination {
        Termination::TimeLimit => vec!["a longer --time-limit".to_owned()],
        Termination::MaxIterations if !makes_exact_passes => {
            vec![format!("--max-iterations {}", asked.stop.max_iterations.saturating_mul(2))]
        }
        Termination::Cancelled => Vec::new(),
        _ if run.solved_by == SolverKind::Descent.name() || !run.rungs.is_empty() => vec![longer_seam()],
        ending => match passes {
            Some(passes) => other_passes(passes, &asked, run.layout, ending),
            None => other_steps(solver, &asked, ending),
        },
    }
}

/// For a boundary that was not reached.
fn other_boundaries(asked: &Boundary, solver: &str) -> Vec<String> {
    let mut tries = Vec::new();
    if solver == SolverKind::LinAbf.name() {
        tries.push(format!("--solver {}", SolverKind::Barrier));
    }
    if !matches!(asked, Boundary::Convex | Boundary::Below2Pi(_)) {
        tries.push(format!("--boundary {}, which asks for less", Boundary::Convex));
    }
    tries.push("to leave out --boundary".to_owned());
    tries
}

/// For inner solves that broke off.
fn stronger_inner_solve(asked: IterativeSettings) -> Vec<String> {
    let mut tries = Vec::new();
    let best = (Reduction::Triangles, PreconditionerKind::Block);
    if (asked.reduction, asked.preconditioner) != best {
        tries.push(format!("--reduction {} --preconditioner {}", Reduction::Triangles, PreconditionerKind::Block));
    }
    tries.push(format!("--max-inner-iterations {}", asked.max_inner_iterations.saturating_mul(10)));
    tries
}

/// For the solver that makes passes.
fn other_passes(passes: Passes, asked: &Pipeline, used: Option<LayoutKind>, termination: Termination) -> Vec<String> {
    let mut tries = Vec::new();
    if passes != Passes::Auto {
        tries.push("--passes auto".to_owned());
    }
    match ring_switch(asked) {
        Some(switch) if asked.initial_guess.ring_switch.is_none() => tries.insert(0, switch),
        Some(switch) => tries.push(switch),
        None => {}
    }
    if termination == Termination::Converged {
        tries.push(longer_seam());
    } else if passes == Passes::Auto && (Some(asked.layout.kind) != used || used != Some(LayoutKind::LeastSquares)) {
        tries.push(format!("--passes 3 --layout {}", LayoutKind::LeastSquares));
    }
    tries
}

/// For the solvers with a fixed target.
fn other_steps(solver: &str, asked: &Pipeline, termination: Termination) -> Vec<String> {
    if termination == Termination::Converged {
        return ring_switch(asked).into_iter().chain([longer_seam()]).collect();
    }
    let mut tries = Vec::new();
    // That of someone's own has none: the default solver, which stands in its place, has none either.
    let newton = asked.solver.newton_settings();
    if newton.is_some_and(|newton| newton.line_search == LineSearch::Full) {
        tries.push(format!("--line-search {}", LineSearch::Merit));
    }
    if newton.is_some_and(|newton| newton.hessian == Hessian::Exact) {
        tries.push(format!("--hessian {}", Hessian::GaussNewton));
    }
    tries.extend(ring_switch(asked));
    if solver != SolverKind::AbfFixedTarget.name() {
        tries.push(format!("--solver {}", SolverKind::AbfFixedTarget));
    } else {
        tries.push(format!("--solver {}", SolverKind::LinAbf));
    }
    tries
}

/// Another start of the rings, if there is one.
fn ring_switch(asked: &Pipeline) -> Option<String> {
    match asked.initial_guess.ring_switch {
        None => Some(format!("--ring-switch {USUAL_RING_SWITCH}")),
        Some(threshold) if threshold > EAGER_RING_SWITCH => Some(format!("--ring-switch {EAGER_RING_SWITCH}")),
        Some(_) => None,
    }
}

/// The angles are right, but their triangles differ in size by more than doubles can hold.
fn longer_seam() -> String {
    "a longer seam".to_owned()
}
