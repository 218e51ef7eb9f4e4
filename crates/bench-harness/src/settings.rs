//! What was meant by flattening: the arguments, checked before any file is read.

use crate::args::FlattenArgs;
use crate::methods::{Method, methods, usage};
use crate::source::Source;
use abf_mesh::io::MeshFormat;
use clap::error::ErrorKind;
use std::path::{Path, PathBuf};

/// Everything a run needs to know.
#[derive(Debug)]
pub(crate) struct Settings {
    /// The meshes; at least one.
    pub(crate) sources: Vec<Source>,
    /// How to flatten each; at least one.
    pub(crate) methods: Vec<Method>,
    /// Where the mesh goes.
    pub(crate) output: Option<PathBuf>,
    /// Where the picture goes.
    pub(crate) png: Option<PathBuf>,
    /// Where to draw the layout in real units.
    pub(crate) svg: Option<PathBuf>,
    /// Where the JSON goes.
    pub(crate) json: Option<JsonTarget>,
    /// Where every iteration goes.
    pub(crate) history: Option<PathBuf>,
}

/// Where JSON goes.
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
        let (history, json) = (args.history, JsonTarget::new(args.json));
        for (option, path) in [("--output", &output), ("--png", &png), ("--svg", &svg)] {
            if let Some(path) = path {
                check_is_for_one(option, path, sources.len(), methods.len())?;
            }
        }
        if let Some(path) = &output {
            check_extension("--output", path)?;
        }
        let targets = [
            ("--output", output.as_deref()),
            ("--png", png.as_deref()),
            ("--svg", svg.as_deref()),
            ("--json", json.as_ref().and_then(JsonTarget::file)),
            ("--history", history.as_deref()),
        ];
        check_distinct(&targets, &args.meshes)?;
        Ok(Self { sources, methods, output, png, svg, json, history })
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

fn check_extension(option: &str, path: &Path) -> Result<(), clap::Error> {
    if matches!(MeshFormat::from_path(path), Some(MeshFormat::Obj | MeshFormat::Ply)) {
        return Ok(());
    }
    let message = format!("{option} {}: the name must end in .obj or .ply", path.display());
    Err(usage(ErrorKind::ValueValidation, message))
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
