//! `flatten`: a disk to the plane.

use crate::arrays::{Given, Rows, indices_of_uv, out2, xy};
use crate::errors::Raised;
use crate::results::{injective, metrics, pinned, relaxed};
use crate::settings::Keywords;
use crate::supervise::Supervision;
use abf::mesh::TriMesh;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Flattens a disk. The dict has the fields of `abf_flatten.Flattening`, with its metrics as a dict.
#[pyfunction]
pub(crate) fn flatten<'py>(
    py: Python<'py>,
    vertices: Rows<f64, 3>,
    faces: Rows<i64, 3>,
    settings: Bound<'py, PyDict>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = Keywords(settings);
    let (pipeline, threads) = (keywords.pipeline()?, keywords.threads()?);
    let given = Given::new(vertices, faces);
    let supervision = Supervision::new(threads, progress, given.face_count());
    let (uv, rows, flat, measured) = supervision.run(py, |observer| {
        let mesh = given.mesh()?;
        let flat = pipeline.run(&mesh, observer).map_err(Raised::raised)?;
        let measured = flat.metrics(&mesh).map_err(Raised::raised)?;
        let parts = flat.injective.as_ref().map_or(1, |report| report.parts);
        // A map in parts has more points than vertices.
        let rows = (parts > 1).then(|| indices_of_uv(&flat.uv));
        let uv = if rows.is_some() { xy(flat.uv.points()) } else { per_vertex(&mesh, &flat.uv) };
        Ok((uv, rows, flat, measured))
    })?;
    let out = PyDict::new(py);
    out.set_item("uv", out2(py, uv)?)?;
    out.set_item("uv_faces", rows.map(|rows| out2(py, rows)).transpose()?)?;
    out.set_item("injective", flat.injective.as_ref().map(|report| injective(py, report)).transpose()?)?;
    out.set_item("metrics", metrics(py, &measured)?)?;
    out.set_item("solver", flat.solver.name())?;
    out.set_item("termination", flat.termination.to_string())?;
    out.set_item("certified", flat.is_certified())?;
    out.set_item("relaxed", flat.relaxed.as_ref().map(|report| relaxed(py, report)).transpose()?)?;
    out.set_item("pinned", flat.pinned.as_ref().map(|report| pinned(py, report)).transpose()?)?;
    out.set_item("tried", flat.rungs.iter().map(|rung| rung.solver.name()).collect::<Vec<_>>())?;
    Ok(out)
}

/// One row per vertex; those of no face are at the origin.
pub(crate) fn per_vertex(mesh: &TriMesh, uv: &abf::mesh::UvMap) -> Vec<[f64; 2]> {
    let mut rows = vec![[0.0; 2]; mesh.vertex_count()];
    for (vertex, id) in mesh.faces().as_flattened().iter().zip(uv.corners()) {
        let point = uv.points()[id.index()];
        rows[vertex.index()] = [point.x, point.y];
    }
    rows
}
