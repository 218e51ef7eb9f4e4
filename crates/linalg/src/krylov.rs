//! What the Krylov methods share: when to stop, and why to believe them.
//!
//! A Krylov method never computes `b − Ax`; it carries a recursion of it along, and stops when that
//! is small. Two things part the recursion from the truth:
//!
//! * Its norm. Preconditioned MINRES follows `‖r‖_C⁻¹ = √⟨r, C⁻¹r⟩`, which a badly scaled `C` makes
//!   small long before `‖r‖` is.
//! * Rounding. After many steps on an ill-conditioned system the recursion goes on falling while
//!   the true residual does not.
//!
//! So a method that wants to stop is checked with the operator itself. If it stopped early only for
//! the norm, it goes on with a smaller target; if its recursion no longer describes `x`, it starts
//! anew from `x` with the true residual; if that does not help either, it has broken down.

use crate::vector::norm;
use crate::{LinOp, Preconditioner};

/// A solution counts as converged up to this multiple of the tolerance: the last bits of a residual
/// are not worth another step.
const SLACK: f64 = 2.0;

/// A recursion describes its `x` if the true residual, in the recursion's own norm, is at most this
/// multiple of what the recursion believes.
const HONEST: f64 = 2.0;

/// A new start must leave at most this part of the true residual, or it is the last.
const PROGRESS: f64 = 0.5;

/// The target of a method told to go on, as a multiple of what would do if `‖r‖` and its own norm
/// fell together from here.
const CAUTION: f64 = 0.5;

/// When an iterative method stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KrylovParams {
    /// The wanted `‖b − Ax‖ / ‖b‖`: the true residual in the 2-norm, without preconditioner.
    pub relative_tolerance: f64,
    /// At most so many iterations, over all restarts.
    pub max_iterations: usize,
}

impl Default for KrylovParams {
    fn default() -> Self {
        Self { relative_tolerance: 1e-10, max_iterations: 10_000 }
    }
}

/// Why an iterative method stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KrylovEnd {
    /// The true relative residual meets the tolerance (within a factor of two).
    Converged,
    /// The iterations ran out; `x` is the last iterate.
    MaxIterations,
    /// The caller's `go_on` said no; `x` is the last iterate.
    Interrupted,
    /// A method that needs a positive definite matrix met a direction with `⟨p, Ap⟩ ≤ 0`. `x` is the iterate before it.
    /// MINRES needs none and never ends so.
    NegativeCurvature,
    /// Nothing helps: restarts no longer reduce the true residual, the preconditioner is not
    /// positive definite, or numbers are not finite. `x` is the best start so far or better.
    Breakdown,
}

/// What an iterative solve took and reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KrylovStats {
    /// Steps taken, over all restarts.
    pub iterations: usize,
    /// `‖b − Ax‖ / ‖b‖`, computed with the operator. NaN if a product is.
    pub relative_residual: f64,
    /// What the method's recursion believed its relative residual (in its own norm) to be when it
    /// first wanted to stop, or at the end if it never did.
    pub estimate: f64,
    /// Why it stopped.
    pub end: KrylovEnd,
}

/// A Krylov method between two starts: it takes steps and believes in a residual.
pub(crate) trait Recursion {
    /// Starts with the residual of the current `x`.
    fn start(c: &dyn Preconditioner, residual: &[f64]) -> Self;
    /// Takes one step, if it can.
    fn step(&mut self, a: &dyn LinOp, c: &dyn Preconditioner, x: &mut [f64]) -> Step;
    /// What the recursion believes the norm of the residual to be: its own norm.
    fn residual_norm(&self) -> f64;
    /// That norm of any vector.
    fn norm(c: &dyn Preconditioner, v: &[f64]) -> f64;
}

/// What came of a step. Only `Taken` changes `x`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    Taken,
    /// Nothing left to divide by, or NaN.
    Broken,
}

/// Solves `A x = b` with one method, from `x`.
pub(crate) fn solve<R: Recursion>(
    a: &dyn LinOp,
    c: &dyn Preconditioner,
    b: &[f64],
    x: &mut [f64],
    params: &KrylovParams,
    go_on: &mut dyn FnMut(usize, f64) -> bool,
) -> KrylovStats {
    assert!(b.len() == a.size() && x.len() == a.size(), "vectors fit the operator");
    let scale = norm(b);
    if scale == 0.0 {
        x.fill(0.0);
        return KrylovStats { iterations: 0, relative_residual: 0.0, estimate: 0.0, end: KrylovEnd::Converged };
    }
    let residual = vec![0.0; b.len()];
    let mut run =
        KrylovRun { a, c, b, scale, own_scale: R::norm(c, b), residual, truth: 0.0, iterations: 0, estimate: 0.0 };
    run.measure(x);
    run.estimate = R::norm(c, &run.residual) / run.own_scale;
    let mut first_claim = None;
    let end = run.restarted::<R>(x, params, &mut first_claim, go_on);
    KrylovStats {
        iterations: run.iterations,
        relative_residual: run.truth,
        estimate: first_claim.unwrap_or(run.estimate),
        end,
    }
}

/// The state of a solve.
struct KrylovRun<'a> {
    a: &'a dyn LinOp,
    c: &'a dyn Preconditioner,
    b: &'a [f64],
    /// `‖b‖`.
    scale: f64,
    /// `b` in the method's own norm.
    own_scale: f64,
    /// `b − Ax` when it was last computed.
    residual: Vec<f64>,
    /// `‖b − Ax‖ / ‖b‖` when it was last computed.
    truth: f64,
    iterations: usize,
    /// The recursion's own relative residual.
    estimate: f64,
}

impl KrylovRun<'_> {
    /// Computes the residual with the operator.
    fn measure(&mut self, x: &[f64]) {
        self.a.apply(x, &mut self.residual);
        for (r, b) in self.residual.iter_mut().zip(self.b) {
            *r = b - *r;
        }
        self.truth = norm(&self.residual) / self.scale;
    }

    /// Sweeps until the end or until another start no longer helps.
    fn restarted<R: Recursion>(
        &mut self,
        x: &mut [f64],
        params: &KrylovParams,
        first_claim: &mut Option<f64>,
        go_on: &mut dyn FnMut(usize, f64) -> bool,
    ) -> KrylovEnd {
        let mut kept = vec![0.0; x.len()];
        loop {
            if self.truth <= params.relative_tolerance {
                return KrylovEnd::Converged;
            }
            kept.copy_from_slice(x);
            let before = self.truth;
            let end = self.sweep::<R>(x, params, first_claim, go_on);
            if end == Some(KrylovEnd::Converged) {
                return KrylovEnd::Converged;
            }
            self.measure(x);
            // An iterate stopped on the way may have a larger residual than the start: the 2-norm
            // is not what MINRES reduces at every step. One that gave up may not.
            let worse = end.is_none() && self.truth > before;
            if worse || !self.truth.is_finite() {
                x.copy_from_slice(&kept);
                self.truth = before;
                return end.unwrap_or(KrylovEnd::Breakdown);
            }
            if let Some(end) = end {
                return end;
            }
            if self.truth > PROGRESS * before {
                return KrylovEnd::Breakdown;
            }
        }
    }

    /// Steps from `x`, whose residual is measured, to an end; or to where the recursion breaks or
    /// no longer describes `x`: `None`.
    fn sweep<R: Recursion>(
        &mut self,
        x: &mut [f64],
        params: &KrylovParams,
        first_claim: &mut Option<f64>,
        go_on: &mut dyn FnMut(usize, f64) -> bool,
    ) -> Option<KrylovEnd> {
        let mut recursion = R::start(self.c, &self.residual);
        let mut target = recursion.residual_norm() / self.own_scale * params.relative_tolerance / self.truth;
        // A preconditioner that is not positive definite has no norm to aim by.
        if target.is_nan() {
            return None;
        }
        while self.iterations < params.max_iterations {
            match recursion.step(self.a, self.c, x) {
                Step::Taken => self.iterations += 1,
                Step::Broken => return None,
            }
            self.estimate = recursion.residual_norm() / self.own_scale;
            let wanted = go_on(self.iterations, self.estimate);
            if self.estimate <= target {
                first_claim.get_or_insert(self.estimate);
                self.measure(x);
                if self.truth <= SLACK * params.relative_tolerance {
                    return Some(KrylovEnd::Converged);
                }
                let honest = R::norm(self.c, &self.residual) <= HONEST * recursion.residual_norm();
                if !honest {
                    return None;
                }
                target = CAUTION * self.estimate * params.relative_tolerance / self.truth;
            }
            if !wanted {
                return Some(KrylovEnd::Interrupted);
            }
        }
        Some(KrylovEnd::MaxIterations)
    }
}

#[cfg(test)]
mod tests;
