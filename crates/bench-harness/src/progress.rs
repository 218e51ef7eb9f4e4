//! Progress on the terminal, the clock of every stage, and the ear for Ctrl-C.

use crate::cancel::Cancel;
use abf::{Event, Observer, Stage, Verdict};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal};
use std::sync::mpsc::{self, Sender};
use std::thread;
use std::time::{Duration, Instant};

/// Work shorter than this shows no progress.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often the line is drawn anew.
const TICK: Duration = Duration::from_millis(100);

/// The observer of one mesh.
pub(crate) struct Progress<'a> {
    cancel: &'a Cancel,
    line: Option<Line>,
    /// When each stage began.
    starts: Vec<(Stage, Instant)>,
    /// When the last stage ended.
    end: Option<Instant>,
}

impl<'a> Progress<'a> {
    /// Starts watching the mesh of that name.
    pub(crate) fn new(mesh: &str, cancel: &'a Cancel) -> Self {
        let line = io::stderr().is_terminal().then(|| Line::new(mesh));
        Self { cancel, line, starts: Vec::new(), end: None }
    }

    /// Says what is being done outside the stages that the library reports.
    pub(crate) fn say(&self, what: impl Into<String>) {
        if let Some(line) = &self.line {
            line.bar.set_message(what.into());
        }
    }

    /// The last stage is over.
    pub(crate) fn end_stages(&mut self) {
        self.end = Some(Instant::now());
    }

    /// How long a stage took, in seconds; 0 if there was none.
    pub(crate) fn seconds(&self, stage: Stage) -> f64 {
        let Some(k) = self.starts.iter().position(|&(s, _)| s == stage) else { return 0.0 };
        let end = self.starts.get(k + 1).map(|&(_, start)| start).or(self.end).unwrap_or_else(Instant::now);
        end.duration_since(self.starts[k].1).as_secs_f64()
    }
}

impl Observer for Progress<'_> {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        match event {
            Event::StageStarted(stage) => {
                self.starts.push((stage, Instant::now()));
                self.say(match stage {
                    Stage::Topology => "topology",
                    Stage::Solve => "solving",
                    _ => "layout",
                });
            }
            Event::Iteration(record) => {
                self.say(format!("solving: {} done, residual {:.1e}", record.iteration, record.constraint_residual));
            }
            _ => {}
        }
        if self.cancel.is_asked() { Verdict::Cancel } else { Verdict::Continue }
    }
}

/// One line on stderr that appears when the work turns out to be long and is gone when it ends.
struct Line {
    bar: ProgressBar,
    /// Dropped when the work ends, which wakes the thread that waits to show the line.
    _end: Sender<()>,
}

impl Line {
    fn new(mesh: &str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{spinner} {prefix}: {msg} ({elapsed})");
        bar.set_style(style.expect("a template without unknown keys"));
        bar.set_prefix(mesh.to_owned());
        bar.set_message("reading");
        let (end, ended) = mpsc::channel::<()>();
        let shown = bar.clone();
        thread::spawn(move || {
            if ended.recv_timeout(PATIENCE) == Err(mpsc::RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(TICK);
            }
        });
        Self { bar, _end: end }
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
        let whole = progress.end.expect("ended").duration_since(progress.starts[0].1).as_secs_f64();
        let sum = progress.seconds(Stage::Topology) + progress.seconds(Stage::Solve);
        assert!((whole - sum).abs() < 1e-9);
        assert!(progress.seconds(Stage::Solve) >= 0.005);
        assert_eq!(progress.seconds(Stage::Layout), 0.0);
    }
}
