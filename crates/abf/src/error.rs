//! Why there is no result.

use abf_constraints::ProblemError;
use abf_embed::EmbedError;
use abf_mesh::{DiskError, GeometryError, TopologyError};
use abf_metrics::MetricsError;
use abf_reconstruct::{LayoutError, LayoutKind};
use abf_solve_core::SolveError;

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
        solver: &'static str,
        /// Why.
        source: SolveError,
    },
    /// The angles could not be laid out.
    #[error("the angles could not be laid out")]
    Layout(#[from] LayoutError),
    /// The descent found no drawing.
    #[error("the descent found no drawing without flips")]
    Descent(#[from] EmbedError),
    /// The descent moves vertices and has no angles to lay out.
    #[error("the descent places the vertices itself: it cannot use the layout '{0}'")]
    DescentLayout(LayoutKind),
    /// LSCM is a least squares layout and has no angles to integrate.
    #[error("lscm is a least squares layout: it cannot use the layout '{0}'")]
    LscmLayout(LayoutKind),
    /// The UVs could not be judged: they do not fit into the precision asked for.
    #[error("the UVs could not be judged")]
    Certificate(#[from] MetricsError),
    /// Cancelled before there was anything to return.
    #[error("cancelled before there was a result")]
    Cancelled,
}

impl From<ProblemError> for FlattenError {
    fn from(error: ProblemError) -> Self {
        match error {
            ProblemError::NotADisk(disk) => Self::NotADisk(disk),
            other => Self::Problem(other),
        }
    }
}
