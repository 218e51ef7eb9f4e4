//! From errors to sentences: what is wrong, where, how many, and what to try next.

use super::hints;
use super::kind::FailureKind;
use super::location::{self, Location};
use super::number::megabytes;
use abf::{AtlasError, FlattenError, MetricsError, UnwrapError};
use abf_mesh::io::{MeshFormat, ReadError, UvDropped, WriteError};
use abf_report::PictureError;
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::io;
use std::path::Path;

/// Why there is no result, or no file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Failure {
    /// A word for programs; it stays the same when the message is reworded.
    pub(crate) kind: FailureKind,
    /// What is wrong, where, and how many times.
    pub(crate) message: String,
    /// What to try next.
    pub(crate) hint: String,
    /// Where, as far as that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) at: Option<Box<Location>>,
}

impl Failure {
    fn new((kind, hint): (FailureKind, &str), message: String) -> Self {
        Self { kind, message, hint: hint.to_owned(), at: None }
    }

    fn at(self, at: Location) -> Self {
        Self { at: (!at.is_unknown()).then(|| Box::new(at)), ..self }
    }

    /// A file that cannot be read.
    pub(crate) fn read(error: &ReadError) -> Self {
        Self::new(hints::read(error), chain(error)).at(location::read(error))
    }

    /// A file that would take more memory than is allowed.
    pub(crate) fn file_memory(file: &str, predicted: u64, limit: u64) -> Self {
        let [predicted, limit] =
            [predicted, limit].map(|bytes| megabytes(usize::try_from(bytes).unwrap_or(usize::MAX)));
        let message = format!("{file}: to read it would take about {predicted} MB, and the limit is {limit} MB");
        Self::new(hints::FILE_MEMORY, message)
    }

    /// A mesh that cannot be flattened. `fanned` says whether polygons were cut, which is what its
    /// triangles are counted after.
    pub(crate) fn flatten(mesh: &str, error: &FlattenError, fanned: bool) -> Self {
        let at = location::flatten(error);
        Self::new(hints::flatten(error), format!("{mesh}: {}", counted(chain(error), &at, fanned))).at(at)
    }

    /// What is wrong with a boundary whose angles are from a file is wrong with that file.
    pub(crate) fn of_boundary_in(self, file: Option<&Path>) -> Self {
        match file.filter(|_| self.kind == FailureKind::Boundary) {
            Some(file) => {
                let (message, file) = (format!("{}, for {}", file.display(), self.message), file.display());
                Self { message, hint: format!("correct {file}, or leave out the vertices that it cannot have"), ..self }
            }
            None => self,
        }
    }

    /// A mesh that cannot be made charts.
    pub(crate) fn unwrap(mesh: &str, error: &UnwrapError, fanned: bool) -> Self {
        let at = location::unwrap(error);
        Self::new(hints::unwrap(error), format!("{mesh}: {}", counted(chain(error), &at, fanned))).at(at)
    }

    /// Charts that cannot be packed.
    pub(crate) fn atlas(mesh: &str, error: &AtlasError) -> Self {
        Self::new(hints::atlas(error), format!("{mesh}: {}", chain(error)))
    }

    /// A file without the seams that were to be kept.
    pub(crate) fn no_seams(mesh: &str) -> Self {
        let hint = "take --seams auto, or --seams file for the borders of groups and materials";
        Self::new((FailureKind::NoSeams, hint), format!("{mesh}: it has no seams to keep"))
    }

    /// A picture of more than one page.
    pub(crate) fn several_pages(path: &Path, pages: usize) -> Self {
        let hint = "take --atlas one, or --max-pages 1, or leave out --png";
        Self::new(
            (FailureKind::NoPicture, hint),
            format!("{}: there are {pages} pages, and a picture shows one", path.display()),
        )
    }

    /// UVs that cannot be judged.
    pub(crate) fn metrics(mesh: &str, error: &MetricsError) -> Self {
        let at = location::metrics(error);
        Self::new(hints::metrics(error), format!("{mesh}: {}", counted(chain(error), &at, false))).at(at)
    }

    /// A file without UVs where there should be some, to do this with.
    pub(crate) fn no_uv(mesh: &str, dropped: Option<UvDropped>, purpose: &str) -> Self {
        let why = dropped.map_or_else(String::new, |why| format!(" that can be used: {why}"));
        let hint = match dropped {
            Some(UvDropped::OtherSet { other, .. }) => format!("take --uv-set {other}"),
            _ => format!("flatten it first, and {purpose} what that writes: abf MESH -o out.obj"),
        };
        Self::new((FailureKind::NoUv, &hint), format!("{mesh}: there are no UVs{why}"))
    }

    /// A mesh that cannot be written.
    pub(crate) fn write(path: &Path, error: &WriteError) -> Self {
        let file = path.display().to_string();
        match error {
            WriteError::Io { cause, .. } => Self::unwritable(&file, cause),
            _ => {
                let message = chain(error);
                let message = if message.contains(&file) { message } else { format!("{file}: {message}") };
                Self::new(hints::write(error), message)
            }
        }
    }

    /// A file or stream that cannot be written.
    pub(crate) fn unwritable(target: &str, error: &io::Error) -> Self {
        // The name of a temporary file says nothing to someone who never asked for one.
        let text = error.to_string();
        let said = text.split(" at path ").next().unwrap_or(&text);
        Self::new(
            (FailureKind::Unwritable, hints::unwritable(Path::new(target), error)),
            format!("{target}: cannot be written: {said}"),
        )
    }

    /// A folder or file that is no mesh and cannot be read.
    pub(crate) fn unreadable(path: &Path, error: &io::Error) -> Self {
        Self::new(hints::cannot_open(error), format!("{}: cannot be read: {error}", path.display()))
    }

    /// A folder without meshes.
    pub(crate) fn no_meshes(folder: &Path) -> Self {
        let formats = MeshFormat::list(|_| true, " or ");
        let hint = format!("name a folder with {formats} files in it or below it");
        Self::new((FailureKind::NoMeshes, &hint), format!("{}: there is no mesh below it", folder.display()))
    }

    /// A file that is not the JSON of a comparison.
    pub(crate) fn no_baseline(path: &Path, why: &str) -> Self {
        let hint = "name a file that abf compare --json has written";
        Self::new((FailureKind::NoBaseline, hint), format!("{}: no earlier comparison: {why}", path.display()))
    }

    /// A file that is not what a survey writes.
    pub(crate) fn no_survey(path: &Path, why: &str) -> Self {
        let hint = "name a file that abf survey --json has written, or leave out --resume";
        Self::new((FailureKind::NoSurvey, hint), format!("{}: no earlier survey: {why}", path.display()))
    }

    /// A survey that was broken off, and would be lost.
    pub(crate) fn unfinished_survey(log: &Path) -> Self {
        let hint = "go on with it with --resume, or delete that file to begin anew";
        Self::new((FailureKind::UnfinishedSurvey, hint), format!("{}: a survey was broken off here", log.display()))
    }

    /// A survey that was made in another way than is asked for now.
    pub(crate) fn other_settings(path: &Path, what: &str, before: &str, now: &str) -> Self {
        let hint = "go on with the settings it was made with, or name another --json for this one";
        let message = format!("{}: made with {what} {before}, and asked for is {now}", path.display());
        Self::new((FailureKind::OtherSettings, hint), message)
    }

    /// A defect of this program.
    pub(crate) fn panicked(mesh: &str) -> Self {
        Self::new((FailureKind::Internal, hints::REPORT), format!("{mesh}: the program has failed on this mesh"))
    }

    /// A picture that cannot be drawn.
    pub(crate) fn picture(path: &Path, error: &PictureError) -> Self {
        let hint = "leave the picture out; the mesh and the figures do not depend on it";
        Self::new((FailureKind::NoPicture, hint), format!("{}: {}", path.display(), chain(error)))
    }

    /// A picture that the user did not wait for.
    pub(crate) fn picture_cancelled(path: &Path) -> Self {
        let hint = "start it again to have it drawn";
        Self::new((FailureKind::Cancelled, hint), format!("{}: {}", path.display(), abf::Cancelled))
    }

    /// Threads that the system does not give.
    pub(crate) fn threads(count: u16, error: &dyn Error) -> Self {
        let message = format!("{count} threads cannot be started: {}", chain(error));
        Self::new((FailureKind::Threads, "ask for fewer --threads; the results are the same"), message)
    }

    /// A mesh that was not begun.
    pub(crate) fn cancelled(mesh: &str) -> Self {
        let hint = hints::flatten(&FlattenError::from(abf::Cancelled)).1;
        Self::new((FailureKind::Cancelled, hint), format!("{mesh}: {}", FlattenError::from(abf::Cancelled)))
    }

    /// Whether nothing is wrong but that the user stopped it.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.kind == FailureKind::Cancelled
    }
}

/// An error and its causes in one line; a cause that the line already tells is not told again.
pub(crate) fn chain(error: &dyn Error) -> String {
    let mut message = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let text = error.to_string();
        if !message.contains(&text) {
            message = format!("{message}: {text}");
        }
        cause = error.source();
    }
    message
}

/// Says from where indices are counted, if the message has some and does not say it.
fn counted(message: String, at: &Location, fanned: bool) -> String {
    if !at.counts_from_zero() {
        return message;
    }
    let after = if fanned { ", faces after polygons are cut into triangles" } else { "" };
    match message.strip_suffix(" in all)") {
        Some(message) => format!("{message} in all; counted from 0{after})"),
        None => format!("{message} (counted from 0{after})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf::PackError;
    use abf_mesh::{DiskError, FaceId, TopologyError, VertexId};

    #[test]
    fn causes_are_told_once() {
        let cause = abf::solve_core::LinearError::NoSolution { relative_residual: 0.5 };
        let error = FlattenError::Solve { solver: abf::SolverKind::LinAbf, source: cause.into() };
        let text = chain(&error);
        assert_eq!(text.matches("linear solve failed").count(), 1, "{text}");
        assert!(text.starts_with("the solver 'linabf' found no angles: the linear system"), "{text}");
    }

    #[test]
    fn indices_are_said_to_count_from_zero_once() {
        let error = TopologyError::NonManifoldVertex { vertex: VertexId::new(3), fans: 2, count: 1 };
        let text = Failure::flatten("a.obj", &error.into(), true).message;
        assert!(text.starts_with("a.obj: the faces at vertex 3 form 2"), "{text}");
        assert!(text.ends_with(" in all; counted from 0, faces after polygons are cut into triangles)"), "{text}");
        let error = DiskError::SeveralComponents { count: 2, first_of_second: FaceId::new(9) };
        let text = Failure::flatten("a.obj", &error.into(), false).message;
        assert_eq!(text.matches("counted from 0").count(), 1, "{text}");
        let text = Failure::flatten("a.obj", &DiskError::NoBoundary { genus: 1 }.into(), false).message;
        assert!(!text.contains("counted"), "{text}");
    }

    #[test]
    fn every_refusal_of_the_packer_has_a_kind_and_a_next_step_of_its_own() {
        let (width, height, texels_per_unit) = (64, 64, 100.0);
        let refusals = [
            PackError::PageTooSmall { width, height, margin: 40.0 },
            PackError::PieceTooLarge { piece: 0, width, height, texels_per_unit, largest: 9.0 },
            PackError::TooManyPages { pieces: 9, pages: 2, texels_per_unit },
            PackError::TooManyPieces { pieces: 9, pages: 2, margin: 2.0, width, height },
            abf::SettingError::new("margin", "at least 0", -1.0).into(),
        ];
        let failures = refusals.map(|refusal| Failure::atlas("a.obj", &AtlasError::Pack(refusal)));
        for (i, one) in failures.iter().enumerate() {
            for other in &failures[..i] {
                assert!(one.kind != other.kind && one.hint != other.hint, "{one:?} {other:?}");
            }
        }
        let no_room = AtlasError::TooManyCharts { charts: 900, margin: 2, page: [64; 2] };
        let failure = Failure::atlas("a.obj", &no_room);
        assert!(failure.message.ends_with("do not fit into 64 × 64 texels"), "{}", failure.message);
        assert!(failure.hint.contains("--resolution") && failure.hint.contains("--margin"), "{}", failure.hint);
    }
}
