//! `pack`: islands of a map laid out anew.

use crate::arrays::{Labels, Mapped, out1, out2, xy};
use crate::errors::Raised;
use crate::results::metrics;
use crate::settings::Keywords;
use crate::supervise::Supervision;
use abf::{Precision, Repack, Stored};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Packs the islands of UVs. The dict has the fields of `abf_flatten.Packed`, with its metrics as a dict.
#[pyfunction]
pub(crate) fn pack<'py>(
    py: Python<'py>,
    mapped: Mapped,
    materials: Option<Labels>,
    settings: Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = Keywords(settings);
    let repack = Repack { atlas: keywords.atlas()?, stack: keywords.value("stack")?.unwrap_or(false) };
    let threads = keywords.threads()?;
    let materials = materials.map(|labels| labels.of(mapped.face_count(), "materials")).transpose()?;
    let packed = Supervision::new(threads, None, mapped.face_count()).run(py, |_| {
        let (mesh, map) = mapped.read()?;
        repack.run(&mesh, &map, materials.as_deref(), Stored::in_precision(Precision::Double)).map_err(Raised::raised)
    })?;
    let page = |island: &usize| packed.placements[*island].page as i32;
    let out = PyDict::new(py);
    out.set_item("uv", out2(py, xy(packed.uv.points()))?)?;
    out.set_item("island_of_face", out1(py, packed.island_of_face.iter().map(|&i| i as i32).collect()))?;
    out.set_item("page_of_face", out1(py, packed.island_of_face.iter().map(page).collect()))?;
    out.set_item("islands", packed.islands)?;
    out.set_item("pages", packed.pages)?;
    out.set_item("texels_per_unit", packed.texels_per_unit)?;
    out.set_item("coverage", packed.coverage)?;
    out.set_item("metrics", metrics(py, &packed.metrics)?)?;
    Ok(out)
}
