//! A solver with its settings: one value.

use crate::settings::growth::Growth;
use crate::settings::{Ladder, SolverKind, SolverParts};
use abf_constraints::WheelForm;
use abf_control::UnknownName;
use abf_solve_abf_newton::Inner;
use abf_solve_core::{AngleSolver, Hessian, IterativeSettings, NewtonSettings};
use std::fmt;
use std::num::NonZeroUsize;
use std::str::FromStr;
use std::sync::Arc;

pub use abf_embed::{Descent, Energy, Pin, PinWeight, Pins, Relax};
pub use abf_solve_abf_newton::{AbfNewton, NewtonMethod};
pub use abf_solve_barrier::Barrier;
pub use abf_solve_hierarchical::{Hierarchical, HierarchicalMethod};
pub use abf_solve_linabf::{LinAbf, Passes};
pub use abf_solve_minres::Minres;
pub use abf_solve_uzawa::Uzawa;

/// A solver with its settings.
///
/// Every solver of this library turns into one, and so does its name; a solver of your own is wrapped by
/// [`Solver::custom`].
///
/// ```
/// use abf::{Barrier, Solver, SolverKind};
///
/// let barrier: Solver = Barrier { barrier_floor: 1e-6, ..Barrier::default() }.into();
/// assert_eq!(barrier.kind(), SolverKind::Barrier);
/// let named: Solver = "abf++".parse()?;
/// assert_eq!(named.kind(), SolverKind::AbfPlusPlus);
/// # Ok::<(), abf::UnknownName>(())
/// ```
#[derive(Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Solver {
    /// One solver after the other, up to the first result that is certified.
    Auto(Ladder),
    /// Linear ABF.
    #[cfg_attr(feature = "serde", serde(rename = "linabf"))]
    LinAbf(LinAbf),
    /// ABF, ABF++ and Newton's method with a direct solve: [`AbfNewton::method`] says which.
    Newton(AbfNewton),
    /// Newton's method solved by conjugate-direction Uzawa.
    Uzawa(Uzawa),
    /// Newton's method solved by MINRES.
    Minres(Minres),
    /// The interior point method.
    Barrier(Barrier),
    /// The descent over the positions of the vertices.
    Descent(Descent),
    /// A coarse version of the mesh, solved and carried back: [`Hierarchical::method`] says what that is for.
    Hierarchical(Hierarchical),
    /// Least squares conformal maps. Its only setting is the layout of the [`Pipeline`](crate::Pipeline).
    Lscm,
    /// A solver of your own. Two are equal when they are the same object. With `serde` it is written by its name, and
    /// cannot be read back.
    #[cfg_attr(feature = "serde", serde(serialize_with = "name_of_custom", skip_deserializing))]
    Custom(Arc<dyn AngleSolver>),
}

/// How a solver gets to UVs.
#[derive(Clone, Copy)]
pub(crate) enum Method<'s> {
    /// By the methods of its rungs.
    Ladder(&'s Ladder),
    /// It finds angles, and these are laid out.
    Angles(&'s dyn AngleSolver),
    /// It moves the vertices.
    Positions(&'s Descent),
    /// It solves and draws a coarse version of the mesh, and carries that back.
    Hierarchy(&'s Hierarchical),
    /// The angles of the surface are laid out as they are.
    SurfaceAngles,
}

impl Solver {
    /// A solver of your own.
    #[must_use]
    pub fn custom(solver: impl AngleSolver + 'static) -> Self {
        Self::Custom(Arc::new(solver))
    }

    /// Every solver of this library with its default settings, in the order of [`SolverKind::ALL`].
    #[must_use]
    pub fn all() -> [Self; SolverKind::ALL.len()] {
        [
            Self::Auto(Ladder::default()),
            Self::LinAbf(LinAbf::default()),
            Self::Newton(AbfNewton::abf()),
            Self::Newton(AbfNewton::abf_plus_plus()),
            Self::Newton(AbfNewton::exact_newton()),
            Self::Newton(AbfNewton::fixed_target()),
            Self::Uzawa(Uzawa::default()),
            Self::Minres(Minres::default()),
            Self::Barrier(Barrier::default()),
            Self::Descent(Descent::default()),
            Self::Hierarchical(Hierarchical::habf_plus_plus()),
            Self::Hierarchical(Hierarchical::hlinabf()),
            Self::Lscm,
        ]
    }

    /// Which solver it is.
    #[must_use]
    pub fn kind(&self) -> SolverKind {
        match self {
            Self::Auto(_) => SolverKind::Auto,
            Self::LinAbf(_) => SolverKind::LinAbf,
            Self::Newton(newton) => match newton.method {
                NewtonMethod::Abf => SolverKind::Abf,
                NewtonMethod::AbfPlusPlus => SolverKind::AbfPlusPlus,
                NewtonMethod::AbfNewton => SolverKind::AbfNewton,
                NewtonMethod::AbfFixedTarget => SolverKind::AbfFixedTarget,
            },
            Self::Uzawa(_) => SolverKind::Uzawa,
            Self::Minres(_) => SolverKind::Minres,
            Self::Barrier(_) => SolverKind::Barrier,
            Self::Descent(_) => SolverKind::Descent,
            Self::Hierarchical(hierarchical) => match hierarchical.method {
                HierarchicalMethod::HLinAbf => SolverKind::HLinAbf,
                HierarchicalMethod::HabfPlusPlus => SolverKind::HabfPlusPlus,
            },
            Self::Lscm => SolverKind::Lscm,
            Self::Custom(solver) => SolverKind::Custom(solver.name()),
        }
    }

    /// The name on the command line and in reports.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.kind().name()
    }

    pub(crate) fn method(&self) -> Method<'_> {
        match self {
            Self::Auto(ladder) => Method::Ladder(ladder),
            Self::LinAbf(solver) => Method::Angles(solver),
            Self::Newton(solver) => Method::Angles(solver),
            Self::Uzawa(solver) => Method::Angles(solver),
            Self::Minres(solver) => Method::Angles(solver),
            Self::Barrier(solver) => Method::Angles(solver),
            Self::Custom(solver) => Method::Angles(solver.as_ref()),
            Self::Descent(descent) => Method::Positions(descent),
            Self::Hierarchical(hierarchical) => Method::Hierarchy(hierarchical),
            Self::Lscm => Method::SurfaceAngles,
        }
    }

    /// The solver of angles; `None` for those that are none by themselves: LSCM, the descent, the hierarchical ones, and
    /// the ladder.
    #[must_use]
    pub fn angle_solver(&self) -> Option<&dyn AngleSolver> {
        match self.method() {
            Method::Angles(solver) => Some(solver),
            Method::Ladder(_) | Method::Positions(_) | Method::Hierarchy(_) | Method::SurfaceAngles => None,
        }
    }

    /// The point of the grid this solver runs; `None` for those that are none: LinABF, the interior point, the descent,
    /// LSCM, the ladder, and a solver of your own.
    #[must_use]
    pub fn newton_settings(&self) -> Option<NewtonSettings> {
        match self {
            Self::Newton(solver) => Some(solver.newton),
            Self::Uzawa(solver) => Some(solver.newton),
            Self::Minres(solver) => Some(solver.newton),
            Self::Auto(_)
            | Self::LinAbf(_)
            | Self::Barrier(_)
            | Self::Descent(_)
            | Self::Hierarchical(_)
            | Self::Lscm
            | Self::Custom(_) => None,
        }
    }

    /// What the inner method of Uzawa and MINRES is told; `None` for all others.
    #[must_use]
    pub fn iterative_settings(&self) -> Option<IterativeSettings> {
        match self {
            Self::Uzawa(solver) => Some(solver.iterative),
            Self::Minres(solver) => Some(solver.iterative),
            Self::Auto(_)
            | Self::LinAbf(_)
            | Self::Newton(_)
            | Self::Barrier(_)
            | Self::Descent(_)
            | Self::Hierarchical(_)
            | Self::Lscm
            | Self::Custom(_) => None,
        }
    }

    /// How many passes are made, of a solver that makes passes.
    #[must_use]
    pub fn passes(&self) -> Option<Passes> {
        match self {
            Self::Auto(ladder) => Some(ladder.linabf.passes),
            Self::LinAbf(solver) => Some(solver.passes),
            Self::Newton(_)
            | Self::Uzawa(_)
            | Self::Minres(_)
            | Self::Barrier(_)
            | Self::Descent(_)
            | Self::Hierarchical(_)
            | Self::Lscm
            | Self::Custom(_) => None,
        }
    }

    /// The last weight of the barrier, of a solver that has one; of the ladder that of its descent.
    #[must_use]
    pub fn barrier_floor(&self) -> Option<f64> {
        match self {
            Self::Auto(ladder) => Some(ladder.descent.barrier_floor),
            Self::Barrier(barrier) => Some(barrier.barrier_floor),
            Self::Descent(descent) => Some(descent.barrier_floor),
            Self::LinAbf(_)
            | Self::Newton(_)
            | Self::Uzawa(_)
            | Self::Minres(_)
            | Self::Hierarchical(_)
            | Self::Lscm
            | Self::Custom(_) => None,
        }
    }

    /// Its settings by what they are about, to change them whichever solver it is.
    pub fn parts_mut(&mut self) -> SolverParts<'_> {
        let mut parts = SolverParts::default();
        match self {
            Self::Auto(ladder) => {
                parts.linabf = Some(&mut ladder.linabf);
                parts.barrier = Some(&mut ladder.barrier);
                parts.descent = Some(&mut ladder.descent);
            }
            Self::LinAbf(solver) => parts.linabf = Some(solver),
            Self::Newton(solver) => parts.newton = Some(&mut solver.newton),
            Self::Uzawa(Uzawa { newton, iterative }) | Self::Minres(Minres { newton, iterative }) => {
                parts.newton = Some(newton);
                parts.iterative = Some(iterative);
            }
            Self::Barrier(solver) => parts.barrier = Some(solver),
            Self::Descent(solver) => parts.descent = Some(solver),
            Self::Hierarchical(_) | Self::Lscm | Self::Custom(_) => {}
        }
        parts
    }

    /// How the memory of its runs grows with the mesh.
    pub(super) fn growth(&self) -> Growth {
        match self {
            Self::LinAbf(
                LinAbf { passes: Passes::Exactly(NonZeroUsize::MIN), .. } | LinAbf { error_bound: Some(_), .. },
            ) => Growth::ONE_PASS,
            Self::LinAbf(_) => Growth::LEAN,
            // What a solver of a user's own takes is not known here; the mesh and a layout are.
            Self::Lscm | Self::Custom(_) => Growth::LSCM,
            Self::Newton(AbfNewton { inner: Inner::FullKkt, .. }) => Growth::WHOLE_LU,
            Self::Newton(AbfNewton { newton, .. }) => match (newton.wheel, newton.hessian) {
                (WheelForm::Product, Hessian::Exact) => Growth::WHOLE_LU,
                (WheelForm::Log, Hessian::GaussNewton) => Growth::FROZEN,
                (WheelForm::Product, Hessian::GaussNewton) | (WheelForm::Log, Hessian::Exact) => Growth::DIRECT,
            },
            Self::Uzawa(Uzawa { iterative, .. }) => Growth::of_iterations(iterative, Growth::UZAWA),
            Self::Minres(Minres { iterative, .. }) => Growth::of_iterations(iterative, Growth::MINRES),
            Self::Barrier(_) => Growth::BARRIER,
            // A mesh that cannot be solved by levels is solved as a whole.
            Self::Hierarchical(hierarchical) => match hierarchical.method {
                HierarchicalMethod::HLinAbf => Growth::FROZEN,
                HierarchicalMethod::HabfPlusPlus => Growth::DIRECT,
            },
            Self::Descent(_) | Self::Auto(_) => Growth::DESCENT,
        }
    }
}

#[cfg(feature = "serde")]
fn name_of_custom<S: serde::Serializer>(solver: &Arc<dyn AngleSolver>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(solver.name())
}

impl SolverKind {
    /// This solver with its default settings; `None` for one of a user's own.
    #[must_use]
    pub fn with_defaults(self) -> Option<Solver> {
        Solver::all().into_iter().find(|solver| solver.kind() == self)
    }
}

impl Default for Solver {
    fn default() -> Self {
        Self::Auto(Ladder::default())
    }
}

impl PartialEq for Solver {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Auto(a), Self::Auto(b)) => a == b,
            (Self::LinAbf(a), Self::LinAbf(b)) => a == b,
            (Self::Newton(a), Self::Newton(b)) => a == b,
            (Self::Uzawa(a), Self::Uzawa(b)) => a == b,
            (Self::Minres(a), Self::Minres(b)) => a == b,
            (Self::Barrier(a), Self::Barrier(b)) => a == b,
            (Self::Descent(a), Self::Descent(b)) => a == b,
            (Self::Hierarchical(a), Self::Hierarchical(b)) => a == b,
            (Self::Lscm, Self::Lscm) => true,
            (Self::Custom(a), Self::Custom(b)) => Arc::ptr_eq(a, b),
            (
                Self::Auto(_)
                | Self::LinAbf(_)
                | Self::Newton(_)
                | Self::Uzawa(_)
                | Self::Minres(_)
                | Self::Barrier(_)
                | Self::Descent(_)
                | Self::Hierarchical(_)
                | Self::Lscm
                | Self::Custom(_),
                _,
            ) => false,
        }
    }
}

impl fmt::Debug for Solver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto(ladder) => ladder.fmt(f),
            Self::LinAbf(solver) => solver.fmt(f),
            Self::Newton(solver) => solver.fmt(f),
            Self::Uzawa(solver) => solver.fmt(f),
            Self::Minres(solver) => solver.fmt(f),
            Self::Barrier(solver) => solver.fmt(f),
            Self::Descent(solver) => solver.fmt(f),
            Self::Hierarchical(solver) => solver.fmt(f),
            Self::Lscm => f.write_str("Lscm"),
            Self::Custom(solver) => f.debug_tuple("Custom").field(&solver.name()).finish(),
        }
    }
}

impl fmt::Display for Solver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A solver of this library by its name, with its default settings.
impl FromStr for Solver {
    type Err = UnknownName;

    fn from_str(s: &str) -> Result<Self, UnknownName> {
        let kind: SolverKind = s.parse()?;
        Ok(Self::all().into_iter().find(|solver| solver.kind() == kind).unwrap_or_default())
    }
}

/// Every solver turns into the value that holds it.
macro_rules! from_solvers {
    ($($solver:ident => $variant:ident),* $(,)?) => {$(
        impl From<$solver> for Solver {
            fn from(solver: $solver) -> Self {
                Self::$variant(solver)
            }
        }
    )*};
}

from_solvers! {
    Ladder => Auto,
    LinAbf => LinAbf,
    AbfNewton => Newton,
    Uzawa => Uzawa,
    Minres => Minres,
    Barrier => Barrier,
    Descent => Descent,
    Hierarchical => Hierarchical,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_one_solver_and_its_name_leads_to_it() {
        assert_eq!(Solver::all().map(|solver| solver.kind()), SolverKind::ALL);
        for solver in Solver::all() {
            assert_eq!(solver.name().parse(), Ok(solver.clone()));
            assert_eq!(solver.kind().with_defaults(), Some(solver));
        }
        assert_eq!(SolverKind::Custom("linabf").with_defaults(), None, "only a value is a solver of your own");
    }

    #[test]
    fn a_kind_says_what_its_solver_can_be_told() {
        for solver in Solver::all() {
            let kind = solver.kind();
            assert_eq!(kind.has_a_fixed_target(), solver.newton_settings().is_some(), "{kind}");
            assert_eq!(kind.iterates_inside(), solver.iterative_settings().is_some(), "{kind}");
            assert_eq!(kind.makes_passes(), solver.passes().is_some(), "{kind}");
            assert_eq!(kind.has_a_barrier(), solver.barrier_floor().is_some(), "{kind}");
            let mut same = solver.clone();
            let parts = same.parts_mut();
            assert_eq!(parts.newton.copied(), solver.newton_settings(), "{kind}");
            assert_eq!(parts.iterative.copied(), solver.iterative_settings(), "{kind}");
            assert_eq!(parts.linabf.map(|linabf| linabf.passes), solver.passes(), "{kind}");
            assert_eq!(parts.barrier.is_some() || parts.descent.is_some(), kind.has_a_barrier(), "{kind}");
            let is_alone = kind.keeps_constraints() && kind != SolverKind::Auto && !kind.is_hierarchical();
            assert_eq!(solver.angle_solver().map(AngleSolver::name), is_alone.then_some(kind.name()));
        }
    }

    #[test]
    fn solvers_are_equal_when_they_are_the_same_with_the_same_settings() {
        let all = Solver::all();
        for (i, a) in all.iter().enumerate() {
            for (j, b) in all.iter().enumerate() {
                assert_eq!(a == b, i == j, "{a} and {b}");
            }
        }
        let own = Solver::custom(LinAbf::default());
        assert_eq!(own, own.clone());
        assert_ne!(own, Solver::custom(LinAbf::default()));
        assert_eq!(format!("{own:?}"), "Custom(\"linabf\")");
    }
}
