//! `relax`: a map that anybody made to less of an energy.

use crate::arrays::{Mapped, out1, out2, rows_of};
use crate::errors::{Raised, chain};
use crate::results::{metrics, pinned, relaxed};
use crate::settings::Keywords;
use crate::supervise::Supervision;
use abf::metrics::measure_certified;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Relaxes a map. The dict has the fields of `abf_flatten.Relaxed`, with its metrics as a dict.
#[pyfunction]
pub(crate) fn relax<'py>(
    py: Python<'py>,
    mapped: Mapped,
    settings: Bound<'py, PyDict>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = Keywords(settings);
    let (pipeline, threads) = (keywords.relaxing()?, keywords.threads()?);
    let is_per_corner = mapped.is_per_corner();
    let supervision = Supervision::new(threads, progress, mapped.face_count());
    let (mesh, map, measured) = supervision.run(py, |observer| {
        let (mesh, given) = mapped.read()?;
        let map = pipeline.relax_map(&mesh, &given, observer).map_err(Raised::raised)?;
        let measured = measure_certified(&mesh, &map.uv, map.certificate.clone()).map_err(Raised::raised)?;
        Ok((mesh, map, measured))
    })?;
    let out = PyDict::new(py);
    let (uv, rows) = rows_of(&mesh, &map.uv, is_per_corner);
    out.set_item("uv", out2(py, uv)?)?;
    out.set_item("uv_faces", rows.map(|rows| out2(py, rows)).transpose()?)?;
    out.set_item("metrics", metrics(py, &measured)?)?;
    out.set_item("termination", map.termination.to_string())?;
    out.set_item("certified", map.is_certified())?;
    out.set_item("chart_of_face", out1(py, map.chart_of_face.iter().map(|&chart| chart as i32).collect()))?;
    let charts = map.charts.iter().map(|report| report.as_ref().map(|report| relaxed(py, report)).transpose());
    out.set_item("charts", charts.collect::<PyResult<Vec<_>>>()?)?;
    out.set_item("refused", map.refused.iter().map(|error| chain(error)).collect::<Vec<_>>())?;
    out.set_item("pinned", map.pinned.as_ref().map(|report| pinned(py, report)).transpose()?)?;
    Ok(out)
}
