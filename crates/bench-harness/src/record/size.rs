//! How large a mesh is, and the matrix of its whole problem.

use abf::KktCounts;
use abf_mesh::{Topology, TriMesh};
use serde::{Deserialize, Serialize};

/// The size of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Size {
    /// Triangles, after polygons are cut.
    pub(crate) triangles: usize,
    /// Vertices, used or not.
    pub(crate) vertices: usize,
    /// Vertices with faces all around; `None` where the faces are no manifold.
    pub(crate) interior_vertices: Option<usize>,
    /// Boundary loops; `None` where the faces are no manifold.
    pub(crate) boundary_loops: Option<usize>,
}

impl Size {
    /// The size of a mesh of any kind.
    pub(crate) fn of(mesh: &TriMesh, topology: Option<&Topology>) -> Self {
        Self {
            triangles: mesh.face_count(),
            vertices: mesh.vertex_count(),
            interior_vertices: topology.map(Topology::interior_vertex_count),
            boundary_loops: topology.map(|t| t.boundary_loops().len()),
        }
    }
}

/// The counters of VMV04 fig. 2: the KKT matrix of the whole problem, which only `abf` assembles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Kkt {
    /// `4 nt + 2 ni`.
    pub(crate) unknowns: usize,
    /// Entries that are not zero by construction, log wheel.
    pub(crate) nonzeros_log: usize,
    /// The same, product wheel.
    pub(crate) nonzeros_product: usize,
}

impl Kkt {
    /// The counters of the problem in its log and its product form.
    pub(crate) fn new([log, product]: [KktCounts; 2]) -> Self {
        Self { unknowns: log.unknowns, nonzeros_log: log.nonzeros, nonzeros_product: product.nonzeros }
    }
}
