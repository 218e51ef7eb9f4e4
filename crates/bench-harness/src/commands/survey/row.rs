//! One mesh of a survey, as it is written, shown and read again.

use crate::record::number::{count, seconds};
use crate::record::{Outcome, Record};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;
use std::time::UNIX_EPOCH;

/// What tells whether a file is still the same.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct FileState {
    bytes: u64,
    /// Nanoseconds since 1970.
    modified_ns: u64,
}

impl FileState {
    /// The state of a file now; `None` where it cannot be told.
    pub(super) fn of(path: &Path) -> Option<Self> {
        let about = fs::metadata(path).ok()?;
        let since = about.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
        Some(Self { bytes: about.len(), modified_ns: u64::try_from(since.as_nanos()).ok()? })
    }
}

/// What a survey shows of a result. Read from its JSON, whether that is of now or of an earlier run; what
/// is not in it is absent or zero.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Row {
    pub(crate) mesh: String,
    pub(crate) triangles: Option<usize>,
    pub(crate) solver: Option<String>,
    /// Whose result it is, of a solver that tries several.
    pub(super) solved_by: Option<String>,
    pub(crate) result: String,
    pub(crate) valid: bool,
    pub(crate) injective: bool,
    pub(crate) flips: usize,
    pub(crate) collapsed: usize,
    pub(crate) wound: usize,
    pub(crate) overlaps: usize,
    pub(crate) f: Option<f64>,
    pub(crate) stretch_l2: Option<f64>,
    pub(super) timings_s: Option<Seconds>,
    pub(crate) refused: Option<String>,
    pub(crate) converged: bool,
    pub(super) error: Option<Error>,
    pub(super) file: Option<FileState>,
    /// What was tried, of a solver that tries several.
    pub(super) rungs: Vec<Rung>,
    /// The charts, of what is no disk.
    pub(super) atlas: Option<Atlas>,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Atlas {
    charts: Vec<Chart>,
}

#[derive(Clone, Debug, Deserialize)]
struct Chart {
    solved_by: String,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Rung {
    solver: String,
    time_s: f64,
}

#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct Seconds {
    total: f64,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Error {
    message: String,
    hint: String,
}

impl Row {
    /// The solver, and what it came down to where it has several methods.
    pub(crate) fn method(&self) -> Option<String> {
        let solver = self.solver.as_deref()?;
        if let Some(Atlas { charts }) = &self.atlas {
            let mut by: Vec<&str> = charts.iter().map(|chart| chart.solved_by.as_str()).collect();
            by.sort_unstable();
            by.dedup();
            return Some(format!("{solver}: {} by {}", count(charts.len(), "chart", "charts"), by.join(", ")));
        }
        Some(match self.solved_by.as_deref().filter(|&rung| rung != solver) {
            Some(rung) => format!("{solver}: {rung}"),
            None => solver.to_owned(),
        })
    }

    /// How long each of the methods that were tried took, where a solver tries several.
    pub(crate) fn rungs(&self) -> Option<String> {
        let times = self.rungs.iter().map(|rung| format!("{} {}", rung.solver, seconds(rung.time_s)));
        (!self.rungs.is_empty()).then(|| times.collect::<Vec<_>>().join(", "))
    }

    /// How long it took, reading and judging included.
    pub(crate) fn seconds(&self) -> Option<f64> {
        self.timings_s.map(|seconds| seconds.total)
    }

    /// What is wrong with it and what to try next, if there is no result.
    pub(super) fn failure(&self) -> Option<String> {
        self.error.as_ref().map(|error| format!("{}: {}", error.message, error.hint))
    }
}

/// A finished mesh.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// What is shown of it.
    pub(super) row: Row,
    /// All of it: one line of JSON.
    pub(super) json: String,
}

/// The record of a mesh with what only a survey says.
#[derive(Serialize)]
struct Finished<'a> {
    #[serde(flatten)]
    record: &'a Record,
    /// One word, or two.
    result: String,
    converged: bool,
    /// Why there is no result, in the words that are counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<&'static str>,
    /// Absent where it cannot be told whether the file is the same later.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<FileState>,
}

impl Entry {
    /// The entry of a mesh that has just been done.
    pub(super) fn new(record: &Record, file: Option<FileState>) -> Self {
        let refused = refused(record);
        let converged = record.termination().is_some_and(abf::Termination::is_as_asked);
        let finished = Finished { record, result: record.result_word(), converged, refused, file };
        let json = serde_json::to_string(&finished).expect("records have text keys only");
        Self::read(json).expect("a record reads back")
    }

    /// An entry that was written; `None` for what is none, such as half of one.
    pub(super) fn read(json: String) -> Option<Self> {
        let row: Row = serde_json::from_str(&json).ok()?;
        (!row.mesh.is_empty()).then_some(Self { row, json })
    }

    /// Whether more memory, and nothing else, may change it.
    pub(super) fn is_for_want_of_memory(&self) -> bool {
        self.row.refused.as_deref() == Some(MEMORY)
    }
}

const MEMORY: &str = "memory";

/// Why a mesh has no result, in few classes; `None` where it has one.
fn refused(record: &Record) -> Option<&'static str> {
    let failure = record.error.as_ref().filter(|_| record.outcome() == Outcome::Failed)?;
    Some(match failure.kind {
        "memory" | "out-of-memory" => MEMORY,
        "internal" => "internal error",
        // The size of whatever could be read is known.
        _ if record.size.is_none() => "unreadable",
        "several-components" | "closed" | "several-boundaries" | "handles" | "not-a-disk" => "not a disk",
        "non-manifold-edge"
        | "non-manifold-vertex"
        | "inconsistent-orientation"
        | "non-orientable"
        | "repeated-vertex"
        | "topology" => "not manifold",
        "zero-area" | "not-finite" | "degenerate-angle" | "geometry" | "no-area" => "degenerate",
        "too-large" => "too large",
        _ => "no result",
    })
}
