//! Who asked to end a part of the work, and how.

use abf_control::{Cancelled, Event, Observer, Verdict};

/// An observer that remembers an abort, and is not asked after it. A part that ends as cancelled without an abort was stopped: what
/// was there before it is a result.
pub(super) struct Hearing<'o> {
    observer: &'o mut dyn Observer,
    is_aborted: bool,
}

impl<'o> Hearing<'o> {
    pub(super) fn new(observer: &'o mut dyn Observer) -> Self {
        Self { observer, is_aborted: false }
    }

    /// # Errors
    /// [`Cancelled`] after an abort.
    pub(super) fn aborted(&self) -> Result<(), Cancelled> {
        if self.is_aborted { Err(Cancelled) } else { Ok(()) }
    }
}

impl Observer for Hearing<'_> {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        if self.is_aborted {
            return Verdict::Abort;
        }
        let verdict = self.observer.observe(event);
        self.is_aborted = verdict == Verdict::Abort;
        verdict
    }
}
