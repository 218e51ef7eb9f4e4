//! What to try next when a result is not what was hoped for.

use crate::record::{Asked, Outcome, Record, Run};
use abf::{LayoutKind, Passes, SolverKind, Termination};

/// The threshold that the paper recommends (§4.2), rad.
const USUAL_RING_SWITCH: f64 = 1.0;
/// A threshold that helps where the usual one does not, rad.
const EAGER_RING_SWITCH: f64 = 0.5;
/// More suggestions would be a manual.
const SUGGESTIONS: usize = 2;

/// What went wrong in a few words, and options that have not been tried yet; `None` where nothing
/// went wrong, or where the error says it.
pub(crate) fn next_to_try(record: &Record) -> Option<String> {
    let (run, quality) = (record.run.as_ref()?, record.quality.as_ref()?);
    if record.outcome() == Outcome::AsAsked {
        return None;
    }
    let (asked, metrics) = (&run.settings, quality.metrics());
    let mut what = Vec::new();
    if !run.termination.is_as_asked() {
        what.push(ending(run));
    }
    if !quality.valid {
        what.push(format!("{} flipped and {} collapsed triangles", metrics.flips, metrics.collapsed));
    }
    if what.is_empty() {
        // As asked and valid, but a file could not be written.
        return None;
    }
    let tries = match run.termination {
        Termination::TimeLimit => vec!["a longer --time-limit".to_owned()],
        Termination::MaxIterations if asked.passes == Passes::Auto => {
            vec![format!("--max-iterations {}", 2 * asked.max_iterations)]
        }
        Termination::Cancelled => Vec::new(),
        ending => untried(run.solver, asked, run.layout, ending),
    };
    let what = what.join(", ");
    Some(if tries.is_empty() { what } else { format!("{what}: try {}", tries.join(", or ")) })
}

/// How the solver ended, in words.
pub(crate) fn ending(run: &Run) -> String {
    let passes = match run.iterations {
        1 => "1 pass".to_owned(),
        n => format!("{n} passes"),
    };
    match run.termination {
        Termination::OnePass if run.iterations == 0 => "one linear solve, as asked".to_owned(),
        Termination::OnePass => "one pass, as asked".to_owned(),
        Termination::MaxIterations => format!("not converged after {passes}"),
        Termination::TimeLimit => format!("out of time after {passes}"),
        other => format!("{other} after {passes}"),
    }
}

/// Options that differ from what was asked, the most promising first.
fn untried(solver: &str, asked: &Asked, used: LayoutKind, termination: Termination) -> Vec<String> {
    if solver == SolverKind::Lscm.name() {
        return vec![format!("--solver {}", SolverKind::LinAbf)];
    }
    let mut tries = Vec::new();
    if asked.passes != Passes::Auto {
        tries.push("--passes auto".to_owned());
    }
    match asked.ring_switch {
        None => tries.insert(0, format!("--ring-switch {USUAL_RING_SWITCH}")),
        Some(threshold) if threshold > EAGER_RING_SWITCH => tries.push(format!("--ring-switch {EAGER_RING_SWITCH}")),
        Some(_) => {}
    }
    if termination == Termination::Converged {
        // The angles are right, but their triangles differ in size by more than doubles can hold.
        tries.push("a longer seam".to_owned());
    } else if asked.passes == Passes::Auto && (asked.layout != used || used != LayoutKind::LeastSquares) {
        tries.push(format!("--passes 3 --layout {}", LayoutKind::LeastSquares));
    }
    tries.truncate(SUGGESTIONS);
    tries
}
