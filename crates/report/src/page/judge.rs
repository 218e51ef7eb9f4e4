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
    /// The runs that have the lowest F, to the digits that are shown: more than one where there is a tie.
    lowest: Vec<usize>,
}

/// How many digits F is shown with. Runs whose F is the same to these have the same F.
pub(crate) const DIGITS: usize = 4;

impl<'a> Judgement<'a> {
    /// Judges every run of a section.
    pub(crate) fn new(section: &'a MeshSection<'a>) -> Self {
        let outcomes: Vec<Outcome> = section.runs.iter().map(|run| outcome(section, run)).collect();
        let best = best(&outcomes, section.injective_only);
        let lowest = lowest(&outcomes, best, section.injective_only);
        Self { section, labels: labels(&section.runs), outcomes, best, lowest }
    }

    /// The figures of a run's layout.
    pub(crate) fn metrics(&self, run: usize) -> Option<&Metrics> {
        self.outcomes[run].metrics()
    }

    /// Whether a run has the lowest F of those that count, or the same.
    pub(crate) fn is_lowest(&self, run: usize) -> bool {
        self.lowest.contains(&run)
    }

    /// The runs that have the lowest F of those that count.
    pub(crate) fn lowest(&self) -> &[usize] {
        &self.lowest
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

/// Whether a layout counts for the lowest F.
fn counts(metrics: &Metrics, injective_only: bool) -> bool {
    if injective_only { metrics.injective() } else { metrics.valid() }
}

/// The run to show large: of those that count the one with the lowest F; if none does, one of those with the
/// fewest flipped and collapsed triangles. `None` if there is no layout at all.
fn best(outcomes: &[Outcome], injective_only: bool) -> Option<usize> {
    let rank = |a: &Metrics, b: &Metrics| -> Ordering {
        counts(b, injective_only)
            .cmp(&counts(a, injective_only))
            .then((a.certificate.flips + a.certificate.collapsed).cmp(&(b.certificate.flips + b.certificate.collapsed)))
            .then(a.f.total_cmp(&b.f))
    };
    let judged = outcomes.iter().enumerate().filter_map(|(k, outcome)| outcome.metrics().map(|m| (k, m)));
    judged.min_by(|(_, a), (_, b)| rank(a, b)).map(|(k, _)| k)
}

/// The runs that count and whose F is that of the best one, to the digits that are shown; none if the best one does not count.
fn lowest(outcomes: &[Outcome], best: Option<usize>, injective_only: bool) -> Vec<usize> {
    let shown = |k: usize| {
        let metrics = outcomes[k].metrics().filter(|metrics| counts(metrics, injective_only))?;
        Some(significant(metrics.f, DIGITS))
    };
    let Some(least) = best.and_then(shown) else { return Vec::new() };
    (0..outcomes.len()).filter(|&k| shown(k).as_ref() == Some(&least)).collect()
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
        outcome(&MeshSection { name: "square", mesh: Some(&mesh), ..MeshSection::default() }, &run)
    }

    #[test]
    fn the_best_run_is_valid_before_it_is_accurate() {
        let failed = Outcome::Failed("no".to_owned());
        let (flipped, poor, exact) = (judged([0.8, 0.1]), judged([0.2, 1.0]), judged([0.0, 1.0]));
        assert_eq!(best(&[failed.clone(), flipped.clone(), poor.clone(), exact], false), Some(3));
        assert_eq!(best(&[failed.clone(), flipped.clone(), poor], false), Some(2));
        assert_eq!(best(&[failed.clone(), flipped], false), Some(1));
        assert_eq!(best(&[failed, Outcome::Unseen], false), None);
    }

    #[test]
    fn runs_with_the_same_f_to_the_digits_shown_tie_for_the_lowest() {
        let (exact, poor) = (judged([0.0, 1.0]), judged([0.2, 1.0]));
        let nearly = judged([1e-9, 1.0]);
        assert_eq!(lowest(&[poor.clone(), poor.clone()], Some(0), false), [0, 1]);
        assert_eq!(lowest(&[poor.clone(), exact.clone(), nearly], Some(1), false), [1], "F of 0 is like no other");
        assert_eq!(lowest(&[judged([0.8, 0.1])], Some(0), false), [0; 0], "it is flipped");
    }

    /// A strip of squares in a plane, and a layout that turns around once and a half: valid, and over itself.
    fn overlapping() -> Outcome {
        const STEPS: usize = 30;
        let strip = |at: &dyn Fn(usize, f64) -> [f64; 2]| -> Vec<[f64; 2]> {
            (0..=STEPS).flat_map(|k| [at(k, 1.0), at(k, 2.0)]).collect()
        };
        let flat = strip(&|k, y| [-(k as f64) * 0.5, y]);
        let turned = strip(&|k, r| {
            let angle = k as f64 * 3.0 * std::f64::consts::PI / STEPS as f64;
            [r * angle.cos(), r * angle.sin()]
        });
        let faces: Vec<[usize; 3]> =
            (0..STEPS).map(|k| 2 * k).flat_map(|k| [[k, k + 1, k + 3], [k, k + 3, k + 2]]).collect();
        let positions = flat.iter().map(|p| Point3::new(p[0], p[1], 0.0)).collect();
        let mesh = TriMesh::new(positions, &faces).expect("indices in range");
        let uv = UvMap::per_vertex(&mesh, &turned.into_iter().map(Point2::from).collect::<Vec<_>>());
        let run = SolverRun { solver: "x", uv: Some(&uv), ..SolverRun::default() };
        outcome(&MeshSection { name: "strip", mesh: Some(&mesh), ..MeshSection::default() }, &run)
    }

    #[test]
    fn a_layout_over_itself_has_the_lowest_f_unless_only_injective_ones_count() {
        let turned = overlapping();
        let metrics = turned.metrics().expect("judged");
        assert!(metrics.valid() && !metrics.injective(), "{}", validity(metrics));
        let poor = judged([0.02, 3.0]);
        assert!(poor.metrics().expect("judged").f > metrics.f && poor.metrics().expect("judged").injective());
        let both = [turned, poor];
        assert_eq!([false, true].map(|injective| best(&both, injective)), [Some(0), Some(1)]);
        assert_eq!([false, true].map(|injective| lowest(&both, best(&both, injective), injective)), [[0], [1]]);
    }

    #[test]
    fn a_second_run_of_one_solver_is_numbered() {
        let runs = ["a", "b", "a", "a"].map(|solver| SolverRun { solver, ..SolverRun::default() });
        assert_eq!(labels(&runs), ["a", "b", "a (2)", "a (3)"]);
    }
}
