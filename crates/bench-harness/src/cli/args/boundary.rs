//! What the boundary is to look like, as it is typed.

use abf::{Boundary, SettingError};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// What stands before the name of a file of angles.
const ANGLES: &str = "angles=";

/// A rule for the boundary, or where its angles stand.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BoundaryRule {
    /// A rule that needs no file.
    Rule(Boundary),
    /// A file with one vertex and its angle on each line.
    File(PathBuf),
}

impl BoundaryRule {
    /// The file of angles, if it is one.
    pub(crate) fn file(&self) -> Option<&Path> {
        match self {
            Self::Rule(_) => None,
            Self::File(path) => Some(path),
        }
    }
}

impl FromStr for BoundaryRule {
    type Err = SettingError;

    fn from_str(s: &str) -> Result<Self, SettingError> {
        match s.strip_prefix(ANGLES).filter(|name| !name.is_empty()) {
            Some(name) => Ok(Self::File(name.into())),
            None => s.parse().map(Self::Rule),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_and_files_are_told_apart() {
        assert_eq!("convex".parse(), Ok(BoundaryRule::Rule(Boundary::Convex)));
        assert_eq!("angles=a=b.txt".parse(), Ok(BoundaryRule::File("a=b.txt".into())));
        for text in ["angles", "angles=", "oval"] {
            assert!(text.parse::<BoundaryRule>().unwrap_err().to_string().contains("angles=FILE"), "{text}");
        }
    }
}
