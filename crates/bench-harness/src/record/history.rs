//! Every outer and inner iteration, for plotting.

use super::figure::{self, known};
use super::head::Head;
use super::json::pretty;
use abf::{Fallback, IterationRecord};
use serde::{Deserialize, Serialize};

/// The name of the JSON's format; the number goes up when a field changes its meaning.
const SCHEMA: &str = "bench-harness-history/2";

/// How one solver came to its angles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct History {
    /// The file.
    pub(crate) mesh: String,
    /// The solver's name.
    pub(crate) solver: String,
    /// Outer iterations or passes, in order.
    pub(crate) iterations: Vec<Iteration>,
}

/// One outer iteration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Iteration {
    /// Counted from 1.
    iteration: usize,
    /// `max |h|` after it, log form, rad.
    #[serde(with = "figure")]
    constraint_residual: f64,
    /// `max |δ|` of the full step, rad.
    #[serde(with = "figure")]
    step: f64,
    /// The share of it that was taken.
    #[serde(with = "figure")]
    step_length: f64,
    /// `Σ w (x − a)²` after it; `None` where the target moves.
    energy: Option<f64>,
    /// Inner iterations; refinement steps of a direct solve.
    inner_iterations: usize,
    /// `‖b − Ax‖ / ‖b‖`, computed.
    inner_residual: Option<f64>,
    /// The inner method's estimate of it, where it has one.
    inner_estimate: Option<f64>,
    /// Whether the inner solve met its tolerance.
    inner_converged: bool,
    /// Negative entries of the Hessian.
    negative_curvature: usize,
    /// Why the exact Hessian was given up, if it was.
    fallback: Option<String>,
    /// Angles clamped to the angle bounds before it.
    clamped_angles: usize,
    /// The estimate after each inner iteration; empty for a direct solve.
    inner: Vec<f64>,
}

impl History {
    /// The history of a solve; `curves` are the estimates after each inner iteration, for every outer
    /// one.
    pub(crate) fn new(mesh: &str, solver: String, records: &[IterationRecord], curves: Vec<Vec<f64>>) -> Self {
        let curves = curves.into_iter().chain(std::iter::repeat(Vec::new()));
        let iterations = records.iter().zip(curves).map(|(record, inner)| Iteration::new(record, inner)).collect();
        Self { mesh: mesh.to_owned(), solver, iterations }
    }

    /// The curve of the outer iterations: how many are done, and the constraint residual.
    pub(crate) fn outer(&self) -> Vec<(f64, f64)> {
        self.iterations.iter().map(|done| (done.iteration as f64, done.constraint_residual)).collect()
    }

    /// The estimates after every inner iteration, one outer iteration after the other.
    pub(crate) fn inner(&self) -> Vec<f64> {
        self.iterations.iter().flat_map(|done| &done.inner).copied().collect()
    }
}

impl Iteration {
    fn new(record: &IterationRecord, inner: Vec<f64>) -> Self {
        Self {
            iteration: record.iteration,
            constraint_residual: known(record.constraint_residual),
            step: known(record.step),
            step_length: known(record.step_length),
            energy: record.energy.filter(|x| x.is_finite()),
            inner_iterations: record.inner_iterations,
            inner_residual: record.solved_to().filter(|x| x.is_finite()),
            inner_estimate: record.inner_estimate.filter(|x| x.is_finite()),
            inner_converged: record.inner_converged,
            negative_curvature: record.negative_curvature,
            fallback: record.fallback.map(|why| fallback_word(why).to_owned()),
            clamped_angles: record.clamped_angles,
            inner,
        }
    }
}

fn fallback_word(fallback: Fallback) -> &'static str {
    match fallback {
        Fallback::LineSearch => "line-search",
        Fallback::NegativeCurvature => "negative-curvature",
        _ => "other",
    }
}

/// Collects the inner curves of one solve while it runs.
#[derive(Debug, Default)]
pub(crate) struct Curves {
    done: Vec<Vec<f64>>,
    current: Vec<f64>,
}

impl Curves {
    /// An inner iteration is done. Direct solves have no estimate, and no curve.
    pub(crate) fn inner(&mut self, estimate: f64) {
        if estimate.is_finite() {
            self.current.push(estimate);
        }
    }

    /// An outer iteration is done.
    pub(crate) fn outer(&mut self) {
        self.done.push(std::mem::take(&mut self.current));
    }

    /// One curve for every finished outer iteration.
    pub(crate) fn into_done(self) -> Vec<Vec<f64>> {
        self.done
    }
}

/// The histories as a JSON document.
pub(crate) fn to_json(runs: &[History]) -> String {
    pretty(&Histories { head: Head::new(SCHEMA), runs: runs.to_vec() })
}

/// Every iteration of several solves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Histories {
    /// What made it.
    #[serde(flatten)]
    pub(crate) head: Head,
    /// One for each solve.
    pub(crate) runs: Vec<History>,
}
