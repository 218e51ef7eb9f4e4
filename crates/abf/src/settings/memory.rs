//! How much memory a flattening takes, known before it is taken.
//!
//! Every part but one grows with the number of triangles; the factors of a disk's matrices grow with
//! `n log n` (George 1973 on nested dissection; minimum degree, which is used, comes close). So a run takes `n (a + b log₂ n)`
//! bytes, with `a` and `b` of the method. Measured on round and long disks of 150 to 640 000 triangles, as `peak_memory_bytes`
//! in the program's JSON; the whole matrix of ABF, factored by LU, grows with a power.

use std::num::NonZeroUsize;

use crate::settings::Solver;
use abf_constraints::WheelForm;
use abf_solve_abf_newton::{AbfNewton, Inner};
use abf_solve_core::{Hessian, IterativeSettings, PreconditionerKind, Reduction};
use abf_solve_linabf::{LinAbf, Passes};
use abf_solve_minres::Minres;
use abf_solve_uzawa::Uzawa;

/// What the fit to these disks leaves open, for meshes whose factors are fuller than theirs.
const MARGIN: f64 = 1.2;

/// Bytes of a mesh with `n` triangles.
#[derive(Clone, Copy, Debug)]
enum Growth {
    /// `n (a + b log₂ n)`.
    Log(f64, f64),
    /// `a n^b`.
    Power(f64, f64),
}

/// Conjugate gradients with factors in single precision: [`SolverKind::LinAbf`] from its second pass on.
const LEAN: Growth = Growth::Log(400.0, 25.0);
/// One factorisation in double precision: one pass of it.
const ONE_PASS: Growth = Growth::Log(60.0, 85.0);
/// The lean steps, with what a line search keeps.
const FROZEN: Growth = Growth::Log(510.0, 26.0);
/// Factors in double precision, with what a line search keeps.
const DIRECT: Growth = Growth::Log(60.0, 95.0);
/// Uzawa with the blocks factored.
const UZAWA: Growth = Growth::Log(700.0, 44.0);
/// MINRES with the blocks factored.
const MINRES: Growth = Growth::Log(350.0, 45.0);
/// Either, on the whole system, with the blocks factored.
const WHOLE_ITERATIVE: Growth = Growth::Log(1110.0, 47.0);
/// Either, with no factor at all.
const NO_FACTOR: Growth = Growth::Log(860.0, 6.0);
/// The whole matrix, by LU. A long mesh takes down to a quarter.
const WHOLE_LU: Growth = Growth::Power(1660.0, 1.4);
/// A complex least squares system.
const LSCM: Growth = Growth::Log(270.0, 34.0);
/// Interior points: factors in double precision, and what the barrier keeps.
const BARRIER: Growth = Growth::Log(110.0, 95.0);
/// The descent over positions, and what the ladder comes to when it is climbed to that.
const DESCENT: Growth = Growth::Log(720.0, 95.0);

/// What a vertex takes that no face uses, and of others the part that the triangles do not cover: its position
/// as it is read and as it is kept, its UV, indices.
const BYTES_PER_VERTEX: u64 = 150;

/// What does not grow with the mesh, such as the history of a solver that goes on to its last iteration.
const AT_LEAST: u64 = 64_000;

impl Growth {
    fn at(self, triangles: usize) -> f64 {
        // A single triangle has no logarithm, and is no case for care.
        let n = triangles.max(2) as f64;
        match self {
            Self::Log(a, b) => n * (a + b * n.log2()),
            Self::Power(a, b) => a * n.powf(b),
        }
    }
}

/// About how many bytes [`Pipeline::run`](crate::Pipeline::run) takes at most at a time, the mesh and reading it included, for a
/// disk of so many triangles and vertices.
///
/// It is above what is measured, and mostly below twice that: round meshes with vertices of about six faces come
/// close to it, long ones and those with few interior vertices take less. Of [`SolverKind::Auto`] it is what its last rung
/// takes, a multiple of the first, which mostly is enough. Not in it: the code, thread
/// stacks, what a solver of a user's own takes, and the scratch of the matrix library, which is sized after the processor's caches.
#[must_use]
pub fn predict_memory(solver: &Solver, triangles: usize, vertices: usize) -> u64 {
    // A disk has at most two vertices more than triangles, and mostly half as many.
    let unused = vertices.saturating_sub(triangles) as u64;
    let bytes = MARGIN * growth(solver).at(triangles);
    (bytes as u64).saturating_add(AT_LEAST).saturating_add(BYTES_PER_VERTEX.saturating_mul(unused))
}

fn growth(solver: &Solver) -> Growth {
    match solver {
        Solver::LinAbf(LinAbf { passes: Passes::Exactly(NonZeroUsize::MIN) }) => ONE_PASS,
        Solver::LinAbf(_) => LEAN,
        // What a solver of a user's own takes is not known here; the mesh and a layout are.
        Solver::Lscm | Solver::Custom(_) => LSCM,
        Solver::Newton(AbfNewton { inner: Inner::FullKkt, .. }) => WHOLE_LU,
        Solver::Newton(AbfNewton { newton, .. }) => match (newton.wheel, newton.hessian) {
            (WheelForm::Product, Hessian::Exact) => WHOLE_LU,
            (WheelForm::Log, Hessian::GaussNewton) => FROZEN,
            (WheelForm::Product, Hessian::GaussNewton) | (WheelForm::Log, Hessian::Exact) => DIRECT,
        },
        Solver::Uzawa(Uzawa { iterative, .. }) => of_iterations(iterative, UZAWA),
        Solver::Minres(Minres { iterative, .. }) => of_iterations(iterative, MINRES),
        Solver::Barrier(_) => BARRIER,
        Solver::Descent(_) | Solver::Auto(_) => DESCENT,
    }
}

/// An inner method, of which this is known with the blocks of the reduced system factored.
fn of_iterations(settings: &IterativeSettings, reduced: Growth) -> Growth {
    match (settings.reduction, settings.preconditioner) {
        (Reduction::None, PreconditionerKind::Block) => WHOLE_ITERATIVE,
        (Reduction::Triangles, PreconditionerKind::Block) => reduced,
        (_, PreconditionerKind::None | PreconditionerKind::Jacobi) => NO_FACTOR,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_meshes_take_more_whatever_the_method_and_no_count_overflows() {
        for solver in Solver::all() {
            let sizes = [0, 1, 2, 100, 10_000, 1_000_000, usize::MAX];
            let bytes = sizes.map(|n| predict_memory(&solver, n, n / 2));
            assert!(bytes.is_sorted() && bytes[0] > 0, "{solver}: {bytes:?}");
            assert!(predict_memory(&solver, 100, usize::MAX) > predict_memory(&solver, 100, 60));
        }
    }

    #[test]
    fn no_other_solver_of_angles_takes_less_than_linabf() {
        let bytes = |solver: &Solver| predict_memory(solver, 100_000, 50_000);
        for solver in Solver::all().into_iter().filter(|solver| solver.kind().finds_angles()) {
            assert!(bytes(&solver) >= bytes(&LinAbf::default().into()), "{solver}");
        }
    }
}
