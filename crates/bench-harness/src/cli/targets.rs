//! Where results go, and checks that they can go there together.

use super::usage::usage;
use abf_mesh::io::MeshFormat;
use clap::error::ErrorKind;
use std::path::{Path, PathBuf};

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

/// Checks that a file that holds one result gets one.
pub(crate) fn check_is_for_one(option: &str, path: &Path, meshes: usize, solvers: usize) -> Result<(), clap::Error> {
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

/// Checks that a set of UVs is asked of a glTF, the only format that has several.
///
/// # Errors
/// A usage error.
pub(crate) fn check_uv_set(uv_set: Option<u32>, inputs: &[PathBuf]) -> Result<(), clap::Error> {
    match uv_set {
        Some(set) if !inputs.iter().any(|input| is_gltf(input)) => {
            let message = format!("--uv-set {set} concerns a glTF, and none is read: leave it out");
            Err(usage(ErrorKind::ArgumentConflict, message))
        }
        _ => Ok(()),
    }
}

/// Whether two names stand for one file, as far as can be told before it exists.
fn same_file(a: &Path, b: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    real(a) == real(b)
}

/// Whether a file is a glTF, by its name.
pub(crate) fn is_gltf(path: &Path) -> bool {
    MeshFormat::from_path(path).is_some_and(MeshFormat::is_gltf)
}
