//! Pictures of a flattened mesh: the checkered surface next to its layout.
//!
//! [`picture()`] takes a mesh and its UVs and returns a PNG. On the left is the surface, textured
//! with a checkerboard through its UVs; on the right the layout with the same checkerboard. Where
//! the squares of the surface are square and of one size, the map keeps angles and areas; the hue
//! drifts across the layout, so that a place on one side can be found on the other.
//!
//! Both halves go through one small software renderer. `raster` decides which triangle is seen at
//! every sample, and only then is each sample coloured, once: the cost is linear in triangles and
//! pixels, and the same input gives the same bytes. Coordinates in a panel are samples with y
//! pointing up, so counter-clockwise means the same there, in the UVs and on the surface.

mod camera;
mod checker;
mod colour;
mod error;
mod layout;
mod outline;
mod panel;
mod picture;
mod raster;
mod surface;

pub use camera::View;
pub use error::PictureError;
pub use picture::{PictureStyle, picture};
