//! What becomes of faces without area.

use std::fmt;
use std::str::FromStr;

/// What becomes of faces without area.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ZeroArea {
    /// They get a valid place like all others; their angles, which they do not have, are those of a thin triangle
    /// ([`AngleProblem::new`](abf_constraints::AngleProblem::new)). Metrics leave them out and count them.
    #[default]
    Carry,
    /// The first is an error: [`GeometryError::ZeroArea`](abf_mesh::GeometryError::ZeroArea).
    Refuse,
}

impl ZeroArea {
    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Carry => "carry",
            Self::Refuse => "refuse",
        }
    }
}

impl fmt::Display for ZeroArea {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ZeroArea {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let known = [Self::Carry, Self::Refuse];
        known
            .into_iter()
            .find(|rule| rule.name() == s)
            .ok_or_else(|| format!("'{s}' is nothing to do with faces without area; there are: carry, refuse"))
    }
}
