//! One observer for components that are worked on side by side.

use abf_control::{Event, Observer, UnwrapProgress, Verdict};
use std::sync::Mutex;

/// Passes on what several threads report.
pub(super) struct Relay<'o> {
    state: Mutex<State<'o>>,
    components: usize,
    faces: usize,
}

struct State<'o> {
    observer: &'o mut (dyn Observer + Send),
    verdict: Verdict,
    components_done: usize,
    faces_done: usize,
    /// Of every component how many charts it has so far, and how many of them are done.
    charts: Vec<[usize; 2]>,
}

impl<'o> Relay<'o> {
    /// Of so many components with so many faces together.
    pub(super) fn new(observer: &'o mut (dyn Observer + Send), components: usize, faces: usize) -> Self {
        let (verdict, charts) = (Verdict::Continue, vec![[0, 0]; components]);
        let state = State { observer, verdict, components_done: 0, faces_done: 0, charts };
        Self { state: Mutex::new(state), components, faces }
    }

    /// An observer for one chart of a component.
    pub(super) fn ear(&self, component: usize, chart: usize) -> Ear<'_, 'o> {
        let mut place = UnwrapProgress::default();
        (place.component, place.components) = (component, self.components);
        (place.chart, place.faces) = (chart, self.faces);
        Ear { relay: self, place }
    }

    /// The component has so many more charts; the number of the first of them.
    pub(super) fn begin_charts(&self, component: usize, count: usize) -> usize {
        self.state.lock().map_or(0, |mut state| {
            let [charts, _] = &mut state.charts[component];
            let first = *charts;
            *charts += count;
            first
        })
    }

    /// A chart of the component is done, and so many faces with it: none where it was cut into others.
    pub(super) fn end_chart(&self, component: usize, faces: usize) {
        if let Ok(mut state) = self.state.lock() {
            state.charts[component][1] += 1;
            state.faces_done += faces;
        }
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
    place: UnwrapProgress,
}

impl Ear<'_, '_> {
    /// The events that follow belong to this round of flattening and cutting.
    pub(super) fn begin_round(&mut self, round: usize) {
        self.place.round = round;
    }

    /// The component is done, which is told.
    pub(super) fn end(mut self) {
        if let Ok(mut state) = self.relay.state.lock() {
            state.components_done += 1;
        }
        self.observe(Event::Working);
    }
}

impl Observer for Ear<'_, '_> {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        let Ok(mut state) = self.relay.state.lock() else { return Verdict::Abort };
        // Who stops one component stops all; a stopped run can still be aborted.
        if state.verdict != Verdict::Abort {
            (self.place.components_done, self.place.faces_done) = (state.components_done, state.faces_done);
            let [charts, charts_done] = state.charts[self.place.component];
            // What is looked at before there are pieces is one.
            (self.place.charts, self.place.charts_done) = (charts.max(1), charts_done);
            let said = state.observer.observe_at(self.place, event);
            if said != Verdict::Continue {
                state.verdict = said;
            }
        }
        state.verdict
    }
}
