//! Progress on the terminal, the clock of every stage, the curves of inner solves, and the ear for
//! Ctrl-C.

use crate::record::Stages;
use crate::record::history::{Part, Trace};
use crate::run::cancel::Cancel;
use abf::{Event, Observer, Stage, UnwrapProgress, Verdict};
use cpu_time::ProcessTime;
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::collections::BTreeMap;
use std::io::{self, IsTerminal};
use std::sync::LazyLock;
use std::sync::mpsc::{self, Sender};
use std::thread;
use std::time::{Duration, Instant};

/// Work shorter than this shows no progress.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often the line is drawn anew.
const TICK: Duration = Duration::from_millis(100);

/// The lines of all meshes that are worked on: a survey has several.
static LINES: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);

/// The observer of one mesh.
pub(crate) struct Progress<'a> {
    cancel: &'a Cancel,
    line: Option<Line>,
    /// The stages of each piece of each component.
    pieces: BTreeMap<(usize, usize), Clock>,
    /// When each rung of a ladder began.
    rungs: Vec<Instant>,
    /// When the last stage ended.
    end: Option<Instant>,
    /// What the processors did between the beginning of the first stage and the end of the layout.
    cpu: Cpu,
    /// Every iteration, if they are wanted.
    trace: Option<Trace>,
    /// When the first stage began.
    begin: Option<Instant>,
}

impl<'a> Progress<'a> {
    /// Starts watching work of that name.
    pub(crate) fn new(name: &str, cancel: &'a Cancel) -> Self {
        let line = io::stderr().is_terminal().then(|| Line::new(name));
        let (pieces, cpu) = (BTreeMap::new(), Cpu::default());
        Self { cancel, line, pieces, rungs: Vec::new(), end: None, cpu, trace: None, begin: None }
    }

    /// Collects every iteration of that solver, if there is one.
    pub(crate) fn with_trace(self, solver: Option<&str>) -> Self {
        Self { trace: solver.map(Trace::of), ..self }
    }

    /// Every iteration, if they were wanted.
    pub(crate) fn take_trace(&mut self) -> Option<Trace> {
        self.trace.take()
    }

    /// Says what is being done outside the stages that the library reports.
    pub(crate) fn say(&self, what: impl Into<String>) {
        if let Some(line) = &self.line {
            line.bar.set_message(what.into());
        }
    }

    /// Whether the user has not asked to stop.
    pub(crate) fn may_go_on(&self) -> bool {
        !self.cancel.is_asked()
    }

    /// The last stage is over.
    pub(crate) fn end_stages(&mut self) {
        self.end = Some(Instant::now());
        self.cpu.stop();
    }

    /// How long the stages took.
    pub(crate) fn stages(&self) -> Stages {
        Stages { flatten_cpu: Some(self.cpu.seconds), ..flattened(|stage| self.seconds(stage)) }
    }

    /// How long the stages of one piece of a component took.
    pub(crate) fn stages_of(&self, component: usize, piece: usize) -> Stages {
        let clock = self.pieces.get(&(component, piece));
        flattened(|stage| clock.map_or(0.0, |clock| clock.seconds(stage, self.end())))
    }

    /// How long the certificate took, in seconds.
    pub(crate) fn certificate(&self) -> f64 {
        self.seconds(Stage::Certificate)
    }

    /// How long each rung of a ladder took, in seconds.
    pub(crate) fn rungs(&self) -> Vec<f64> {
        let ends = self.rungs.iter().skip(1).copied().chain([self.end()]);
        self.rungs.iter().zip(ends).map(|(start, end)| end.duration_since(*start).as_secs_f64()).collect()
    }

    /// How long a stage took, in seconds, every time it came, of all pieces together; 0 if there was none.
    fn seconds(&self, stage: Stage) -> f64 {
        self.pieces.values().map(|clock| clock.seconds(stage, self.end())).sum()
    }

    fn end(&self) -> Instant {
        self.end.unwrap_or_else(Instant::now)
    }

    /// Keeps what is known of an iteration, if that is wanted.
    fn note(&mut self, event: Event<'_>, now: Instant) {
        let Some(trace) = &mut self.trace else { return };
        let time_s = now.duration_since(*self.begin.get_or_insert(now)).as_secs_f64();
        match event {
            Event::StageStarted(Stage::Relax) => trace.stage(Part::Relax),
            Event::StageStarted(Stage::Topology | Stage::Solve) => trace.stage(Part::Solve),
            Event::RungStarted(solver) => trace.rung(solver),
            Event::Start { record, corners } => trace.start(record, corners, time_s),
            Event::Drawing(drawing) => trace.drawing(drawing.f(), drawing.flips()),
            Event::Inner { relative_residual, .. } => trace.inner(relative_residual),
            Event::Iteration(record) => trace.iteration(record, time_s),
            _ => {}
        }
    }
}

/// The stages of one piece, or of a whole mesh that is no chart.
#[derive(Default)]
struct Clock {
    /// When each of them began.
    starts: Vec<(Stage, Instant)>,
    /// When a piece was last heard of: others go on after it.
    heard: Option<Instant>,
}

impl Clock {
    /// How long a stage took, every time it came; the last of a whole mesh goes on until `end`.
    fn seconds(&self, stage: Stage, end: Instant) -> f64 {
        let ends = self.starts.iter().skip(1).map(|&(_, start)| start).chain([self.heard.unwrap_or(end)]);
        let of_this = self.starts.iter().zip(ends).filter(|((s, _), _)| *s == stage);
        of_this.map(|((_, start), end)| end.duration_since(*start).as_secs_f64()).sum()
    }
}

/// The stages from a mesh to its UVs, and their sum.
fn flattened(seconds: impl Fn(Stage) -> f64) -> Stages {
    let [topology, solve, layout] = [Stage::Topology, Stage::Solve, Stage::Layout].map(&seconds);
    let relax = Some(seconds(Stage::Relax)).filter(|&relax| relax > 0.0);
    let flatten = topology + solve + layout + relax.unwrap_or(0.0);
    Stages { topology, solve, layout, relax, flatten, flatten_cpu: None }
}

/// Processor time, from the first stage to the one after the layout.
#[derive(Default)]
struct Cpu {
    running: Option<ProcessTime>,
    seconds: f64,
}

impl Cpu {
    fn stage(&mut self, stage: Stage) {
        match stage {
            Stage::Topology | Stage::Solve | Stage::Layout | Stage::Relax => {
                self.running.get_or_insert_with(ProcessTime::now);
            }
            _ => self.stop(),
        }
    }

    fn stop(&mut self) {
        if let Some(begin) = self.running.take() {
            self.seconds += begin.elapsed().as_secs_f64();
        }
    }
}

impl Observer for Progress<'_> {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        self.observe_at(UnwrapProgress::default(), event)
    }

    fn observe_at(&mut self, place: UnwrapProgress, event: Event<'_>) -> Verdict {
        if let Some(line) = self.line.as_ref().filter(|_| place.faces > 0) {
            line.faces(place.faces_done, place.faces);
        }
        let now = Instant::now();
        self.note(event, now);
        let clock = self.pieces.entry((place.component, place.chart)).or_default();
        clock.heard = (place.charts > 0).then_some(now);
        match event {
            Event::StageStarted(stage) => {
                clock.starts.push((stage, now));
                self.cpu.stage(stage);
                self.say(at(
                    place,
                    match stage {
                        Stage::Topology => "topology",
                        Stage::Solve => "solving",
                        Stage::Certificate => "certificate",
                        Stage::Relax => "relaxing",
                        _ => "layout",
                    },
                ));
            }
            Event::RungStarted(_) => self.rungs.push(now),
            Event::Iteration(record) => {
                let is_relaxing = clock.starts.last().is_some_and(|&(stage, _)| stage == Stage::Relax);
                let done = match record.energy {
                    Some(energy) if is_relaxing => format!("relaxing: {} done, energy {energy:.4e}", record.iteration),
                    None if is_relaxing => format!("relaxing: {} done, to shapes within reach", record.iteration),
                    _ => format!("solving: {} done, residual {:.1e}", record.iteration, record.constraint_residual),
                };
                self.say(at(place, &done));
            }
            _ => {}
        }
        self.cancel.verdict()
    }
}

/// What is being done, and where: the component, its piece and the round, of a mesh that is made into charts. Where there
/// is one of a kind it is not counted.
fn at(place: UnwrapProgress, what: &str) -> String {
    if place.charts == 0 {
        return what.to_owned();
    }
    let of = |name: &str, number: usize, all: usize| (all > 1).then(|| format!("{name} {}/{all}", number + 1));
    let parts = [of("component", place.component, place.components), of("piece", place.chart, place.charts)];
    let parts: Vec<String> = parts.into_iter().flatten().chain([format!("round {}", place.round + 1)]).collect();
    format!("{}: {what}", parts.join(", "))
}

/// One line on stderr that appears when the work turns out to be long and is gone when it ends.
struct Line {
    bar: ProgressBar,
    /// Dropped when the work ends, which wakes the thread that waits to show the line.
    _end: Sender<()>,
}

impl Line {
    fn new(name: &str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{spinner} {prefix}: {msg} ({elapsed})");
        bar.set_style(style.expect("a template without unknown keys"));
        bar.set_prefix(name.to_owned());
        bar.set_message("reading");
        let (end, ended) = mpsc::channel::<()>();
        let shown = bar.clone();
        thread::spawn(move || {
            if ended.recv_timeout(PATIENCE) == Err(mpsc::RecvTimeoutError::Timeout) {
                LINES.add(shown).enable_steady_tick(TICK);
            }
        });
        Self { bar, _end: end }
    }

    /// So many faces are in finished charts of so many: there is something to draw a bar of.
    fn faces(&self, done: usize, all: usize) {
        let all = all as u64;
        if self.bar.length() != Some(all) {
            let style = ProgressStyle::with_template("{spinner} {prefix}: {bar:20} {percent}% {msg} ({elapsed})");
            self.bar.set_style(style.expect("a template without unknown keys"));
            self.bar.set_length(all);
        }
        self.bar.set_position(done as u64);
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::history::{Ended, History};

    #[test]
    fn stages_are_timed_from_their_start_to_the_start_of_the_next() {
        let cancel = Cancel::default();
        let mut progress = Progress::new("a mesh", &cancel);
        for stage in [Stage::Topology, Stage::Solve] {
            assert_eq!(progress.observe(Event::StageStarted(stage)), Verdict::Continue);
            thread::sleep(Duration::from_millis(5));
        }
        progress.end_stages();
        thread::sleep(Duration::from_millis(5));
        let whole = progress.end.expect("ended").duration_since(progress.pieces[&(0, 0)].starts[0].1).as_secs_f64();
        let stages = progress.stages();
        assert!((whole - stages.flatten).abs() < 1e-9);
        assert!(stages.solve >= 0.005);
        assert_eq!(stages.layout, 0.0);
    }

    #[test]
    fn stages_of_components_side_by_side_are_timed_apart_and_the_place_is_said() {
        let cancel = Cancel::default();
        let mut progress = Progress::new("a mesh", &cancel);
        let mut second = UnwrapProgress::default();
        (second.component, second.components, second.charts, second.round) = (1, 3, 1, 1);
        progress.observe_at(UnwrapProgress::default(), Event::StageStarted(Stage::Solve));
        progress.observe_at(second, Event::StageStarted(Stage::Solve));
        thread::sleep(Duration::from_millis(5));
        progress.observe_at(second, Event::Working);
        let of_second = progress.stages_of(1, 0).solve;
        thread::sleep(Duration::from_millis(5));
        progress.end_stages();
        // Both went on at the same time, the second until it was last heard of.
        assert!(of_second >= 0.005 && progress.stages_of(1, 0).solve == of_second);
        assert!(progress.stages().solve >= 0.010 + of_second);
        assert_eq!(progress.stages_of(1, 1), Stages::default());
        assert_eq!(at(UnwrapProgress::default(), "layout"), "layout");
        assert_eq!(at(second, "layout"), "component 2/3, round 2: layout");
        (second.components, second.chart, second.charts) = (1, 4, 7);
        assert_eq!(at(second, "layout"), "piece 5/7, round 2: layout");
    }

    #[test]
    fn inner_curves_are_cut_at_outer_iterations() {
        let cancel = Cancel::default();
        let mut progress = Progress::new("a mesh", &cancel).with_trace(Some("uzawa"));
        let ended = Ended { mesh: "a mesh".to_owned(), solved_by: "uzawa".to_owned(), corners: 3, figures: None };
        let record = abf::IterationRecord::default();
        for estimates in [&[0.5, 0.1][..], &[f64::NAN], &[0.2]] {
            for &relative_residual in estimates {
                progress.observe(Event::Inner { iteration: 1, inner: 1, relative_residual });
            }
            progress.observe(Event::Iteration(&record));
        }
        let trace = progress.take_trace().expect("wanted");
        let history = History::new(&abf::Pipeline::default(), ended, trace);
        let curves: Vec<&[f64]> = history.iterations.iter().map(|done| done.inner.as_slice()).collect();
        assert_eq!(curves, [&[0.5, 0.1][..], &[], &[0.2]]);
        assert!(progress.take_trace().is_none());
    }
}
