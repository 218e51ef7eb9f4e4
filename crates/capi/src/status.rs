//! What became of a call.

use abf::constraints::ProblemError;
use abf::cut::RepairError;
use abf::mesh::GeometryError;
use abf::{ArrayError, AtlasError, FlattenError, MetricsError, UnwrapError};
use std::error::Error;
use std::ffi::CStr;

/// What became of a call. Codes are never renumbered; `abf_last_error` has the sentence.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AbfStatus {
    /// There is a result. Its view says whether it is valid.
    Ok = 0,
    /// A pointer that is null and may not be, or is not aligned to what it points to.
    Pointer = 1,
    /// A `size` field that is not the size of a struct that this version of the library knows.
    StructSize = 2,
    /// Counts whose arrays cannot exist, or have more elements than 32-bit indices can name.
    TooLarge = 3,
    /// A stride below 12 bytes, or not a multiple of 4.
    Stride = 4,
    /// A number of indices that is not a multiple of 3.
    IndexCount = 5,
    /// An index without a vertex.
    IndexRange = 6,
    /// A coordinate that is NaN or infinite.
    NotFinite = 7,
    /// A setting out of range, or a name that nothing has.
    Setting = 8,
    /// The mesh is not a disk: `abf_unwrap` takes it.
    NotADisk = 9,
    /// No faces, or faces that form no oriented manifold: `abf_unwrap` repairs those.
    Topology = 10,
    /// Faces without area.
    Geometry = 11,
    /// The mesh needs repair, and `strict` was set.
    NotClean = 12,
    /// It would take more memory than `max_memory`; none of it was taken.
    Memory = 13,
    /// The callback aborted, or stopped before there was anything to return.
    Cancelled = 14,
    /// No solver found a map.
    NoResult = 15,
    /// The charts do not fit into the atlas.
    Packing = 16,
    /// The system gives no threads.
    Threads = 17,
    /// A defect of the library. Please report it with the sentence.
    Internal = 18,
}

impl AbfStatus {
    /// All of them, in the order of their codes.
    pub(crate) const ALL: [Self; 19] = [
        Self::Ok,
        Self::Pointer,
        Self::StructSize,
        Self::TooLarge,
        Self::Stride,
        Self::IndexCount,
        Self::IndexRange,
        Self::NotFinite,
        Self::Setting,
        Self::NotADisk,
        Self::Topology,
        Self::Geometry,
        Self::NotClean,
        Self::Memory,
        Self::Cancelled,
        Self::NoResult,
        Self::Packing,
        Self::Threads,
        Self::Internal,
    ];

    /// Its name in words with hyphens.
    #[must_use]
    pub const fn name(self) -> &'static CStr {
        match self {
            Self::Ok => c"ok",
            Self::Pointer => c"pointer",
            Self::StructSize => c"struct-size",
            Self::TooLarge => c"too-large",
            Self::Stride => c"stride",
            Self::IndexCount => c"index-count",
            Self::IndexRange => c"index-range",
            Self::NotFinite => c"not-finite",
            Self::Setting => c"setting",
            Self::NotADisk => c"not-a-disk",
            Self::Topology => c"topology",
            Self::Geometry => c"geometry",
            Self::NotClean => c"not-clean",
            Self::Memory => c"memory",
            Self::Cancelled => c"cancelled",
            Self::NoResult => c"no-result",
            Self::Packing => c"packing",
            Self::Threads => c"threads",
            Self::Internal => c"internal",
        }
    }
}

/// A status with its sentence.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Failure {
    pub(crate) status: AbfStatus,
    pub(crate) text: String,
}

impl Failure {
    pub(crate) fn new(status: AbfStatus, text: impl Into<String>) -> Self {
        Self { status, text: text.into() }
    }

    fn of(status: AbfStatus, error: &dyn Error) -> Self {
        Self { status, text: chain(error) }
    }

    /// A setting that was refused.
    pub(crate) fn setting(error: &dyn Error) -> Self {
        Self::of(AbfStatus::Setting, error)
    }
}

impl From<FlattenError> for Failure {
    fn from(error: FlattenError) -> Self {
        Self::of(of_flatten(&error), &error)
    }
}

impl From<ArrayError> for Failure {
    fn from(error: ArrayError) -> Self {
        let status = match &error {
            ArrayError::IndexCount { .. } => AbfStatus::IndexCount,
            ArrayError::Index { .. } => AbfStatus::IndexRange,
            ArrayError::NotFinite { .. } => AbfStatus::NotFinite,
            ArrayError::Geometry(geometry) => of_geometry(geometry),
            ArrayError::Unwrap(unwrap) => of_unwrap(unwrap),
            ArrayError::Atlas(atlas) => of_atlas(atlas),
            _ => AbfStatus::NoResult,
        };
        Self::of(status, &error)
    }
}

impl From<MetricsError> for Failure {
    fn from(error: MetricsError) -> Self {
        Self::of(of_metrics(&error), &error)
    }
}

fn of_flatten(error: &FlattenError) -> AbfStatus {
    match error {
        FlattenError::Geometry(geometry) => of_geometry(geometry),
        FlattenError::Topology(_) => AbfStatus::Topology,
        FlattenError::NotADisk(_) | FlattenError::Problem(ProblemError::NotADisk(_)) => AbfStatus::NotADisk,
        settings if settings.is_of_settings() => AbfStatus::Setting,
        FlattenError::Memory { .. } => AbfStatus::Memory,
        FlattenError::Cancelled(_) => AbfStatus::Cancelled,
        FlattenError::Certificate(metrics) => of_metrics(metrics),
        FlattenError::RelaxChart { source, .. } => of_flatten(source),
        _ => AbfStatus::NoResult,
    }
}

fn of_geometry(error: &GeometryError) -> AbfStatus {
    match error {
        GeometryError::IndexOutOfRange { .. } => AbfStatus::IndexRange,
        GeometryError::NotFinite { .. } => AbfStatus::NotFinite,
        _ => AbfStatus::Geometry,
    }
}

fn of_metrics(error: &MetricsError) -> AbfStatus {
    match error {
        MetricsError::Cancelled(_) => AbfStatus::Cancelled,
        MetricsError::NoFaces => AbfStatus::Topology,
        MetricsError::NoArea { .. } => AbfStatus::Geometry,
        MetricsError::PositionNotFinite { .. } | MetricsError::UvNotFinite { .. } => AbfStatus::NotFinite,
        _ => AbfStatus::NoResult,
    }
}

fn of_unwrap(error: &UnwrapError) -> AbfStatus {
    match error {
        UnwrapError::Repair(RepairError::Geometry(geometry)) => of_geometry(geometry),
        UnwrapError::Repair(_) => AbfStatus::Topology,
        UnwrapError::NotClean { .. } => AbfStatus::NotClean,
        UnwrapError::Hint { .. } | UnwrapError::Setting(_) => AbfStatus::Setting,
        UnwrapError::Chart { source, .. } | UnwrapError::Flatten(source) => of_flatten(source),
        UnwrapError::Cancelled(_) => AbfStatus::Cancelled,
        _ => AbfStatus::NoResult,
    }
}

fn of_atlas(error: &AtlasError) -> AbfStatus {
    match error {
        AtlasError::Setting(_) | AtlasError::Labels { .. } => AbfStatus::Setting,
        AtlasError::TooManyCharts { .. } | AtlasError::Pack(_) => AbfStatus::Packing,
        AtlasError::Metrics(metrics) => of_metrics(metrics),
        _ => AbfStatus::NoResult,
    }
}

/// An error with its causes, in one line.
fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        text.push_str(": ");
        text.push_str(&cause.to_string());
        source = cause.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_their_places_and_names_differ() {
        for (code, status) in AbfStatus::ALL.into_iter().enumerate() {
            assert_eq!(status as usize, code);
            assert_eq!(AbfStatus::ALL.iter().filter(|other| other.name() == status.name()).count(), 1, "{status:?}");
        }
    }
}
