//! What the iterative inner methods are told, and how their end is judged.

use crate::{Hessian, LinearError, NewtonSettings, SolveError, StepError, StepReport};
use abf_constraints::WheelForm;
use abf_control::{SettingError, UnknownName};
use abf_linalg::{KrylovEnd, KrylovParams, KrylovStats};

/// Which system an iterative method works on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, strum::Display, strum::EnumString, strum::VariantNames)]
#[strum(serialize_all = "kebab-case", parse_err_ty = UnknownName, parse_err_fn = unknown_reduction)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Reduction {
    /// `M = J Λ⁻¹ Jᵀ`, all `nt + 2 ni` multipliers, never assembled (VMV04 §7).
    None,
    /// `S`: the triangle rows eliminated, `2 ni` multipliers.
    #[default]
    Triangles,
}

fn unknown_reduction(given: &str) -> UnknownName {
    UnknownName::of::<Reduction>("reduction", given)
}

/// Which preconditioner an iterative method uses. Each is built with 2w, so that it is positive
/// definite whatever the signs in Λ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, strum::Display, strum::EnumString, strum::VariantNames)]
#[strum(serialize_all = "kebab-case", parse_err_ty = UnknownName, parse_err_fn = unknown_preconditioner)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum PreconditionerKind {
    /// None (VMV04).
    None,
    /// The diagonal.
    Jacobi,
    /// Exact factors of the V–V and the W–W block of `S`, whose coupling is weak; without reduction
    /// with the triangle rows eliminated inside the preconditioner.
    #[default]
    Block,
}

fn unknown_preconditioner(given: &str) -> UnknownName {
    UnknownName::of::<PreconditionerKind>("preconditioner", given)
}

/// What an iterative inner method may be told besides its tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct IterativeSettings {
    /// The system it works on.
    pub reduction: Reduction,
    /// Its preconditioner.
    pub preconditioner: PreconditionerKind,
    /// At most so many inner iterations in one step.
    pub max_inner_iterations: usize,
}

impl Default for IterativeSettings {
    fn default() -> Self {
        Self {
            reduction: Reduction::default(),
            preconditioner: PreconditionerKind::default(),
            max_inner_iterations: 20_000,
        }
    }
}

impl IterativeSettings {
    /// The method of VMV04: the whole `M`, no preconditioner.
    #[must_use]
    pub fn as_published() -> Self {
        Self { reduction: Reduction::None, preconditioner: PreconditionerKind::None, ..Self::default() }
    }

    /// Checks the settings and that they go with this point of the grid; iterative solvers call it
    /// first.
    ///
    /// # Errors
    /// [`SolveError::Setting`] for a limit of zero; [`SolveError::Unsupported`] for the exact Hessian
    /// of the product wheel, which cannot be inverted entry by entry.
    pub fn check(&self, newton: &NewtonSettings) -> Result<(), SolveError> {
        if self.max_inner_iterations == 0 {
            return Err(SettingError::new("max_inner_iterations", "at least 1", 0).into());
        }
        if newton.wheel == WheelForm::Product && newton.hessian == Hessian::Exact {
            return Err(SolveError::Unsupported(
                "the exact Hessian of the product wheel is not diagonal: \
                 use the log wheel, the Gauss–Newton Hessian, or the solver 'abf'",
            ));
        }
        Ok(())
    }

    /// When an inner solve to this relative residual stops.
    #[must_use]
    pub fn krylov(&self, relative_tolerance: f64) -> KrylovParams {
        KrylovParams { relative_tolerance, max_iterations: self.max_inner_iterations }
    }
}

impl StepReport {
    /// Judges the end of an inner solve. One that ran out of iterations is still a step: the line
    /// search decides about it, and `inner_converged` keeps it from counting as the last.
    ///
    /// # Errors
    /// [`StepError::Interrupted`]; [`LinearError::NoSolution`] when the result is not finite, or the
    /// method broke down without having reduced the residual.
    pub fn from_krylov(stats: KrylovStats) -> Result<Self, StepError> {
        let KrylovStats { iterations, relative_residual, estimate, end } = stats;
        let is_usable = match end {
            KrylovEnd::Interrupted => return Err(StepError::Interrupted),
            KrylovEnd::Converged | KrylovEnd::MaxIterations => relative_residual.is_finite(),
            KrylovEnd::NegativeCurvature | KrylovEnd::Breakdown => relative_residual < 1.0,
        };
        if !is_usable {
            return Err(LinearError::NoSolution { relative_residual }.into());
        }
        let inner_converged = end == KrylovEnd::Converged;
        Ok(Self { iterations, relative_residual, estimate: Some(estimate), inner_converged, ..Self::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        for reduction in [Reduction::None, Reduction::Triangles] {
            assert_eq!(reduction.to_string().parse(), Ok(reduction));
        }
        for kind in [PreconditionerKind::None, PreconditionerKind::Jacobi, PreconditionerKind::Block] {
            assert_eq!(kind.to_string().parse(), Ok(kind));
        }
        let error = "ilu".parse::<PreconditionerKind>().unwrap_err();
        assert_eq!(error.to_string(), "there is no preconditioner 'ilu'; there are: none, jacobi, block");
        assert!("rows".parse::<Reduction>().is_err());
    }

    #[test]
    fn the_exact_hessian_of_the_product_wheel_is_refused_with_advice() {
        let product =
            NewtonSettings { wheel: WheelForm::Product, hessian: Hessian::Exact, ..NewtonSettings::default() };
        let error = IterativeSettings::default().check(&product).unwrap_err();
        assert!(error.to_string().contains("use the log wheel, the Gauss–Newton Hessian, or the solver 'abf'"));
        for (wheel, hessian) in [(WheelForm::Log, Hessian::Exact), (WheelForm::Product, Hessian::GaussNewton)] {
            let newton = NewtonSettings { wheel, hessian, ..NewtonSettings::default() };
            assert_eq!(IterativeSettings::default().check(&newton), Ok(()));
        }
        let none = IterativeSettings { max_inner_iterations: 0, ..IterativeSettings::default() };
        assert!(matches!(none.check(&NewtonSettings::default()), Err(SolveError::Setting(_))));
    }

    fn ended(end: KrylovEnd, relative_residual: f64) -> Result<StepReport, StepError> {
        StepReport::from_krylov(KrylovStats { iterations: 7, relative_residual, estimate: 1e-9, end })
    }

    #[test]
    fn running_out_of_iterations_gives_a_step_that_is_not_converged() {
        assert!(ended(KrylovEnd::Converged, 1e-9).expect("a step").inner_converged);
        let report = ended(KrylovEnd::MaxIterations, 0.3).expect("a step");
        assert!(!report.inner_converged);
        assert_eq!((report.iterations, report.relative_residual, report.estimate), (7, 0.3, Some(1e-9)));
    }

    #[test]
    fn what_is_no_solution_is_no_step() {
        assert_eq!(ended(KrylovEnd::Interrupted, 1e-9), Err(StepError::Interrupted));
        for (end, residual) in [(KrylovEnd::Breakdown, 1.5), (KrylovEnd::MaxIterations, f64::NAN)] {
            assert!(matches!(ended(end, residual), Err(StepError::Linear(LinearError::NoSolution { .. }))));
        }
    }
}
