//! What changed since an earlier comparison.

use crate::record::failure::Failure;
use crate::record::number::count;
use crate::record::{Change, Quality, Record, SCHEMA, result_word};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The results of an earlier comparison by mesh and solver. A mesh without results has no solver.
#[derive(Debug)]
pub(crate) struct Baseline {
    file: String,
    results: BTreeMap<(String, Option<String>), Earlier>,
}

/// What is kept of an earlier result.
#[derive(Clone, Debug, Default, PartialEq)]
struct Earlier {
    result: String,
    f: Option<f64>,
    stretch_l2: Option<f64>,
    flips: Option<i64>,
    flatten_s: Option<f64>,
}

impl Baseline {
    /// Reads the JSON of an earlier comparison.
    ///
    /// # Errors
    /// When it cannot be read or is something else.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let text = fs::read_to_string(path).map_err(|error| Failure::unreadable(path, &error))?;
        let json: Value =
            serde_json::from_str(&text).map_err(|error| Failure::no_baseline(path, &error.to_string()))?;
        if json["schema"] != SCHEMA {
            return Err(Failure::no_baseline(path, &format!("its \"schema\" is not \"{SCHEMA}\"")));
        }
        let results = json["results"].as_array().map(Vec::as_slice).unwrap_or_default();
        let keyed = results.iter().filter_map(|result| {
            let solver = result["solver"].as_str().map(str::to_owned);
            Some(((result["mesh"].as_str()?.to_owned(), solver), Earlier::new(result)))
        });
        Ok(Self { file: path.display().to_string(), results: keyed.collect() })
    }

    /// What changed in this result.
    pub(super) fn change(&self, record: &Record) -> Change {
        let earlier = self.results.get(&key(record)).cloned();
        let earlier = earlier.unwrap_or_else(|| Earlier { result: Change::NEW.to_owned(), ..Earlier::default() });
        let metrics = record.quality.as_ref().map(Quality::metrics);
        Change {
            result: earlier.result,
            f_ratio: ratio(metrics.map(|m| m.f), earlier.f),
            stretch_l2_ratio: ratio(metrics.map(|m| m.stretch_l2), earlier.stretch_l2),
            flips_change: metrics.and_then(|m| Some(m.flips as i64 - earlier.flips?)),
            time_ratio: ratio(record.timings_s.map(|t| t.stages.flatten), earlier.flatten_s),
        }
    }

    /// How many results are as they were, in a sentence.
    pub(super) fn summary(&self, records: &[Record]) -> String {
        let is_new = |record: &&Record| !self.results.contains_key(&key(record));
        let has_changed = |record: &&Record| !is_new(record) && !is_as_before(record);
        let (new, changed) = (records.iter().filter(is_new).count(), records.iter().filter(has_changed).count());
        let known: Vec<_> = records.iter().map(key).collect();
        let gone = self.results.keys().filter(|key| !known.contains(key)).count();
        let same = count(records.len() - new - changed, "result as it was", "results as they were");
        format!("{}: {same}, {changed} changed, {new} new, {gone} not made now\n", self.file)
    }
}

impl Earlier {
    fn new(result: &Value) -> Self {
        let word = match result["not_run"]["kind"].as_str() {
            Some(kind) => format!("not run: {kind}"),
            None => result_word(
                result["error"]["kind"].as_str(),
                result["termination"].as_str(),
                result["valid"].as_bool().unwrap_or(false),
            ),
        };
        Self {
            result: word,
            f: result["f"].as_f64(),
            stretch_l2: result["stretch_l2"].as_f64(),
            flips: result["flips"].as_i64(),
            flatten_s: result["timings_s"]["flatten"].as_f64(),
        }
    }
}

fn key(record: &Record) -> (String, Option<String>) {
    (record.mesh.clone(), record.solver.map(str::to_owned))
}

/// Whether result, F, stretch and flips are what they were. Times never are.
fn is_as_before(record: &Record) -> bool {
    let Some(change) = &record.baseline else { return false };
    let is_one = |ratio: Option<f64>| ratio.is_none_or(|ratio| ratio == 1.0);
    let has_distortion = is_one(change.f_ratio) && is_one(change.stretch_l2_ratio);
    change.result == record.result_word() && has_distortion && change.flips_change.unwrap_or(0) == 0
}

/// New divided by old; 1 where they are the same, zero and infinity included.
fn ratio(new: Option<f64>, old: Option<f64>) -> Option<f64> {
    let (new, old) = (new?, old?);
    Some(if new == old { 1.0 } else { new / old })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_did_not_change_has_the_ratio_one_even_at_zero() {
        assert_eq!(ratio(Some(0.0), Some(0.0)), Some(1.0));
        assert_eq!(ratio(Some(3.0), Some(2.0)), Some(1.5));
        assert_eq!(ratio(Some(3.0), None), None);
    }

    #[test]
    fn earlier_results_are_named_as_results_are_now() {
        let word = |json: &str| Earlier::new(&serde_json::from_str(json).expect("JSON")).result;
        assert_eq!(word(r#"{"termination": "stalled", "valid": false}"#), "stalled, not valid");
        assert_eq!(word(r#"{"error": {"kind": "closed"}}"#), "error: closed");
        assert_eq!(word(r#"{"not_run": {"kind": "too large"}}"#), "not run: too large");
    }
}
