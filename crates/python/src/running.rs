//! The calls that are at work when the interpreter ends.
//!
//! A daemon thread that asks for the interpreter's lock after the end is torn down in the middle of a call. So the end is
//! announced while the lock can still be had, and waits for those calls: each sees it within a tick, and aborts.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

/// How long the end of the interpreter waits at most: longer than the longest step that cannot be interrupted on a mesh of
/// a million triangles.
const PATIENCE: Duration = Duration::from_secs(10);

/// How often it looks up.
const TICK: Duration = Duration::from_millis(2);

static COUNT: AtomicUsize = AtomicUsize::new(0);
static IS_ENDING: AtomicBool = AtomicBool::new(false);
/// The process that is counted for: a fork takes the count along, but not the threads.
static PROCESS: AtomicU32 = AtomicU32::new(0);

/// A call at work.
pub(crate) struct Running;

impl Running {
    pub(crate) fn new() -> Self {
        let process = std::process::id();
        if PROCESS.swap(process, Ordering::SeqCst) != process {
            COUNT.store(0, Ordering::SeqCst);
        }
        COUNT.fetch_add(1, Ordering::SeqCst);
        Self
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        COUNT.fetch_sub(1, Ordering::SeqCst);
    }
}

/// An error once the interpreter ends.
pub(crate) fn check() -> PyResult<()> {
    match IS_ENDING.load(Ordering::SeqCst) {
        true => Err(PyRuntimeError::new_err("the interpreter ends")),
        false => Ok(()),
    }
}

/// Ends all calls, and waits until they have.
#[pyfunction]
pub(crate) fn end_calls(py: Python<'_>) {
    if PROCESS.load(Ordering::SeqCst) != std::process::id() {
        return;
    }
    IS_ENDING.store(true, Ordering::SeqCst);
    py.detach(|| {
        let looks = PATIENCE.as_millis() / TICK.as_millis();
        for _ in (0..looks).take_while(|_| COUNT.load(Ordering::SeqCst) > 0) {
            thread::sleep(TICK);
        }
    });
}
