//! Coarser meshes by edge collapses, and drawings carried back to the finer ones without flips.
//!
//! [`Hierarchy::coarsen`] removes vertices in rounds. A vertex collapses into a neighbour: its faces become one or two
//! fewer, and those that are left cover its ring. [`Hierarchy::coarsest`] is what remains; it is small, and a drawing of
//! it is cheap. [`Hierarchy::refine`] puts the vertices back in the opposite order. The neighbour that a vertex went into sees
//! all of its ring, so the kernel of the ring is not empty, and there is a place for the vertex that turns no triangle over.
//!
//! | symbol | name here | meaning |
//! | --- | --- | --- |
//! | v | `vertex` | the vertex that goes and comes back |
//! | u | `target` of a collapse | the neighbour that it goes into |
//! | x | | the angles of the drawing, rad |
//! | a | `target` of an angle | the angles of the surface, scaled to 2π around a vertex, rad |
//!
//! ```
//! use abf_mesh::{Point2, Topology};
//! use abf_multires::Hierarchy;
//! use abf_shapes::Shape;
//!
//! let mesh = Shape::BumpySheet.mesh(4000);
//! let topology = Topology::build(mesh.vertex_count(), mesh.faces())?;
//! let hierarchy = Hierarchy::coarsen(&mesh, &topology, 500, &mut || Ok(()))?;
//! assert!(hierarchy.coarsest(&mesh).mesh.face_count() <= 500);
//!
//! // Seen from above, the sheet is a drawing of itself.
//! let mut uv: Vec<Point2<f64>> = mesh.positions().iter().map(|p| Point2::new(p.x, p.y)).collect();
//! let levels = hierarchy.refine((&mesh, &topology), &mesh.corner_angles(), &mut uv, 1, &mut || Ok(()))?;
//! assert_eq!(levels.last().map(|level| level.triangles), Some(mesh.face_count()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Where things are: `working.rs` the corner table that shrinks · `cost.rs` what a collapse costs · `coarsen.rs` rounds ·
//! `hierarchy.rs` what they leave · `refine.rs` the way back · `kernel.rs` where a vertex can be · `star.rs` a step of one
//! vertex · `relax.rs` of all.

mod coarsen;
mod cost;
mod hierarchy;
mod kernel;
mod refine;
mod relax;
mod star;
mod working;

pub use hierarchy::{CoarseMesh, Hierarchy};
pub use refine::{LevelReport, RefineError};
