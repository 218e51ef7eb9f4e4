//! How the memory of a flattening grows with its mesh.
//!
//! Every part but one grows with the number of triangles. The factors of a disk's matrices grow with `n log n` (George 1973 on
//! nested dissection; minimum degree, which is used, comes close). So a run takes `n (a + b log₂ n)` bytes, with `a` and
//! `b` of the method. They were measured on round and long disks of 150 to 640 000 triangles, as `peak_memory_bytes` in the
//! program's JSON. The whole matrix of ABF, factored by LU, grows with a power.

use abf_solve_core::{IterativeSettings, PreconditionerKind, Reduction};

/// Bytes of a mesh with `n` triangles.
#[derive(Clone, Copy, Debug)]
pub(super) enum Growth {
    /// `n (a + b log₂ n)`.
    Log(f64, f64),
    /// `a n^b`.
    Power(f64, f64),
}

impl Growth {
    /// Conjugate gradients with factors in single precision: LinABF from its second pass on.
    pub(super) const LEAN: Self = Self::Log(400.0, 25.0);
    /// One factorisation in double precision: one pass of it.
    pub(super) const ONE_PASS: Self = Self::Log(60.0, 85.0);
    /// The lean steps, with what a line search keeps.
    pub(super) const FROZEN: Self = Self::Log(510.0, 26.0);
    /// Factors in double precision, with what a line search keeps.
    pub(super) const DIRECT: Self = Self::Log(60.0, 95.0);
    /// Uzawa with the blocks factored.
    pub(super) const UZAWA: Self = Self::Log(700.0, 44.0);
    /// MINRES with the blocks factored.
    pub(super) const MINRES: Self = Self::Log(350.0, 45.0);
    /// Either, on the whole system, with the blocks factored.
    pub(super) const WHOLE_ITERATIVE: Self = Self::Log(1110.0, 47.0);
    /// Either, with no factor at all.
    pub(super) const NO_FACTOR: Self = Self::Log(860.0, 6.0);
    /// The whole matrix, by LU. A long mesh takes down to a quarter.
    pub(super) const WHOLE_LU: Self = Self::Power(1660.0, 1.4);
    /// A complex least squares system.
    pub(super) const LSCM: Self = Self::Log(270.0, 34.0);
    /// Interior points: factors in double precision, and what the barrier keeps.
    pub(super) const BARRIER: Self = Self::Log(110.0, 95.0);
    /// The descent over positions, and what the ladder comes to when it is climbed to that.
    pub(super) const DESCENT: Self = Self::Log(720.0, 95.0);

    /// Bytes of a mesh of so many triangles.
    pub(super) fn at(self, triangles: usize) -> f64 {
        // A single triangle has no logarithm, and is no case for care.
        let n = triangles.max(2) as f64;
        match self {
            Self::Log(a, b) => n * (a + b * n.log2()),
            Self::Power(a, b) => a * n.powf(b),
        }
    }

    /// An inner method, of which this is known with the blocks of the reduced system factored.
    pub(super) const fn of_iterations(settings: &IterativeSettings, reduced: Self) -> Self {
        match (settings.reduction, settings.preconditioner) {
            (Reduction::None, PreconditionerKind::Block) => Self::WHOLE_ITERATIVE,
            (Reduction::Triangles, PreconditionerKind::Block) => reduced,
            (_, PreconditionerKind::None | PreconditionerKind::Jacobi) => Self::NO_FACTOR,
        }
    }
}
