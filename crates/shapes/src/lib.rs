//! Parametric shapes of any size: the fixtures, the benchmarks' meshes and the tests'.
//!
//! [`Shape::mesh`] builds a disk of about as many triangles as asked for; [`fixtures()`] lists the
//! ones kept as files; [`loop_subdivide`] refines any manifold mesh for scaling benchmarks. The
//! letters, the ring cyclide, the twisted band and the wavy saddle stand in for the models of
//! Zayer, Rössl, Seidel, *Efficient Iterative Solvers for Angle Based Flattening*, 2004.
//!
//! **Invariant.** Every mesh is one component with one boundary loop and no handle, oriented,
//! without unreferenced vertices and without a face of zero area; and the same request gives the
//! same bits on every machine. Three things see to the second: sines and exponentials are computed
//! from basic arithmetic (`portable`), coordinates are rounded to nine decimals so that a text
//! file holds them exactly, and what looks random comes from an integer hash.

mod bands;
mod blocks;
mod domes;
mod fixtures;
mod lattice;
mod letters;
mod portable;
mod pyramids;
mod shape;
mod sheets;
mod subdivide;

pub use fixtures::{DEFAULT_FIXTURE, Fixture, fixtures};
pub use shape::{Shape, UnknownShape};
pub use subdivide::loop_subdivide;
