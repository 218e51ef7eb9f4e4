//! For every error a word for programs and the next thing to try.
//!
//! The libraries' enums may grow: what is not known here gets a hint that always helps.

use super::kind::FailureKind;
use abf::constraints::ProblemError;
use abf::cut::RepairError;
use abf::embed::EmbedError;
use abf::reconstruct::LayoutError;
use abf::solve_core::{LinearError, SolveError};
use abf::{AtlasError, Elsewhere, FlattenError, MetricsError, PackError, SolverKind, Termination, UnwrapError};
use abf_mesh::io::{MeshFormat, ReadError, WriteError};
use abf_mesh::{DiskError, GeometryError, TopologyError};
use std::io;
use std::path::Path;
use std::sync::LazyLock;

/// The kind of an error, and what to try next.
pub(crate) type Hint = (FailureKind, &'static str);

/// Between two things to try.
pub(crate) const OR: &str = ", or ";
/// Before them, after what is wrong.
pub(crate) const TRY: &str = ": try ";
/// Where everything has been tried.
pub(crate) const NOTHING_ELSE: &str = "repair the mesh in a modelling program";

const EXPORT_AGAIN: &str = "the file is damaged: export it again, or fetch it again";
pub(crate) const REPORT: &str = "this should not happen: please report it with the file";
const MERGE: &str =
    "delete the extra faces, or split the mesh into its sheets (in Blender: Select > All by Trait > Non Manifold)";

/// For what is no disk where only disks are taken.
const CHARTS: &str = "cut it into charts first: abf MESH -o charts.obj";

const MORE_MEMORY: &str = "use a larger --max-memory, or a coarser mesh, or a larger machine";

/// For settings out of their range; the message names the setting and the range.
const SETTING: Hint = (FailureKind::Setting, "give that setting a value in its range");

/// For files that would take more memory than is allowed.
pub(crate) const FILE_MEMORY: Hint = (FailureKind::Memory, MORE_MEMORY);

/// For names of files that no writer serves.
static WRITTEN: LazyLock<String> = LazyLock::new(|| {
    format!("end the name in .{}", MeshFormat::list(MeshFormat::is_written, " or .").replace(", ", ", ."))
});

/// For files that cannot be read.
pub(crate) fn read(error: &ReadError) -> Hint {
    match error {
        ReadError::Open { cause, .. } => cannot_open(cause),
        ReadError::UnknownExtension { .. } => {
            (FailureKind::UnknownExtension, "convert it to one of these, or rename it if it is one of them")
        }
        ReadError::Empty { .. } => (FailureKind::EmptyFile, EXPORT_AGAIN),
        ReadError::NoVertices { .. } => (FailureKind::NoVertices, "is it a mesh? export one with vertices and faces"),
        ReadError::NoFaces { .. } => {
            (FailureKind::NoFaces, "a point cloud or a curve has no surface: export a mesh with faces")
        }
        ReadError::BadNumber { .. } => (FailureKind::BadNumber, "correct that line; numbers have a point, not a comma"),
        ReadError::NotFinite { .. } => {
            (FailureKind::NotFinite, "correct or remove these vertices: NaN and infinity have no place")
        }
        ReadError::MissingCoordinate { .. } => {
            (FailureKind::MissingCoordinate, "a vertex needs x, y and z: correct that line")
        }
        ReadError::MissingValue { .. } => (FailureKind::MissingValue, "complete that line"),
        ReadError::BadIndex { .. } => (FailureKind::BadIndex, "correct that face: indices are whole numbers"),
        ReadError::IndexZero { .. } => {
            (FailureKind::IndexZero, "add 1 to every index, if the program that wrote it counted from 0")
        }
        ReadError::IndexOutOfRange { .. } => {
            (FailureKind::IndexOutOfRange, "correct or remove these faces, or export the file again")
        }
        ReadError::TooFewCorners { .. } => (FailureKind::TooFewCorners, "remove these faces: a face needs 3 corners"),
        ReadError::BadListLength { .. } => (FailureKind::BadListLength, EXPORT_AGAIN),
        ReadError::Truncated { .. } => (FailureKind::Truncated, EXPORT_AGAIN),
        ReadError::UnexpectedEnd { .. } => (FailureKind::UnexpectedEnd, EXPORT_AGAIN),
        ReadError::BadHeader { .. } => {
            (FailureKind::BadHeader, "is it that format? correct the header, or export it again")
        }
        ReadError::Syntax { .. } => (FailureKind::Syntax, "is it that format? correct that line, or export it again"),
        ReadError::Unsupported { .. } => (FailureKind::Unsupported, "export the mesh without it, for example as obj"),
        ReadError::Json { .. } => (FailureKind::BadJson, EXPORT_AGAIN),
        ReadError::Document { .. } => {
            (FailureKind::BadDocument, "correct that place, or export the model again with a newer program")
        }
        ReadError::Buffer { .. } => {
            (FailureKind::MissingBuffer, "put it where the document says: names count from its folder")
        }
        ReadError::Compressed { .. } => {
            (FailureKind::Compressed, "save the model again without compression of the geometry")
        }
        ReadError::ClaimTooLarge { .. } => (FailureKind::ClaimTooLarge, EXPORT_AGAIN),
        ReadError::TooLarge { .. } => (FailureKind::TooLarge, "split the mesh, or make it coarser"),
        _ => (FailureKind::Unreadable, EXPORT_AGAIN),
    }
}

/// For files that cannot be opened.
pub(crate) fn cannot_open(cause: &io::Error) -> Hint {
    match cause.kind() {
        io::ErrorKind::NotFound => (FailureKind::NotFound, "check the name and the folder"),
        io::ErrorKind::IsADirectory => (
            FailureKind::Directory,
            "name the files in it; survey DIR flattens all that is below it, compare DIR with several solvers",
        ),
        io::ErrorKind::PermissionDenied => (FailureKind::NoPermission, "ask for permission to read it"),
        io::ErrorKind::OutOfMemory => (FailureKind::OutOfMemory, "use a smaller mesh or a larger machine"),
        _ => (FailureKind::CannotOpen, "check the name and whether the disk is there"),
    }
}

/// For meshes that cannot be flattened.
pub(crate) fn flatten(error: &FlattenError) -> Hint {
    match error {
        FlattenError::Geometry(error) => geometry(error),
        FlattenError::Topology(error) => topology(error),
        FlattenError::NotADisk(error) | FlattenError::Problem(ProblemError::NotADisk(error)) => disk(error),
        FlattenError::Problem(ProblemError::Setting(_))
        | FlattenError::Solve { source: SolveError::Setting(_), .. } => SETTING,
        FlattenError::Problem(ProblemError::Angle { .. }) => (
            FailureKind::DegenerateAngle,
            "remove or improve the triangles without area, for example by merging vertices",
        ),
        FlattenError::Problem(ProblemError::Boundary(_)) => {
            (FailureKind::Boundary, "change --boundary, or the faces it names; --boundary convex asks for less")
        }
        FlattenError::Pins(_) => (FailureKind::Setting, "change those lines of the file of --pins"),
        FlattenError::PinsElsewhere(Elsewhere::Normalize) => (FailureKind::Setting, "leave out --pins, or --normalize"),
        FlattenError::PinsElsewhere(Elsewhere::Boundary) => (FailureKind::Setting, "leave out --pins, or --boundary"),
        FlattenError::PinsElsewhere(_) => (
            FailureKind::Setting,
            "leave out --pins, or give one disk without options and outputs of an atlas, such as --cut-disks or a glTF",
        ),
        FlattenError::GapTooLarge { .. } => (FailureKind::Setting, "take that, or less, for --boundary-gap"),
        FlattenError::RelaxBoundary(_) => (FailureKind::Setting, "leave out --energy, or --boundary"),
        FlattenError::BoundarySolver(_) => (FailureKind::Setting, "take --solver auto, linabf or barrier"),
        FlattenError::BoundaryCharts(_) => (
            FailureKind::Setting,
            "leave out --boundary, or give one disk without options and outputs of an atlas, such as --cut-disks or a glTF",
        ),
        FlattenError::Problem(_) => (FailureKind::Internal, REPORT),
        FlattenError::Solve { solver, source: SolveError::Linear(error) } => linear(
            error,
            match solver {
                SolverKind::LinAbf => "try --solver barrier, or improve the thinnest triangles",
                _ => "try --solver linabf, or improve the thinnest triangles",
            },
        ),
        FlattenError::Solve { .. } => (FailureKind::NoAngles, "try --solver lscm, or --solver auto"),
        FlattenError::Layout(LayoutError::Linear { source, .. }) => {
            linear(source, "try another --layout, or improve the thinnest triangles")
        }
        FlattenError::Layout(LayoutError::NotFinite { .. }) => {
            (FailureKind::LayoutOverflow, "try --layout least-squares, or --layout poisson")
        }
        FlattenError::Layout(LayoutError::NoBoundary) => (FailureKind::Closed, CHARTS),
        FlattenError::Layout(_) => (FailureKind::NoLayout, "try another --layout"),
        FlattenError::LscmLayout(_) => {
            (FailureKind::Setting, "take --layout least-squares, or --layout least-squares-weighted")
        }
        // These are no UVs of a file.
        FlattenError::Certificate(MetricsError::UvNotFinite { .. }) => {
            (FailureKind::LayoutOverflow, "scale the mesh down: its lengths are near the end of the range of numbers")
        }
        FlattenError::Certificate(error) => metrics(error),
        FlattenError::Memory { leaner: Some(_), .. } => {
            (FailureKind::Memory, "try that solver, or a larger --max-memory")
        }
        FlattenError::Memory { .. } => (FailureKind::Memory, MORE_MEMORY),
        FlattenError::Descent(EmbedError::Interrupted(Termination::TimeLimit)) => {
            (FailureKind::Time, "use a longer --time-limit")
        }
        FlattenError::Cancelled(_) | FlattenError::Descent(EmbedError::Interrupted(_)) => {
            (FailureKind::Cancelled, "start it again to have it flattened")
        }
        _ => (FailureKind::NotFlattened, "try --solver lscm, or --solver auto"),
    }
}

/// For meshes that cannot be made charts.
pub(crate) fn unwrap(error: &UnwrapError) -> Hint {
    match error {
        UnwrapError::Repair(RepairError::NoFaces { .. }) => {
            (FailureKind::NoFaces, "a point cloud or a curve has no surface: export a mesh with faces")
        }
        UnwrapError::Repair(_) => (FailureKind::BeyondRepair, "repair the mesh in a modelling program"),
        UnwrapError::NotClean { .. } => (FailureKind::NotClean, "leave out --strict to have it repaired"),
        UnwrapError::Setting(_) => SETTING,
        UnwrapError::Chart { source, .. } | UnwrapError::Flatten(source) => flatten(source),
        _ => (FailureKind::Internal, REPORT),
    }
}

/// For charts that cannot be packed.
pub(crate) fn atlas(error: &AtlasError) -> Hint {
    match error {
        AtlasError::Setting(_) => SETTING,
        AtlasError::Labels { .. } => {
            (FailureKind::NoMaterials, "take --atlas one, or --atlas per-component: this file has no materials")
        }
        AtlasError::TooManyCharts { .. } => (
            FailureKind::TooManyCharts,
            "use a larger --resolution or --page, or a smaller --margin, or more --max-pages",
        ),
        AtlasError::Pack(error) => pack(error),
        AtlasError::Metrics(error) => metrics(error),
        _ => (FailureKind::Internal, REPORT),
    }
}

/// For pieces that cannot be packed.
fn pack(error: &PackError) -> Hint {
    match error {
        PackError::Setting(_) => SETTING,
        PackError::PageTooSmall { .. } => {
            (FailureKind::PageTooSmall, "use a larger --resolution or --page, or a smaller --margin")
        }
        PackError::PieceTooLarge { .. } => {
            (FailureKind::ChartTooLarge, "use a lower --texels-per-unit, or a larger --resolution or --page")
        }
        PackError::TooManyPages { .. } => (
            FailureKind::TooManyPages,
            "use more --max-pages, or a lower --texels-per-unit, or a larger --resolution or --page",
        ),
        PackError::TooManyPieces { .. } => (
            FailureKind::TooManyCharts,
            "use a larger --resolution or --page, or a smaller --margin, or more --max-pages",
        ),
        // The charts that are packed are finite and have points.
        PackError::NotFinite { .. } | PackError::NoPoints { .. } => (FailureKind::Internal, REPORT),
        _ => (FailureKind::Internal, REPORT),
    }
}

fn geometry(error: &GeometryError) -> Hint {
    match error {
        GeometryError::NotFinite { .. } => {
            (FailureKind::NotFinite, "correct or remove these vertices: NaN and infinity have no place")
        }
        GeometryError::ZeroArea { .. } => (
            FailureKind::ZeroArea,
            "remove these faces, or merge vertices that lie on each other (in Blender: Merge by Distance)",
        ),
        GeometryError::IndexOutOfRange { .. } => (FailureKind::IndexOutOfRange, "correct or remove that face"),
        _ => (FailureKind::Geometry, "repair the mesh in a modelling program"),
    }
}

fn topology(error: &TopologyError) -> Hint {
    match error {
        TopologyError::Empty => {
            (FailureKind::NoFaces, "a point cloud or a curve has no surface: export a mesh with faces")
        }
        TopologyError::TooLarge { .. } => (FailureKind::TooLarge, "split the mesh, or make it coarser"),
        TopologyError::RepeatedVertex { .. } => (FailureKind::RepeatedVertex, "remove these faces: they have no area"),
        TopologyError::NonManifoldEdge { .. } => (FailureKind::NonManifoldEdge, MERGE),
        TopologyError::InconsistentOrientation { .. } => (
            FailureKind::InconsistentOrientation,
            "turn some faces around (in Blender: Mesh > Normals > Recalculate Outside)",
        ),
        TopologyError::NonOrientable { .. } => (FailureKind::NonOrientable, "cut it across, so that it has two sides"),
        TopologyError::NonManifoldVertex { .. } => {
            (FailureKind::NonManifoldVertex, "give every fan its own copy of the vertex, or close the gap between them")
        }
        _ => (FailureKind::Topology, "repair the mesh in a modelling program"),
    }
}

fn disk(error: &DiskError) -> Hint {
    match error {
        DiskError::SeveralComponents { .. } => (FailureKind::SeveralComponents, CHARTS),
        DiskError::NoBoundary { genus: 0 } => (FailureKind::Closed, CHARTS),
        DiskError::NoBoundary { .. } => (FailureKind::Closed, CHARTS),
        DiskError::SeveralBoundaries { .. } => (FailureKind::SeveralBoundaries, CHARTS),
        DiskError::Handles { .. } => (FailureKind::Handles, CHARTS),
        _ => (FailureKind::NotADisk, "cut it into disks first"),
    }
}

fn linear(error: &LinearError, otherwise: &'static str) -> Hint {
    match error {
        LinearError::TooLarge { .. } | LinearError::OutOfMemory { .. } => {
            (FailureKind::OutOfMemory, "use a coarser mesh or a larger machine")
        }
        _ => (FailureKind::LinearSolve, otherwise),
    }
}

/// For UVs that cannot be judged.
pub(crate) fn metrics(error: &MetricsError) -> Hint {
    match error {
        MetricsError::NoFaces => {
            (FailureKind::NoFaces, "a point cloud or a curve has no surface: export a mesh with faces")
        }
        MetricsError::CornerCount { .. } => (FailureKind::Internal, REPORT),
        MetricsError::UvNotFinite { .. } => {
            (FailureKind::UvNotFinite, "make these UVs anew: NaN and infinity have no place")
        }
        MetricsError::PositionNotFinite { .. } => {
            (FailureKind::NotFinite, "correct or remove these vertices: NaN and infinity have no place")
        }
        MetricsError::NoArea { .. } => (FailureKind::NoArea, "is it the right mesh? all of its faces are lines"),
        _ => (FailureKind::NotJudged, "repair the mesh in a modelling program"),
    }
}

/// For meshes that cannot be written.
pub(crate) fn write(error: &WriteError) -> Hint {
    match error {
        WriteError::Io { .. } => (FailureKind::Unwritable, ELSEWHERE),
        WriteError::UnknownExtension { .. } => (FailureKind::UnknownExtension, &WRITTEN),
        // Files with such numbers are not read: these are beyond 32 bits.
        WriteError::NotFinite { .. } => (
            FailureKind::NotFinite,
            "write an obj or ply, which hold doubles, or scale the mesh down: a glTF has 32-bit numbers",
        ),
        WriteError::ColourMismatch { .. } => (FailureKind::Internal, REPORT),
        WriteError::Document(error) => read(error),
        WriteError::TexcoordTaken { .. } => (FailureKind::TexcoordTaken, "choose a free set, or overwrite that one"),
        WriteError::TexcoordGap { .. } => (FailureKind::TexcoordGap, "choose the next free set"),
        WriteError::TooLarge { .. } => (FailureKind::TooLarge, "write a .gltf instead of a .glb, or split the model"),
        WriteError::Unreachable { .. } => (FailureKind::Unreachable, "write to the folder of the original"),
        _ => (FailureKind::Internal, REPORT),
    }
}

const ELSEWHERE: &str = "choose another place";

/// For files that cannot be written.
pub(crate) fn unwritable(target: &Path, cause: &io::Error) -> &'static str {
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match cause.kind() {
        _ if target.as_os_str().is_empty() => "give the file a name",
        io::ErrorKind::NotFound if target.is_symlink() => {
            "the link leads into a folder that is not there: make that folder, or remove the link"
        }
        io::ErrorKind::NotFound if !folder.exists() => "make the folder first",
        io::ErrorKind::NotFound => "no file can be made in that folder: choose another place",
        io::ErrorKind::NotADirectory => "what stands before the last / is a file: choose another place",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => "choose a folder you may write to",
        io::ErrorKind::IsADirectory => "there is a folder of that name: choose another name",
        io::ErrorKind::StorageFull => "free some space, or choose another disk",
        _ => ELSEWHERE,
    }
}
