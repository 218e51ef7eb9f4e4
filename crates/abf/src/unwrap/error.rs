//! Why there are no charts.

use crate::FlattenError;
use abf_control::{Cancelled, SettingError};
use abf_cut::{RepairError, RepairReport};
use abf_mesh::FaceId;
use abf_metrics::MetricsError;

/// Why a mesh could not be unwrapped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnwrapError {
    /// There is nothing to work with.
    #[error(transparent)]
    Repair(RepairError),
    /// A strict run met a mesh that needs repair.
    #[error("the mesh is not clean, and a strict run repairs nothing: {}", .found.join(", "))]
    NotClean {
        /// What would be done, a sentence for each kind.
        found: Vec<String>,
    },
    /// A hint that is not of this mesh.
    #[error("{given} {what}, but the mesh has {expected}")]
    Hint {
        /// Of what.
        what: &'static str,
        /// How many were given.
        given: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A setting outside its range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A component or chart that could not be flattened.
    #[error("the chart that begins at face {first} could not be flattened")]
    Chart {
        /// Its first face, by its number in the input.
        first: FaceId,
        /// Why.
        source: FlattenError,
    },
    /// The observer aborted it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The cut surface is not what it should be.
    #[error(transparent)]
    Flatten(#[from] FlattenError),
}

impl From<RepairError> for UnwrapError {
    fn from(error: RepairError) -> Self {
        match error {
            RepairError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Repair(error),
        }
    }
}

impl UnwrapError {
    /// Whether a part of the mesh has no area at all, so that there is nothing to flatten or to judge.
    pub(super) fn is_without_area(&self) -> bool {
        matches!(self, Self::Chart { source: FlattenError::Certificate(MetricsError::NoArea { .. }), .. })
    }
}

/// What a strict run says to a mesh that needs repair.
pub(super) fn refuse_repairs(report: &RepairReport) -> Result<(), UnwrapError> {
    if report.is_clean() && report.zero_area_faces.count == 0 {
        return Ok(());
    }
    // Unused vertices are no reason to refuse.
    let mut reasons = *report;
    reasons.unused_vertices = 0;
    Err(UnwrapError::NotClean { found: reasons.sentences() })
}
