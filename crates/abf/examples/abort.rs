//! How long an abort takes: runs solvers on a generated mesh, and aborts them at many questions.
//!
//! `cargo run --release -p abf --example abort -- 500000` prints, in seconds of processor time, the longest wait between two
//! questions with the events around it, and the longest way from an abort to the return.

#![allow(clippy::print_stdout, reason = "an example shows what it measured")]

use abf::{Event, Observer, Pipeline, Solver, SurfaceHints, Unwrap, Verdict};
use abf_shapes::Shape;
use cpu_time::ProcessTime;
use std::error::Error;

/// At how many questions each run is aborted.
const POINTS: usize = 6;

/// Aborts at the question of this number, and measures the way there.
struct Clock {
    abort_at: usize,
    asked: usize,
    last: (ProcessTime, String),
    /// The longest wait, and the events before and after it.
    longest: (f64, String, String),
}

impl Clock {
    fn new(abort_at: usize) -> Self {
        Self { abort_at, asked: 0, last: (ProcessTime::now(), "start".into()), longest: Default::default() }
    }

    /// Takes the time since the last question.
    fn take(&mut self, now: String) {
        let waited = self.last.0.elapsed().as_secs_f64();
        let before = std::mem::replace(&mut self.last.1, now);
        if waited > self.longest.0 {
            self.longest = (waited, before, self.last.1.clone());
        }
        self.last.0 = ProcessTime::now();
    }
}

/// An event in a few words; questions without a name of their own are numbered.
fn named(event: &Event<'_>, number: usize) -> String {
    match event {
        Event::StageStarted(stage) => format!("{stage:?}"),
        Event::RungStarted(name) => format!("rung {name}"),
        Event::Iteration(record) => format!("iteration {}", record.iteration),
        Event::Inner { iteration, inner, .. } => format!("iteration {iteration}, inner {inner}"),
        _ => format!("question {number}"),
    }
}

impl Observer for Clock {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        self.asked += 1;
        self.take(named(&event, self.asked));
        if self.asked == self.abort_at { Verdict::Abort } else { Verdict::Continue }
    }
}

/// Runs once to the end, then aborts at some of the questions.
fn measure(name: &str, run: impl Fn(&mut Clock) -> bool) {
    let mut whole = Clock::new(usize::MAX);
    let finished = run(&mut whole);
    whole.take("end".into());
    let (waited, before, after) = &whole.longest;
    println!("{name}: {} questions, finished {finished}; longest wait {waited:.3} s, {before} to {after}", whole.asked);
    let mut slowest = 0.0_f64;
    for point in 1..=POINTS {
        let mut clock = Clock::new((whole.asked * point / POINTS).max(1));
        assert!(!run(&mut clock), "an aborted run has no result");
        slowest = slowest.max(clock.last.0.elapsed().as_secs_f64());
    }
    println!("{name}: {POINTS} aborts, longest way back {slowest:.3} s");
}

fn main() -> Result<(), Box<dyn Error>> {
    let triangles = std::env::args().nth(1).map_or(Ok(500_000), |size| size.parse())?;
    let mesh = Shape::BumpySheet.mesh(triangles);
    for name in ["linabf", "abf++", "descent"] {
        let solver: Solver = name.parse()?;
        let pipeline = Pipeline { solver, ..Pipeline::default() };
        measure(name, |clock| pipeline.run(&mesh, clock).is_ok());
    }
    let unwrap = Unwrap { cut_disks: true, ..Unwrap::default() };
    measure("unwrap", |clock| unwrap.run(&mesh, &SurfaceHints::default(), clock).is_ok());
    Ok(())
}
