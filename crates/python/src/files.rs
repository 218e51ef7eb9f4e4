//! `read`, `parse` and `write`: mesh files.

use crate::arrays::{Given, GivenUv, Rows, indices_of, out2, xy};
use crate::errors::{FormatError, chain, of_system};
use crate::supervise::Supervision;
use abf::mesh::io::{self, MeshFile, MeshFormat, ReadError, WriteError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Reads a mesh file; the extension names its format. The dict has the fields of `abf_flatten.MeshFile`.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let file = Supervision::new(None, None, 0).run(py, move |_| io::read(&path).map_err(|e| of_reading(&e)))?;
    mesh_file(py, &file)
}

/// Reads a mesh from the bytes of a file with that name.
#[pyfunction]
pub(crate) fn parse<'py>(py: Python<'py>, name: PathBuf, data: &[u8]) -> PyResult<Bound<'py, PyDict>> {
    let Some(format) = MeshFormat::of_input(&name) else {
        let known = MeshFormat::list(|_| true, " and ");
        let name = name.display();
        return Err(FormatError::new_err(format!(
            "{name}: the extension names no known mesh format; known are {known}"
        )));
    };
    let shown = name.into_os_string().to_string_lossy().into_owned();
    let file = Supervision::new(None, None, 0)
        .run(py, move |_| io::parse(format, &shown, data).map_err(|e| of_reading(&e)))?;
    mesh_file(py, &file)
}

/// Writes a mesh file, whole or not at all; the extension names its format.
#[pyfunction]
pub(crate) fn write<'py>(
    py: Python<'py>,
    path: PathBuf,
    vertices: Rows<f64, 3>,
    faces: Rows<i64, 3>,
    uv: Option<Rows<f64, 2>>,
    uv_faces: Option<Rows<i64, 3>>,
) -> PyResult<()> {
    let given = Given::new(vertices, faces);
    let known = uv.map(|uv| GivenUv::new(uv, uv_faces));
    Supervision::new(None, None, given.face_count()).run(py, move |_| {
        let mesh = given.mesh()?;
        let map = known.map(|known| known.map(&mesh)).transpose()?;
        io::write(&path, &mesh, map.as_ref()).map_err(|e| of_writing(&e))
    })
}

fn mesh_file<'py>(py: Python<'py>, file: &MeshFile) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    out.set_item("vertices", out2(py, file.mesh.positions().iter().map(|p| [p.x, p.y, p.z]).collect())?)?;
    out.set_item("faces", out2(py, indices_of(file.mesh.faces()))?)?;
    let uv = file.uv.as_ref();
    out.set_item("uv", uv.map(|uv| out2(py, xy(uv.points()))).transpose()?)?;
    let rows = |uv: &abf::mesh::UvMap| -> Vec<[u32; 3]> {
        uv.corners().as_chunks::<3>().0.iter().map(|ids| ids.map(|id| id.index() as u32)).collect()
    };
    out.set_item("uv_faces", uv.map(|uv| out2(py, rows(uv))).transpose()?)?;
    out.set_item("notes", file.notes.sentences())?;
    Ok(out)
}

fn of_reading(error: &ReadError) -> PyErr {
    match error {
        ReadError::Open { cause, .. } => of_system(cause, error.to_string()),
        error => FormatError::new_err(chain(error)),
    }
}

fn of_writing(error: &WriteError) -> PyErr {
    match error {
        WriteError::Io { cause, .. } => of_system(cause, error.to_string()),
        error => FormatError::new_err(chain(error)),
    }
}
