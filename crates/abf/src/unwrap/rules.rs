//! How seams are made, and what becomes of holes.

use abf_control::UnknownName;
use abf_cut::HoleFilling;
use std::fmt;
use std::str::FromStr;

/// Where seams come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, strum::Display, strum::EnumString, strum::VariantNames)]
#[strum(serialize_all = "kebab-case", parse_err_ty = UnknownName, parse_err_fn = unknown_seams)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum SeamRule {
    /// From the shape and the stretch.
    #[default]
    Auto,
    /// Those of [`SurfaceHints`](super::SurfaceHints): the seams of the UV map, the borders of the labels, and the
    /// seams that are marked. What they leave is cut further only
    /// where it is no disk, or misses the aim.
    Keep,
}

/// What becomes of holes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum HoleRule {
    /// By what comes of it: left as they are where the map is valid, injective and within the aim; else joined by seams;
    /// else closed.
    #[default]
    Auto,
    /// Closed by virtual faces while the chart is flattened, until a seam reaches their rim; they are dropped after.
    Fill(HoleFilling),
    /// Joined by seams.
    Cut,
    /// Left as they are in components without handles where that comes to a map within the aim, else joined by seams: the
    /// angle conditions of a disk, which do not say that a hole closes, and least squares.
    Free,
}

fn unknown_seams(given: &str) -> UnknownName {
    UnknownName::of::<SeamRule>("rule for seams", given)
}

impl fmt::Display for HoleRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Fill(filling) => write!(f, "fill-{filling}"),
            Self::Cut => f.write_str("cut"),
            Self::Free => f.write_str("free"),
        }
    }
}

impl FromStr for HoleRule {
    type Err = UnknownName;

    fn from_str(s: &str) -> Result<Self, UnknownName> {
        match s {
            "auto" => Ok(Self::Auto),
            "fill" => Ok(Self::Fill(HoleFilling::default())),
            "fill-fan" => Ok(Self::Fill(HoleFilling::Fan)),
            "fill-ears" => Ok(Self::Fill(HoleFilling::Ears)),
            "cut" => Ok(Self::Cut),
            "free" => Ok(Self::Free),
            _ => {
                let known = &["auto", "fill", "fill-fan", "fill-ears", "cut", "free"];
                Err(UnknownName::new("rule for holes", s, known))
            }
        }
    }
}
