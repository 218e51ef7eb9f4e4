//! Back to the constraints, when the line search finds no acceptable step.

use crate::iterate::Iterate;
use crate::path::{advance, longest, nearer_end};
use crate::system::StepSystem;
use abf_constraints::{AngleProblem, largest};
use abf_control::{Checkpoint, IterationRecord};
use abf_solve_core::{KktVector, LinearError};

/// No share below this is tried.
const SHORTEST: f64 = 1e-6;

/// A share has to take this part of what the linearisation promises.
const DECREASE: f64 = 1e-4;

/// One step of LinABF in the metric of logarithms: the smallest `Σ (e/r)²`, `r` being the distances to the nearer of 0 and
/// π, with `J e = −h`. It descends `‖h‖₁` whatever the iterate, and keeps close to where it is. `None` when no share of it
/// does any good.
pub(crate) fn restored(
    problem: &AngleProblem<'_>,
    system: &mut StepSystem,
    iterate: &Iterate,
    fraction: f64,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Option<(Iterate, IterationRecord)>, LinearError> {
    let lambda: Vec<f64> = iterate.angles.iter().map(|&x| nearer_end(x).powi(-2)).collect();
    let mut out = KktVector::default();
    let linear = system.solve(problem, iterate, &lambda, &vec![0.0; lambda.len()], &mut out, checkpoint)?;
    let mut share = longest(&iterate.angles, &out.delta, fraction);
    while share > SHORTEST {
        let trial = Iterate::new(problem, advance(&iterate.angles, &out.delta, share));
        if trial.is_finite() && trial.violation <= (1.0 - DECREASE * share) * iterate.violation {
            let record = IterationRecord {
                step: largest(&out.delta),
                step_length: share,
                inner_iterations: linear.iterations,
                inner_residual: linear.relative_residual,
                inner_converged: true,
                ..IterationRecord::default()
            };
            return Ok(Some((trial, record)));
        }
        share *= 0.5;
    }
    Ok(None)
}
