//! Between `NumPy` arrays and meshes. Every array is copied before its values are looked at, so that a thread that changes it
//! during the call does no harm.

use crate::errors::{GeometryError, Raised, ShapeError};
use abf::mesh::{Point2, Point3, TriMesh, UvId, UvMap, VertexId};
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

/// An array with `N` columns, copied.
pub(crate) struct Rows<T, const N: usize>(pub(crate) Vec<[T; N]>);

/// A label for every face, copied.
pub(crate) struct Labels(Vec<u32>);

impl Rows<i64, 2> {
    /// Edges by their two vertices, if there are such vertices.
    pub(crate) fn edges(&self, vertices: usize) -> PyResult<Vec<[u32; 2]>> {
        check(&self.0, vertices, "seam", "vertices")?;
        Ok(self.0.iter().map(|edge| edge.map(|i| i as u32)).collect())
    }
}

/// A mesh that nobody has looked at yet.
pub(crate) struct Given {
    positions: Vec<[f64; 3]>,
    faces: Vec<[i64; 3]>,
}

impl Given {
    /// A mesh of these arrays.
    pub(crate) fn new(vertices: Rows<f64, 3>, faces: Rows<i64, 3>) -> Self {
        Self { positions: vertices.0, faces: faces.0 }
    }

    /// How many faces there are.
    pub(crate) fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// The mesh.
    pub(crate) fn mesh(self) -> PyResult<TriMesh> {
        let triangles = self.triangles()?;
        let points = self.positions.into_iter().map(Point3::from).collect();
        TriMesh::new(points, &triangles).map_err(|e| abf::FlattenError::from(e).raised())
    }

    /// The mesh as the library takes arrays: positions, and the indices of every face.
    pub(crate) fn flat(self) -> PyResult<Flat> {
        let triangles = self.triangles()?.into_iter().map(|face| face.map(|i| i as u32)).collect();
        Ok((self.positions, triangles))
    }

    fn triangles(&self) -> PyResult<Vec<[usize; 3]>> {
        if self.faces.is_empty() {
            return Err(GeometryError::new_err("the mesh has no faces"));
        }
        if let Some(vertex) = self.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(GeometryError::new_err(format!("vertex {vertex} has a coordinate that is not finite")));
        }
        check(&self.faces, self.positions.len(), "face", "vertices")?;
        Ok(self.faces.iter().map(|face| face.map(|i| i as usize)).collect())
    }
}

/// Positions, and the indices of every face.
pub(crate) type Flat = (Vec<[f64; 3]>, Vec<[u32; 3]>);

impl<'py, T: Element + Copy, const N: usize> FromPyObject<'_, 'py> for Rows<T, N> {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let array: PyReadonlyArray2<'py, T> = given.extract()?;
        let &[count, columns] = array.shape() else { unreachable!("it has two axes") };
        if columns != N {
            return Err(ShapeError::new_err(format!("an array must have shape (n, {N}), got ({count}, {columns})")));
        }
        Ok(Self(match array.as_slice() {
            Ok(all) => all.as_chunks::<N>().0.to_vec(),
            Err(_) => array.as_array().rows().into_iter().map(|row| std::array::from_fn(|k| row[k])).collect(),
        }))
    }
}

impl<'py> FromPyObject<'_, 'py> for Labels {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let array: PyReadonlyArray1<'py, u32> = given.extract()?;
        Ok(Self(array.as_array().iter().copied().collect()))
    }
}

impl Labels {
    /// The labels, if there is one for each of so many faces.
    pub(crate) fn of(self, faces: usize, name: &str) -> PyResult<Vec<u32>> {
        let given = self.0.len();
        if given == faces {
            return Ok(self.0);
        }
        Err(ShapeError::new_err(format!("{name} must have a label for each of the {faces} faces, got {given}")))
    }
}

/// A mesh with UVs that nobody has looked at yet: its vertices, its faces, its UVs, and the rows of every corner.
pub(crate) struct Mapped {
    given: Given,
    uv: GivenUv,
}

impl<'py> FromPyObject<'_, 'py> for Mapped {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let (vertices, faces, uv, uv_faces) = given.extract()?;
        Ok(Self { given: Given::new(vertices, faces), uv: GivenUv::new(uv, uv_faces) })
    }
}

impl Mapped {
    /// Whether there are rows of every corner.
    pub(crate) fn is_per_corner(&self) -> bool {
        self.uv.faces.is_some()
    }

    /// How many faces there are.
    pub(crate) fn face_count(&self) -> usize {
        self.given.face_count()
    }

    /// The mesh and its map.
    pub(crate) fn read(self) -> PyResult<(TriMesh, UvMap)> {
        let mesh = self.given.mesh()?;
        let map = self.uv.map(&mesh)?;
        Ok((mesh, map))
    }
}

/// UVs that nobody has looked at yet.
pub(crate) struct GivenUv {
    points: Vec<[f64; 2]>,
    faces: Option<Vec<[i64; 3]>>,
}

impl GivenUv {
    /// One UV per vertex, or the rows of every corner.
    pub(crate) fn new(uv: Rows<f64, 2>, uv_faces: Option<Rows<i64, 3>>) -> Self {
        Self { points: uv.0, faces: uv_faces.map(|rows| rows.0) }
    }

    /// The map of a mesh.
    pub(crate) fn map(self, mesh: &TriMesh) -> PyResult<UvMap> {
        let points: Vec<Point2<f64>> = self.points.into_iter().map(Point2::from).collect();
        let corners = match self.faces {
            None if points.len() != mesh.vertex_count() => {
                return Err(ShapeError::new_err(format!(
                    "uv must have a row for each of the {} vertices, got {}; give uv_faces where UVs are per corner",
                    mesh.vertex_count(),
                    points.len()
                )));
            }
            None => mesh.faces().as_flattened().iter().map(|v| UvId::new(v.index())).collect(),
            Some(faces) if faces.len() != mesh.face_count() => {
                return Err(ShapeError::new_err(format!(
                    "uv_faces must have a row for each of the {} faces, got {}",
                    mesh.face_count(),
                    faces.len()
                )));
            }
            Some(faces) => {
                check(&faces, points.len(), "row of uv_faces", "UVs")?;
                faces.as_flattened().iter().map(|&i| UvId::new(i as usize)).collect()
            }
        };
        if let Some(at) = points.iter().position(|p| !p.coords.iter().all(|x| x.is_finite())) {
            return Err(GeometryError::new_err(format!("row {at} of uv is not finite")));
        }
        Ok(UvMap::new(points, corners))
    }
}

/// Rows as an array: the memory goes to `NumPy` as it is.
pub(crate) fn out2<T: Element, const N: usize>(py: Python<'_>, rows: Vec<[T; N]>) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    rows.into_flattened().into_pyarray(py).reshape([count, N])
}

/// A vector as an array: the memory goes to `NumPy` as it is.
pub(crate) fn out1<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    values.into_pyarray(py)
}

/// The coordinates of points.
pub(crate) fn xy(points: &[Point2<f64>]) -> Vec<[f64; 2]> {
    points.iter().map(|p| [p.x, p.y]).collect()
}

/// Faces as they go out.
pub(crate) fn indices_of(faces: &[[VertexId; 3]]) -> Vec<[u32; 3]> {
    faces.iter().map(|face| face.map(|v| v.index() as u32)).collect()
}

/// The rows of a map as they go out: one per vertex, or, where that is asked for or a vertex has several, one per point and
/// the row of every corner.
pub(crate) fn rows_of(mesh: &TriMesh, map: &UvMap, is_per_corner: bool) -> (Vec<[f64; 2]>, Option<Vec<[u32; 3]>>) {
    let per_vertex = if is_per_corner { None } else { map.one_per_vertex(mesh) };
    match per_vertex {
        Some(points) => (xy(&points), None),
        None => (xy(map.points()), Some(indices_of_uv(map))),
    }
}

/// The rows of every corner of a map, as they go out.
pub(crate) fn indices_of_uv(map: &UvMap) -> Vec<[u32; 3]> {
    map.corners().as_chunks::<3>().0.iter().map(|face| face.map(|id| id.index() as u32)).collect()
}

/// Checks that all indices name something.
fn check<const N: usize>(rows: &[[i64; N]], count: usize, row_name: &str, what: &str) -> PyResult<()> {
    let is_known = |&i: &i64| usize::try_from(i).is_ok_and(|i| i < count);
    let wrong = rows.iter().enumerate().find_map(|(row, indices)| Some((row, indices.iter().find(|i| !is_known(i))?)));
    match wrong {
        None => Ok(()),
        Some((row, index)) => Err(GeometryError::new_err(format!(
            "{row_name} {row} has the index {index}, and there are {count} {what} (counted from 0)"
        ))),
    }
}
