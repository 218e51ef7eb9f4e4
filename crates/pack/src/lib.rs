//! Polygons with holes into pages, by their true shape, all at one scale.
//!
//! ```
//! use abf_pack::{PackSettings, Piece, pack};
//!
//! // A frame, and a square that goes into its hole.
//! let square = |low: f64, high: f64| vec![[low, low], [high, low], [high, high], [low, high]];
//! let frame = Piece::new(vec![square(0.0, 10.0), square(1.0, 9.0)]);
//! let inner = Piece::new(vec![square(0.0, 7.0)]);
//!
//! let packing = pack(&[frame, inner], &PackSettings::default())?;
//! assert!(packing.coverage > 0.8);
//! // In texels of its page.
//! let corner = packing.texel(1, [0.0, 0.0]);
//! assert!(corner[0] > 100.0 && corner[0] < 1024.0);
//! # Ok::<(), abf_pack::PackError>(())
//! ```
//!
//! **Margins hold by geometry.** Every piece has two sets of cells of a grid: the cells that it touches, and the cells that
//! a point nearer than the margin touches. Pieces are put where the second set of the one meets no cell of the first set of
//! another. So no two points of two pieces are nearer than the margin, whatever the size of the cells.
//!
//! [`side_by_side`] puts pieces beside each other at their own scale instead, for cutting.
//!
//! **The result does not depend on time or threads.** What is tried is counted, not timed.

mod boxes;
mod combine;
mod error;
mod gaps;
mod geometry;
mod grid;
mod page;
mod piece;
mod raster;
mod search;
mod settings;
mod shape;
mod side_by_side;
mod stage;

pub use error::PackError;
pub use gaps::{Gap, gaps};
pub use piece::{Packing, Piece, Placement};
pub use search::pack;
pub use settings::{Effort, PackSettings};
pub use side_by_side::{SideBySide, side_by_side};
