//! The library at work, and the thread that called beside it.
//!
//! Python hears signals on the thread that calls only, and so do callbacks have to be called there. So the work is done by
//! threads of a pool, without the interpreter's lock; the thread that called looks up every [`TICK`], takes the lock for a
//! moment, sees to signals and progress, and aborts the work when either raises.

use crate::pools::Lease;
use crate::running::{self, Running};
use abf::{Event, Observer, Stage, UnwrapProgress, Verdict};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// How often the thread that called looks up.
const TICK: Duration = Duration::from_millis(20);

/// Who may be told of progress, and how many threads there are.
pub(crate) struct Supervision {
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
    faces: usize,
}

/// How far the work is.
#[derive(Clone, Copy, PartialEq)]
struct News {
    stage: &'static str,
    solver: Option<&'static str>,
    iteration: usize,
    residual: f64,
    faces_done: usize,
}

/// What both sides see.
struct Shared {
    is_aborted: AtomicBool,
    news: Mutex<Option<News>>,
}

/// Hears of progress on the threads that work.
struct Relay<'s> {
    shared: &'s Shared,
    is_asked: bool,
    news: News,
}

impl Supervision {
    /// `faces` is how many faces the mesh has, for `total` of progress.
    pub(crate) fn new(threads: Option<usize>, progress: Option<Py<PyAny>>, faces: usize) -> Self {
        Self { threads, progress, faces }
    }

    /// Runs `work` on threads of their own, and gives back what comes of it, or what a signal or a callback raised.
    pub(crate) fn run<T: Send>(
        self,
        py: Python<'_>,
        work: impl FnOnce(&mut (dyn Observer + Send)) -> PyResult<T> + Send,
    ) -> PyResult<T> {
        let _running = Running::new();
        let lease = Lease::new(py, self.threads)?;
        let result = py.detach(|| self.supervised(&lease, work));
        lease.give_back(py);
        let result = result?;
        if self.progress.is_some() {
            let done = News { stage: "done", solver: None, iteration: 0, residual: f64::NAN, faces_done: self.faces };
            self.tell(py, done)?;
        }
        Ok(result)
    }

    fn supervised<T: Send>(
        &self,
        lease: &Lease,
        work: impl FnOnce(&mut (dyn Observer + Send)) -> PyResult<T> + Send,
    ) -> PyResult<T> {
        let shared = Shared { is_aborted: AtomicBool::new(false), news: Mutex::new(None) };
        let (ends, ended) = mpsc::channel::<()>();
        let mut raised = None;
        let is_asked = self.progress.is_some();
        let run = || {
            let _hung_up_at_the_end = ends;
            let news = News { stage: "start", solver: None, iteration: 0, residual: f64::NAN, faces_done: 0 };
            work(&mut Relay { shared: &shared, is_asked, news })
        };
        let result = lease.pool().run_beside(run, || {
            while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
                if raised.is_none()
                    && let Err(error) = self.look_up(&shared)
                {
                    raised = Some(error);
                    shared.is_aborted.store(true, Ordering::Relaxed);
                }
            }
        });
        raised.map_or(result, Err)
    }

    /// Sees to signals, and tells of progress.
    fn look_up(&self, shared: &Shared) -> PyResult<()> {
        running::check()?;
        Python::attach(|py| {
            py.check_signals()?;
            match shared.news.lock().unwrap_or_else(PoisonError::into_inner).take() {
                Some(news) => self.tell(py, news),
                None => Ok(()),
            }
        })
    }

    fn tell(&self, py: Python<'_>, news: News) -> PyResult<()> {
        let Some(progress) = &self.progress else { return Ok(()) };
        let News { stage, solver, iteration, residual, faces_done } = news;
        progress.call1(py, (stage, solver, iteration, residual, faces_done, self.faces)).map(|_| ())
    }
}

impl Relay<'_> {
    fn verdict(&mut self, faces_done: usize, event: Event<'_>) -> Verdict {
        if self.is_asked {
            let before = self.news;
            self.news.faces_done = faces_done;
            match event {
                Event::StageStarted(stage) => self.news.stage = name(stage),
                Event::RungStarted(solver) => self.news.solver = Some(solver),
                Event::Iteration(record) => {
                    (self.news.iteration, self.news.residual) = (record.iteration, record.constraint_residual);
                }
                _ => {}
            }
            if self.news != before {
                *self.shared.news.lock().unwrap_or_else(PoisonError::into_inner) = Some(self.news);
            }
        }
        match self.shared.is_aborted.load(Ordering::Relaxed) {
            true => Verdict::Abort,
            false => Verdict::Continue,
        }
    }
}

impl Observer for Relay<'_> {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        self.verdict(0, event)
    }

    fn observe_at(&mut self, progress: UnwrapProgress, event: Event<'_>) -> Verdict {
        self.verdict(progress.faces_done, event)
    }
}

fn name(stage: Stage) -> &'static str {
    match stage {
        Stage::Topology => "topology",
        Stage::Solve => "solve",
        Stage::Layout => "layout",
        Stage::Relax => "relax",
        Stage::Certificate => "certificate",
        _ => "work",
    }
}
