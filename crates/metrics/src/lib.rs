//! Distortion and validity of a UV map, judged from the mesh and the UVs alone.
//!
//! [`measure`] sums a map up in one [`Metrics`]; [`per_face`] gives the same figures triangle by
//! triangle, for pictures and histograms. Neither asks how the map was made, and neither needs a
//! manifold, a disk or one chart: whatever has a UV at every corner can be judged, so every method
//! and every foreign file is held to the same measure.
//!
//! Two kinds of questions are answered in two ways:
//!
//! * *Is the map valid?* is a question of signs. The orientation of every UV triangle is the exact
//!   one of the coordinates as they are stored (Shewchuk's adaptive predicate), never that of a
//!   rounded area, so "no flip" is a statement about the map and not about a tolerance. In the same way
//!   [`certify`] counts the turns around every vertex and finds where the map lies over itself: its
//!   [`Certificate`] says whether the map is one to one, locally and as a whole.
//! * *How good is it?* is a question of sizes: angle errors, stretch, quasi-conformal and area
//!   distortion. All of them are ratios that no translation, rotation, mirroring or uniform scaling
//!   of the UVs changes, and all of them are computed after both surfaces have been scaled by
//!   powers of two, which is exact, so that neither tiny nor huge coordinates overflow.
//!
//! | symbol | code name | meaning |
//! | --- | --- | --- |
//! | A₃, ΣA₃ | `surface_area` | area of a triangle, of all triangles, in 3-D |
//! | A₂, ΣA₂ | `uv_area` | the same in the plane, without sign |
//! | α° | `mesh_angles` | angles of the 3-D triangle, rad |
//! | x | `uv_angles` | angles of the UV triangle, rad |
//! | s₁ ≥ s₂ | | singular values of the affine map from the UV triangle to the 3-D triangle |

mod certificate;
mod charts;
mod error;
mod face;
mod interval;
mod measure;
mod precision;
#[cfg(feature = "serde")]
mod serialise;
mod triangle;

pub use certificate::{
    Certificate, certify, certify_asking, certify_connected, certify_connected_asking, certify_stored,
    certify_stored_asking,
};
pub use charts::charts;
pub use error::MetricsError;
pub use face::{FaceDistortion, Orientation, per_face};
pub use measure::{Metrics, measure, measure_certified};
pub use precision::Precision;
