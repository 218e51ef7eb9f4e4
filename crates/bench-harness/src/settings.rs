//! What was meant by flattening: the arguments, checked before any file is read.

use crate::args::{COMMANDS, FlattenArgs};
use crate::charting::Charting;
use crate::methods::{Method, methods, usage};
use crate::source::Source;
use clap::error::ErrorKind;
use std::path::{Path, PathBuf};

/// Everything a run needs to know.
#[derive(Debug)]
pub(crate) struct Settings {
    /// The meshes; at least one.
    pub(crate) sources: Vec<Source>,
    /// How to flatten each; at least one.
    pub(crate) methods: Vec<Method>,
    /// How to make charts.
    pub(crate) charting: Charting,
    /// Where the mesh goes.
    pub(crate) output: Option<PathBuf>,
    /// Where the picture goes.
    pub(crate) png: Option<PathBuf>,
    /// Where to draw the layout in real units.
    pub(crate) svg: Option<PathBuf>,
    /// Where the JSON goes.
    pub(crate) json: Option<JsonTarget>,
    /// Where every iteration goes.
    pub(crate) history: Option<JsonTarget>,
}

/// Where text for programs goes: JSON, or comma-separated values.
#[derive(Debug)]
pub(crate) enum JsonTarget {
    /// To stdout; the table makes way.
    Stdout,
    /// To a file.
    File(PathBuf),
}

impl JsonTarget {
    /// Reads the argument, in which `-` is stdout.
    pub(crate) fn new(argument: Option<PathBuf>) -> Option<Self> {
        argument.map(|path| if path.as_os_str() == "-" { Self::Stdout } else { Self::File(path) })
    }

    /// The file, if it is one.
    pub(crate) fn file(&self) -> Option<&Path> {
        match self {
            Self::Stdout => None,
            Self::File(path) => Some(path),
        }
    }
}

impl Settings {
    /// Checks the arguments.
    ///
    /// # Errors
    /// A usage error: a setting out of range, outputs that fit no single result, an output that
    /// would replace an input.
    pub(crate) fn new(args: FlattenArgs) -> Result<Self, clap::Error> {
        let methods = methods(&args.solver, &args.method)?;
        let sources = match args.meshes.as_slice() {
            [] => vec![Source::Builtin],
            meshes => meshes.iter().cloned().map(Source::File).collect(),
        };
        let (output, png, svg) = (args.output, args.png, args.svg);
        let charting = Charting::new(args.charts, &args.meshes, output.as_deref())?;
        let (history, json) = (JsonTarget::new(args.history), JsonTarget::new(args.json));
        let (seam_lines, remap) = (&charting.seam_lines, &charting.remap);
        let singles =
            [("--output", &output), ("--png", &png), ("--svg", &svg), ("--seam-lines", seam_lines), ("--remap", remap)];
        for (option, path) in singles {
            if let Some(path) = path {
                check_is_for_one(option, path, sources.len(), methods.len())?;
            }
        }
        if let Some(path) = &output {
            check_extension("--output", path, &["obj", "ply", "glb", "gltf"])?;
        }
        let targets = [
            ("--output", output.as_deref()),
            ("--png", png.as_deref()),
            ("--svg", svg.as_deref()),
            ("--seam-lines", seam_lines.as_deref()),
            ("--remap", remap.as_deref()),
            ("--json", json.as_ref().and_then(JsonTarget::file)),
            ("--history", history.as_ref().and_then(JsonTarget::file)),
        ];
        check_distinct(&targets, &args.meshes)?;
        check_one_stdout(&[("--json", json.as_ref()), ("--history", history.as_ref())])?;
        for (option, path, extension) in [("--png", &png, "png"), ("--svg", &svg, "svg")] {
            if let Some(path) = path {
                check_extension(option, path, &[extension])?;
            }
        }
        args.meshes.iter().try_for_each(|mesh| check_is_no_command(mesh))?;
        Ok(Self { sources, methods, charting, output, png, svg, json, history })
    }

    /// The files that will be written.
    pub(crate) fn files(&self) -> [Option<&Path>; 7] {
        let [json, history] = [&self.json, &self.history].map(|target| target.as_ref().and_then(JsonTarget::file));
        let (seams, remap) = (self.charting.seam_lines.as_deref(), self.charting.remap.as_deref());
        [self.output.as_deref(), self.png.as_deref(), self.svg.as_deref(), json, history, seams, remap]
    }

    /// How much memory each may take.
    pub(crate) fn max_memory(&self) -> Option<u64> {
        self.methods[0].pipeline.max_memory
    }

    /// Whether several solvers are to be compared.
    pub(crate) fn is_comparison(&self) -> bool {
        self.methods.len() > 1
    }
}

/// Checks that a file that holds one result gets one.
fn check_is_for_one(option: &str, path: &Path, meshes: usize, solvers: usize) -> Result<(), clap::Error> {
    let shown = path.display();
    let message = if meshes > 1 {
        format!("{option} {shown} takes one mesh, and there are {meshes}")
    } else if solvers > 1 {
        format!("{option} {shown} takes one solver, and there are {solvers}: run it again with the one you choose")
    } else {
        return Ok(());
    };
    Err(usage(ErrorKind::TooManyValues, message))
}

/// Checks that the name of a file says what will be in it.
///
/// # Errors
/// A usage error with the endings that would.
pub(crate) fn check_extension(option: &str, path: &Path, extensions: &[&str]) -> Result<(), clap::Error> {
    let found = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if extensions.iter().any(|extension| found.eq_ignore_ascii_case(extension)) {
        return Ok(());
    }
    let message = format!("{option} {}: the name must end in .{}", path.display(), extensions.join(" or ."));
    Err(usage(ErrorKind::ValueValidation, message))
}

/// Checks that only one output goes to stdout.
///
/// # Errors
/// A usage error that names two.
pub(crate) fn check_one_stdout(targets: &[(&str, Option<&JsonTarget>)]) -> Result<(), clap::Error> {
    let to_stdout: Vec<&str> =
        targets.iter().filter(|(_, target)| matches!(target, Some(JsonTarget::Stdout))).map(|(o, _)| *o).collect();
    match to_stdout.as_slice() {
        [first, second, ..] => {
            let message = format!("{first} and {second} cannot both go to stdout: name a file for one of them");
            Err(usage(ErrorKind::ArgumentConflict, message))
        }
        _ => Ok(()),
    }
}

/// Checks that a mesh is not a mistyped command: a bare word of no file.
fn check_is_no_command(mesh: &Path) -> Result<(), clap::Error> {
    let is_word = mesh.extension().is_none() && mesh.components().count() == 1 && !mesh.exists();
    let Some(word) = mesh.to_str().filter(|word| is_word && !word.is_empty()) else { return Ok(()) };
    let commands = COMMANDS.join(", ");
    let message = match COMMANDS.iter().find(|command| is_like(word, command)) {
        Some(command) => format!("there is no file and no command '{word}': did you mean '{command}'?"),
        None => format!("there is no file and no command '{word}'; the commands are {commands}"),
    };
    Err(usage(ErrorKind::InvalidSubcommand, message))
}

/// Whether one word may be the other mistyped: the one begins the other, or at most two letters differ.
fn is_like(word: &str, command: &str) -> bool {
    /// The most letters that are added, left out or exchanged.
    const SLIPS: usize = 2;
    /// Beginnings shorter than this mean nothing.
    const BEGINNING: usize = 3;
    let (a, b): (Vec<char>, Vec<char>) = (word.to_lowercase().chars().collect(), command.chars().collect());
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.iter().enumerate() {
            let changed = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()] <= SLIPS || (a.len() >= BEGINNING && b.starts_with(&a))
}

/// Checks that no file that is to be written is another one, or one that is read.
///
/// # Errors
/// A usage error that names both.
pub(crate) fn check_distinct(targets: &[(&str, Option<&Path>)], inputs: &[PathBuf]) -> Result<(), clap::Error> {
    let named = || targets.iter().filter_map(|&(option, path)| Some((option, path?)));
    for (option, path) in named() {
        let shown = path.display();
        if inputs.iter().any(|input| same_file(input, path)) {
            let message = format!("{option} {shown} would replace the file that is read: choose another name");
            return Err(usage(ErrorKind::ArgumentConflict, message));
        }
        if let Some((other, _)) = named().find(|&(other, p)| other != option && same_file(p, path)) {
            let message = format!("{other} and {option} are the same file: {shown}");
            return Err(usage(ErrorKind::ArgumentConflict, message));
        }
    }
    Ok(())
}

/// Whether two names stand for one file, as far as can be told before it exists.
fn same_file(a: &Path, b: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    real(a) == real(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_taken_for_the_commands_they_resemble() {
        for (word, command) in
            [("metric", "metrics"), ("mertics", "metrics"), ("comp", "compare"), ("Fixture", "fixtures")]
        {
            assert!(is_like(word, command), "{word}");
            assert_eq!(COMMANDS.iter().filter(|command| is_like(word, command)).count(), 1, "{word}");
        }
        assert!(!COMMANDS.iter().any(|command| is_like("cow", command) || is_like("mesh", command)));
    }
}
