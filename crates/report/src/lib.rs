//! What people look at: pictures of a flattened mesh, layouts for machines, and pages about runs.
//!
//! * [`picture()`] returns a PNG: on the left the surface, textured with a checkerboard through its
//!   UVs, on the right the layout with the same checkerboard. Where the squares of the surface are
//!   square and of one size, the map keeps angles and areas; the hue drifts across the layout, so
//!   that a place on one side can be found on the other.
//! * [`svg::layout_svg`] and [`dxf::layout_dxf`] return the layout in real units, in layers for cutters and plotters.
//! * [`page::render`] returns one self-contained HTML page about many runs on many meshes: pictures,
//!   tables, convergence and histograms. [`plots`] returns its charts as SVG documents, and [`error_svg`] the layout coloured
//!   by its angle errors. [`sparsity_svg`] draws where the entries of a matrix are.
//!
//! All pictures go through one small software renderer. `raster` decides which triangle is seen at
//! every sample, and only then is each sample coloured, once, with what its face is painted with
//! (`skin`): the cost is linear in triangles and pixels. Coordinates in a panel are samples with y
//! pointing up, so counter-clockwise means the same there, in the UVs and on the surface.
//!
//! **Invariant:** the same input gives the same bytes, in every format.

mod camera;
mod checker;
mod colour;
mod drawing;
pub mod dxf;
mod error;
mod error_map;
mod layout;
pub mod page;
mod panel;
mod picture;
mod plot;
mod raster;
mod scale;
mod scene;
mod skin;
mod sparsity;
mod surface;
pub mod svg;

pub use camera::View;
pub use error::PictureError;
pub use error_map::error_svg;
pub use picture::{PictureStyle, picture, picture_unless};
pub use plot::{Plot, plots};
pub use sparsity::{SparsityPanel, sparsity_png, sparsity_svg};
