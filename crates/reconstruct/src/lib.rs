//! From angles to coordinates.
//!
//! Angles determine a planar mesh up to a similarity, if they close. Three ways to lay it out:
//!
//! * [least squares](LayoutKind::LeastSquares) (ABF++; the papers' default): every triangle asks
//!   its third vertex to stand where its angles say, all of them are satisfied as well as possible.
//!   Works for angles that do not close, such as those of a single pass of LinABF. On the angles of
//!   the surface itself, [weighted](LayoutKind::LeastSquaresWeighted), it is LSCM (Lévy et al. 2002).
//! * [tree integration](LayoutKind::Tree): edge lengths and directions are carried from triangle
//!   to triangle, in logarithms and in radians, where errors add instead of multiplying; linear time.
//! * [Poisson](LayoutKind::Poisson): the integrated edge vectors as the right-hand side of a
//!   cotangent-Laplacian solve, which spreads what is left of the error.
//!
//! [`LayoutKind::Auto`] takes the tree when the angles close, else least squares. For angles that
//! close all of them give the same drawing.
//!
//! Whatever the method, the first of two boundary [pins](PinnedPair) is put at the origin, the second on
//! the positive x-axis, triangles run counter-clockwise, and the total UV area equals the area of
//! the surface.

mod layout;
mod least_squares;
mod numbering;
mod pins;
mod poisson;
mod tree;

pub use abf_linalg::{LinearError, LinearStats};
pub use layout::{ANGLE_CLAMP, Layout, LayoutError, LayoutKind, LayoutSettings, aligned, layout, layout_asking};
pub use pins::PinnedPair;
