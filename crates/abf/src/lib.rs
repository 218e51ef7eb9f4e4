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

pub use abf_mesh as mesh;

pub use abf_constraints::{Boundary, BoundaryAngle, GuessSettings, KktCounts, WheelForm};
pub use abf_control::{
    Cancelled, Drawing, Event, Fallback, IterationRecord, Observer, SettingError, Silent, Stage, StopCriteria,
    Termination, UnknownName, UnwrapProgress, Verdict,
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
pub use atlas::{
    Atlas, AtlasError, AtlasPages, NarrowPlace, Packed, Parted, Parting, Placement, Repack, Repacked, Stored,
};
pub use error::{Elsewhere, FlattenError};
pub use flattening::{
    BoundaryReport, Flattening, HierarchyReport, InjectiveReport, LayoutReport, PinReport, RelaxReport, RelaxedMap,
    RungReport,
};
pub use judge::{JudgeError, JudgeSettings, Judgement, judge};
pub use pattern::{Developed, Laid, Orient, Pattern};
pub use precision_limits::PrecisionLimits;
pub use run::flatten;
pub use settings::*;
pub use solve_report::SolveReport;
pub use unwrap::{HoleRule, SeamRule, SurfaceHints, Unwrap, UnwrapError, Unwrapped, UnwrappedChart};

/// The constraints as functions of angles, for solvers of your own; settings and counts are at the root of the crate.
pub mod constraints {
    pub use abf_constraints::{
        AngleProblem, BadAngle, BadAngleCause, BoundaryConditions, BoundaryError, ConstraintRows, Jacobian,
        ProblemError, RESIDUAL_CLAMP, TriangleReduction, TriangleRows, WheelDerivative, angles_out_of_range,
        boundary_loop, largest, linearise, max_residual, residual,
    };
}

/// Run control for code of your own that takes long; observers and events are at the root of the crate.
pub mod control {
    pub use abf_control::{Checkpoint, TimeBudget, Watch, ask, at_block, set_clock};
}

/// Repair, filled holes, seams and charts by themselves; the settings of [`Unwrap`] are at the root of the crate.
pub mod cut {
    pub use abf_cut::{
        Chart, ConformalScale, CostSettings, EdgeCosts, Filled, Found, HardSurface, HoleFilling, PlanarFacets,
        RepairError, RepairReport, Repaired, SeamWays, Seams, Welded, distances, extend, fill, hard_surface,
        hard_surface_asking, label_borders, loop_length, open, outer_loop, planar_facets, repair, repair_asking,
        repair_with, scaled_angles, split, split_asking, two_parts, two_parts_asking, uv_borders, weld, weld_asking,
        weld_within,
    };
}

/// Tutte's embedding, and what the descent from it and [`Relax`] do; these two are at the root of the crate.
pub mod embed {
    pub use abf_embed::{
        BoundarySpacing, DescentRecord, DescentSolution, EmbedError, FirstDrawing, InjectiveDrawing, PinError,
        PinFault, PinResidual, PinnedDrawing, RelaxStep, RelaxedDrawing, StepKind, TutteEmbedding, TutteWeights,
        boundary_gap, first_drawing, tutte, vertex_points,
    };
}

/// What hierarchical solvers report; the settings, [`Hierarchical`], are at the root of the crate.
pub mod hierarchy {
    pub use abf_solve_hierarchical::{LevelReport, NoHierarchy, RefineError};
}

/// Distortion and validity of any UV map; what they come to, [`Metrics`] and [`Certificate`], is at the root of the crate.
pub mod metrics {
    pub use abf_metrics::{
        FaceDistortion, Orientation, certify, certify_asking, certify_connected, certify_connected_asking,
        certify_stored, certify_stored_asking, charts, measure, measure_certified, per_face,
    };
}

/// How many threads a call takes.
pub mod parallel {
    pub use abf_parallel::{Pool, PoolError, current_num_threads, with_threads};
}

/// From angles to coordinates; which layout is asked for is at the root of the crate.
pub mod reconstruct {
    pub use abf_reconstruct::{ANGLE_CLAMP, Layout, LayoutError, PinnedPair, aligned, layout, layout_asking};
}

/// The parts that solvers are made of; the settings they share are at the root of the crate.
pub mod solve_core {
    pub use abf_solve_core::{
        ConstraintProducts, DirectStep, FrozenStep, KktStep, KktSystem, KktVector, LeastCorrection, LinearError,
        LinearStats, Linearisation, Preconditioning, ProductCurvature, ReducedSystem, SchurComplement, SolveError,
        StepError, StepReport, add_transposed_product, constraint_residual,
    };
}

/// The code in the documents compiles and runs.
#[cfg(all(doctest, feature = "io"))]
mod documents {
    #[doc = include_str!("../../../README.md")]
    struct Readme;
    #[doc = include_str!("../../../docs/library.md")]
    struct Library;
}
