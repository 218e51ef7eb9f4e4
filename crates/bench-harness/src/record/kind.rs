//! What kinds of failures there are.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Why there is no result, or no file: a word for programs, which stays when a message is reworded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FailureKind {
    /// Something in a glTF document is wrong.
    BadDocument,
    /// The header of a file makes no sense.
    BadHeader,
    /// An index is not a whole number.
    BadIndex,
    /// A glTF document is not JSON.
    BadJson,
    /// A list in a PLY has a length that makes no sense.
    BadListLength,
    /// A word should be a number.
    BadNumber,
    /// The mesh cannot be repaired.
    BeyondRepair,
    /// No map of this mesh has the boundary asked for.
    Boundary,
    /// The user stopped it.
    Cancelled,
    /// The file cannot be opened.
    CannotOpen,
    /// At the scale given a chart is larger than a page.
    ChartTooLarge,
    /// A header claims more than the file holds.
    ClaimTooLarge,
    /// The surface has no boundary.
    Closed,
    /// The geometry is compressed.
    Compressed,
    /// A triangle has an angle of 0 or π.
    DegenerateAngle,
    /// A folder stands where a file should.
    Directory,
    /// The file has no byte.
    EmptyFile,
    /// Something else is wrong with the geometry.
    Geometry,
    /// The surface has handles.
    Handles,
    /// Two faces are oriented against each other.
    InconsistentOrientation,
    /// An index names nothing.
    IndexOutOfRange,
    /// An index is 0 where indices count from 1.
    IndexZero,
    /// A defect of this program.
    Internal,
    /// The coordinates are too large for doubles.
    LayoutOverflow,
    /// A linear system could not be solved.
    LinearSolve,
    /// It would take more memory than is allowed.
    Memory,
    /// A buffer of a glTF cannot be read.
    MissingBuffer,
    /// A vertex has too few coordinates.
    MissingCoordinate,
    /// A line ends too early.
    MissingValue,
    /// The solver found no angles.
    NoAngles,
    /// The whole surface has no area.
    NoArea,
    /// The file is no earlier comparison.
    NoBaseline,
    /// There is no face.
    NoFaces,
    /// The layout failed.
    NoLayout,
    /// There are no materials to go by.
    NoMaterials,
    /// There is no mesh in a folder.
    NoMeshes,
    /// The file may not be read.
    NoPermission,
    /// The picture cannot be drawn.
    NoPicture,
    /// There are no seams to keep.
    NoSeams,
    /// The file is no earlier survey.
    NoSurvey,
    /// There are no UVs to judge.
    NoUv,
    /// There is no vertex.
    NoVertices,
    /// An edge has three or more faces.
    NonManifoldEdge,
    /// Fans of faces touch in a vertex.
    NonManifoldVertex,
    /// The surface has one side only.
    NonOrientable,
    /// The surface is not a disk for another reason.
    NotADisk,
    /// The mesh needs repair, and none was allowed.
    NotClean,
    /// A coordinate is not finite.
    NotFinite,
    /// The mesh was not flattened for another reason.
    NotFlattened,
    /// The file is not there.
    NotFound,
    /// The UVs cannot be judged for another reason.
    NotJudged,
    /// An earlier survey had other settings.
    OtherSettings,
    /// The system has no memory left.
    OutOfMemory,
    /// The margins leave nothing of a page.
    PageTooSmall,
    /// A face uses a vertex twice.
    RepeatedVertex,
    /// A setting is out of range, or does not go with the solver.
    Setting,
    /// The surface has several boundary loops.
    SeveralBoundaries,
    /// The mesh has several components.
    SeveralComponents,
    /// The format wants another word.
    Syntax,
    /// A set of texture coordinates would leave a gap.
    TexcoordGap,
    /// A set of texture coordinates is there already.
    TexcoordTaken,
    /// The system does not give so many threads.
    Threads,
    /// The time was up before there was a result.
    Time,
    /// A face has fewer than 3 corners.
    TooFewCorners,
    /// There is more than 32-bit indices can name.
    TooLarge,
    /// The charts do not fit into an atlas.
    TooManyCharts,
    /// At the scale given the charts need more pages.
    TooManyPages,
    /// Something else is wrong with the topology.
    Topology,
    /// A binary file ends too early.
    Truncated,
    /// A text file ends too early.
    UnexpectedEnd,
    /// A survey was broken off here.
    UnfinishedSurvey,
    /// The extension names no format.
    UnknownExtension,
    /// A file cannot be named from the folder of the output.
    Unreachable,
    /// The file cannot be read for another reason.
    Unreadable,
    /// The file uses something that is not read.
    Unsupported,
    /// The file cannot be written.
    Unwritable,
    /// A UV is not finite.
    UvNotFinite,
    /// A face has no area.
    ZeroArea,
}

impl fmt::Display for FailureKind {
    /// The word, as in the JSON.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// Why a solver was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum NotRunKind {
    /// The settings do not go with it.
    #[serde(rename = "settings")]
    Settings,
    /// The mesh is too large for it.
    #[serde(rename = "too large")]
    TooLarge,
}

impl fmt::Display for NotRunKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// Why a mesh of a survey has no result, in the words that are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Refused {
    /// There are faces without area, or coordinates that are not finite.
    Degenerate,
    /// A defect of this program.
    #[serde(rename = "internal error")]
    Internal,
    /// It would take too much.
    Memory,
    /// Anything else.
    #[serde(rename = "no result")]
    NoResult,
    /// The surface is not a disk, and only disks were taken.
    #[serde(rename = "not a disk")]
    NotADisk,
    /// The faces are no manifold.
    #[serde(rename = "not manifold")]
    NotManifold,
    /// There is more than indices can name.
    #[serde(rename = "too large")]
    TooLarge,
    /// The file cannot be read.
    Unreadable,
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

impl FailureKind {
    /// The class it is counted in by a survey.
    pub(crate) fn refused(self, is_readable: bool) -> Refused {
        match self {
            Self::Memory | Self::OutOfMemory => Refused::Memory,
            Self::Internal => Refused::Internal,
            _ if !is_readable => Refused::Unreadable,
            Self::SeveralComponents | Self::Closed | Self::SeveralBoundaries | Self::Handles | Self::NotADisk => {
                Refused::NotADisk
            }
            Self::NonManifoldEdge
            | Self::NonManifoldVertex
            | Self::InconsistentOrientation
            | Self::NonOrientable
            | Self::RepeatedVertex
            | Self::Topology => Refused::NotManifold,
            Self::ZeroArea | Self::NotFinite | Self::DegenerateAngle | Self::Geometry | Self::NoArea => {
                Refused::Degenerate
            }
            Self::TooLarge => Refused::TooLarge,
            _ => Refused::NoResult,
        }
    }

    /// Whether the mesh itself is to blame, so that no other solver or seam can help.
    pub(crate) fn is_of_the_mesh(self) -> bool {
        matches!(self, Self::NoFaces | Self::BeyondRepair | Self::NotClean | Self::NotFinite)
    }
}
