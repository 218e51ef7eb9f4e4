//! What is known about one result: the one source of every table and of the JSON.

mod atlas;
mod quality;
mod run;
mod settings;
mod times;

use crate::compare::Change;
use crate::errors::Failure;
use crate::methods::NotRun;
use abf::KktCounts;
use abf_mesh::{Topology, TriMesh};
pub(crate) use atlas::{Atlas, Charted};
pub(crate) use quality::Quality;
pub(crate) use run::{Run, Rung};
use serde::{Serialize, Serializer};
pub(crate) use settings::Asked;
use std::fmt;
pub(crate) use times::{Repeats, Spread, Stages, Timings};

/// The name of the JSON's format; the number goes up when a field changes its meaning.
pub(crate) const SCHEMA: &str = "bench-harness/1";

/// Everything there is to say about one mesh and one solver.
///
/// Parts that do not apply are absent from the JSON: a judged file has no solver, a mesh that
/// failed has what was known before. Numbers that are not finite are `null`.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Record {
    /// The file.
    pub(crate) mesh: String,
    /// How large the mesh is.
    #[serde(flatten)]
    pub(crate) size: Option<Size>,
    /// The solver's name; none where no solver is to blame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) solver: Option<&'static str>,
    /// What the solver and the layout did.
    #[serde(flatten)]
    pub(crate) run: Option<Run>,
    /// The charts, where the mesh was cut into some.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) atlas: Option<Atlas>,
    /// How valid and how distorted the UVs are.
    #[serde(flatten)]
    pub(crate) quality: Option<Quality>,
    /// How large the KKT matrix is in either wheel form.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) kkt: Option<Kkt>,
    /// What reading did beyond copying.
    pub(crate) notes: Vec<String>,
    /// What to try next.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) hint: Option<String>,
    /// What is said of overlaps; the figures are in the JSON anyway.
    #[serde(skip)]
    pub(crate) overlap: Option<String>,
    /// What is said of the rungs of `auto`, likewise.
    #[serde(skip)]
    pub(crate) climb: Option<String>,
    /// What is said of the precision of doubles, likewise.
    #[serde(skip)]
    pub(crate) precision: Option<String>,
    /// Where the time went.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) timings_s: Option<Timings>,
    /// How far the times of several runs are apart.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) repeats: Option<Repeats>,
    /// See [`crate::memory`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) peak_memory_bytes: Option<usize>,
    /// What was expected of it, see [`abf::predict_memory`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) predicted_memory_bytes: Option<u64>,
    /// What changed since an earlier comparison.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) baseline: Option<Change>,
    /// The files that were written.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) written: Vec<String>,
    /// Why the solver was left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) not_run: Option<NotRun>,
    /// Why there is no result, or why it is not written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<Failure>,
}

/// The size of a mesh.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Size {
    /// Triangles, after polygons are cut.
    pub(crate) triangles: usize,
    /// Vertices, used or not.
    pub(crate) vertices: usize,
    /// Vertices with faces all around; `None` where the faces are no manifold.
    pub(crate) interior_vertices: Option<usize>,
    /// Boundary loops; `None` where the faces are no manifold.
    pub(crate) boundary_loops: Option<usize>,
}

impl Size {
    /// The size of a mesh of any kind.
    pub(crate) fn of(mesh: &TriMesh, topology: Option<&Topology>) -> Self {
        Self {
            triangles: mesh.face_count(),
            vertices: mesh.vertex_count(),
            interior_vertices: topology.map(Topology::interior_vertex_count),
            boundary_loops: topology.map(|t| t.boundary_loops().len()),
        }
    }
}

/// The counters of VMV04 fig. 2: the KKT matrix of the whole problem, which only `abf` assembles.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Kkt {
    /// `4 nt + 2 ni`.
    pub(crate) unknowns: usize,
    /// Entries that are not zero by construction, log wheel.
    pub(crate) nonzeros_log: usize,
    /// The same, product wheel.
    pub(crate) nonzeros_product: usize,
}

impl Kkt {
    /// The counters of the problem in its log and its product form.
    pub(crate) fn new([log, product]: [KktCounts; 2]) -> Self {
        Self { unknowns: log.unknowns, nonzeros_log: log.nonzeros, nonzeros_product: product.nonzeros }
    }
}

/// How it went, from good to bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Outcome {
    /// As asked, and valid.
    AsAsked,
    /// There is a result, but not converged or not valid; or the user stopped it.
    NotAsAsked,
    /// No result, or a file that could not be written.
    Failed,
}

impl Outcome {
    /// The exit code of the program.
    pub(crate) fn exit_code(self) -> u8 {
        match self {
            Self::AsAsked => 0,
            Self::NotAsAsked => 1,
            Self::Failed => 2,
        }
    }
}

impl Record {
    /// How it went. A solver that was left out did nothing wrong.
    pub(crate) fn outcome(&self) -> Outcome {
        let as_asked = self.termination().is_none_or(abf::Termination::is_as_asked);
        let valid = self.quality.as_ref().is_some_and(|quality| quality.valid) || self.not_run.is_some();
        match &self.error {
            Some(failure) if !failure.is_cancelled() => Outcome::Failed,
            None if as_asked && valid => Outcome::AsAsked,
            _ => Outcome::NotAsAsked,
        }
    }

    /// One word, or two, on how it went.
    pub(crate) fn result_word(&self) -> String {
        if let Some(not_run) = &self.not_run {
            return format!("not run: {}", not_run.kind);
        }
        let valid = self.quality.as_ref().is_some_and(|quality| quality.valid);
        let termination = self.termination().map(|end| end.to_string());
        result_word(self.error.as_ref().map(|failure| failure.kind), termination.as_deref(), valid)
    }

    /// How the solver ended; of several charts, on the first that did not go as asked.
    pub(crate) fn termination(&self) -> Option<abf::Termination> {
        let of_charts = || self.atlas.as_ref().and_then(Atlas::termination);
        self.run.as_ref().map(|run| run.termination).or_else(of_charts)
    }

    /// Whether the user stopped it.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.termination() == Some(abf::Termination::Cancelled)
            || self.error.as_ref().is_some_and(Failure::is_cancelled)
    }
}

/// One word, or two, on a result of which this is known.
pub(crate) fn result_word(error: Option<&str>, termination: Option<&str>, valid: bool) -> String {
    match (error, termination, valid) {
        (Some(kind), ..) => format!("error: {kind}"),
        (None, Some(word), true) => word.to_owned(),
        (None, Some(word), false) => format!("{word}, not valid"),
        (None, None, true) => "valid".to_owned(),
        (None, None, false) => "not valid".to_owned(),
    }
}

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

fn as_text<S: Serializer>(value: &impl fmt::Display, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

fn as_optional_text<S: Serializer>(value: &Option<impl fmt::Display>, serializer: S) -> Result<S::Ok, S::Error> {
    match value {
        Some(value) => as_text(value, serializer),
        None => serializer.serialize_none(),
    }
}
