//! Ctrl-C.

use crate::show::console;
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The exit code of a program ended by an interrupt: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// Whether the user wants to stop.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// Listens to Ctrl-C and termination signals. The first asks the solver to return the best it
    /// has; the second ends the program at once. Files are renamed into place when they are
    /// complete, so neither leaves a half-written one.
    pub(crate) fn on_ctrl_c() -> Self {
        let cancel = Self::default();
        let flag = Arc::clone(&cancel.0);
        let handler = move || {
            if flag.swap(true, Ordering::Relaxed) {
                process::exit(INTERRUPTED);
            }
            console::words("stopping with the best so far; once more to leave at once\n");
        };
        // Without a handler Ctrl-C ends the program at once, which is no reason not to start.
        let _ = ctrlc::set_handler(handler);
        cancel
    }

    /// Whether the user has asked to stop.
    pub(crate) fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
