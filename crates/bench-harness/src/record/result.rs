//! Everything about one mesh and one solver.

use super::atlas::Atlas;
use super::change::Change;
use super::failure::Failure;
use super::not_run::NotRun;
use super::outcome::{Outcome, result_word};
use super::quality::Quality;
use super::repacked::Repacked;
use super::run::RunRecord;
use super::size::{Kkt, Size};
use super::times::{Repeats, Timings};
use serde::{Deserialize, Serialize};

/// Everything there is to say about one mesh and one solver.
///
/// Parts that do not apply are absent from the JSON: a judged file has no solver, a mesh that
/// failed has what was known before. Numbers that are not finite are `null`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    /// The file.
    pub(crate) mesh: String,
    /// How large the mesh is.
    #[serde(flatten)]
    pub(crate) size: Option<Size>,
    /// The solver's name; none where no solver is to blame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) solver: Option<String>,
    /// What the solver and the layout did; of charts, all together.
    #[serde(flatten)]
    pub(crate) run: Option<RunRecord>,
    /// The charts, where the mesh was cut into some.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) atlas: Option<Atlas>,
    /// The islands of a file, laid out anew.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) repacked: Option<Repacked>,
    /// How valid and how distorted the UVs are.
    #[serde(flatten)]
    pub(crate) quality: Option<Quality>,
    /// How large the KKT matrix is in either wheel form.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) kkt: Option<Kkt>,
    /// What reading and writing did beyond copying; what was repaired is in `atlas`.
    pub(crate) notes: Vec<String>,
    /// What to try next.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) hint: Option<String>,
    /// Where the time went.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) timings_s: Option<Timings>,
    /// How far the times of several runs are apart.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) repeats: Option<Repeats>,
    /// See [`crate::run::memory`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) peak_memory_bytes: Option<usize>,
    /// What was expected of it, see [`abf::predict_memory`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) predicted_memory_bytes: Option<u64>,
    /// What changed since an earlier comparison.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) baseline: Option<Change>,
    /// The files that were written.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) written: Vec<String>,
    /// Why the solver was left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) not_run: Option<NotRun>,
    /// Why there is no result, or why it is not written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<Failure>,
}

impl Record {
    /// How it went. A solver that was left out did nothing wrong.
    pub(crate) fn outcome(&self) -> Outcome {
        let as_asked = self.termination().is_none_or(abf::Termination::is_as_asked);
        let is_kept = |quality: &Quality| quality.valid && quality.lost == 0;
        let valid = self.quality.as_ref().is_some_and(is_kept) || self.not_run.is_some();
        let as_asked = as_asked && self.atlas.as_ref().is_none_or(|atlas| self.is_as_asked(atlas));
        match &self.error {
            Some(failure) if !failure.is_cancelled() => Outcome::Failed,
            None if as_asked && valid => Outcome::AsAsked,
            _ => Outcome::NotAsAsked,
        }
    }

    fn is_as_asked(&self, atlas: &Atlas) -> bool {
        // No chart over another, either.
        let is_apart = self.quality.as_ref().is_none_or(|quality| quality.injective);
        atlas.is_as_asked() && (is_apart || atlas.may_overlap)
    }

    /// One word, or two, on how it went.
    pub(crate) fn result_word(&self) -> String {
        if let Some(not_run) = &self.not_run {
            return format!("not run: {}", not_run.kind);
        }
        let valid = self.quality.as_ref().is_some_and(|quality| quality.valid);
        let is_lost = self.quality.as_ref().is_some_and(|quality| quality.lost > 0);
        let lost = if is_lost && self.error.is_none() { ", triangles lost" } else { "" };
        let termination = self.termination().map(|end| end.to_string());
        let word = result_word(self.error.as_ref().map(|failure| failure.kind), termination.as_deref(), valid);
        word + lost
    }

    /// How the solver ended; of several charts, on the first that did not go as asked.
    pub(crate) fn termination(&self) -> Option<abf::Termination> {
        self.run.as_ref().map(|run| run.termination)
    }

    /// Whether the user stopped it.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.termination() == Some(abf::Termination::Cancelled)
            || self.error.as_ref().is_some_and(Failure::is_cancelled)
    }
}
