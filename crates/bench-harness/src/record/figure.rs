//! Numbers that may be infinite, which JSON cannot say: `null` stands for them.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The figure as a record keeps it: a finite number, or infinity for whatever is none.
pub(super) fn known(x: f64) -> f64 {
    if x.is_finite() { x } else { f64::INFINITY }
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
pub(super) fn serialize<S: Serializer>(x: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    Some(*x).filter(|x| x.is_finite()).serialize(serializer)
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}
