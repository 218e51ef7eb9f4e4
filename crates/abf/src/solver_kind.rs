//! The solvers by name.

use std::fmt;
use std::str::FromStr;

/// The methods there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SolverKind {
    /// Linear ABF (Zayer, Lévy, Seidel 2007).
    #[default]
    LinAbf,
    /// Least squares conformal maps (Lévy et al. 2002): no angles are solved for, the layout alone
    /// does the work.
    Lscm,
}

impl SolverKind {
    /// Every solver, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::LinAbf, Self::Lscm];

    /// The name on the command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LinAbf => "linabf",
            Self::Lscm => "lscm",
        }
    }
}

impl fmt::Display for SolverKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A solver name that does not exist, or not yet.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no solver '{name}' in this version; there are: {}", known())]
pub struct UnknownSolver {
    /// The name that was given.
    pub name: String,
}

fn known() -> String {
    SolverKind::ALL.map(SolverKind::name).join(", ")
}

impl FromStr for SolverKind {
    type Err = UnknownSolver;

    fn from_str(s: &str) -> Result<Self, UnknownSolver> {
        Self::ALL.into_iter().find(|kind| kind.name() == s).ok_or_else(|| UnknownSolver { name: s.to_owned() })
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
        assert!(e.to_string().contains("linabf, lscm"), "{e}");
    }
}
