//! `unwrap`: any mesh to an atlas.

use crate::arrays::{Given, GivenUv, Labels, Rows, out1, out2};
use crate::errors::Raised;
use crate::results::metrics;
use crate::settings::Keywords;
use crate::supervise::Supervision;
use abf::{ArrayUnwrapper, SurfaceHints, UnwrappedArrays};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What is known of a mesh besides itself.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Hints {
    /// Its UVs, whose seams are kept.
    uv: Option<Rows<f64, 2>>,
    /// The row of `uv` of every corner.
    uv_faces: Option<Rows<i64, 3>>,
    /// Edges that are seams, by their vertices.
    edges: Option<Rows<i64, 2>>,
    /// A label for every face: charts end where it changes, and pages may be by it.
    materials: Option<Labels>,
    /// A label for every face: vertices are joined within one object only.
    objects: Option<Labels>,
    /// A label for every face: no seam runs between two of one polygon.
    polygons: Option<Labels>,
}

/// Unwraps a mesh. The dict has the fields of `abf_flatten.Unwrapped`, with its metrics as a dict.
#[pyfunction]
pub(crate) fn unwrap<'py>(
    py: Python<'py>,
    vertices: Rows<f64, 3>,
    faces: Rows<i64, 3>,
    hints: Hints,
    settings: Bound<'py, PyDict>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = Keywords(settings);
    let Hints { uv, uv_faces, edges, materials, objects, polygons } = hints;
    let keeps = keywords.value::<bool>("keeps")?.unwrap_or(false);
    let unwrap = keywords.unwrap(keeps)?;
    unwrap.check().map_err(|e| abf::ArrayError::from(e).raised())?;
    let parting = keywords.parting(unwrap.max_stretch)?;
    let unwrapper = ArrayUnwrapper { unwrap, atlas: keywords.atlas()?, parting };
    let may_overlap = keywords.is("overlap", "allow", "refuse")?;
    let threads = keywords.threads()?;
    let given = Given::new(vertices, faces);
    let known = uv.map(|uv| GivenUv::new(uv, uv_faces));
    let materials = materials.map(|labels| labels.of(given.face_count(), "materials")).transpose()?;
    let polygons = polygons.map(|labels| labels.of(given.face_count(), "polygons")).transpose()?;
    let objects = objects.map(|labels| labels.of(given.face_count(), "objects")).transpose()?;
    let supervision = Supervision::new(threads, progress, given.face_count());
    let flat = supervision.run(py, |observer| {
        let (positions, triangles) = given.flat()?;
        let uv = match known {
            Some(known) => Some(known.map(&plain_mesh(&positions, &triangles)?)?),
            None => None,
        };
        let edges = edges.map(|edges| edges.edges(positions.len())).transpose()?;
        let seams = edges.map(|edges| SurfaceHints::corners_facing(&triangles, &edges));
        let forbidden = polygons.map(|polygons| SurfaceHints::corners_inside(&triangles, &polygons));
        let hints = SurfaceHints {
            uv: uv.as_ref(),
            face_labels: materials.as_deref(),
            objects: objects.as_deref(),
            forbidden: forbidden.as_deref(),
            seams: seams.as_deref(),
        };
        unwrapper.run_in_doubles(&positions, triangles.as_flattened(), &hints, observer).map_err(Raised::raised)
    })?;
    unwrapped(py, flat, may_overlap)
}

/// The mesh of arrays that are known to be in range, to read UVs against.
fn plain_mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> PyResult<abf::mesh::TriMesh> {
    let points = positions.iter().map(|&p| p.into()).collect();
    let triangles: Vec<[usize; 3]> = triangles.iter().map(|t| t.map(|i| i as usize)).collect();
    abf::mesh::TriMesh::new(points, &triangles).map_err(|e| abf::ArrayError::from(e).raised())
}

fn unwrapped(py: Python<'_>, flat: UnwrappedArrays, may_overlap: bool) -> PyResult<Bound<'_, PyDict>> {
    let certified = flat.is_certified(may_overlap);
    let UnwrappedArrays { uvs, indices, remap, packed, unwrapped, parted_for_coverage, parted_for_margin, .. } = flat;
    let faces = indices.len() / 3;
    let (mut chart_of_face, mut page_of_face) = (vec![-1_i32; faces], vec![-1_i32; faces]);
    for (number, (chart, placement)) in unwrapped.charts.iter().zip(&packed.placements).enumerate() {
        for face in &chart.faces {
            chart_of_face[face.index()] = number as i32;
            page_of_face[face.index()] = placement.page as i32;
        }
    }
    let out = PyDict::new(py);
    out.set_item("vmapping", out1(py, remap))?;
    out.set_item("indices", out2(py, indices.as_chunks::<3>().0.to_vec())?)?;
    out.set_item("uvs", out2(py, uvs)?)?;
    out.set_item("chart_of_face", out1(py, chart_of_face))?;
    out.set_item("page_of_face", out1(py, page_of_face))?;
    out.set_item("charts", unwrapped.charts.len())?;
    out.set_item("pages", packed.pages)?;
    out.set_item("texels_per_unit", packed.texels_per_unit)?;
    out.set_item("coverage", packed.coverage)?;
    out.set_item("metrics", metrics(py, &packed.metrics)?)?;
    out.set_item("seam_length", unwrapped.seam_length)?;
    out.set_item("repairs", unwrapped.repairs.sentences())?;
    out.set_item("parted_for_coverage", parted_for_coverage)?;
    out.set_item("parted_for_margin", parted_for_margin)?;
    out.set_item("certified", certified)?;
    let steps = |chart: &abf::UnwrappedChart| chart.relaxed.as_ref().map_or(0, |report| report.steps);
    out.set_item("relax_steps", unwrapped.charts.iter().map(steps).sum::<usize>())?;
    out.set_item("unfinished", unwrapped.charts.iter().filter(|chart| chart.unfinished).count())?;
    Ok(out)
}
