//! What is left of a coordinate in a file.

use abf_control::UnknownName;

/// What a format keeps of a coordinate.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    Hash,
    strum::Display,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantNames,
)]
#[strum(serialize_all = "kebab-case", parse_err_ty = UnknownName, parse_err_fn = unknown)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Precision {
    /// 24 bits, as graphics memory and some formats do.
    Single,
    /// 53 bits, all there are.
    #[default]
    Double,
}

impl Precision {
    /// The name on the command line and in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The coordinate as it is stored, to the nearest.
    #[must_use]
    pub fn round(self, x: f64) -> f64 {
        match self {
            Self::Single => f64::from(x as f32),
            Self::Double => x,
        }
    }

    /// The distance from 1 to the next number: one unit in the last place of `x` is at most `ε |x|`.
    #[must_use]
    pub const fn epsilon(self) -> f64 {
        match self {
            Self::Single => f32::EPSILON as f64,
            Self::Double => f64::EPSILON,
        }
    }
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<Precision>("precision", given)
}
