//! One value per corner, computed in parallel.

use abf_parallel::prelude::*;

/// How many entries one task computes.
pub(crate) const PER_TASK: usize = 1 << 12;

/// `f` of every angle, in parallel.
pub(crate) fn per_corner(angles: &[f64], f: impl Fn(f64) -> f64 + Sync) -> Vec<f64> {
    let mut out = vec![0.0; angles.len()];
    out.par_chunks_mut(PER_TASK).zip(angles.par_chunks(PER_TASK)).for_each(|(out, angles)| {
        out.iter_mut().zip(angles).for_each(|(out, &x)| *out = f(x));
    });
    out
}
