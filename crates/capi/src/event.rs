//! What a callback is told.

use abf::{Event, Observer, Stage, UnwrapProgress, Verdict};
use std::ffi::{CString, c_char, c_void};
use std::ptr;

/// What a callback returns to go on.
pub const ABF_CONTINUE: i32 = 0;
/// What a callback returns to stop with the best result so far. Every other number aborts without one.
pub const ABF_STOP: i32 = 1;
/// What a callback returns to abort without a result.
pub const ABF_ABORT: i32 = 2;

/// What has happened.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AbfEventKind {
    /// Work goes on. Told between blocks of long work, so that it can be interrupted there.
    Working = 0,
    /// A stage begins: `stage`.
    Stage = 1,
    /// The next solver of "auto" begins: `solver`.
    Solver = 2,
    /// An outer iteration, or a pass of Linear ABF, is done: `iteration`, `residual`.
    Iteration = 3,
    /// An inner iteration is done: `iteration`, `inner`, `residual`.
    Inner = 4,
}

/// The parts of flattening a disk, in their order.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AbfStage {
    /// Corner table, disk check, angles of the surface.
    Topology = 0,
    /// Solving for the angles.
    Solve = 1,
    /// From angles to coordinates.
    Layout = 2,
    /// From coordinates to what is proved of them.
    Certificate = 3,
    /// After the layout: to the least of an energy, or to pins.
    Relax = 4,
}

/// What a callback is told. Later versions append fields.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AbfEvent {
    /// What has happened.
    pub kind: AbfEventKind,
    /// The stage that runs.
    pub stage: AbfStage,
    /// The solver that begins, else null. Valid during the call.
    pub solver: *const c_char,
    /// Outer iterations are counted from 1.
    pub iteration: u32,
    /// Inner iterations of it that are done.
    pub inner: u32,
    /// Of an outer iteration `max |h|`, rad; of an inner one its estimate of the relative residual, NaN where it has none.
    pub residual: f64,
    /// `abf_unwrap`: which connected component, and how many there are.
    pub component: u32,
    /// See `component`.
    pub components: u32,
    /// `abf_unwrap`: faces of all components, and how many of them are in finished charts.
    pub faces: u32,
    /// See `faces`.
    pub faces_done: u32,
    /// `abf_unwrap`: the round of flattening and cutting, counted from 0.
    pub round: u32,
}

/// Called on a thread that works, for one call of the library never by two threads at once. It returns `ABF_CONTINUE`,
/// `ABF_STOP` or `ABF_ABORT`, and must neither throw nor unwind.
pub type AbfProgress = Option<unsafe extern "C" fn(user: *mut c_void, event: *const AbfEvent) -> i32>;

/// Tells a callback what an observer hears.
pub(crate) struct Relay<'a> {
    call: &'a mut (dyn FnMut(&AbfEvent) -> i32 + Send),
    stage: AbfStage,
}

impl<'a> Relay<'a> {
    pub(crate) fn new(call: &'a mut (dyn FnMut(&AbfEvent) -> i32 + Send)) -> Self {
        Self { call, stage: AbfStage::Topology }
    }
}

impl Observer for Relay<'_> {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        self.observe_at(UnwrapProgress::default(), event)
    }

    fn observe_at(&mut self, place: UnwrapProgress, event: Event<'_>) -> Verdict {
        let mut told = AbfEvent {
            kind: AbfEventKind::Working,
            stage: self.stage,
            solver: ptr::null(),
            iteration: 0,
            inner: 0,
            residual: 0.0,
            component: narrow(place.component),
            components: narrow(place.components),
            faces: narrow(place.faces),
            faces_done: narrow(place.faces_done),
            round: narrow(place.round),
        };
        let mut name = CString::default();
        match event {
            Event::StageStarted(stage) => {
                self.stage = of_stage(stage).unwrap_or(self.stage);
                (told.kind, told.stage) = (AbfEventKind::Stage, self.stage);
            }
            Event::RungStarted(solver) => {
                name = CString::new(solver).unwrap_or_default();
                (told.kind, told.solver) = (AbfEventKind::Solver, name.as_ptr());
            }
            Event::Iteration(record) => {
                (told.kind, told.iteration) = (AbfEventKind::Iteration, narrow(record.iteration));
                (told.inner, told.residual) = (narrow(record.inner_iterations), record.constraint_residual);
            }
            Event::Inner { iteration, inner, relative_residual } => {
                (told.kind, told.iteration) = (AbfEventKind::Inner, narrow(iteration));
                (told.inner, told.residual) = (narrow(inner), relative_residual);
            }
            _ => {}
        }
        let verdict = match (self.call)(&told) {
            ABF_CONTINUE => Verdict::Continue,
            ABF_STOP => Verdict::Stop,
            _ => Verdict::Abort,
        };
        drop(name);
        verdict
    }
}

fn of_stage(stage: Stage) -> Option<AbfStage> {
    match stage {
        Stage::Topology => Some(AbfStage::Topology),
        Stage::Solve => Some(AbfStage::Solve),
        Stage::Layout => Some(AbfStage::Layout),
        Stage::Certificate => Some(AbfStage::Certificate),
        Stage::Relax => Some(AbfStage::Relax),
        _ => None,
    }
}

fn narrow(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
