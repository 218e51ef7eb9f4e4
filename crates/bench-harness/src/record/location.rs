//! Where something is wrong, as data.

use abf::constraints::ProblemError;
use abf::cut::RepairError;
use abf::{FlattenError, MetricsError, UnwrapError};
use abf_mesh::io::{FilePlace, Location as InFile, ReadError};
use abf_mesh::{DiskError, FaceId, GeometryError, TopologyError, VertexId};
use serde::{Deserialize, Serialize};

/// Where something is wrong: the first place, if there are several. What is not known is absent.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Location {
    /// The line of a text file, counted from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) line: Option<usize>,
    /// The byte of a binary file, counted from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) byte: Option<usize>,
    /// The place in a glTF document, such as `meshes[0].primitives[1]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) path: Option<String>,
    /// The faces, counted from 0, after polygons are cut into triangles.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) faces: Vec<usize>,
    /// The vertices, counted from 0.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) vertices: Vec<usize>,
    /// The corner of the face: 0, 1 or 2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) corner: Option<usize>,
    /// How many such places there are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) count: Option<usize>,
}

impl Location {
    /// Whether nothing is known.
    pub(crate) fn is_unknown(&self) -> bool {
        *self == Self::default()
    }

    /// Whether it names faces or vertices by numbers that count from 0.
    pub(crate) fn counts_from_zero(&self) -> bool {
        !(self.faces.is_empty() && self.vertices.is_empty())
    }

    fn faces<const N: usize>(faces: [FaceId; N]) -> Self {
        Self { faces: faces.map(FaceId::index).to_vec(), ..Self::default() }
    }

    fn vertices<const N: usize>(vertices: [VertexId; N]) -> Self {
        Self { vertices: vertices.map(VertexId::index).to_vec(), ..Self::default() }
    }

    fn of(self, count: usize) -> Self {
        Self { count: Some(count), ..self }
    }
}

/// Where a file is wrong.
pub(super) fn read(error: &ReadError) -> Location {
    match error {
        ReadError::NotFinite { at, count } | ReadError::TooFewCorners { at, count, .. } => in_file(at).of(*count),
        ReadError::IndexOutOfRange { at, count, .. } => in_file(at).of(*count),
        ReadError::BadNumber { at, .. }
        | ReadError::MissingCoordinate { at, .. }
        | ReadError::MissingValue { at, .. }
        | ReadError::BadIndex { at, .. }
        | ReadError::IndexZero { at, .. }
        | ReadError::BadListLength { at, .. }
        | ReadError::BadHeader { at, .. }
        | ReadError::Syntax { at, .. }
        | ReadError::Unsupported { at, .. }
        | ReadError::ClaimTooLarge { at, .. } => in_file(at),
        ReadError::Document { path, .. } | ReadError::Buffer { path, .. } | ReadError::Compressed { path, .. } => {
            Location { path: Some(path.clone()), ..Location::default() }
        }
        _ => Location::default(),
    }
}

/// Where a mesh cannot be flattened.
pub(super) fn flatten(error: &FlattenError) -> Location {
    match error {
        FlattenError::Geometry(error) => geometry(error),
        FlattenError::Topology(error) => topology(error),
        FlattenError::NotADisk(error) | FlattenError::Problem(ProblemError::NotADisk(error)) => disk(error),
        FlattenError::Problem(ProblemError::Angle { corner, face, count, .. }) => {
            Location { corner: Some(*corner), faces: vec![*face], count: Some(*count), ..Location::default() }
        }
        FlattenError::Certificate(error) => metrics(error),
        _ => Location::default(),
    }
}

/// Where a mesh cannot be made charts.
pub(super) fn unwrap(error: &UnwrapError) -> Location {
    match error {
        UnwrapError::Repair(RepairError::Geometry(error)) => geometry(error),
        UnwrapError::Repair(RepairError::Topology(error)) => topology(error),
        UnwrapError::Chart { first, .. } => Location::faces([*first]),
        UnwrapError::Flatten(error) => flatten(error),
        _ => Location::default(),
    }
}

/// Where UVs cannot be judged.
pub(super) fn metrics(error: &MetricsError) -> Location {
    match error {
        MetricsError::UvNotFinite { first, count } | MetricsError::PositionNotFinite { first, count } => {
            Location::faces([*first]).of(*count)
        }
        _ => Location::default(),
    }
}

fn in_file(at: &InFile) -> Location {
    match at.place {
        FilePlace::Line(line) => Location { line: Some(line), ..Location::default() },
        FilePlace::Byte(byte) => Location { byte: Some(byte), ..Location::default() },
    }
}

fn geometry(error: &GeometryError) -> Location {
    match error {
        // The vertex is not there: it is a number that the face names.
        GeometryError::IndexOutOfRange { face, .. } => Location::faces([*face]),
        GeometryError::NotFinite { first, count } => Location::vertices([*first]).of(*count),
        GeometryError::ZeroArea { first, count } => Location::faces([*first]).of(*count),
        _ => Location::default(),
    }
}

fn topology(error: &TopologyError) -> Location {
    match error {
        TopologyError::RepeatedVertex { face, vertex, count } => {
            Location { vertices: vec![vertex.index()], ..Location::faces([*face]) }.of(*count)
        }
        TopologyError::NonManifoldEdge { a, b, count, .. } => Location::vertices([*a, *b]).of(*count),
        TopologyError::InconsistentOrientation { first, second, a, b, count } => {
            Location { faces: vec![first.index(), second.index()], ..Location::vertices([*a, *b]) }.of(*count)
        }
        TopologyError::NonOrientable { first, second } => Location::faces([*first, *second]),
        TopologyError::NonManifoldVertex { vertex, count, .. } => Location::vertices([*vertex]).of(*count),
        _ => Location::default(),
    }
}

fn disk(error: &DiskError) -> Location {
    match error {
        DiskError::SeveralComponents { first_of_second, .. } => Location::faces([*first_of_second]),
        DiskError::SeveralBoundaries { vertex, .. } => Location::vertices([*vertex]),
        _ => Location::default(),
    }
}
