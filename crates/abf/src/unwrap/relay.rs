//! One observer for components that are worked on side by side.

use abf_control::{Event, Observer, Place, Verdict};
use std::sync::Mutex;

/// Passes on what several threads report.
pub(super) struct Relay<'o> {
    state: Mutex<State<'o>>,
    components: usize,
}

struct State<'o> {
    observer: &'o mut (dyn Observer + Send),
    verdict: Verdict,
    components_done: usize,
}

impl<'o> Relay<'o> {
    pub(super) fn new(observer: &'o mut (dyn Observer + Send), components: usize) -> Self {
        let state = State { observer, verdict: Verdict::Continue, components_done: 0 };
        Self { state: Mutex::new(state), components }
    }

    /// An observer for one component.
    pub(super) fn ear(&self, component: usize) -> Ear<'_, 'o> {
        let mut place = Place::default();
        (place.component, place.components, place.charts) = (component, self.components, 1);
        Ear { relay: self, place }
    }

    /// Whether someone has asked to stop, or to abort.
    pub(super) fn is_stopped(&self) -> bool {
        self.state.lock().map_or(true, |state| state.verdict != Verdict::Continue)
    }

    /// Whether there is to be no result. An observer that panicked is not asked again.
    pub(super) fn is_aborted(&self) -> bool {
        self.state.lock().map_or(true, |state| state.verdict == Verdict::Abort)
    }
}

/// What one component reports to.
pub(super) struct Ear<'r, 'o> {
    relay: &'r Relay<'o>,
    place: Place,
}

impl Ear<'_, '_> {
    /// The events that follow belong to this round of flattening and cutting.
    pub(super) fn begin_round(&mut self, round: usize) {
        self.place.round = round;
    }

    /// The component is done.
    pub(super) fn end(self) {
        if let Ok(mut state) = self.relay.state.lock() {
            state.components_done += 1;
        }
    }
}

impl Observer for Ear<'_, '_> {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        let Ok(mut state) = self.relay.state.lock() else { return Verdict::Abort };
        // Who stops one component stops all; a stopped run can still be aborted.
        if state.verdict != Verdict::Abort {
            self.place.components_done = state.components_done;
            let said = state.observer.observe_at(self.place, event);
            if said != Verdict::Continue {
                state.verdict = said;
            }
        }
        state.verdict
    }
}
