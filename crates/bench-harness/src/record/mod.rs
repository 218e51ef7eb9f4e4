//! What is known about one mesh: the one source of the table and of the JSON.

use crate::errors::Failure;
use abf::{Flattening, LayoutKind, Metrics, Passes, Pipeline, Termination};
use abf_mesh::{FaceId, Topology, TriMesh};
use serde::{Serialize, Serializer};
use std::fmt;

/// The name of the JSON's format; the number goes up when a field changes its meaning.
const SCHEMA: &str = "bench-harness/1";

/// Everything there is to say about one mesh.
///
/// Parts that do not apply are absent from the JSON: a judged file has no solver, a mesh that
/// failed has what was known before. Numbers that are not finite are `null`.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Record {
    /// The file.
    pub(crate) mesh: String,
    /// How large the mesh is.
    #[serde(flatten)]
    pub(crate) size: Option<Size>,
    /// What the solver and the layout did.
    #[serde(flatten)]
    pub(crate) run: Option<Run>,
    /// How valid and how distorted the UVs are.
    #[serde(flatten)]
    pub(crate) quality: Option<Quality>,
    /// What reading did beyond copying.
    pub(crate) notes: Vec<String>,
    /// What to try next.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) hint: Option<String>,
    /// Where the time went.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) timings_s: Option<Timings>,
    /// See [`crate::memory`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) peak_memory_bytes: Option<usize>,
    /// The files that were written.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) written: Vec<String>,
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

/// What was asked of the solver and the layout, and what they did.
#[derive(Debug, Serialize)]
pub(crate) struct Run {
    /// The solver's name.
    pub(crate) solver: &'static str,
    /// What it was asked.
    pub(crate) settings: Asked,
    /// How it ended.
    #[serde(serialize_with = "as_text")]
    pub(crate) termination: Termination,
    /// `max |h|` of its angles, log form, rad; `None` where no angles are solved for.
    pub(crate) constraint_residual: Option<f64>,
    /// Angles not inside (0, π); `None` where no angles are solved for.
    pub(crate) angles_out_of_range: Option<usize>,
    /// Outer iterations or passes.
    pub(crate) iterations: usize,
    /// Inner iterations of all of them; refinement steps where the solve is direct.
    pub(crate) inner_iterations: usize,
    /// Angles moved into their bounds: between passes by the solver, and before the layout.
    pub(crate) moved_angles: usize,
    /// Rings that started from their target angles.
    pub(crate) switched_rings: usize,
    /// The layout that was used; never `auto`.
    #[serde(serialize_with = "as_text")]
    pub(crate) layout: LayoutKind,
    /// The largest disagreement between the two sides of an edge; `None` where nothing was
    /// integrated.
    pub(crate) closing_error: Option<f64>,
}

impl Run {
    /// The report of a flattening.
    pub(crate) fn new(pipeline: &Pipeline, flat: &Flattening) -> Self {
        let solution = flat.solution.as_ref();
        Self {
            solver: pipeline.solver.name(),
            settings: Asked::new(pipeline),
            termination: flat.termination,
            constraint_residual: solution.map(abf::AngleSolution::constraint_residual),
            angles_out_of_range: solution.map(abf::AngleSolution::angles_out_of_range),
            iterations: solution.map_or(0, abf::AngleSolution::iterations),
            inner_iterations: solution.map_or(0, abf::AngleSolution::inner_iterations),
            moved_angles: solution.map_or(0, abf::AngleSolution::moved_angles) + flat.layout.moved_angles,
            switched_rings: flat.switched_rings,
            layout: flat.layout.kind,
            closing_error: flat.layout.closing_error,
        }
    }
}

/// The settings, as they are in the JSON.
#[derive(Debug, Serialize)]
pub(crate) struct Asked {
    /// A number or `"auto"`.
    #[serde(serialize_with = "as_number_or_text")]
    pub(crate) passes: Passes,
    /// Which layout; `auto` where the program may choose.
    #[serde(serialize_with = "as_text")]
    pub(crate) layout: LayoutKind,
    /// Radians; `None` for off.
    pub(crate) ring_switch: Option<f64>,
    /// Radians.
    pub(crate) angle_bound: f64,
    /// Radians.
    pub(crate) tolerance: f64,
    /// Passes with `auto`.
    pub(crate) max_iterations: usize,
    /// Seconds; `None` for no limit.
    pub(crate) time_limit_s: Option<f64>,
    /// Whether the UVs are scaled into the unit square.
    pub(crate) normalize: bool,
    /// Threads in use.
    pub(crate) threads: usize,
}

impl Asked {
    fn new(pipeline: &Pipeline) -> Self {
        Self {
            passes: pipeline.passes,
            layout: pipeline.layout.kind,
            ring_switch: pipeline.estimate.ring_switch,
            angle_bound: pipeline.estimate.angle_bound,
            tolerance: pipeline.stop.tolerance,
            max_iterations: pipeline.stop.max_iterations,
            time_limit_s: pipeline.stop.time_limit.map(|limit| limit.as_secs_f64()),
            normalize: pipeline.normalize,
            threads: rayon::current_num_threads(),
        }
    }
}

/// The figures of [`Metrics`] that the program reports, under the same names.
#[derive(Debug, Serialize)]
pub(crate) struct Quality {
    /// No flipped and no collapsed triangle.
    pub(crate) valid: bool,
    #[serde(flatten)]
    figures: Figures,
}

impl Quality {
    /// The judgement of the UVs.
    pub(crate) fn new(metrics: Metrics) -> Self {
        Self { valid: metrics.valid(), figures: Figures(metrics) }
    }

    /// The figures.
    pub(crate) fn metrics(&self) -> &Metrics {
        &self.figures.0
    }
}

/// [`Metrics`] without the number of triangles, which [`Size`] has.
#[derive(Debug)]
struct Figures(Metrics);

impl Serialize for Figures {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeMap;
        let m = &self.0;
        let indices = |faces: &[FaceId]| faces.iter().map(|face| face.index()).collect::<Vec<_>>();
        let mut map = serializer.serialize_map(None)?;
        for (name, count) in [
            ("flips", m.flips),
            ("collapsed", m.collapsed),
            ("near_collapsed", m.near_collapsed),
            ("degenerate_3d", m.degenerate_3d),
            ("charts", m.charts),
        ] {
            map.serialize_entry(name, &count)?;
        }
        for (name, figure) in [
            ("f", m.f),
            ("f_weighted", m.f_weighted),
            ("max_angle_error", m.max_angle_error),
            ("stretch_l2", m.stretch_l2),
            ("stretch_linf", m.stretch_linf),
            ("qc_mean", m.qc_mean),
            ("qc_max", m.qc_max),
            ("area_l2", m.area_l2),
            ("uv_area", m.uv_area),
            ("surface_area", m.surface_area),
        ] {
            map.serialize_entry(name, &figure)?;
        }
        map.serialize_entry("flipped_faces", &indices(&m.flipped_faces))?;
        map.serialize_entry("collapsed_faces", &indices(&m.collapsed_faces))?;
        map.end()
    }
}

/// Where the time went, in seconds.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Timings {
    /// Reading the file, or making the built-in mesh.
    pub(crate) read: f64,
    /// Corner table, disk check, angles of the surface, estimate.
    pub(crate) topology: f64,
    /// Solving for the angles.
    pub(crate) solve: f64,
    /// From angles to coordinates.
    pub(crate) layout: f64,
    /// Judging the UVs.
    pub(crate) metrics: f64,
    /// Writing the mesh.
    pub(crate) write: f64,
    /// All of it, from beginning to end. Pictures come after.
    pub(crate) total: f64,
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
    /// How it went.
    pub(crate) fn outcome(&self) -> Outcome {
        let as_asked = self.run.as_ref().is_none_or(|run| run.termination.is_as_asked());
        let valid = self.quality.as_ref().is_some_and(|quality| quality.valid);
        match &self.error {
            Some(failure) if !failure.is_cancelled() => Outcome::Failed,
            None if as_asked && valid => Outcome::AsAsked,
            _ => Outcome::NotAsAsked,
        }
    }
}

/// The records as a JSON document.
pub(crate) fn to_json(records: &[Record]) -> String {
    #[derive(Serialize)]
    struct Document<'a> {
        schema: &'static str,
        results: &'a [Record],
    }
    let document = Document { schema: SCHEMA, results: records };
    let mut text = serde_json::to_string_pretty(&document).expect("records have text keys only");
    text.push('\n');
    text
}

fn as_text<S: Serializer>(value: &impl fmt::Display, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

fn as_number_or_text<S: Serializer>(passes: &Passes, serializer: S) -> Result<S::Ok, S::Error> {
    match passes {
        Passes::Exactly(n) => n.serialize(serializer),
        Passes::Auto => as_text(passes, serializer),
    }
}
