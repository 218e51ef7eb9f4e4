//! One mesh and one solver, several times.

use crate::cli::methods::Method;
use crate::record::{Repeats, Spread, Stages};
use crate::run::cancel::Cancel;
use crate::run::load::Loaded;
use crate::run::{Flattened, Wanted, flatten, flatten_again};

/// How often.
#[derive(Clone, Copy, Debug)]
pub(super) struct Runs {
    /// Runs that are not measured.
    pub(super) warmup: usize,
    /// Runs that are; at least one.
    pub(super) repeats: usize,
    /// Whether every iteration is collected, in the first measured run.
    pub(super) with_history: bool,
}

/// Flattens a mesh several times. The figures are those of the first measured run, the times the
/// medians of all. What has no result the first time is not tried again.
pub(super) fn repeated(loaded: &Loaded, method: &Method, runs: Runs, cancel: &Cancel) -> Flattened {
    if method.not_run(loaded.mesh()).is_none() {
        for _ in 0..runs.warmup {
            if cancel.is_asked() || flatten_again(loaded, method, cancel).is_err() {
                break;
            }
        }
    }
    let wanted = Wanted { with_history: runs.with_history, ..Wanted::default() };
    let mut first = flatten(loaded, method, &wanted, cancel);
    if first.record.error.is_some() || first.record.is_cancelled() {
        return first;
    }
    let Some(mut timings) = first.record.timings_s else { return first };
    let mut measured: Vec<Stages> = vec![timings.stages];
    let mut identical = true;
    for _ in 1..runs.repeats {
        // A run that the user stops is none: what was measured before it stands.
        match flatten_again(loaded, method, cancel) {
            _ if cancel.is_asked() => break,
            Ok((fingerprint, stages)) => {
                identical &= first.is_the_same_as(&fingerprint);
                measured.push(stages);
            }
            Err(_) => identical = false,
        }
    }
    let Spread { median, deviation, min, max } = Spread::of(&measured);
    timings.total += median.flatten - timings.stages.flatten;
    timings.stages = median;
    first.record.timings_s = Some(timings);
    let (count, warmup) = (measured.len(), runs.warmup);
    first.record.repeats = Some(Repeats { count, warmup, identical, deviation_s: deviation, min_s: min, max_s: max });
    first
}
