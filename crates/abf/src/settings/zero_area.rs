//! What becomes of faces without area.

use abf_control::UnknownName;

/// What becomes of faces without area.
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
    pub fn name(self) -> &'static str {
        self.into()
    }
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<ZeroArea>("rule for faces without area", given)
}
