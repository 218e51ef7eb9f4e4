//! From the library's errors to Python exceptions.

use abf::constraints::ProblemError;
use abf::embed::EmbedError;
use abf::{ArrayError, AtlasError, FlattenError, JudgeError, MetricsError, PackError, UnwrapError};
use pyo3::create_exception;
use pyo3::exceptions::{PyMemoryError, PyOSError, PyValueError};
use pyo3::prelude::*;
use std::error::Error;
use std::io;

create_exception!(
    abf_flatten,
    AbfError,
    PyValueError,
    "Why there is no result. Every error of its own kind derives from it."
);
create_exception!(abf_flatten, ShapeError, AbfError, "An array of another shape than is needed.");
create_exception!(
    abf_flatten,
    GeometryError,
    AbfError,
    "Coordinates that are not finite, indices out of range, no faces, or faces without area."
);
create_exception!(abf_flatten, TopologyError, AbfError, "Faces that form no oriented manifold: unwrap() repairs them.");
create_exception!(abf_flatten, NotADiskError, AbfError, "A mesh that is no disk: unwrap() takes it.");
create_exception!(
    abf_flatten,
    SettingError,
    AbfError,
    "A setting outside its range, or settings that do not go together."
);
create_exception!(
    abf_flatten,
    NoResultError,
    AbfError,
    "No solver found a map, or the charts do not fit into their pages."
);
create_exception!(
    abf_flatten,
    FormatError,
    AbfError,
    "A mesh file that cannot be understood, or a format that is not known."
);

/// An error and all its causes in one line.
pub(crate) fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text.push_str(": ");
        text.push_str(&error.to_string());
        cause = error.source();
    }
    text
}

/// What kind of exception an error becomes.
#[derive(Clone, Copy)]
enum Kind {
    NotADisk,
    Topology,
    Geometry,
    Setting,
    Memory,
    NoResult,
}

impl Kind {
    fn exception(self, text: String) -> PyErr {
        match self {
            Self::NotADisk => NotADiskError::new_err(text),
            Self::Topology => TopologyError::new_err(text),
            Self::Geometry => GeometryError::new_err(text),
            Self::Setting => SettingError::new_err(text),
            Self::Memory => PyMemoryError::new_err(text),
            Self::NoResult => NoResultError::new_err(text),
        }
    }
}

/// An error of the library that becomes an exception.
pub(crate) trait Raised: Error + Sized + 'static {
    /// The exception.
    fn raised(self) -> PyErr;
}

impl Raised for FlattenError {
    fn raised(self) -> PyErr {
        of_flatten(&self).exception(chain(&self))
    }
}

impl Raised for ArrayError {
    fn raised(self) -> PyErr {
        let kind = match &self {
            Self::IndexCount { .. } | Self::Index { .. } | Self::NotFinite { .. } | Self::Geometry(_) => Kind::Geometry,
            Self::Unwrap(error) => of_unwrap(error),
            Self::Atlas(error) => of_atlas(error),
            _ => Kind::NoResult,
        };
        kind.exception(chain(&self))
    }
}

impl Raised for AtlasError {
    fn raised(self) -> PyErr {
        of_atlas(&self).exception(chain(&self))
    }
}

impl Raised for JudgeError {
    fn raised(self) -> PyErr {
        Kind::Geometry.exception(chain(&self))
    }
}

impl Raised for MetricsError {
    fn raised(self) -> PyErr {
        Kind::Geometry.exception(chain(&self))
    }
}

fn of_flatten(error: &FlattenError) -> Kind {
    match error {
        FlattenError::NotADisk(_) | FlattenError::Descent(EmbedError::NotADisk(_)) => Kind::NotADisk,
        FlattenError::Topology(_) => Kind::Topology,
        FlattenError::Geometry(_)
        | FlattenError::Certificate(
            MetricsError::NoFaces | MetricsError::NoArea { .. } | MetricsError::PositionNotFinite { .. },
        )
        | FlattenError::Problem(ProblemError::Angle { .. }) => Kind::Geometry,
        FlattenError::Problem(_) => Kind::Setting,
        settings if settings.is_of_settings() => Kind::Setting,
        FlattenError::Memory { .. } => Kind::Memory,
        FlattenError::RelaxChart { source, .. } => of_flatten(source),
        _ => Kind::NoResult,
    }
}

fn of_unwrap(error: &UnwrapError) -> Kind {
    match error {
        UnwrapError::Repair(_) => Kind::Geometry,
        UnwrapError::NotClean { .. } => Kind::Topology,
        UnwrapError::Hint { .. } | UnwrapError::Setting(_) => Kind::Setting,
        UnwrapError::Chart { source, .. } | UnwrapError::Flatten(source) => of_flatten(source),
        _ => Kind::NoResult,
    }
}

fn of_atlas(error: &AtlasError) -> Kind {
    match error {
        AtlasError::Setting(_)
        | AtlasError::Labels { .. }
        | AtlasError::Pack(PackError::Setting(_) | PackError::PageTooSmall { .. }) => Kind::Setting,
        AtlasError::Metrics(_) => Kind::Geometry,
        _ => Kind::NoResult,
    }
}

/// What the system says of a file: `FileNotFoundError` and its like, with the number of the system's error.
pub(crate) fn of_system(cause: &io::Error, text: String) -> PyErr {
    match cause.raw_os_error() {
        // Python takes the subclass from the number.
        Some(number) => PyOSError::new_err((number, text)),
        None => io::Error::new(cause.kind(), text).into(),
    }
}
