//! Where the time went.

use serde::{Deserialize, Serialize};

/// Where the time of one result went, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Timings {
    /// Reading the file, or making the built-in mesh.
    pub(crate) read: f64,
    /// From the mesh to its UVs; the medians of several runs.
    #[serde(flatten)]
    pub(crate) stages: Stages,
    /// Repairing, cutting, flattening and certifying charts.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub(crate) charts: f64,
    /// Packing them, and judging the whole.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub(crate) atlas: f64,
    /// Proving what the UVs are; part of `metrics` where a file is judged.
    pub(crate) certificate: f64,
    /// Judging the UVs.
    pub(crate) metrics: f64,
    /// Writing the mesh.
    pub(crate) write: f64,
    /// All of it, from beginning to end. Pictures come after.
    pub(crate) total: f64,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_nothing(seconds: &f64) -> bool {
    *seconds == 0.0
}

/// Where the time from the mesh to its UVs went, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Stages {
    /// Corner table, disk check, angles of the surface, initial guess.
    pub(crate) topology: f64,
    /// Solving for the angles.
    pub(crate) solve: f64,
    /// From angles to coordinates.
    pub(crate) layout: f64,
    /// Relaxing the map; absent where that was not asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) relax: Option<f64>,
    /// All of them: what solvers are compared by.
    pub(crate) flatten: f64,
    /// The processor time of the same, over all threads; absent where other work goes on beside it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) flatten_cpu: Option<f64>,
}

/// The times of runs that were made several times.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Repeats {
    /// How many were measured; the timings are their medians.
    pub(crate) count: usize,
    /// How many were made before and not measured.
    pub(crate) warmup: usize,
    /// Whether all of them gave the same bits.
    pub(crate) identical: bool,
    /// The standard deviation; 0 of a single run.
    #[serde(default)]
    pub(crate) deviation_s: Stages,
    /// The least.
    pub(crate) min_s: Stages,
    /// The greatest.
    pub(crate) max_s: Stages,
}

/// Median, standard deviation, least and greatest of each stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spread {
    /// The middle one; the mean of the middle two.
    pub(crate) median: Stages,
    /// The standard deviation, from the mean.
    pub(crate) deviation: Stages,
    /// The least.
    pub(crate) min: Stages,
    /// The greatest.
    pub(crate) max: Stages,
}

impl Spread {
    /// The spread of at least one run.
    pub(crate) fn of(runs: &[Stages]) -> Self {
        let each = |pick: fn(&[f64]) -> f64| {
            let stage = |of: fn(&Stages) -> f64| {
                let mut seconds: Vec<f64> = runs.iter().map(of).collect();
                seconds.sort_by(f64::total_cmp);
                pick(&seconds)
            };
            Stages {
                topology: stage(|s| s.topology),
                solve: stage(|s| s.solve),
                layout: stage(|s| s.layout),
                relax: runs.iter().all(|s| s.relax.is_some()).then(|| stage(|s| s.relax.unwrap_or_default())),
                flatten: stage(|s| s.flatten),
                flatten_cpu: runs
                    .iter()
                    .all(|s| s.flatten_cpu.is_some())
                    .then(|| stage(|s| s.flatten_cpu.unwrap_or_default())),
            }
        };
        Self {
            median: each(median),
            deviation: each(deviation),
            min: each(|sorted| sorted[0]),
            max: each(|sorted| sorted[sorted.len() - 1]),
        }
    }
}

fn deviation(seconds: &[f64]) -> f64 {
    let mean = seconds.iter().sum::<f64>() / seconds.len() as f64;
    let squares: f64 = seconds.iter().map(|s| (s - mean).powi(2)).sum();
    (squares / (seconds.len().max(2) - 1) as f64).sqrt()
}

fn median(sorted: &[f64]) -> f64 {
    let middle = sorted.len() / 2;
    if sorted.len() % 2 == 1 { sorted[middle] } else { f64::midpoint(sorted[middle - 1], sorted[middle]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_is_taken_stage_by_stage() {
        let run =
            |solve, layout| Stages { topology: 1.0, solve, layout, flatten: 1.0 + solve + layout, ..Stages::default() };
        let spread = Spread::of(&[run(5.0, 1.0), run(2.0, 2.0), run(3.0, 9.0)]);
        assert_eq!(spread.median, Stages { topology: 1.0, solve: 3.0, layout: 2.0, flatten: 7.0, ..Stages::default() });
        assert_eq!((spread.min.solve, spread.max.layout), (2.0, 9.0));
        assert_eq!((spread.deviation.topology, spread.deviation.layout), (0.0, 19_f64.sqrt()));
        assert_eq!(Spread::of(&[run(5.0, 1.0), run(2.0, 2.0)]).median.solve, 3.5);
        let once = Spread::of(&[run(5.0, 1.0)]);
        assert_eq!((once.median, once.deviation.solve), (run(5.0, 1.0), 0.0));
    }
}
