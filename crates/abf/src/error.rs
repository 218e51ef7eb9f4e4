//! Why there is no result.

use crate::settings::{Injective, SolverKind};
use abf_constraints::ProblemError;
use abf_control::Cancelled;
use abf_embed::{EmbedError, PinError};
use abf_mesh::{DiskError, FaceId, GeometryError, TopologyError};
use abf_metrics::MetricsError;
use abf_reconstruct::{LayoutError, LayoutKind};
use abf_solve_core::SolveError;
use std::fmt;

/// What a setting does not go with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Elsewhere {
    /// UVs scaled into the unit square.
    Normalize,
    /// A rule for the boundary.
    Boundary,
    /// Pins.
    Pins,
    /// A mesh that is cut into charts.
    Charts,
    /// A map that has seams already, or several charts.
    Seams,
    /// A map that is there already.
    Map,
}

impl fmt::Display for Elsewhere {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Normalize => "normalize",
            Self::Boundary => "a boundary rule",
            Self::Pins => "pins",
            Self::Charts => "charts",
            Self::Seams => "a map with seams or of several charts",
            Self::Map => "a map that is there",
        })
    }
}

/// Why a mesh could not be flattened.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlattenError {
    /// Coordinates that are not finite, or faces without area.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Faces that do not form an oriented manifold.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// A manifold that is not a disk.
    #[error(transparent)]
    NotADisk(#[from] DiskError),
    /// A setting out of range, or angles no triangle has.
    #[error(transparent)]
    Problem(ProblemError),
    /// The solver found no angles.
    #[error("the solver '{solver}' found no angles")]
    Solve {
        /// Which solver.
        solver: SolverKind,
        /// Why.
        source: SolveError,
    },
    /// The angles could not be laid out.
    #[error("the angles could not be laid out")]
    Layout(#[source] LayoutError),
    /// The descent found no drawing.
    #[error("the descent found no drawing without flips")]
    Descent(#[source] EmbedError),
    /// The descent moves vertices and has no angles to lay out.
    #[error("the descent places the vertices itself: it cannot use the layout '{0}'")]
    DescentLayout(LayoutKind),
    /// The map could not be relaxed.
    #[error("the map could not be relaxed")]
    Relax(#[source] EmbedError),
    /// There is no map without overlaps to start from.
    #[error("no map without overlaps was found")]
    Injective(#[source] EmbedError),
    /// What keeps a map from lying over itself moves the boundary, and parts it.
    #[error("the rule '{0}' for overlaps does not go with {1}")]
    InjectiveElsewhere(Injective, Elsewhere),
    /// A gap is kept by a map that is deformed, in the units of the mesh.
    #[error("a boundary gap needs the rule 'deform' for overlaps, and UVs that are not normalized")]
    GapElsewhere,
    /// With a larger gap nearly every pair of places on the boundary would be too near.
    #[error("a boundary gap of {gap} is too large for this mesh: at most {most}")]
    GapTooLarge {
        /// What was asked for.
        gap: f64,
        /// A quarter of the side of a square as large as the surface.
        most: f64,
    },
    /// Pins that no map of the mesh can have.
    #[error("the pins do not fit the mesh")]
    Pins(#[source] PinError),
    /// A chart of a map could not be relaxed.
    #[error("the chart of face {face} could not be relaxed")]
    RelaxChart {
        /// Its first face.
        face: FaceId,
        /// Why; what it counts is counted in the chart.
        #[source]
        source: Box<Self>,
    },
    /// Pins say where the map is.
    #[error("pins do not go with {0}")]
    PinsElsewhere(Elsewhere),
    /// Relaxing moves the boundary.
    #[error("relaxing to the energy '{0}' moves the boundary: it does not keep a boundary rule")]
    RelaxBoundary(String),
    /// Only some solvers keep what is asked of the boundary.
    #[error("the solver '{0}' does not keep a boundary rule: auto, linabf and barrier do")]
    BoundarySolver(SolverKind),
    /// A rule is for the boundary of one disk, and seams make boundaries of their own.
    #[error("the boundary rule '{0}' is for one disk without holes, uncut, and this makes charts")]
    BoundaryCharts(String),
    /// LSCM is a least squares layout and has no angles to integrate.
    #[error("lscm is a least squares layout: it cannot use the layout '{0}'")]
    LscmLayout(LayoutKind),
    /// The UVs could not be judged: they do not fit into the precision asked for.
    #[error("the UVs could not be judged")]
    Certificate(#[source] MetricsError),
    /// It would take more memory than [`Pipeline::max_memory`](crate::Pipeline::max_memory); none of it was taken.
    #[error(
        "the solver '{solver}' would take about {} for {triangles} triangles, and the limit is {}{}",
        in_units(*predicted), in_units(*limit), instead(*leaner)
    )]
    Memory {
        /// Which solver.
        solver: SolverKind,
        /// How many triangles the mesh has.
        triangles: usize,
        /// See [`predict_memory`](crate::predict_memory), bytes.
        predicted: u64,
        /// What is allowed, bytes.
        limit: u64,
        /// A solver that keeps within the limit, and what is predicted for it.
        leaner: Option<(SolverKind, u64)>,
    },
    /// Aborted, or stopped before there was anything to return.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl FlattenError {
    /// What a solver returned instead of angles.
    pub(crate) fn of_solver(solver: SolverKind, source: SolveError) -> Self {
        match source {
            SolveError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            source => Self::Solve { solver, source },
        }
    }

    /// Whether other settings would help: one is out of its range, or some do not go together or with the mesh.
    #[must_use]
    pub fn is_of_settings(&self) -> bool {
        matches!(
            self,
            Self::Problem(ProblemError::Setting(_) | ProblemError::Boundary(_))
                | Self::Solve { source: SolveError::Setting(_) | SolveError::Unsupported(_), .. }
                | Self::Descent(EmbedError::Setting(_))
                | Self::DescentLayout(_)
                | Self::LscmLayout(_)
                | Self::BoundarySolver(_)
                | Self::BoundaryCharts(_)
                | Self::Relax(EmbedError::Setting(_))
                | Self::RelaxBoundary(_)
                | Self::Pins(_)
                | Self::PinsElsewhere(_)
                | Self::Injective(EmbedError::Setting(_))
                | Self::InjectiveElsewhere(..)
                | Self::GapElsewhere
                | Self::GapTooLarge { .. }
        )
    }

    /// What came of relaxing instead of a map.
    pub(crate) fn of_relaxing(error: EmbedError) -> Self {
        match error {
            EmbedError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Relax(other),
        }
    }
}

impl From<LayoutError> for FlattenError {
    fn from(error: LayoutError) -> Self {
        match error {
            LayoutError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Layout(other),
        }
    }
}

impl From<MetricsError> for FlattenError {
    fn from(error: MetricsError) -> Self {
        match error {
            MetricsError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Certificate(other),
        }
    }
}

impl From<EmbedError> for FlattenError {
    fn from(error: EmbedError) -> Self {
        match error {
            EmbedError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Descent(other),
        }
    }
}

impl From<ProblemError> for FlattenError {
    fn from(error: ProblemError) -> Self {
        match error {
            ProblemError::NotADisk(disk) => Self::NotADisk(disk),
            other => Self::Problem(other),
        }
    }
}

/// Bytes in thousands, millions or billions, with no more digits than a prediction has.
fn in_units(bytes: u64) -> String {
    let bytes = bytes as f64;
    let (scale, unit) = if bytes < 1e6 {
        (1e3, "kB")
    } else if bytes < 1e9 {
        (1e6, "MB")
    } else {
        (1e9, "GB")
    };
    let amount = bytes / scale;
    if amount < 10.0 { format!("{amount:.1} {unit}") } else { format!("{amount:.0} {unit}") }
}

fn instead(leaner: Option<(SolverKind, u64)>) -> String {
    leaner.map_or_else(String::new, |(solver, bytes)| format!("; '{solver}' takes about {}", in_units(bytes)))
}
