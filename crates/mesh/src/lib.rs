//! Triangle meshes: typed ids, corner-table topology, UV maps, reading and writing.
//!
//! The corner is the unit of this whole project: corner `3f + k` is the angle of face `f` at its
//! `k`-th vertex, and it *is* unknown `3f + k` of every solver. [`Topology`] knows which corners
//! meet where and holds no coordinates; [`TriMesh`] holds coordinates and faces; [`UvMap`] holds
//! one UV per corner, so that a seam needs no special case.
//!
//! A mesh read from a file is a [`TriMesh`] whatever its shape. [`Topology::build`] accepts
//! oriented manifolds with boundary; [`Topology::require_disk`] accepts one component with one
//! boundary loop and no handle, which is what the angle constraints of every method need.

mod bounds;
mod disjoint_sets;
mod disk;
mod ids;
#[cfg(feature = "io")]
pub mod io;
pub mod predicates;
mod submesh;
pub mod text;
mod topology;
mod tri_mesh;
mod uv_map;

pub use bounds::bounds;
pub use disjoint_sets::DisjointSets;
pub use disk::{BoundaryLoop, DiskError};
pub use ids::{CornerId, FaceId, UvId, VertexId};
pub use nalgebra::{Point2, Point3, Vector2, Vector3};
pub use submesh::Submesh;
pub use topology::{BrokenLaw, Topology, TopologyError};
pub use tri_mesh::{GeometryError, TriMesh};
pub use uv_map::UvMap;
