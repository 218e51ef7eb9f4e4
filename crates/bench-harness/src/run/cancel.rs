//! Ctrl-C.

use crate::show::console;
use abf::Verdict;
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::thread;
use std::time::Duration;

/// The exit code of a program ended by an interrupt: 128 + SIGINT.
pub(crate) const INTERRUPTED: u8 = 130;

/// How long work may take to hear that it is to stop at once; then the program ends all the same. The solvers are asked
/// far more often, but for reading a pipe and for single calls of a factorisation.
const GRACE: Duration = Duration::from_millis(500);

/// Whether the user has asked to leave at once.
static ABORTED: AtomicBool = AtomicBool::new(false);

/// How often the user has asked to stop.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cancel(Arc<AtomicU8>);

impl Cancel {
    /// Listens to Ctrl-C and termination signals. The first asks the solver to return the best it has. The second asks it
    /// to stop at once, without a result, and ends the program where that is not heard. Files are renamed into place when
    /// they are complete, so neither leaves a half-written one.
    pub(crate) fn on_ctrl_c() -> Self {
        let cancel = Self::default();
        let asked = Arc::clone(&cancel.0);
        let handler = move || {
            if asked.fetch_add(1, Ordering::Relaxed) == 0 {
                console::words("stopping with the best so far; once more to leave at once\n");
            } else {
                ABORTED.store(true, Ordering::Relaxed);
                thread::sleep(GRACE);
                process::exit(INTERRUPTED.into());
            }
        };
        // Without a handler Ctrl-C ends the program at once, which is no reason not to start.
        let _ = ctrlc::set_handler(handler);
        cancel
    }

    /// Whether the user has asked to stop.
    pub(crate) fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed) > 0
    }

    /// What work asks that has no best so far: whether the user has asked to stop since it began.
    pub(crate) fn since_now(&self) -> impl FnMut() -> Result<(), abf::Cancelled> + '_ {
        let before = self.0.load(Ordering::Relaxed);
        move || if self.0.load(Ordering::Relaxed) > before { Err(abf::Cancelled) } else { Ok(()) }
    }

    /// What a solver is told.
    pub(crate) fn verdict(&self) -> Verdict {
        match self.0.load(Ordering::Relaxed) {
            0 => Verdict::Continue,
            1 => Verdict::Stop,
            _ => Verdict::Abort,
        }
    }
}

/// Whether the user has asked to leave at once: whatever the outcome, the program was interrupted.
pub(crate) fn is_aborted() -> bool {
    ABORTED.load(Ordering::Relaxed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_question_stops_and_the_second_aborts() {
        let cancel = Cancel::default();
        let told = [(); 3].map(|()| {
            let verdict = cancel.verdict();
            cancel.0.fetch_add(1, Ordering::Relaxed);
            verdict
        });
        assert_eq!(told, [Verdict::Continue, Verdict::Stop, Verdict::Abort]);
        assert!(cancel.is_asked());
    }

    #[test]
    fn work_that_begins_after_a_stop_is_ended_by_the_next_one_only() {
        let cancel = Cancel::default();
        cancel.0.store(1, Ordering::Relaxed);
        let mut asked = cancel.since_now();
        assert_eq!((asked(), cancel.is_asked()), (Ok(()), true));
        cancel.0.fetch_add(1, Ordering::Relaxed);
        assert_eq!(asked(), Err(abf::Cancelled));
    }
}
