//! Records as JSON documents.

use super::head::Head;
use super::result::Record;
use serde::{Deserialize, Serialize};

/// The name of the JSON's format; the number goes up when a field changes its meaning.
pub(crate) const SCHEMA: &str = "bench-harness/3";

/// The document of every command but `survey`, which has more to say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Document {
    /// What made it.
    #[serde(flatten)]
    pub(crate) head: Head,
    /// The results, in order.
    pub(crate) results: Vec<Record>,
}

/// The records as a JSON document.
pub(crate) fn to_json(records: &[Record]) -> String {
    pretty(&Document { head: Head::new(SCHEMA), results: records.to_vec() })
}

/// Any document as JSON, with a line end.
pub(crate) fn pretty(document: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(document).expect("documents have text keys only");
    text.push('\n');
    text
}
