//! The solvers by name.

use abf_control::UnknownName;
use std::fmt;
use std::str::FromStr;

/// Which solver, without its settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SolverKind {
    /// A ladder of the others, up to the first result that is certified: see [`RungReport`](crate::RungReport).
    #[default]
    Auto,
    /// Linear ABF (Zayer, Lévy, Seidel 2007).
    LinAbf,
    /// ABF as published in 2001 (Sheffer, de Sturler): product wheel, exact Hessian, whole matrix.
    Abf,
    /// ABF++ (Sheffer, Lévy, Mogilnitsky, Bogomyakov 2005): product wheel, Gauss–Newton, reduced.
    AbfPlusPlus,
    /// Newton's method with the log wheel and the exact Hessian (ZRS05), solved directly.
    AbfNewton,
    /// Log wheel, Gauss–Newton, the target of ABF kept.
    AbfFixedTarget,
    /// Newton's method solved by conjugate-direction Uzawa (Zayer, Rössl, Seidel 2004).
    Uzawa,
    /// Newton's method solved by MINRES (Zayer, Rössl, Seidel 2004).
    Minres,
    /// Interior point in angle space: a log barrier at 0 and π, a filter, restoration.
    Barrier,
    /// Descent over the positions of the vertices, from Tutte's embedding through drawings without flips only: no
    /// layout, the positions are the unknowns.
    Descent,
    /// Hierarchical ABF++ (Sheffer, Lévy, Mogilnitsky, Bogomyakov 2005), reconstructed: ABF++ on a coarse version of the
    /// mesh, whose drawing is carried back. The positions are the result.
    HabfPlusPlus,
    /// Linear ABF that linearises at the angles of a coarse drawing, carried back.
    HLinAbf,
    /// Least squares conformal maps (Lévy et al. 2002): no angles are solved for, the layout alone
    /// does the work.
    Lscm,
    /// A solver of a user's own, by its name: [`Solver::Custom`](crate::Solver::Custom).
    Custom(&'static str),
}

impl SolverKind {
    /// Every solver of this library, in the order of the documentation.
    pub const ALL: [Self; 13] = [
        Self::Auto,
        Self::LinAbf,
        Self::Abf,
        Self::AbfPlusPlus,
        Self::AbfNewton,
        Self::AbfFixedTarget,
        Self::Uzawa,
        Self::Minres,
        Self::Barrier,
        Self::Descent,
        Self::HabfPlusPlus,
        Self::HLinAbf,
        Self::Lscm,
    ];

    /// The name on the command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::LinAbf => "linabf",
            Self::Abf => "abf",
            Self::AbfPlusPlus => "abf++",
            Self::AbfNewton => "abf-newton",
            Self::AbfFixedTarget => "abf-fixed-target",
            Self::Uzawa => "uzawa",
            Self::Minres => "minres",
            Self::Barrier => "barrier",
            Self::Descent => "descent",
            Self::HabfPlusPlus => "habf++",
            Self::HLinAbf => "hlinabf",
            Self::Lscm => "lscm",
            Self::Custom(name) => name,
        }
    }

    /// Whether it solves for angles at all.
    #[must_use]
    pub const fn finds_angles(self) -> bool {
        match self {
            Self::Auto
            | Self::LinAbf
            | Self::Abf
            | Self::AbfPlusPlus
            | Self::AbfNewton
            | Self::AbfFixedTarget
            | Self::Uzawa
            | Self::Minres
            | Self::Barrier
            | Self::Descent
            | Self::HabfPlusPlus
            | Self::HLinAbf
            | Self::Custom(_) => true,
            Self::Lscm => false,
        }
    }

    /// Whether it keeps angles to constraints that have to be met. The descent keeps them by construction.
    #[must_use]
    pub const fn keeps_constraints(self) -> bool {
        match self {
            Self::Auto
            | Self::LinAbf
            | Self::Abf
            | Self::AbfPlusPlus
            | Self::AbfNewton
            | Self::AbfFixedTarget
            | Self::Uzawa
            | Self::Minres
            | Self::Barrier
            | Self::HabfPlusPlus
            | Self::HLinAbf
            | Self::Custom(_) => true,
            Self::Descent | Self::Lscm => false,
        }
    }

    /// Whether it makes passes, with a target that moves.
    #[must_use]
    pub const fn makes_passes(self) -> bool {
        match self {
            Self::Auto | Self::LinAbf => true,
            Self::Abf
            | Self::AbfPlusPlus
            | Self::AbfNewton
            | Self::AbfFixedTarget
            | Self::Uzawa
            | Self::Minres
            | Self::Barrier
            | Self::Descent
            | Self::HabfPlusPlus
            | Self::HLinAbf
            | Self::Lscm
            | Self::Custom(_) => false,
        }
    }

    /// Whether it keeps what is asked of the boundary; of the ladder some of its solvers do. One of a user's own says so
    /// itself: [`AngleSolver::keeps_boundary`](abf_solve_core::AngleSolver::keeps_boundary).
    #[must_use]
    pub const fn keeps_boundary(self) -> bool {
        match self {
            Self::Auto | Self::LinAbf | Self::Barrier | Self::Custom(_) => true,
            Self::Abf
            | Self::AbfPlusPlus
            | Self::AbfNewton
            | Self::AbfFixedTarget
            | Self::Uzawa
            | Self::Minres
            | Self::Descent
            | Self::HabfPlusPlus
            | Self::HLinAbf
            | Self::Lscm => false,
        }
    }

    /// Whether the error of its passes can be bounded. The ladder leaves that out.
    #[must_use]
    pub const fn bounds_errors(self) -> bool {
        matches!(self, Self::LinAbf)
    }

    /// Whether a barrier keeps it away from angles of 0 and π.
    #[must_use]
    pub const fn has_a_barrier(self) -> bool {
        match self {
            Self::Auto | Self::Barrier | Self::Descent => true,
            Self::LinAbf
            | Self::Abf
            | Self::AbfPlusPlus
            | Self::AbfNewton
            | Self::AbfFixedTarget
            | Self::Uzawa
            | Self::Minres
            | Self::HabfPlusPlus
            | Self::HLinAbf
            | Self::Lscm
            | Self::Custom(_) => false,
        }
    }

    /// Whether its steps are solved by iterations.
    #[must_use]
    pub const fn iterates_inside(self) -> bool {
        match self {
            Self::Uzawa | Self::Minres => true,
            Self::Auto
            | Self::LinAbf
            | Self::Abf
            | Self::AbfPlusPlus
            | Self::AbfNewton
            | Self::AbfFixedTarget
            | Self::Barrier
            | Self::Descent
            | Self::HabfPlusPlus
            | Self::HLinAbf
            | Self::Lscm
            | Self::Custom(_) => false,
        }
    }

    /// Whether it coarsens the mesh first.
    #[must_use]
    pub const fn is_hierarchical(self) -> bool {
        matches!(self, Self::HabfPlusPlus | Self::HLinAbf)
    }

    /// Whether it is a point of the grid of [`NewtonSettings`](abf_solve_core::NewtonSettings): it minimises an energy with a
    /// fixed target, step by step.
    #[must_use]
    pub const fn has_a_fixed_target(self) -> bool {
        match self {
            Self::Abf | Self::AbfPlusPlus | Self::AbfNewton | Self::AbfFixedTarget | Self::Uzawa | Self::Minres => true,
            Self::Auto
            | Self::LinAbf
            | Self::Barrier
            | Self::Descent
            | Self::HabfPlusPlus
            | Self::HLinAbf
            | Self::Lscm
            | Self::Custom(_) => false,
        }
    }

    /// What one of its iterations is called, in the singular and the plural.
    #[must_use]
    pub const fn iteration_names(self) -> [&'static str; 2] {
        match self {
            Self::LinAbf | Self::HLinAbf => ["pass", "passes"],
            Self::Descent => ["step", "steps"],
            Self::Auto
            | Self::Abf
            | Self::AbfPlusPlus
            | Self::AbfNewton
            | Self::AbfFixedTarget
            | Self::Uzawa
            | Self::Minres
            | Self::Barrier
            | Self::HabfPlusPlus
            | Self::Lscm
            | Self::Custom(_) => ["iteration", "iterations"],
        }
    }
}

impl fmt::Display for SolverKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for SolverKind {
    type Err = UnknownName;

    fn from_str(s: &str) -> Result<Self, UnknownName> {
        Self::ALL.into_iter().find(|kind| kind.name() == s).ok_or_else(|| UnknownName::new("solver", s, &NAMES))
    }
}

/// The names of the solvers of this library.
const NAMES: [&str; SolverKind::ALL.len()] = {
    let mut names = [""; SolverKind::ALL.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = SolverKind::ALL[i].name();
        i += 1;
    }
    names
};

/// Its name. Only those of this library can be read back.
#[cfg(feature = "serde")]
impl serde::Serialize for SolverKind {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for SolverKind {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
        name.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back_and_unknown_ones_list_the_known() {
        for kind in SolverKind::ALL {
            assert_eq!(kind.name().parse(), Ok(kind));
        }
        let e = "slim".parse::<SolverKind>().unwrap_err();
        assert!(e.to_string().contains("auto, linabf, abf, abf++"), "{e}");
    }
}
