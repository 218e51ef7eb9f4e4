//! Flatten triangle meshes to the plane by solving for the angles of the flat mesh.
//!
//! ```
//! use abf::mesh::{Point3, TriMesh};
//!
//! // A pyramid without its base.
//! let points = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.5]];
//! let mesh = TriMesh::new(points.map(Point3::from).to_vec(), &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])?;
//!
//! let flat = abf::flatten(&mesh)?;
//! assert!(flat.termination.is_as_asked());
//! // Proved, not measured: no triangle is turned over, and none lies over another.
//! assert!(flat.certificate.injective());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`flatten`] uses the defaults: [`Solver::Auto`], a ladder of solvers up to the first whose result is proved valid;
//! [`Flattening::rungs`] says which were tried. [`Pipeline`] holds every setting: which [`Solver`],
//! which layout, when to stop. [`Unwrap`] takes meshes that are no disks: closed, with holes or handles, in several parts,
//! broken; it repairs, cuts and flattens them chart by chart. Core crates print nothing; an [`Observer`] hears what happens and may
//! stop a run, with a result, or abort it, without one.

mod arrays;
mod atlas;
mod error;
mod flattening;
mod judge;
mod pattern;
mod precision_limits;
mod run;
mod settings;
mod solve_report;
mod unwrap;

pub use abf_constraints as constraints;
pub use abf_control as control;
pub use abf_cut as cut;
pub use abf_embed as embed;
pub use abf_mesh as mesh;
pub use abf_metrics as metrics;
pub use abf_parallel as parallel;
pub use abf_reconstruct as reconstruct;
pub use abf_solve_core as solve_core;

pub use abf_constraints::{EstimateSettings, KktCounts, WheelForm};
pub use abf_control::{
    Cancelled, Event, Fallback, IterationRecord, Observer, Place, SettingError, Silent, Stage, StopCriteria,
    Termination, UnknownName, Verdict,
};
pub use abf_cut::{DoubleSided, Weld};
pub use abf_metrics::{Certificate, Metrics, MetricsError, Precision};
pub use abf_pack::{Effort, PackError};
pub use abf_reconstruct::{LayoutKind, LayoutSettings};
pub use abf_solve_core::{
    AngleSolution, AngleSolver, BoundRule, Hessian, InnerTolerance, IterativeSettings, LineSearch, NewtonSettings,
    PreconditionerKind, Reduction,
};
pub use arrays::{ArrayError, ArrayUnwrapper, UnwrappedArrays};
pub use atlas::{Atlas, AtlasError, AtlasPages, NarrowPlace, Packed, Placement, Repack, Repacked, Stored};
pub use error::FlattenError;
pub use flattening::{Flattening, LayoutReport, RungReport};
pub use judge::{JudgeError, JudgeSettings, Judgement, judge};
pub use pattern::{Developed, Laid, Orient, Pattern};
pub use precision_limits::PrecisionLimits;
pub use run::flatten;
pub use settings::*;
pub use solve_report::SolveReport;
pub use unwrap::{HoleRule, SeamRule, SurfaceHints, Unwrap, UnwrapError, Unwrapped, UnwrappedChart};

/// The code in the documents compiles and runs.
#[cfg(all(doctest, feature = "io"))]
mod documents {
    #[doc = include_str!("../../../README.md")]
    struct Readme;
    #[doc = include_str!("../../../docs/library.md")]
    struct Library;
}
