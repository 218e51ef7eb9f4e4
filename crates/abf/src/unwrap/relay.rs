//! One observer for components that are worked on side by side.

use abf_solve_core::{Event, Observer, Verdict};
use std::sync::Mutex;

/// Passes on what several threads report.
pub(super) struct Relay<'o> {
    observer: Mutex<(&'o mut (dyn Observer + Send), Verdict)>,
}

impl<'o> Relay<'o> {
    pub(super) fn new(observer: &'o mut (dyn Observer + Send)) -> Self {
        Self { observer: Mutex::new((observer, Verdict::Continue)) }
    }

    /// An observer for one thread.
    pub(super) fn ear(&self) -> Ear<'_, 'o> {
        Ear { relay: self }
    }
}

/// What one thread reports to.
pub(super) struct Ear<'r, 'o> {
    relay: &'r Relay<'o>,
}

impl Observer for Ear<'_, '_> {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        // An observer that panicked is not asked again.
        let Ok(mut guard) = self.relay.observer.lock() else { return Verdict::Cancel };
        let (observer, verdict) = &mut *guard;
        // Who cancels one component cancels all.
        if *verdict == Verdict::Continue {
            *verdict = observer.observe(event);
        }
        *verdict
    }
}
