//! How much memory a flattening takes, known before it is taken. `growth.rs` has the figures of every method.

use crate::settings::Solver;

/// What the fit to these disks leaves open, for meshes whose factors are fuller than theirs.
const MARGIN: f64 = 1.2;

/// What a vertex takes that no face uses, and of others the part that the triangles do not cover: its position
/// as it is read and as it is kept, its UV, indices.
const BYTES_PER_VERTEX: u64 = 150;

/// What does not grow with the mesh, such as the history of a solver that goes on to its last iteration.
const AT_LEAST: u64 = 64_000;

/// About how many bytes [`Pipeline::run`](crate::Pipeline::run) takes at most at a time, the mesh and reading it included, for a
/// disk of so many triangles and vertices.
///
/// It is above what is measured, and mostly below twice that: round meshes with vertices of about six faces come
/// close to it, long ones and those with few interior vertices take less. Of [`Solver::Auto`] it is what its last rung
/// takes, a multiple of the first, which mostly is enough. Not in it: the code, thread
/// stacks, what a solver of a user's own takes, and the scratch of the matrix library, which is sized after the processor's caches.
#[must_use]
pub fn predict_memory(solver: &Solver, triangles: usize, vertices: usize) -> u64 {
    // A disk has at most two vertices more than triangles, and mostly half as many.
    let unused = vertices.saturating_sub(triangles) as u64;
    let bytes = MARGIN * solver.growth().at(triangles);
    (bytes as u64).saturating_add(AT_LEAST).saturating_add(BYTES_PER_VERTEX.saturating_mul(unused))
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_solve_linabf::LinAbf;

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
