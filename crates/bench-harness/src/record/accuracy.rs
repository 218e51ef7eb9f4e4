//! How exactly inner methods solve.

use super::misread::Misread;
use abf::InnerTolerance;
use std::fmt;
use std::str::FromStr;

/// A tolerance that the program chooses.
const AUTO: &str = "auto";

/// How exactly an inner method solves, as it is typed and shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct InnerAccuracy(
    /// As the library has it.
    pub(crate) InnerTolerance,
);

impl FromStr for InnerAccuracy {
    type Err = Misread;

    fn from_str(s: &str) -> Result<Self, Misread> {
        if s == AUTO {
            return Ok(Self(InnerTolerance::default()));
        }
        let fixed = s.parse().map(|tolerance| Self(InnerTolerance::Fixed(tolerance)));
        fixed.map_err(|_| Misread::new(format!("a number or '{AUTO}'"), s))
    }
}

impl fmt::Display for InnerAccuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            InnerTolerance::Fixed(tolerance) => write!(f, "{tolerance:e}"),
            InnerTolerance::Inexact { .. } => f.write_str(AUTO),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inner_tolerances_read_back() {
        for text in ["auto", "1e-6"] {
            assert_eq!(text.parse::<InnerAccuracy>().expect("a tolerance").to_string(), text);
        }
        assert!("tight".parse::<InnerAccuracy>().unwrap_err().to_string().contains("'auto'"));
    }
}
