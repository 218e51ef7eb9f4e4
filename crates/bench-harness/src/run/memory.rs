//! How much memory one mesh takes.
//!
//! A counting allocator stands in front of the system's. It counts the bytes the program asks the
//! heap for and has not given back; not the allocator's own overhead, thread stacks, or the code.

use abf::{LayoutKind, LayoutSettings, Pipeline, Silent};
use abf_shapes::Shape;
use peak_alloc::PeakAlloc;
use std::sync::Once;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// A watch on the heap from one moment on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeapWatch {
    before: usize,
}

impl HeapWatch {
    /// Starts watching. There is one peak for the whole program: only one watch at a time.
    pub(crate) fn start() -> Self {
        static WARM_UP: Once = Once::new();
        WARM_UP.call_once(|| {
            warm_up();
            // Scratch belongs to a thread, and parallel work may be the first that a thread does.
            rayon::broadcast(|_| warm_up());
        });
        HEAP.reset_peak_usage();
        Self { before: HEAP.current_usage() }
    }

    /// Starts watching work on something that is there already and takes `kept` bytes, which count;
    /// whatever else is in use does not.
    pub(crate) fn start_with(kept: usize) -> Self {
        let Self { before } = Self::start();
        Self { before: before.saturating_sub(kept) }
    }

    /// The bytes in use now, without those in use before.
    pub(crate) fn bytes(&self) -> usize {
        HEAP.current_usage().saturating_sub(self.before)
    }

    /// The most bytes in use at any moment since the start, without those in use before.
    pub(crate) fn peak_bytes(&self) -> usize {
        HEAP.peak_usage().saturating_sub(self.before)
    }
}

/// Flattens a few triangles, with a real and a complex factorisation.
///
/// In its first product the matrix library reserves scratch for as long as the thread lives, sized
/// after the processor's last cache (a gigabyte where that cache is half of one) and hardly ever
/// touched. No mesh is to blame for that.
fn warm_up() {
    const TRIANGLES: usize = 100;
    let layout = LayoutSettings { kind: LayoutKind::LeastSquares, ..LayoutSettings::default() };
    // Only its allocations matter.
    let _ = Pipeline { layout, ..Pipeline::default() }.run(&Shape::Hemisphere.mesh(TRIANGLES), &mut Silent);
}
