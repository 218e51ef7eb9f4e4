//! Vectors: the same bits for any number of threads.
//!
//! Sums run over chunks of fixed length, and the partial sums are added in their order, so neither
//! the number of threads nor whether there are any shows in the result.

use crate::Scalar;
use abf_parallel::prelude::*;

/// How many elements one partial sum covers.
const CHUNK: usize = 4096;

/// From this length on chunks are handed to threads; below, starting them costs more than they save.
const PARALLEL_LEN: usize = 1 << 16;

/// `Σ xᵢ yᵢ`.
///
/// # Panics
/// If the lengths differ.
#[must_use]
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    assert_eq!(x.len(), y.len(), "vectors of one length");
    sum_chunks(x, y, |x, y| x.iter().zip(y).map(|(a, b)| a * b).sum())
}

/// `√(Σ |xᵢ|²)`.
#[must_use]
pub fn norm<T: Scalar>(x: &[T]) -> f64 {
    sum_chunks(x, x, |x, _| x.iter().map(|v| v.norm_squared()).sum()).sqrt()
}

/// `y ← y + a x`.
///
/// # Panics
/// If the lengths differ.
pub fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    update(x, y, |x, y| y + a * x);
}

/// `y ← x + a y`.
///
/// # Panics
/// If the lengths differ.
pub fn xpay(x: &[f64], a: f64, y: &mut [f64]) {
    update(x, y, |x, y| x + a * y);
}

/// `x ← a x`.
pub(crate) fn scale(a: f64, x: &mut [f64]) {
    x.iter_mut().for_each(|v| *v *= a);
}

fn sum_chunks<T: Sync>(x: &[T], y: &[T], sum: impl Fn(&[T], &[T]) -> f64 + Sync) -> f64 {
    if x.len() < PARALLEL_LEN {
        x.chunks(CHUNK).zip(y.chunks(CHUNK)).map(|(x, y)| sum(x, y)).sum()
    } else {
        let partial: Vec<f64> = x.par_chunks(CHUNK).zip(y.par_chunks(CHUNK)).map(|(x, y)| sum(x, y)).collect();
        partial.into_iter().sum()
    }
}

fn update(x: &[f64], y: &mut [f64], new: impl Fn(f64, f64) -> f64 + Sync) {
    assert_eq!(x.len(), y.len(), "vectors of one length");
    let serial = |x: &[f64], y: &mut [f64]| x.iter().zip(y).for_each(|(&x, y)| *y = new(x, *y));
    if x.len() < PARALLEL_LEN {
        serial(x, y);
    } else {
        x.par_chunks(CHUNK).zip(y.par_chunks_mut(CHUNK)).for_each(|(x, y)| serial(x, y));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{Random, with_threads};

    #[test]
    fn a_sum_has_the_same_bits_for_any_number_of_threads() {
        let x = Random::new(1).vector(3 * PARALLEL_LEN + 17);
        let sums = [1, 2, 3].map(|threads| with_threads(threads, || (dot(&x, &x), norm(&x))));
        assert_eq!(sums[0], sums[1]);
        assert_eq!(sums[0], sums[2]);
        let plain: f64 = x.iter().map(|v| v * v).sum();
        assert!((sums[0].0 - plain).abs() < 1e-12 * plain);
    }

    #[test]
    fn updates_touch_every_element() {
        for len in [0, 1, CHUNK, PARALLEL_LEN + 3] {
            let mut y = vec![2.0; len];
            axpy(3.0, &vec![1.0; len], &mut y);
            xpay(&vec![1.0; len], 2.0, &mut y);
            scale(0.5, &mut y);
            assert_eq!(y, vec![5.5; len]);
        }
    }
}
