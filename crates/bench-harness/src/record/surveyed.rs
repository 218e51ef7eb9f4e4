//! One mesh of a survey, and the survey as a whole: as they are written, shown and read again.

use super::head::{Head, Program};
use super::kind::Refused;
use super::outcome::Outcome;
use super::result::Record;
use super::settings::Asked;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::UNIX_EPOCH;

/// The document of a survey.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SurveyDocument {
    /// What made it.
    #[serde(flatten)]
    pub(crate) head: Head,
    /// How it was made, and what was counted.
    pub(crate) survey: About,
    /// The results, in the order of the meshes.
    pub(crate) results: Vec<Surveyed>,
}

/// What a survey says of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct About {
    /// The solver's name.
    pub(crate) solver: String,
    /// What its results depend on.
    pub(crate) made_with: MadeWith,
    /// What was counted.
    #[serde(flatten)]
    pub(crate) counts: Counts,
}

/// What the results of a survey depend on: two surveys that agree in it can be one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MadeWith {
    /// The program.
    pub(crate) program: Program,
    /// The solver's name.
    pub(crate) solver: String,
    /// Its settings. How many threads there are makes no difference, nor how much memory.
    pub(crate) settings: Asked,
    /// Whether what is no disk is refused.
    pub(crate) disks_only: bool,
}

impl MadeWith {
    /// The first setting in which two surveys differ: its name, and its value in either.
    pub(crate) fn difference(&self, now: &Self) -> Option<[String; 3]> {
        let listed = |of: &Self| {
            let mut all = vec![("version of the program".to_owned(), of.program.version.clone())];
            all.push(("solver".to_owned(), of.solver.clone()));
            // What was refused for want of memory is tried again anyway.
            all.extend(of.settings.listed().into_iter().filter(|(name, _)| name != "max_memory"));
            all.push(("disks_only".to_owned(), of.disks_only.to_string()));
            all.into_iter().collect::<Vec<_>>()
        };
        let (before, now) = (listed(self), listed(now));
        let value = |list: &[(String, String)], name: &str| {
            list.iter().find(|(other, _)| other == name).map_or_else(|| "none".to_owned(), |(_, value)| value.clone())
        };
        let names = before.iter().chain(&now).map(|(name, _)| name);
        let mut pairs = names.map(|name| [name.clone(), value(&before, name), value(&now, name)]);
        pairs.find(|[_, before, now]| before != now)
    }
}

/// How many meshes are what. A result may be several things at once: flipped, overlapping, not converged.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Counts {
    /// Meshes there are.
    pub(crate) meshes: usize,
    /// Meshes that are done; the others were not begun when the survey was stopped.
    pub(crate) done: usize,
    /// No triangle flipped or collapsed, no vertex wound around.
    pub(crate) valid: usize,
    /// Valid, and without overlap.
    pub(crate) injective: usize,
    /// With flipped triangles.
    pub(crate) flipped: usize,
    /// With collapsed triangles.
    pub(crate) collapsed: usize,
    /// With vertices wound around twice.
    pub(crate) wound: usize,
    /// That overlap themselves, valid or not.
    pub(crate) overlapping: usize,
    /// Results, valid or not, of a solver that did not end as asked.
    pub(crate) not_converged: usize,
    /// Without a result, by reason.
    pub(crate) refused: BTreeMap<Refused, usize>,
}

/// The first line of the log of a survey.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct LogHead {
    /// The name of the format.
    pub(crate) schema: String,
    /// What the results depend on.
    pub(crate) made_with: MadeWith,
}

/// The record of a mesh with what only a survey says: a line of its log, and a result of its document.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Surveyed {
    /// Everything about it.
    #[serde(flatten)]
    pub(crate) record: Record,
    /// One word, or two.
    pub(crate) result: String,
    /// Whether the solver ended as asked.
    pub(crate) converged: bool,
    /// Why there is no result, in the words that are counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) refused: Option<Refused>,
    /// Absent where it cannot be told whether the file is the same later.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) file: Option<FileState>,
}

impl Surveyed {
    /// The entry of a mesh that has just been done.
    pub(crate) fn new(record: Record, file: Option<FileState>) -> Self {
        let failure = record.error.as_ref().filter(|_| record.outcome() == Outcome::Failed);
        // The size of whatever could be read is known.
        let refused = failure.map(|failure| failure.kind.refused(record.size.is_some()));
        let converged = record.termination().is_some_and(abf::Termination::is_as_asked);
        Self { result: record.result_word(), converged, refused, file, record }
    }
}

/// What tells whether a file is still the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct FileState {
    /// How long it is.
    pub(crate) bytes: u64,
    /// When it was changed, in nanoseconds since 1970.
    pub(crate) modified_ns: u64,
}

impl FileState {
    /// The state of a file now; `None` where it cannot be told.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let about = fs::metadata(path).ok()?;
        let since = about.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
        Some(Self { bytes: about.len(), modified_ns: u64::try_from(since.as_nanos()).ok()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf::{Ladder, LinAbf, Pipeline, StopCriteria};

    #[test]
    fn the_setting_that_differs_is_named_with_both_values() {
        let made_with = |pipeline: &Pipeline| MadeWith {
            program: Program::this(),
            solver: pipeline.solver.name().to_owned(),
            settings: Asked::new(pipeline),
            disks_only: false,
        };
        let plain = made_with(&Pipeline::default());
        let linabf = LinAbf { passes: "1".parse().expect("one"), ..LinAbf::default() };
        let one_pass = Ladder { linabf, ..Ladder::default() };
        let tight = StopCriteria { tolerance: 1e-9, ..StopCriteria::default() };
        for (other, expected) in [
            (Pipeline { solver: LinAbf::default().into(), ..Pipeline::default() }, ["solver", "auto", "linabf"]),
            (Pipeline { solver: one_pass.into(), ..Pipeline::default() }, ["linabf.passes", "auto", "1"]),
            (Pipeline { stop: tight, ..Pipeline::default() }, ["stop.tolerance", "1e-8", "1e-9"]),
            (Pipeline { normalize: true, ..Pipeline::default() }, ["normalize", "false", "true"]),
        ] {
            assert_eq!(plain.difference(&made_with(&other)), Some(expected.map(str::to_owned)));
        }
        assert_eq!(plain.difference(&plain), None);
        assert_eq!(plain.difference(&made_with(&Pipeline { max_memory: Some(1), ..Pipeline::default() })), None);
        let mut threads = plain.settings.clone();
        threads.threads += 1;
        assert_eq!(plain.difference(&MadeWith { settings: threads, ..plain.clone() }), None);
        let old = MadeWith { program: Program { version: "0.0.9".to_owned(), ..Program::this() }, ..plain.clone() };
        let (before, now) = ("0.0.9".to_owned(), Program::this().version);
        assert_eq!(old.difference(&plain), Some(["version of the program".to_owned(), before, now]));
    }
}
