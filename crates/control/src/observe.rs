//! Progress and cancellation.

use crate::{Cancelled, IterationRecord, StopCriteria, Termination, clock};
use std::fmt;
use std::time::Duration;

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
    /// From a map to one of less energy, where that is asked for; another [`Stage::Certificate`] follows.
    Relax,
}

/// Something that happened.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// A stage begins; the one before it has ended.
    StageStarted(Stage),
    /// The next solver of a ladder begins, by its name; its stages follow.
    RungStarted(&'static str),
    /// A solver, or the relaxing of a map, begins, and this is what it starts from. A solver that works in rounds, or on
    /// several levels, begins several times.
    Start {
        /// Its iteration 0: of the residual and of the energy, before anything is done. The rest of it says nothing.
        record: &'a IterationRecord,
        /// How many corners what it works on has: fewer than the mesh on a coarse level.
        corners: usize,
    },
    /// The positions of the vertices, of a solver that has such. The [`Event::Start`] or [`Event::Iteration`] that they belong
    /// to follows.
    Drawing(&'a dyn Drawing),
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
    /// Work inside a stage goes on. It is asked between blocks of long work, so that it can be interrupted there.
    Working,
}

/// A drawing on its way. It is measured when it is asked, so that it costs nobody anything who does not ask.
pub trait Drawing: fmt::Debug {
    /// `F / 3nt`, rad²: the mean of `(x − α°)²` over all corners, `x` being the angles of the drawing and `α°` those of the
    /// surface.
    fn f(&self) -> f64;

    /// How many triangles are not counter-clockwise, by the exact predicate.
    fn flips(&self) -> usize;
}

/// Where in the unwrapping of a mesh something happened, with the totals known so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct UnwrapProgress {
    /// Which connected component, counted from 0.
    pub component: usize,
    /// How many components there are.
    pub components: usize,
    /// How many components are done.
    pub components_done: usize,
    /// Which chart of the component, counted from 0.
    pub chart: usize,
    /// How many charts the component has so far; cuts add to it.
    pub charts: usize,
    /// How many of these are done: finished, or cut into others.
    pub charts_done: usize,
    /// How many faces all components have.
    pub faces: usize,
    /// How many of these are in finished charts: all of them at the end.
    pub faces_done: usize,
    /// Which round of flattening and cutting the component is in, counted from 0.
    pub round: usize,
}

/// Whether to go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Go on.
    Continue,
    /// Stop soon, with a result: the best angles so far and [`Termination::Cancelled`].
    Stop,
    /// Stop at once, without a result: [`Cancelled`]. Nothing is asked after it.
    Abort,
}

/// Someone who is told what happens and may stop it. Core crates are silent; this is how a program
/// shows progress.
pub trait Observer {
    /// Called for every [`Event`], on the solving thread.
    fn observe(&mut self, event: Event<'_>) -> Verdict;

    /// Called instead of [`Observer::observe`] for an event in a part of a larger mesh. It passes the event on, if it is
    /// not implemented.
    fn observe_at(&mut self, place: UnwrapProgress, event: Event<'_>) -> Verdict {
        let _ = place;
        self.observe(event)
    }
}

/// What long work calls between its blocks; it ends with the error at once.
pub type Checkpoint<'a> = dyn FnMut() -> Result<(), Cancelled> + 'a;

/// So many steps of a long loop are a block: less than 50 ms where a step takes 10 µs.
const BLOCK: usize = 1 << 12;

/// Calls the checkpoint of a long loop before every block of its steps, which are counted from 0.
///
/// # Errors
/// What the checkpoint returns.
#[inline]
pub fn at_block(step: usize, checkpoint: &mut Checkpoint<'_>) -> Result<(), Cancelled> {
    if step.is_multiple_of(BLOCK) { checkpoint() } else { Ok(()) }
}

/// Tells an observer what happens, outside of a solver's loop: only [`Verdict::Abort`] ends it, since a stopped run still
/// has its result laid out and certified.
///
/// # Errors
/// [`Cancelled`] if the observer aborts.
pub fn ask(observer: &mut dyn Observer, event: Event<'_>) -> Result<(), Cancelled> {
    match observer.observe(event) {
        Verdict::Abort => Err(Cancelled),
        Verdict::Continue | Verdict::Stop => Ok(()),
    }
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
    deadline: Option<Duration>,
    iteration: usize,
    interruption: Option<Termination>,
    is_aborted: bool,
}

impl<'a> Watch<'a> {
    /// Starts watching; a time limit counts from here.
    pub fn start(stop: &StopCriteria, observer: &'a mut dyn Observer) -> Self {
        Self { observer, deadline: stop.deadline(), iteration: 1, interruption: None, is_aborted: false }
    }

    /// Reports what a solver starts from: the constraint residual, rad, and the energy, where it has one, of so many corners.
    ///
    /// # Errors
    /// [`Cancelled`] if the observer aborts.
    pub fn start_from(
        &mut self,
        corners: usize,
        constraint_residual: f64,
        energy: Option<f64>,
    ) -> Result<(), Cancelled> {
        let record = IterationRecord { constraint_residual, energy, ..IterationRecord::default() };
        self.ask(Event::Start { record: &record, corners })
    }

    /// Shows the positions of the vertices, before the start or the iteration that they belong to is reported.
    ///
    /// # Errors
    /// [`Cancelled`] if the observer aborts.
    pub fn drawing(&mut self, drawing: &dyn Drawing) -> Result<(), Cancelled> {
        self.ask(Event::Drawing(drawing))
    }

    /// Reports a finished outer iteration.
    ///
    /// # Errors
    /// [`Cancelled`] if the observer aborts.
    pub fn iteration(&mut self, record: &IterationRecord) -> Result<(), Cancelled> {
        self.iteration = record.iteration + 1;
        self.ask(Event::Iteration(record))
    }

    /// Reports inner work; `false` means stop now.
    ///
    /// # Errors
    /// [`Cancelled`] if the observer aborts.
    pub fn inner(&mut self, inner: usize, relative_residual: f64) -> Result<bool, Cancelled> {
        self.ask(Event::Inner { iteration: self.iteration, inner, relative_residual })?;
        Ok(self.interruption.is_none())
    }

    /// Asks between two blocks of long work. A stop is kept for [`Watch::interruption`].
    ///
    /// # Errors
    /// [`Cancelled`] if the observer aborts.
    pub fn checkpoint(&mut self) -> Result<(), Cancelled> {
        self.ask(Event::Working)
    }

    /// Why the solve must end now, if it must: stopped or out of time.
    #[must_use]
    pub fn interruption(&self) -> Option<Termination> {
        self.interruption
    }

    /// The abort, once more: for loops that took it for another kind of end.
    ///
    /// # Errors
    /// [`Cancelled`] if the observer aborted.
    pub fn aborted(&self) -> Result<(), Cancelled> {
        if self.is_aborted { Err(Cancelled) } else { Ok(()) }
    }

    fn ask(&mut self, event: Event<'_>) -> Result<(), Cancelled> {
        // After an abort nothing is asked, whatever the caller makes of the error.
        self.aborted()?;
        match self.observer.observe(event) {
            Verdict::Abort => {
                self.is_aborted = true;
                return Err(Cancelled);
            }
            Verdict::Stop => self.interruption = Some(Termination::Cancelled),
            Verdict::Continue if self.interruption.is_none() && self.is_late() => {
                self.interruption = Some(Termination::TimeLimit);
            }
            Verdict::Continue => {}
        }
        Ok(())
    }

    fn is_late(&self) -> bool {
        self.deadline.is_some_and(|deadline| clock::now().is_some_and(|now| now >= deadline))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct StopAt(usize);

    impl Observer for StopAt {
        fn observe(&mut self, event: Event<'_>) -> Verdict {
            match event {
                Event::Inner { inner, .. } if inner >= self.0 => Verdict::Stop,
                _ => Verdict::Continue,
            }
        }
    }

    #[test]
    fn a_long_loop_is_asked_before_every_block() {
        let mut asked = 0;
        let mut checkpoint = || {
            asked += 1;
            if asked == 3 { Err(Cancelled) } else { Ok(()) }
        };
        let end = (0..10 * BLOCK).find(|&step| at_block(step, &mut checkpoint).is_err());
        assert_eq!((end, asked), (Some(2 * BLOCK), 3));
    }

    #[test]
    fn a_stopped_watch_stays_stopped() {
        let mut observer = StopAt(2);
        let mut watch = Watch::start(&StopCriteria::default(), &mut observer);
        assert!(watch.inner(1, 0.5).expect("not aborted"));
        assert!(!watch.inner(2, 0.5).expect("not aborted"));
        assert!(!watch.inner(1, 0.5).expect("not aborted"));
        assert_eq!(watch.interruption(), Some(Termination::Cancelled));
    }

    #[test]
    fn an_aborted_watch_asks_nothing_more() {
        struct AbortFirst(usize);
        impl Observer for AbortFirst {
            fn observe(&mut self, _: Event<'_>) -> Verdict {
                self.0 += 1;
                Verdict::Abort
            }
        }
        let mut observer = AbortFirst(0);
        let mut watch = Watch::start(&StopCriteria::default(), &mut observer);
        assert_eq!(watch.checkpoint(), Err(Cancelled));
        assert_eq!(watch.inner(1, 0.5), Err(Cancelled));
        assert_eq!(watch.iteration(&IterationRecord::default()), Err(Cancelled));
        assert_eq!(observer.0, 1);
    }

    #[test]
    fn a_watch_without_time_says_so() {
        let stop = StopCriteria { time_limit: Some(Duration::ZERO), ..StopCriteria::default() };
        let mut observer = Silent;
        let mut watch = Watch::start(&stop, &mut observer);
        assert!(!watch.inner(1, 0.5).expect("not aborted"));
        assert_eq!(watch.interruption(), Some(Termination::TimeLimit));
    }
}
