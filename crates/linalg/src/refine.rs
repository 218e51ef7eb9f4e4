//! Iterative refinement, written once above every factorisation.

use crate::vector::norm;
use crate::{LinearError, Scalar};
use abf_control::Checkpoint;

/// When to refine a solution, and how often at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// Refine while the true relative residual is above this.
    pub tolerance: f64,
    /// At most so many times.
    pub max_steps: usize,
}

impl Default for Refinement {
    fn default() -> Self {
        Self { tolerance: 1e-12, max_steps: 3 }
    }
}

/// What a linear solve took and reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearStats {
    /// Iterations: refinement steps of a direct solve, matrix products of an iterative one.
    pub iterations: usize,
    /// `‖b − Ax‖ / ‖b‖`, computed with the matrix, never estimated by the method.
    pub relative_residual: f64,
}

/// Solves `A x = b`, `rhs` being `b` on entry and `x` on return: `x ← F⁻¹b`, then `x ← x + F⁻¹(b − Ax)`
/// until the true residual meets `refinement.tolerance` or no longer falls.
///
/// `apply_inverse` overwrites a vector with `F⁻¹` of it; `residual(x, b, out)` writes `b − Ax`. The checkpoint is asked
/// before every refinement.
pub(crate) fn solve_refined<T: Scalar>(
    rhs: &mut [T],
    refinement: Refinement,
    apply_inverse: impl Fn(&mut [T]) -> Result<(), LinearError>,
    residual: impl Fn(&[T], &[T], &mut [T]),
    checkpoint: &mut Checkpoint<'_>,
) -> Result<LinearStats, LinearError> {
    let b = rhs.to_vec();
    let scale = norm(&b);
    if scale == 0.0 {
        return Ok(LinearStats::default());
    }
    apply_inverse(rhs)?;
    checkpoint()?;
    let mut correction = vec![T::ZERO; b.len()];
    residual(rhs, &b, &mut correction);
    let mut stats = LinearStats { iterations: 0, relative_residual: norm(&correction) / scale };
    while stats.relative_residual > refinement.tolerance && stats.iterations < refinement.max_steps {
        checkpoint()?;
        apply_inverse(&mut correction)?;
        checkpoint()?;
        let refined: Vec<T> = rhs.iter().zip(&correction).map(|(&x, &d)| x + d).collect();
        residual(&refined, &b, &mut correction);
        let relative_residual = norm(&correction) / scale;
        stats.iterations += 1;
        // NaN compares false: a broken refinement is dropped like a useless one.
        let better = relative_residual < stats.relative_residual;
        if !better {
            break;
        }
        rhs.copy_from_slice(&refined);
        stats.relative_residual = relative_residual;
    }
    if stats.relative_residual < 1.0 {
        Ok(stats)
    } else {
        Err(LinearError::NoSolution { relative_residual: stats.relative_residual })
    }
}
