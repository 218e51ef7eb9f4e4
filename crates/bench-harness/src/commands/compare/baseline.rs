//! What changed since an earlier comparison.

use crate::record::failure::Failure;
use crate::record::number::count;
use crate::record::{Change, Document, Record, SCHEMA};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The results of an earlier comparison by mesh and solver. A mesh without results has no solver.
#[derive(Debug)]
pub(crate) struct Baseline {
    file: String,
    results: BTreeMap<Key, Record>,
}

type Key = (String, Option<String>);

impl Baseline {
    /// Reads the JSON of an earlier comparison.
    ///
    /// # Errors
    /// When it cannot be read or is something else.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        /// What tells whether the rest can be understood.
        #[derive(Deserialize)]
        struct Top {
            schema: String,
        }
        let text = fs::read_to_string(path).map_err(|error| Failure::unreadable(path, &error))?;
        let text = abf_mesh::text::without_mark(&text);
        let none = |error: serde_json::Error| Failure::no_baseline(path, &error.to_string());
        let top: Top = serde_json::from_str(text).map_err(none)?;
        if top.schema != SCHEMA {
            return Err(Failure::no_baseline(path, &format!("its \"schema\" is not \"{SCHEMA}\"")));
        }
        let document: Document = serde_json::from_str(text).map_err(none)?;
        let results = document.results.into_iter().map(|record| (key(&record), record)).collect();
        Ok(Self { file: path.display().to_string(), results })
    }

    /// What changed in this result.
    pub(super) fn change(&self, record: &Record) -> Change {
        let earlier = self.results.get(&key(record));
        let figures = |of: &Record| of.quality.as_ref().map(|quality| (quality.f, quality.stretch_l2));
        let [now, then] = [Some(record), earlier].map(|record| record.and_then(figures));
        let flips = |of: &Record| of.quality.as_ref().map(|quality| quality.flips as i64);
        let seconds = |of: &Record| of.timings_s.map(|timings| timings.stages.flatten);
        Change {
            result: earlier.map_or_else(|| Change::NEW.to_owned(), Record::result_word),
            f_ratio: ratio(now.map(|(f, _)| f), then.map(|(f, _)| f)),
            stretch_l2_ratio: ratio(now.map(|(_, l2)| l2), then.map(|(_, l2)| l2)),
            flips_change: flips(record).zip(earlier.and_then(flips)).map(|(now, then)| now - then),
            time_ratio: ratio(seconds(record), earlier.and_then(seconds)),
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

fn key(record: &Record) -> Key {
    (record.mesh.clone(), record.solver.clone())
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
    Some(if new == old { 1.0 } else { new / old }).filter(|ratio| ratio.is_finite())
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
}
