//! Every outer and inner iteration, for plotting.

use super::head::Head;
use super::json::pretty;
use super::settings::Asked;
use abf::{Energy, Fallback, Injective, IterationRecord, Pipeline, Relax};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::iter::once;

/// The name of the JSON's format; the number goes up when a field changes its meaning.
const SCHEMA: &str = "bench-harness-history/3";

/// How one solver came to its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct History {
    /// The file.
    pub(crate) mesh: String,
    /// The solver's name.
    pub(crate) solver: String,
    /// Whose result it is: with `auto` the solver it came to.
    pub(crate) solved_by: String,
    /// What it was asked.
    pub(crate) settings: Asked,
    /// The corners of the mesh. Rows with fewer are those of a coarse level.
    pub(crate) corners: usize,
    /// `F / 3nt` of the result, rad².
    pub(crate) f: Option<f64>,
    /// Its flipped triangles.
    pub(crate) flips: Option<usize>,
    /// What the rows do not have, and why.
    pub(crate) notes: Vec<String>,
    /// Outer iterations or passes, in order.
    pub(crate) iterations: Vec<Iteration>,
}

/// One outer iteration, or what the first one starts from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Iteration {
    /// The solver it is of: with `auto` one of those that are tried.
    pub(crate) by: String,
    /// What is being done.
    pub(crate) stage: Part,
    /// Which start it follows, counted from 1: solvers that work in rounds or on levels have several.
    pub(crate) start: usize,
    /// The corners of what is worked on.
    pub(crate) corners: usize,
    /// Counted from 1; 0 is what is there before the first.
    pub(crate) iteration: usize,
    /// When it was done, seconds since the run began.
    pub(crate) time_s: f64,
    /// `max |h|` after it, log form, rad; `None` where it is not finite, and while relaxing.
    pub(crate) constraint_residual: Option<f64>,
    /// `F / 3nt` of the drawing after it, rad²; `None` where there is no drawing yet.
    pub(crate) f: Option<f64>,
    /// The triangles of the drawing that are not counter-clockwise.
    pub(crate) flips: Option<usize>,
    /// The energy after it; `None` where the target moves.
    pub(crate) energy: Option<f64>,
    /// Which energy that is. Only energies of one name and of the same corners can be compared.
    pub(crate) energy_of: Option<String>,
    /// `max |δ|` of the full step: rad; while relaxing, part of the side of a square as large as the surface.
    pub(crate) step: Option<f64>,
    /// The share of it that was taken.
    pub(crate) step_length: Option<f64>,
    /// Inner iterations; refinement steps of a direct solve.
    pub(crate) inner_iterations: usize,
    /// `‖b − Ax‖ / ‖b‖`, computed.
    pub(crate) inner_residual: Option<f64>,
    /// The inner method's estimate of it, where it has one.
    pub(crate) inner_estimate: Option<f64>,
    /// Whether the inner solve met its tolerance; `None` where there was none.
    pub(crate) inner_converged: Option<bool>,
    /// Negative entries of the Hessian.
    pub(crate) negative_curvature: usize,
    /// Why the exact Hessian was given up, if it was.
    pub(crate) fallback: Option<String>,
    /// Angles clamped to the angle bounds before it.
    pub(crate) clamped_angles: usize,
    /// The estimate after each inner iteration; empty for a direct solve.
    pub(crate) inner: Vec<f64>,
}

/// What is being done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Part {
    /// Solving.
    #[default]
    Solve,
    /// Relaxing.
    Relax,
}

impl Part {
    /// The word, as in the JSON.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Solve => "solve",
            Self::Relax => "relax",
        }
    }
}

/// What a run came to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ended {
    /// The file.
    pub(crate) mesh: String,
    /// Whose result it is.
    pub(crate) solved_by: String,
    /// The corners of the mesh.
    pub(crate) corners: usize,
    /// `F / 3nt` and the flipped triangles.
    pub(crate) figures: Option<(f64, usize)>,
}

impl History {
    /// The history of a run.
    pub(crate) fn new(pipeline: &Pipeline, ended: Ended, trace: Trace) -> Self {
        let Ended { mesh, solved_by, corners, figures } = ended;
        let energy_of = |part: Part| match part {
            Part::Solve => Energy::Abf.to_string(),
            Part::Relax => relaxed_energy(pipeline),
        };
        let named = |row: Iteration| Iteration { energy_of: row.energy.is_some().then(|| energy_of(row.stage)), ..row };
        let iterations: Vec<Iteration> = trace.rows.into_iter().map(named).collect();
        Self {
            mesh,
            solver: pipeline.solver.name().to_owned(),
            solved_by,
            settings: Asked::new(pipeline),
            corners,
            f: figures.map(|(f, _)| f).filter(|f| f.is_finite()),
            flips: figures.map(|(_, flips)| flips),
            notes: notes(&iterations, corners),
            iterations,
        }
    }

    /// The curve of the outer iterations of the solver whose result it is, or of the last of its starts: how many are done,
    /// and the constraint residual.
    pub(crate) fn outer(&self) -> Vec<(f64, f64)> {
        self.last().filter_map(|done| Some((done.iteration as f64, done.constraint_residual?))).collect()
    }

    /// The estimates after every inner iteration of the same, one outer iteration after the other.
    pub(crate) fn inner(&self) -> Vec<f64> {
        self.last().flat_map(|done| &done.inner).copied().collect()
    }

    /// Seconds and the constraint residual, of everything that was tried.
    pub(crate) fn timed(&self) -> Vec<(f64, f64)> {
        self.iterations.iter().filter_map(|done| Some((done.time_s, done.constraint_residual?))).collect()
    }

    /// Seconds and the energy, by the name of the energy; not those of coarse levels, which are sums over fewer corners.
    pub(crate) fn energies(&self) -> Vec<(String, Vec<(f64, f64)>)> {
        let mut curves: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
        for done in self.iterations.iter().filter(|done| done.corners == self.corners) {
            if let (Some(name), Some(energy)) = (&done.energy_of, done.energy) {
                curves.entry(name).or_default().push((done.time_s, energy));
            }
        }
        curves.into_iter().map(|(name, curve)| (name.to_owned(), curve)).collect()
    }

    /// The rows of the last start of the solver whose result it is.
    fn last(&self) -> impl Iterator<Item = &Iteration> {
        let of_solver = || self.iterations.iter().filter(|done| done.stage == Part::Solve);
        let by = of_solver().rfind(|done| done.by == self.solved_by).or_else(|| of_solver().next_back());
        let start = by.map(|done| done.start);
        of_solver().filter(move |done| Some(done.start) == start)
    }
}

/// The energy that is relaxed, and what stands beside it.
fn relaxed_energy(pipeline: &Pipeline) -> String {
    // Maps without overlaps are made for angles where nothing else is asked for.
    let is_deformed = pipeline.injective == Injective::Deform;
    let default = if is_deformed { Energy::Abf } else { Relax::default().energy };
    let energy = pipeline.relax.map_or(default, |relax| relax.energy);
    let barrier = (energy == Energy::Abf).then_some("barrier");
    let pins = pipeline.pins.is_some().then_some("pins");
    let contacts = is_deformed.then_some("contacts");
    let beside = [barrier, pins, contacts].into_iter().flatten().map(str::to_owned);
    let parts: Vec<String> = once(energy.to_string()).chain(beside).collect();
    parts.join(" + ")
}

/// What the rows do not have, and why.
fn notes(rows: &[Iteration], corners: usize) -> Vec<String> {
    let names = |wanted: fn(&Iteration) -> bool| {
        let mut names: Vec<&str> = Vec::new();
        for row in rows.iter().filter(|row| wanted(row)) {
            if !names.contains(&row.by.as_str()) {
                names.push(&row.by);
            }
        }
        (!names.is_empty()).then(|| names.join(", "))
    };
    let without_drawing = names(|row| row.stage == Part::Solve && row.f.is_none());
    let without_energy = names(|row| row.stage == Part::Solve && row.energy.is_none());
    let coarse = rows.iter().find(|row| row.corners != corners).map(|row| row.corners);
    let within_reach = rows.iter().any(|row| row.stage == Part::Relax && row.energy.is_none());
    [
        without_drawing.map(|by| format!("no f and no flips of {by}: positions come after its last row")),
        without_energy.map(|by| format!("no energy of {by}: the target moves")),
        coarse.map(|n| format!("rows of {n} corners are those of a coarse level: their energy is not one of the mesh")),
        within_reach.then(|| "no energy of steps to shapes within reach: the target moves".to_owned()),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn fallback_word(fallback: Fallback) -> &'static str {
    match fallback {
        Fallback::LineSearch => "line-search",
        Fallback::NegativeCurvature => "negative-curvature",
        _ => "other",
    }
}

/// Collects the iterations of one run while it goes on.
#[derive(Debug, Default)]
pub(crate) struct Trace {
    rows: Vec<Iteration>,
    by: String,
    stage: Part,
    start: usize,
    corners: usize,
    drawn: Option<(f64, usize)>,
    inner: Vec<f64>,
}

impl Trace {
    /// Of a solver.
    pub(crate) fn of(solver: &str) -> Self {
        Self { by: solver.to_owned(), ..Self::default() }
    }

    /// Another solver begins.
    pub(crate) fn rung(&mut self, solver: &str) {
        solver.clone_into(&mut self.by);
    }

    /// Something else is being done.
    pub(crate) fn stage(&mut self, stage: Part) {
        self.stage = stage;
    }

    /// A solver starts from here.
    pub(crate) fn start(&mut self, record: &IterationRecord, corners: usize, time_s: f64) {
        self.start += 1;
        self.corners = corners;
        self.inner.clear();
        let row = self.row(record, time_s);
        self.rows.push(row);
    }

    /// The next row has a drawing.
    pub(crate) fn drawing(&mut self, f: f64, flips: usize) {
        self.drawn = Some((f, flips));
    }

    /// An inner iteration is done. Direct solves have no estimate, and no curve.
    pub(crate) fn inner(&mut self, estimate: f64) {
        if estimate.is_finite() {
            self.inner.push(estimate);
        }
    }

    /// An outer iteration is done.
    pub(crate) fn iteration(&mut self, record: &IterationRecord, time_s: f64) {
        let row = self.row(record, time_s);
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        self.rows.push(Iteration {
            step: finite(record.step),
            step_length: finite(record.step_length),
            inner_residual: record.solved_to().and_then(finite),
            inner_estimate: record.inner_estimate.and_then(finite),
            inner_converged: Some(record.inner_converged),
            ..row
        });
    }

    fn row(&mut self, record: &IterationRecord, time_s: f64) -> Iteration {
        let drawn = self.drawn.take();
        let residual = Some(record.constraint_residual).filter(|_| self.stage == Part::Solve);
        Iteration {
            by: self.by.clone(),
            stage: self.stage,
            start: self.start,
            corners: self.corners,
            iteration: record.iteration,
            time_s,
            constraint_residual: residual.filter(|x| x.is_finite()),
            f: drawn.map(|(f, _)| f).filter(|f| f.is_finite()),
            flips: drawn.map(|(_, flips)| flips),
            energy: record.energy.filter(|x| x.is_finite()),
            energy_of: None,
            step: None,
            step_length: None,
            inner_iterations: record.inner_iterations,
            inner_residual: None,
            inner_estimate: None,
            inner_converged: None,
            negative_curvature: record.negative_curvature,
            fallback: record.fallback.map(|why| fallback_word(why).to_owned()),
            clamped_angles: record.clamped_angles,
            inner: std::mem::take(&mut self.inner),
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use abf::Pins;

    fn ended(solved_by: &str) -> Ended {
        Ended { mesh: "m".to_owned(), solved_by: solved_by.to_owned(), corners: 9, figures: Some((0.5, 0)) }
    }

    fn record(iteration: usize, residual: f64, energy: Option<f64>) -> IterationRecord {
        IterationRecord { iteration, constraint_residual: residual, energy, ..IterationRecord::default() }
    }

    #[test]
    fn energies_that_cannot_be_compared_have_curves_of_their_own_and_those_of_coarse_levels_none() {
        let mut trace = Trace::of("descent");
        trace.start(&record(0, 1.0, Some(50.0)), 3, 0.0);
        trace.start(&record(0, 1.0, Some(5.0)), 9, 1.0);
        trace.iteration(&record(1, 0.1, Some(4.0)), 2.0);
        trace.stage(Part::Relax);
        trace.drawing(0.25, 1);
        trace.start(&record(0, 0.0, Some(7.0)), 9, 3.0);
        let relax = Some(Relax { energy: Energy::Isometric, ..Relax::default() });
        let pipeline = Pipeline { relax, ..Pipeline::default() };
        let history = History::new(&pipeline, ended("descent"), trace);
        let expected = [("abf".to_owned(), vec![(1.0, 5.0), (2.0, 4.0)]), ("isometric".to_owned(), vec![(3.0, 7.0)])];
        assert_eq!(history.energies(), expected);
        assert_eq!(history.outer(), [(0.0, 1.0), (1.0, 0.1)]);
        assert_eq!(history.timed().len(), 3, "relaxing has no residual");
        assert_eq!((history.iterations[3].f, history.iterations[3].flips), (Some(0.25), Some(1)));
        assert!(history.notes.iter().any(|note| note.starts_with("rows of 3 corners")), "{:?}", history.notes);
    }

    #[test]
    fn the_curve_is_that_of_the_solver_whose_result_it_is() {
        let mut trace = Trace::of("auto");
        for (solver, residual) in [("linabf", 1.0), ("barrier", 2.0)] {
            trace.rung(solver);
            trace.start(&record(0, residual, None), 9, 0.0);
            trace.inner(0.5);
            trace.iteration(&record(1, 0.1 * residual, None), 1.0);
        }
        let history = History::new(&Pipeline::default(), ended("linabf"), trace);
        assert_eq!(history.outer(), [(0.0, 1.0), (1.0, 0.1)]);
        assert_eq!((history.inner(), history.timed().len()), (vec![0.5], 4));
        let note = "no f and no flips of linabf, barrier: positions come after its last row";
        assert!(history.notes.contains(&note.to_owned()), "{:?}", history.notes);
    }

    #[test]
    fn an_energy_is_named_with_what_stands_beside_it() {
        let named = |energy, pins: bool| {
            let relax = Some(Relax { energy, ..Relax::default() });
            relaxed_energy(&Pipeline { relax, pins: pins.then(Pins::default), ..Pipeline::default() })
        };
        assert_eq!(named(Energy::Abf, false), "abf + barrier");
        assert_eq!(named(Energy::USABLE, true), "usable + pins");
        let deform = Pipeline { injective: Injective::Deform, ..Pipeline::default() };
        assert_eq!(relaxed_energy(&deform), "abf + barrier + contacts");
    }
}
