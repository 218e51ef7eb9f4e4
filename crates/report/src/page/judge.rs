//! What became of every run, and which one is shown large.

use std::cmp::Ordering;

use abf_metrics::{Metrics, measure};

use super::number::significant;
use super::{MeshSection, SolverRun};

/// What became of a run.
#[derive(Clone, Debug)]
pub(crate) enum Outcome {
    /// A layout that could be judged.
    Judged(Box<Metrics>),
    /// No result, or none that counts.
    Failed(String),
    /// Neither a layout nor a failure: the run is known by its figures only.
    Unseen,
}

impl Outcome {
    /// The figures of a layout.
    pub(crate) fn metrics(&self) -> Option<&Metrics> {
        match self {
            Self::Judged(metrics) => Some(metrics),
            Self::Failed(_) | Self::Unseen => None,
        }
    }
}

/// A section with what became of its runs.
pub(crate) struct Judgement<'a> {
    /// The section.
    pub(crate) section: &'a MeshSection<'a>,
    /// What became of every run.
    pub(crate) outcomes: Vec<Outcome>,
    /// The name of every run.
    pub(crate) labels: Vec<String>,
    /// The run to show large; see [`best`].
    pub(crate) best: Option<usize>,
}

impl<'a> Judgement<'a> {
    /// Judges every run of a section.
    pub(crate) fn new(section: &'a MeshSection<'a>) -> Self {
        let outcomes: Vec<Outcome> = section.runs.iter().map(|run| outcome(section, run)).collect();
        let best = best(&outcomes);
        Self { section, labels: labels(&section.runs), outcomes, best }
    }

    /// The figures of a run's layout.
    pub(crate) fn metrics(&self, run: usize) -> Option<&Metrics> {
        self.outcomes[run].metrics()
    }

    /// Whether a run is the best of the valid ones.
    pub(crate) fn is_best(&self, run: usize) -> bool {
        self.best == Some(run) && self.metrics(run).is_some_and(Metrics::valid)
    }
}

fn outcome(section: &MeshSection<'_>, run: &SolverRun<'_>) -> Outcome {
    if let Some(reason) = &run.failure {
        return Outcome::Failed(reason.clone());
    }
    match (section.mesh, run.uv) {
        (Some(mesh), Some(uv)) => match measure(mesh, uv) {
            Ok(metrics) => Outcome::Judged(Box::new(metrics)),
            Err(e) => Outcome::Failed(format!("the layout cannot be judged: {e}")),
        },
        _ => Outcome::Unseen,
    }
}

/// The run to show large: the valid one with the lowest F; if none is valid, one of those with the
/// fewest flipped and collapsed triangles. `None` if there is no layout at all.
fn best(outcomes: &[Outcome]) -> Option<usize> {
    let rank = |a: &Metrics, b: &Metrics| -> Ordering {
        (a.certificate.flips + a.certificate.collapsed)
            .cmp(&(b.certificate.flips + b.certificate.collapsed))
            .then(a.f.total_cmp(&b.f))
    };
    let judged = outcomes.iter().enumerate().filter_map(|(k, outcome)| outcome.metrics().map(|m| (k, m)));
    judged.min_by(|(_, a), (_, b)| rank(a, b)).map(|(k, _)| k)
}

/// The name of every run: its solver, numbered from the second run of one solver on.
fn labels(runs: &[SolverRun<'_>]) -> Vec<String> {
    let numbered = |(k, run): (usize, &SolverRun<'_>)| {
        let before = runs[..k].iter().filter(|other| other.solver == run.solver).count();
        if before == 0 { run.solver.to_owned() } else { format!("{} ({})", run.solver, before + 1) }
    };
    runs.iter().enumerate().map(numbered).collect()
}

/// How a layout lies, in a few words.
pub(crate) fn validity(metrics: &Metrics) -> String {
    let parts: Vec<String> = [
        (metrics.certificate.flips, "flipped"),
        (metrics.certificate.collapsed, "collapsed"),
        (metrics.certificate.wound, "wound vertices"),
        (metrics.certificate.overlaps(), "overlaps"),
    ]
    .into_iter()
    .filter(|&(count, _)| count > 0)
    .map(|(count, word)| format!("{count} {word}"))
    .collect();
    match (metrics.valid(), parts.is_empty()) {
        (true, true) => "valid".to_owned(),
        (true, false) => format!("valid, {}", parts.join(", ")),
        (false, _) => parts.join(", "),
    }
}

/// The figures of a layout in one line.
pub(crate) fn in_words(metrics: &Metrics) -> String {
    const DIGITS: usize = 4;
    format!(
        "{}, F/3nt {}, L2 stretch {}, largest angle error {}°",
        validity(metrics),
        significant(metrics.f, DIGITS),
        significant(metrics.stretch_l2, DIGITS),
        significant(metrics.max_angle_error.to_degrees(), DIGITS - 1)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::{Point2, Point3, TriMesh, UvMap};

    /// A square folded in two triangles, and a layout of it.
    fn judged(last: [f64; 2]) -> Outcome {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let positions = corners.iter().map(|p| Point3::new(p[0], p[1], 0.0)).collect();
        let mesh = TriMesh::new(positions, &[[0, 1, 2], [0, 2, 3]]).expect("indices in range");
        let uv: Vec<_> = corners[..3].iter().chain([&last]).map(|&p| Point2::from(p)).collect();
        let uv = UvMap::per_vertex(&mesh, &uv);
        let run = SolverRun { solver: "x", uv: Some(&uv), ..SolverRun::default() };
        outcome(&MeshSection { name: "square", mesh: Some(&mesh), runs: Vec::new() }, &run)
    }

    #[test]
    fn the_best_run_is_valid_before_it_is_accurate() {
        let failed = Outcome::Failed("no".to_owned());
        let (flipped, poor, exact) = (judged([0.8, 0.1]), judged([0.2, 1.0]), judged([0.0, 1.0]));
        assert_eq!(best(&[failed.clone(), flipped.clone(), poor.clone(), exact]), Some(3));
        assert_eq!(best(&[failed.clone(), flipped.clone(), poor]), Some(2));
        assert_eq!(best(&[failed.clone(), flipped]), Some(1));
        assert_eq!(best(&[failed, Outcome::Unseen]), None);
    }

    #[test]
    fn a_second_run_of_one_solver_is_numbered() {
        let runs = ["a", "b", "a", "a"].map(|solver| SolverRun { solver, ..SolverRun::default() });
        assert_eq!(labels(&runs), ["a", "b", "a (2)", "a (3)"]);
    }
}
