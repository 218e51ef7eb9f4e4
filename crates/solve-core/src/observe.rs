//! Progress and cancellation.

use crate::{IterationRecord, StopCriteria, Termination};
use std::time::Instant;

/// The parts of flattening a mesh, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stage {
    /// Corner table, disk check, angles of the surface.
    Topology,
    /// Solving for the angles.
    Solve,
    /// From angles to coordinates.
    Layout,
    /// From coordinates to what is proved of them.
    Certificate,
}

/// Something that happened.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// A stage begins; the one before it has ended.
    StageStarted(Stage),
    /// The next solver of a ladder begins, by its name; its stages follow.
    RungStarted(&'static str),
    /// An outer iteration, or a pass of LinABF, is done.
    Iteration(&'a IterationRecord),
    /// An inner iteration, or one part of a direct solve, is done.
    Inner {
        /// The outer iteration it belongs to, counted from 1.
        iteration: usize,
        /// How many inner iterations of it are done.
        inner: usize,
        /// The method's own estimate of the relative residual; NaN where it has none.
        relative_residual: f64,
    },
}

/// Whether to go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Go on.
    Continue,
    /// Stop as soon as possible and return the best angles so far.
    Cancel,
}

/// Someone who is told what happens and may cancel. Core crates are silent; this is how a program
/// shows progress.
pub trait Observer {
    /// Called for every [`Event`], on the solving thread.
    fn observe(&mut self, event: Event<'_>) -> Verdict;
}

/// An observer that lets everything happen.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {
    fn observe(&mut self, _: Event<'_>) -> Verdict {
        Verdict::Continue
    }
}

/// An observer with the clock of one solve: what a solver asks whether it may go on.
pub struct Watch<'a> {
    observer: &'a mut dyn Observer,
    deadline: Option<Instant>,
    iteration: usize,
    interruption: Option<Termination>,
}

impl<'a> Watch<'a> {
    /// Starts watching; a time limit counts from here.
    pub fn start(stop: &StopCriteria, observer: &'a mut dyn Observer) -> Self {
        Self { observer, deadline: stop.deadline(), iteration: 1, interruption: None }
    }

    /// Reports a finished outer iteration.
    pub fn iteration(&mut self, record: &IterationRecord) {
        let verdict = self.observer.observe(Event::Iteration(record));
        self.iteration = record.iteration + 1;
        self.note(verdict);
    }

    /// Reports inner work; `false` means stop now.
    pub fn inner(&mut self, inner: usize, relative_residual: f64) -> bool {
        let iteration = self.iteration;
        let verdict = self.observer.observe(Event::Inner { iteration, inner, relative_residual });
        self.note(verdict);
        self.interruption.is_none()
    }

    /// Why the solve must end now, if it must: cancelled or out of time.
    #[must_use]
    pub fn interruption(&self) -> Option<Termination> {
        self.interruption
    }

    fn note(&mut self, verdict: Verdict) {
        if verdict == Verdict::Cancel {
            self.interruption = Some(Termination::Cancelled);
        } else if self.interruption.is_none() && self.deadline.is_some_and(|d| Instant::now() >= d) {
            self.interruption = Some(Termination::TimeLimit);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    struct CancelAt(usize);

    impl Observer for CancelAt {
        fn observe(&mut self, event: Event<'_>) -> Verdict {
            match event {
                Event::Inner { inner, .. } if inner >= self.0 => Verdict::Cancel,
                _ => Verdict::Continue,
            }
        }
    }

    #[test]
    fn a_cancelled_watch_stays_cancelled() {
        let mut observer = CancelAt(2);
        let mut watch = Watch::start(&StopCriteria::default(), &mut observer);
        assert!(watch.inner(1, 0.5));
        assert!(!watch.inner(2, 0.5));
        assert!(!watch.inner(1, 0.5));
        assert_eq!(watch.interruption(), Some(Termination::Cancelled));
    }

    #[test]
    fn a_watch_without_time_says_so() {
        let stop = StopCriteria { time_limit: Some(Duration::ZERO), ..StopCriteria::default() };
        let mut observer = Silent;
        let mut watch = Watch::start(&stop, &mut observer);
        assert!(!watch.inner(1, 0.5));
        assert_eq!(watch.interruption(), Some(Termination::TimeLimit));
    }
}
