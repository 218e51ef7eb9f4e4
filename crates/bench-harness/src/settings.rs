//! What was meant: the arguments, checked before any file is read.

use crate::args::{Args, FlattenArgs};
use crate::errors::Failure;
use crate::source::Source;
use abf::mesh::{Point3, TriMesh};
use abf::{EstimateSettings, LayoutSettings, Pipeline, StopCriteria};
use abf_mesh::io::MeshFormat;
use clap::CommandFactory;
use clap::error::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Everything a run needs to know.
#[derive(Debug)]
pub(crate) struct Settings {
    /// The meshes; at least one.
    pub(crate) sources: Vec<Source>,
    /// How to flatten.
    pub(crate) pipeline: Pipeline,
    /// How many threads; `None` for one per core.
    threads: Option<u16>,
    /// Where the mesh goes.
    pub(crate) output: Option<PathBuf>,
    /// Where the picture goes.
    pub(crate) png: Option<PathBuf>,
    /// Where the JSON goes.
    pub(crate) json: Option<JsonTarget>,
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
}

impl Settings {
    /// Checks the arguments.
    ///
    /// # Errors
    /// A usage error: a setting out of range, outputs that fit no single mesh, an output that
    /// would replace an input.
    pub(crate) fn new(args: FlattenArgs) -> Result<Self, clap::Error> {
        let pipeline = pipeline(&args)?;
        let sources = match args.meshes.as_slice() {
            [] => vec![Source::Builtin],
            meshes => meshes.iter().cloned().map(Source::File).collect(),
        };
        let (output, png, json) = (args.output, args.png, JsonTarget::new(args.json));
        let json_file = if let Some(JsonTarget::File(path)) = &json { Some(path.as_path()) } else { None };
        let targets = [("--output", output.as_deref()), ("--png", png.as_deref()), ("--json", json_file)];
        check_targets(&targets, &args.meshes)?;
        Ok(Self { sources, pipeline, threads: args.threads, output, png, json })
    }

    /// Starts the threads that all parallel work uses.
    ///
    /// # Errors
    /// When the system has no room for that many.
    pub(crate) fn start_threads(&self) -> Result<(), Failure> {
        let Some(threads) = self.threads else { return Ok(()) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        pool.build_global().map_err(|error| Failure::threads(threads, &error))
    }
}

fn usage(kind: ErrorKind, message: impl std::fmt::Display) -> clap::Error {
    Args::command().error(kind, message)
}

fn pipeline(args: &FlattenArgs) -> Result<Pipeline, clap::Error> {
    let (estimate, stop) = (EstimateSettings::default(), StopCriteria::default());
    let time_limit = args.time_limit.map(seconds).transpose()?;
    let pipeline = Pipeline {
        solver: args.solver,
        passes: args.passes,
        estimate: EstimateSettings {
            ring_switch: args.ring_switch.0,
            angle_bound: args.angle_bound.unwrap_or(estimate.angle_bound),
        },
        stop: StopCriteria {
            tolerance: args.tolerance.unwrap_or(stop.tolerance),
            max_iterations: args.max_iterations.unwrap_or(stop.max_iterations),
            time_limit,
            ..stop
        },
        layout: LayoutSettings { kind: args.layout, ..LayoutSettings::default() },
        normalize: args.normalize,
    };
    check_pipeline(&pipeline).map_err(|message| usage(ErrorKind::ValueValidation, message))?;
    Ok(pipeline)
}

fn seconds(limit: f64) -> Result<Duration, clap::Error> {
    let message = || format!("--time-limit must be a number of seconds, at least 0, got {limit}");
    Duration::try_from_secs_f64(limit).map_err(|_| usage(ErrorKind::ValueValidation, message()))
}

/// Asks the library whether it takes these settings, on a mesh of one triangle: its rules are not
/// repeated here, and no file is read in vain.
fn check_pipeline(pipeline: &Pipeline) -> Result<(), String> {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from).to_vec();
    let triangle = TriMesh::new(points, &[[0, 1, 2]]).expect("indices in range");
    pipeline.stop.check().map_err(|error| error.to_string())?;
    match pipeline.run(&triangle, &mut abf::Silent) {
        Ok(_) => Ok(()),
        Err(error) => Err(crate::errors::chain(&error)),
    }
}

/// Checks the files that are to be written.
fn check_targets(targets: &[(&str, Option<&Path>)], meshes: &[PathBuf]) -> Result<(), clap::Error> {
    let named = || targets.iter().filter_map(|&(option, path)| Some((option, path?)));
    for (option, path) in named() {
        let shown = path.display();
        if option != "--json" && meshes.len() > 1 {
            let message = format!("{option} {shown} takes one mesh, and there are {}", meshes.len());
            return Err(usage(ErrorKind::TooManyValues, message));
        }
        if option == "--output" && !matches!(MeshFormat::from_path(path), Some(MeshFormat::Obj | MeshFormat::Ply)) {
            let message = format!("{option} {shown}: the name must end in .obj or .ply");
            return Err(usage(ErrorKind::ValueValidation, message));
        }
        if meshes.iter().any(|mesh| same_file(mesh, path)) {
            let message = format!("{option} {shown} would replace the mesh that is read: choose another name");
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
