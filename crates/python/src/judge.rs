//! `metrics` and `certify`: what is true of UVs that anybody made.

use crate::arrays::{Given, GivenUv, Rows};
use crate::errors::{Raised, SettingError};
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
    vertices: Rows<f64, 3>,
    faces: Rows<i64, 3>,
    uv: Rows<f64, 2>,
    uv_faces: Option<Rows<i64, 3>>,
    settings: Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = Keywords(settings);
    let (weld, threads) = (keywords.weld()?, keywords.threads()?);
    let as_stored = keywords.value::<bool>("as_stored")?.unwrap_or(false);
    let given = Given::new(vertices, faces);
    let known = GivenUv::new(uv, uv_faces);
    let measured = Supervision::new(threads, None, given.face_count()).run(py, |_| {
        let mesh = given.mesh()?;
        let map = known.map(&mesh)?;
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
    vertices: Rows<f64, 3>,
    faces: Rows<i64, 3>,
    uv: Rows<f64, 2>,
    uv_faces: Option<Rows<i64, 3>>,
    settings: Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = Keywords(settings);
    let threads = keywords.threads()?;
    let precision = match keywords.value::<String>("precision")?.as_deref() {
        None | Some("double") => Precision::Double,
        Some("single") => Precision::Single,
        Some(other) => {
            return Err(SettingError::new_err(format!("precision must be 'single' or 'double', got '{other}'")));
        }
    };
    let given = Given::new(vertices, faces);
    let known = GivenUv::new(uv, uv_faces);
    let certificate = Supervision::new(threads, None, given.face_count()).run(py, |observer| {
        let mesh = given.mesh()?;
        let map = known.map(&mesh)?;
        certify_asking(&mesh, &map, precision, &mut || ask(observer, Event::Working)).map_err(Raised::raised)
    })?;
    results::certificate(py, &certificate)
}
