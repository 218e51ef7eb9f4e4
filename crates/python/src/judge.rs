//! `metrics` and `certify`: what is true of UVs that anybody made.

use crate::arrays::Mapped;
use crate::errors::Raised;
use crate::results;
use crate::settings::Keywords;
use crate::supervise::Supervision;
use abf::control::ask;
use abf::metrics::{certify_asking, measure};
use abf::{Event, JudgeSettings, Precision, judge};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Measures UVs, after the repair that `unwrap` makes, or as they are.
#[pyfunction]
pub(crate) fn metrics<'py>(
    py: Python<'py>,
    mapped: Mapped,
    settings: Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = Keywords(settings);
    let (weld, threads) = (keywords.weld()?, keywords.threads()?);
    let as_stored = keywords.value::<bool>("as_stored")?.unwrap_or(false);
    let measured = Supervision::new(threads, None, mapped.face_count()).run(py, |_| {
        let (mesh, map) = mapped.read()?;
        if as_stored {
            return measure(&mesh, &map).map_err(Raised::raised);
        }
        let settings = JudgeSettings { weld, ..JudgeSettings::default() };
        judge(&mesh, &map, &settings).map(|judged| judged.metrics).map_err(Raised::raised)
    })?;
    results::metrics(py, &measured)
}

/// Certifies UVs as they are, in the precision that they will be stored in.
#[pyfunction]
pub(crate) fn certify<'py>(
    py: Python<'py>,
    mapped: Mapped,
    settings: Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = Keywords(settings);
    let threads = keywords.threads()?;
    let is_single = keywords.is("precision", "single", "double")?;
    let precision = if is_single { Precision::Single } else { Precision::Double };
    let certificate = Supervision::new(threads, None, mapped.face_count()).run(py, |observer| {
        let (mesh, map) = mapped.read()?;
        certify_asking(&mesh, &map, precision, &mut || ask(observer, Event::Working)).map_err(Raised::raised)
    })?;
    results::certificate(py, &certificate)
}
