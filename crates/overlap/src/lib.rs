//! Where a drawing of triangles in the plane lies over itself, by exact signs.
//!
//! A map is one to one where no triangle is turned over, none winds around a vertex with its neighbours more than once, and
//! the boundary encloses no point twice. The last is what this crate finds out:
//!
//! * [`Overlaps::find`] counts where a [`Sheet`], any map whatever, covers the plane more than once, and names faces.
//! * [`BoundaryTest`] says of one drawing after the other of the same mesh whether its boundary keeps clear of itself.
//! * [`winds_twice`] and [`turns`] count turns around vertices.
//!
//! Only signs of areas (Shewchuk's adaptive predicate) and comparisons of coordinates decide.
//!
//! ```
//! use abf_mesh::{Point2, Topology};
//! use abf_overlap::BoundaryTest;
//! use abf_shapes::Shape;
//!
//! let mesh = Shape::BumpySheet.mesh(200);
//! let topology = Topology::build(mesh.vertex_count(), mesh.faces())?;
//! // Seen from above, the sheet is a drawing of itself.
//! let uv: Vec<Point2<f64>> = mesh.positions().iter().map(|p| Point2::new(p.x, p.y)).collect();
//! assert!(BoundaryTest::new(&topology).is_clear(&uv, &mut || Ok(()))?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Where things are: `sheet.rs` triangles joined where they share an edge · `overlaps/` what the boundary tells ·
//! `boundary_test.rs` the same for drawings of one mesh · `winding.rs` turns · `box_tree.rs` a hierarchy of boxes ·
//! `direction.rs` directions around a point.

mod boundary_test;
mod box_tree;
mod direction;
mod overlaps;
mod sheet;
mod winding;

pub use boundary_test::BoundaryTest;
pub use box_tree::{BoxTree, Extent};
pub use overlaps::Overlaps;
pub use sheet::{Fan, Sheet};
pub use winding::{turns, winds_twice};
