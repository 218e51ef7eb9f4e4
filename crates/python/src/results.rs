//! What is known of a map, as a dict.

use crate::errors::chain;
use abf::{Certificate, InjectiveReport, Metrics, PinReport, RelaxReport};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The fields of `abf_flatten.Certificate`.
pub(crate) fn certificate<'py>(py: Python<'py>, c: &Certificate) -> PyResult<Bound<'py, PyDict>> {
    let faces = |faces: &[abf::mesh::FaceId]| faces.iter().map(|f| f.index()).collect::<Vec<_>>();
    let out = PyDict::new(py);
    out.set_item("valid", c.valid())?;
    out.set_item("injective", c.injective())?;
    out.set_item("charts", c.charts)?;
    out.set_item("flips", c.flips)?;
    out.set_item("collapsed", c.collapsed)?;
    out.set_item("near_collapsed", c.near_collapsed)?;
    out.set_item("wound", c.wound)?;
    out.set_item("overlaps", c.overlaps())?;
    out.set_item("touches", c.touches)?;
    out.set_item("uv_angle_min", c.uv_angle_min)?;
    out.set_item("uv_angle_max", c.uv_angle_max)?;
    out.set_item("constraint_residual", c.constraint_residual)?;
    out.set_item("flipped_faces", faces(&c.flipped_faces))?;
    out.set_item("collapsed_faces", faces(&c.collapsed_faces))?;
    out.set_item("wound_vertices", c.wound_vertices.iter().map(|v| v.index()).collect::<Vec<_>>())?;
    let pairs: Vec<(usize, usize)> = c.overlapping_faces.iter().map(|[a, b]| (a.index(), b.index())).collect();
    out.set_item("overlapping_faces", pairs)?;
    Ok(out)
}

/// The fields of `abf_flatten.Metrics`.
pub(crate) fn metrics<'py>(py: Python<'py>, m: &Metrics) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    out.set_item("triangles", m.triangles)?;
    out.set_item("degenerate_3d", m.degenerate_3d)?;
    out.set_item("f", m.f)?;
    out.set_item("f_weighted", m.f_weighted)?;
    out.set_item("max_angle_error", m.max_angle_error)?;
    out.set_item("stretch_l2", m.stretch_l2)?;
    out.set_item("stretch_linf", m.stretch_linf)?;
    out.set_item("qc_mean", m.qc_mean)?;
    out.set_item("qc_max", m.qc_max)?;
    out.set_item("area_l2", m.area_l2)?;
    out.set_item("uv_area", m.uv_area)?;
    out.set_item("surface_area", m.surface_area)?;
    out.set_item("certificate", certificate(py, &m.certificate)?)?;
    Ok(out)
}

/// The fields of `abf_flatten.RelaxReport`.
pub(crate) fn relaxed<'py>(py: Python<'py>, report: &RelaxReport) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    out.set_item("energy", report.energy.to_string())?;
    out.set_item("before", report.before)?;
    out.set_item("after", report.after)?;
    out.set_item("steps", report.steps)?;
    out.set_item("progressive_steps", report.progressive_steps)?;
    out.set_item("from_tutte", report.from_tutte)?;
    Ok(out)
}

/// The fields of `abf_flatten.InjectiveReport`.
pub(crate) fn injective<'py>(py: Python<'py>, report: &InjectiveReport) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    out.set_item("rule", report.rule.name())?;
    out.set_item("overlaps", report.overlaps)?;
    out.set_item("energy", report.energy.map(|energy| energy.to_string()))?;
    out.set_item("before", report.before)?;
    out.set_item("after", report.after)?;
    out.set_item("steps", report.steps)?;
    out.set_item("first_steps", report.first_steps)?;
    out.set_item("gap", report.gap)?;
    out.set_item("parts", report.parts)?;
    out.set_item("error", report.error.as_ref().map(|error| chain(error)))?;
    Ok(out)
}

/// The fields of `abf_flatten.PinReport`.
pub(crate) fn pinned<'py>(py: Python<'py>, report: &PinReport) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    let distances = PyDict::new(py);
    for pin in &report.residuals {
        distances.set_item(pin.vertex, pin.distance)?;
    }
    let missed = report.residuals.iter().filter(|pin| pin.is_missed()).map(|pin| pin.vertex);
    out.set_item("energy", report.energy.to_string())?;
    out.set_item("after", report.after)?;
    out.set_item("steps", report.steps)?;
    out.set_item("missed", missed.collect::<Vec<u32>>())?;
    out.set_item("distances", distances)?;
    Ok(out)
}
