//! A primal–dual interior point method for the angle problem.
//!
//! Minimises the energy of ABF with a logarithmic barrier at both ends of the interval,
//!
//! ```text
//! φ(x) = Σ w (x − a)² − μ Σ [log x + log(π − x)]   subject to   h(x) = 0,        μ → barrier_floor,
//! ```
//!
//! so that no angle ever leaves (0, π). Every step solves
//!
//! ```text
//! [ Λ  Jᵀ ] [ δ  ]     [ dφ/dx + Jᵀλ ]
//! [ J  0  ] [ Δλ ] = − [ h           ],        Λ = 2w + z_lo/x + z_hi/(π − x) − m/sin²x,
//! ```
//!
//! `z_lo ≈ μ/x` and `z_hi ≈ μ/(π − x)` being the multipliers of the bounds and `m` those of the wheels (the log form). `Λ` is
//! diagonal, so a step is one Cholesky factorisation of the same reduced system as everywhere else. Three things make it
//! converge where a damped Newton method leaves the interval:
//!
//! * A filter line search with second-order corrections, and a restoration phase where it finds nothing (Wächter, Biegler,
//!   *On the implementation of an interior-point filter line-search algorithm*, 2006): `search.rs`, `filter.rs`, `restore.rs`.
//!   `μ` falls as in Fiacco–McCormick. A run that is stuck starts again from the middle with a larger `μ`.
//! * Small angles move as exponentials, along which the wheels are as good as linear: `path.rs`.
//! * The exact Hessian of VMV04 §6, made convex on each triangle's own plane `Σ δ = 0`, which keeps the system positive
//!   definite: `curvature.rs`.
//!
//! # The floor of μ
//!
//! As μ → 0 the result tends to the optimum of ABF. On some meshes that optimum is degenerate: its smallest angles are 0.
//! There, as on the dino of `docs/models.md`, the smallest angle falls in proportion to μ while `F/3nt` no longer changes, and
//! a floor keeps every triangle usable; elsewhere, as on its cow, a lower floor changes neither.
//!
//! A layout keeps angles at least 1e-6 from 0, so results with smaller ones close no longer and flip. That is what
//! [`Barrier::smallest_angle`] is for: with it, a floor of 1e-8 does no harm. A floor of 1e-9 is within 1e-6 rad of the
//! optimum of ABF where that is not degenerate. Angles below the clamp of the reported residual (1e-9) end a solve as
//! [`Termination::Stalled`](abf_control::Termination::Stalled).
//!
//! Upper bounds on angle sums at the boundary have slacks in (0, π), kept there by the same barrier: `slack.rs`.
//!
//! What no setting helps against: a drawing whose triangles differ in size by more than doubles can hold has valid angles, and
//! no valid coordinates.

mod curvature;
mod direction;
mod dual;
mod filter;
mod iterate;
mod path;
mod restore;
mod run;
mod search;
mod slack;
mod system;

use crate::run::BarrierRun;
use abf_constraints::AngleProblem;
use abf_control::{Observer, SettingError, StopCriteria, Watch};
use abf_solve_core::{AngleSolution, AngleSolver, Hessian, SolveError};

/// The interior point method and its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Barrier {
    /// The second derivatives used: those of the constraints too, made convex triangle by triangle, or
    /// `Λ = 2w + z_lo/x + z_hi/(π − x)` alone, which mostly needs up to twice as many steps and now and then does not arrive.
    pub hessian: Hessian,
    /// The first `μ`, no unit: weights are `1/a²`, so 1 is the energy of an angle that is off by all of its target.
    pub barrier_start: f64,
    /// The last `μ`. See the [crate documentation](crate) for what it costs and what it is good for.
    pub barrier_floor: f64,
    /// `μ` does not fall further once an angle would fall below this with it, rad, that is not about as small in its target;
    /// 0 lets it. Angles below 1e-6 rad do not survive a layout in doubles.
    pub smallest_angle: f64,
    /// By what `μ` is multiplied at least, in (0, 1).
    pub barrier_reduction: f64,
    /// Converged means, besides the [`StopCriteria`], that at the floor `max |r dL/dr|` and `max |z r − μ|` are at most this,
    /// `r` being the distances of the angles to 0 and π: energy per relative change.
    pub optimality_tolerance: f64,
    /// No step takes more than this share of the distance of an angle to 0 or π, in (0, 1).
    pub fraction: f64,
}

impl Default for Barrier {
    fn default() -> Self {
        Self {
            hessian: Hessian::Exact,
            barrier_start: 0.1,
            barrier_floor: 1e-3,
            smallest_angle: 1e-5,
            barrier_reduction: 0.1,
            optimality_tolerance: 1e-6,
            fraction: 0.99,
        }
    }
}

impl Barrier {
    /// Solves from these angles instead of the initial guess of the problem: one per corner, rad, any that are finite. Those of
    /// a valid drawing satisfy the constraints already.
    ///
    /// # Errors
    /// [`SolveError::Setting`] when a setting is out of range, [`SolveError::Unsupported`] when the start does not fit,
    /// [`SolveError::Linear`] when the very first step has no solution. Later failures end the solve with the best angles so
    /// far.
    pub fn solve_from(
        &self,
        problem: &AngleProblem<'_>,
        start: &[f64],
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<AngleSolution, SolveError> {
        stop.check()?;
        self.check()?;
        if start.len() != problem.topology().corner_count() || !start.iter().all(|x| x.is_finite()) {
            return Err(SolveError::Unsupported("a start needs one finite angle for every corner"));
        }
        let mut watch = Watch::start(stop, observer);
        let run = BarrierRun::new(*self, problem, start.to_vec(), &mut || watch.checkpoint())?;
        let (angles, termination, history) = run.solve(stop, &mut watch)?;
        Ok(AngleSolution::measure(problem, angles, termination, history))
    }
}

/// Solves from the initial guess of the problem: [`Barrier::solve_from`].
impl AngleSolver for Barrier {
    fn name(&self) -> &'static str {
        "barrier"
    }

    fn check(&self) -> Result<(), SolveError> {
        let fault = |name, allowed, value| Err(SettingError::new(name, allowed, value).into());
        for (name, value) in [
            ("barrier_start", self.barrier_start),
            ("barrier_floor", self.barrier_floor),
            ("optimality_tolerance", self.optimality_tolerance),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return fault(name, "positive and finite", value);
            }
        }
        if self.barrier_floor > self.barrier_start {
            return fault("barrier_floor", "at most barrier_start", self.barrier_floor);
        }
        if !(self.smallest_angle >= 0.0 && self.smallest_angle.is_finite()) {
            return fault("smallest_angle", "at least 0 and finite", self.smallest_angle);
        }
        for (name, value) in [("barrier_reduction", self.barrier_reduction), ("fraction", self.fraction)] {
            if !(value > 0.0 && value < 1.0) {
                return fault(name, "in (0, 1)", value);
            }
        }
        Ok(())
    }

    fn keeps_boundary(&self) -> bool {
        true
    }

    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<AngleSolution, SolveError> {
        self.solve_from(problem, problem.initial_guess(), stop, observer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_out_of_range_are_named() {
        let fine = Barrier::default();
        for (settings, message) in [
            (Barrier { barrier_floor: 0.0, ..fine }, "barrier_floor must be positive and finite, got 0"),
            (Barrier { barrier_start: f64::NAN, ..fine }, "barrier_start must be positive and finite, got NaN"),
            (Barrier { barrier_floor: 2.0, ..fine }, "barrier_floor must be at most barrier_start, got 2"),
            (Barrier { barrier_reduction: 1.0, ..fine }, "barrier_reduction must be in (0, 1), got 1"),
            (Barrier { smallest_angle: -0.5, ..fine }, "smallest_angle must be at least 0 and finite, got -0.5"),
            (Barrier { fraction: 1.5, ..fine }, "fraction must be in (0, 1), got 1.5"),
            (
                Barrier { optimality_tolerance: -1.0, ..fine },
                "optimality_tolerance must be positive and finite, got -1",
            ),
        ] {
            assert_eq!(settings.check().unwrap_err().to_string(), message);
        }
        assert_eq!(fine.check(), Ok(()));
    }
}
