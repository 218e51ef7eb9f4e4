//! What becomes of a map that lies over itself.

use abf_control::UnknownName;

/// What becomes of a map that lies over itself. One that does not is left as it is.
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
pub enum Injective {
    /// It stays, and the certificate counts the overlaps. Charts of [`Unwrap`](crate::Unwrap) have a rule of their own.
    #[default]
    Off,
    /// It is parted along the overlap into several charts, side by side. In [`Unwrap`](crate::Unwrap) the same as `Off`.
    Split,
    /// It is made anew from Tutte's embedding, which does not lie over itself, through maps that do not: first for lengths, then
    /// for the energy of [`Pipeline::relax`](crate::Pipeline::relax), or that of ABF.
    Deform,
}

impl Injective {
    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Whether it is the default.
    #[cfg(feature = "serde")]
    pub(crate) fn is_off(&self) -> bool {
        *self == Self::Off
    }
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<Injective>("rule for maps that lie over themselves", given)
}
