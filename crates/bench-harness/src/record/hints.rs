//! For every error a word for programs and the next thing to try.
//!
//! The libraries' enums may grow: what is not known here gets a hint that always helps.

use abf::constraints::ProblemError;
use abf::cut::RepairError;
use abf::embed::EmbedError;
use abf::reconstruct::LayoutError;
use abf::solve_core::{LinearError, SolveError};
use abf::{AtlasError, FlattenError, MetricsError, Termination, UnwrapError};
use abf_mesh::io::{ReadError, WriteError};
use abf_mesh::{DiskError, GeometryError, TopologyError};
use std::io;
use std::path::Path;

/// The kind of an error, and what to try next.
pub(crate) type Hint = (&'static str, &'static str);

const EXPORT_AGAIN: &str = "the file is damaged: export it again, or fetch it again";
pub(crate) const REPORT: &str = "this should not happen: please report it with the file";
const MERGE: &str =
    "delete the extra faces, or split the mesh into its sheets (in Blender: Select > All by Trait > Non Manifold)";

/// For what is no disk where only disks are taken.
const CHARTS: &str = "flatten it without --disks-only, or cut it into charts first: bench-harness MESH -o charts.obj";

/// The kind of what would take more memory than is allowed.
const MEMORY: &str = "memory";
const MORE_MEMORY: &str = "use a larger --max-memory, a coarser mesh or a larger machine";

/// For files that would take more memory than is allowed.
pub(crate) const FILE_MEMORY: Hint = (MEMORY, MORE_MEMORY);

/// For files that cannot be read.
pub(crate) fn read(error: &ReadError) -> Hint {
    match error {
        ReadError::Open { cause, .. } => cannot_open(cause),
        ReadError::UnknownExtension { .. } => {
            ("unknown-extension", "convert it to one of these, or rename it if it is one of them")
        }
        ReadError::Empty { .. } => ("empty-file", EXPORT_AGAIN),
        ReadError::NoVertices { .. } => ("no-vertices", "is it a mesh? export one with vertices and faces"),
        ReadError::NoFaces { .. } => ("no-faces", "a point cloud or a curve has no surface: export a mesh with faces"),
        ReadError::BadNumber { .. } => ("bad-number", "correct that line; numbers have a point, not a comma"),
        ReadError::NotFinite { .. } => {
            ("not-finite", "correct or remove these vertices: NaN and infinity have no place")
        }
        ReadError::MissingCoordinate { .. } => ("missing-coordinate", "a vertex needs x, y and z: correct that line"),
        ReadError::MissingValue { .. } => ("missing-value", "complete that line"),
        ReadError::BadIndex { .. } => ("bad-index", "correct that face: indices are whole numbers"),
        ReadError::IndexZero { .. } => {
            ("index-zero", "add 1 to every index, if the program that wrote it counted from 0")
        }
        ReadError::IndexOutOfRange { .. } => {
            ("index-out-of-range", "correct or remove these faces, or export the file again")
        }
        ReadError::TooFewCorners { .. } => ("too-few-corners", "remove these faces: a face needs 3 corners"),
        ReadError::BadListLength { .. } => ("bad-list-length", EXPORT_AGAIN),
        ReadError::Truncated { .. } => ("truncated", EXPORT_AGAIN),
        ReadError::UnexpectedEnd { .. } => ("unexpected-end", EXPORT_AGAIN),
        ReadError::BadHeader { .. } => ("bad-header", "is it that format? correct the header, or export it again"),
        ReadError::Syntax { .. } => ("syntax", "is it that format? correct that line, or export it again"),
        ReadError::Unsupported { .. } => ("unsupported", "export the mesh without it, for example as obj"),
        ReadError::Json { .. } => ("bad-json", EXPORT_AGAIN),
        ReadError::Document { .. } => {
            ("bad-document", "correct that place, or export the model again with a newer program")
        }
        ReadError::Buffer { .. } => ("missing-buffer", "put it where the document says: names count from its folder"),
        ReadError::Compressed { .. } => ("compressed", "save the model again without compression of the geometry"),
        ReadError::ClaimTooLarge { .. } => ("claim-too-large", EXPORT_AGAIN),
        ReadError::TooLarge { .. } => ("too-large", "split the mesh, or make it coarser"),
        _ => ("unreadable", EXPORT_AGAIN),
    }
}

/// For files that cannot be opened.
pub(crate) fn cannot_open(cause: &io::Error) -> Hint {
    match cause.kind() {
        io::ErrorKind::NotFound => ("not-found", "check the name and the folder"),
        io::ErrorKind::IsADirectory => (
            "directory",
            "name the files in it; survey DIR flattens all that is below it, compare DIR with several solvers",
        ),
        io::ErrorKind::PermissionDenied => ("no-permission", "ask for permission to read it"),
        io::ErrorKind::OutOfMemory => ("out-of-memory", "use a smaller mesh or a larger machine"),
        _ => ("cannot-open", "check the name and whether the disk is there"),
    }
}

/// For meshes that cannot be flattened.
pub(crate) fn flatten(error: &FlattenError) -> Hint {
    match error {
        FlattenError::Geometry(error) => geometry(error),
        FlattenError::Topology(error) => topology(error),
        FlattenError::NotADisk(error) | FlattenError::Problem(ProblemError::NotADisk(error)) => disk(error),
        FlattenError::Problem(ProblemError::Setting(_))
        | FlattenError::Solve { source: SolveError::Setting(_), .. } => ("setting", "change that option"),
        FlattenError::Problem(ProblemError::Angle { .. }) => {
            ("degenerate-angle", "remove or improve the triangles without area, for example by merging vertices")
        }
        FlattenError::Problem(_) => ("internal", REPORT),
        FlattenError::Solve { source: SolveError::Linear(error), .. } => linear(error),
        FlattenError::Solve { .. } => ("no-angles", "try --solver lscm, which needs no angles"),
        FlattenError::Layout(LayoutError::Linear { source, .. }) => linear(source),
        FlattenError::Layout(LayoutError::NotFinite { .. }) => ("layout-overflow", "try --layout least-squares"),
        FlattenError::Layout(LayoutError::NoBoundary) => ("closed", CHARTS),
        FlattenError::Layout(_) => ("no-layout", "try another --layout"),
        FlattenError::LscmLayout(_) => ("setting", "take --layout least-squares or least-squares-weighted"),
        FlattenError::Certificate(error) => metrics(error),
        FlattenError::Memory { leaner: Some(_), .. } => (MEMORY, "try that solver, or a larger --max-memory"),
        FlattenError::Memory { .. } => (MEMORY, MORE_MEMORY),
        FlattenError::Descent(EmbedError::Interrupted(Termination::TimeLimit)) => ("time", "use a longer --time-limit"),
        FlattenError::Cancelled(_) | FlattenError::Descent(EmbedError::Interrupted(_)) => {
            ("cancelled", "start it again to have it flattened")
        }
        _ => ("not-flattened", "try --solver lscm"),
    }
}

/// For meshes that cannot be made charts.
pub(crate) fn unwrap(error: &UnwrapError) -> Hint {
    match error {
        UnwrapError::Repair(RepairError::NoFaces { .. }) => {
            ("no-faces", "a point cloud or a curve has no surface: export a mesh with faces")
        }
        UnwrapError::Repair(_) => ("beyond-repair", "repair the mesh in a modelling program"),
        UnwrapError::NotClean { .. } => ("not-clean", "leave out --strict to have it repaired"),
        UnwrapError::Setting(_) => ("setting", "change that option"),
        UnwrapError::Chart { source, .. } | UnwrapError::Flatten(source) => flatten(source),
        _ => ("internal", REPORT),
    }
}

/// For charts that cannot be packed.
pub(crate) fn atlas(error: &AtlasError) -> Hint {
    match error {
        AtlasError::Setting(_) => ("setting", "change that option"),
        AtlasError::Labels { .. } => ("no-materials", "this file has no materials: take --atlas one or per-component"),
        AtlasError::TooManyCharts { .. } => ("too-many-charts", "use a larger --resolution or a smaller --margin"),
        AtlasError::Pack(_) => ("no-room", "use a lower --texels-per-unit, more --max-pages or a larger --resolution"),
        AtlasError::Metrics(error) => metrics(error),
        _ => ("internal", REPORT),
    }
}

fn geometry(error: &GeometryError) -> Hint {
    match error {
        GeometryError::NotFinite { .. } => {
            ("not-finite", "correct or remove these vertices: NaN and infinity have no place")
        }
        GeometryError::ZeroArea { .. } => (
            "zero-area",
            "remove these faces, or merge vertices that lie on each other (in Blender: Merge by Distance)",
        ),
        GeometryError::IndexOutOfRange { .. } => ("index-out-of-range", "correct or remove that face"),
        _ => ("geometry", "repair the mesh in a modelling program"),
    }
}

fn topology(error: &TopologyError) -> Hint {
    match error {
        TopologyError::Empty => ("no-faces", "a point cloud or a curve has no surface: export a mesh with faces"),
        TopologyError::TooLarge { .. } => ("too-large", "split the mesh, or make it coarser"),
        TopologyError::RepeatedVertex { .. } => ("repeated-vertex", "remove these faces: they have no area"),
        TopologyError::NonManifoldEdge { .. } => ("non-manifold-edge", MERGE),
        TopologyError::InconsistentOrientation { .. } => {
            ("inconsistent-orientation", "turn some faces around (in Blender: Mesh > Normals > Recalculate Outside)")
        }
        TopologyError::NonOrientable { .. } => ("non-orientable", "cut it across, so that it has two sides"),
        TopologyError::NonManifoldVertex { .. } => {
            ("non-manifold-vertex", "give every fan its own copy of the vertex, or close the gap between them")
        }
        _ => ("topology", "repair the mesh in a modelling program"),
    }
}

fn disk(error: &DiskError) -> Hint {
    match error {
        DiskError::SeveralComponents { .. } => ("several-components", CHARTS),
        DiskError::NoBoundary { genus: 0 } => ("closed", CHARTS),
        DiskError::NoBoundary { .. } => ("closed", CHARTS),
        DiskError::SeveralBoundaries { .. } => ("several-boundaries", CHARTS),
        DiskError::Handles { .. } => ("handles", CHARTS),
        _ => ("not-a-disk", "cut it into disks first"),
    }
}

fn linear(error: &LinearError) -> Hint {
    match error {
        LinearError::TooLarge { .. } | LinearError::OutOfMemory { .. } => {
            ("out-of-memory", "use a coarser mesh or a larger machine")
        }
        _ => ("linear-solve", "improve the thinnest triangles, or try --angle-bound 0.01 or another --layout"),
    }
}

/// For UVs that cannot be judged.
pub(crate) fn metrics(error: &MetricsError) -> Hint {
    match error {
        MetricsError::NoFaces => ("no-faces", "a point cloud or a curve has no surface: export a mesh with faces"),
        MetricsError::CornerCount { .. } => ("internal", REPORT),
        MetricsError::UvNotFinite { .. } => ("uv-not-finite", "make these UVs anew: NaN and infinity have no place"),
        MetricsError::PositionNotFinite { .. } => {
            ("not-finite", "correct or remove these vertices: NaN and infinity have no place")
        }
        MetricsError::NoArea { .. } => ("no-area", "is it the right mesh? all of its faces are lines"),
        _ => ("not-judged", "repair the mesh in a modelling program"),
    }
}

/// For meshes that cannot be written.
pub(crate) fn write(error: &WriteError) -> Hint {
    match error {
        WriteError::Io { .. } => ("unwritable", ELSEWHERE),
        WriteError::UnknownExtension { .. } => ("unknown-extension", "end the name in .obj, .ply, .glb or .gltf"),
        WriteError::NotFinite { .. } => ("not-finite", "correct or remove these: NaN and infinity have no place"),
        WriteError::Document(error) => read(error),
        WriteError::TexcoordTaken { .. } => ("texcoord-taken", "choose a free set, or overwrite that one"),
        WriteError::TexcoordGap { .. } => ("texcoord-gap", "choose the next free set"),
        WriteError::TooLarge { .. } => ("too-large", "write a .gltf instead of a .glb, or split the model"),
        WriteError::Unreachable { .. } => ("unreachable", "write to the folder of the original"),
        _ => ("internal", REPORT),
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
