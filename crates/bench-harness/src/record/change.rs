//! What changed in one result.

use serde::{Deserialize, Serialize};

/// One result beside the earlier one. `None` where one of them has no value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Change {
    /// How it went then; `"new"` if there was none.
    pub(crate) result: String,
    /// F now, divided by F then.
    pub(crate) f_ratio: Option<f64>,
    /// L² stretch now, divided by that then.
    pub(crate) stretch_l2_ratio: Option<f64>,
    /// Flips now, less those then.
    pub(crate) flips_change: Option<i64>,
    /// The time from mesh to UVs now, divided by that then.
    pub(crate) time_ratio: Option<f64>,
}

impl Change {
    /// What stands for a result that there was not.
    pub(crate) const NEW: &'static str = "new";
}
