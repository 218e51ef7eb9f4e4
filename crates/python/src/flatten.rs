//! `flatten`: a disk to the plane.

use crate::arrays::{Given, Rows, out2, rows_of};
use crate::errors::Raised;
use crate::results::{injective, metrics, pinned, relaxed};
use crate::settings::Keywords;
use crate::supervise::Supervision;
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
        let (uv, rows) = rows_of(&mesh, &flat.uv, false);
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
