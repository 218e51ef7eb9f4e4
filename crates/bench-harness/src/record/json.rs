//! Records as JSON documents.

use super::result::Record;
use serde::Serialize;

/// The name of the JSON's format; the number goes up when a field changes its meaning.
pub(crate) const SCHEMA: &str = "bench-harness/1";

/// The records as a JSON document.
pub(crate) fn to_json(records: &[Record]) -> String {
    #[derive(Serialize)]
    struct Document<'a> {
        schema: &'static str,
        results: &'a [Record],
    }
    pretty(&Document { schema: SCHEMA, results: records })
}

/// Any document as JSON, with a line end.
pub(crate) fn pretty(document: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(document).expect("documents have text keys only");
    text.push('\n');
    text
}
