//! What was meant by a survey: the arguments, checked before any file is read.

use crate::cli::args::{ChartArgs, SolverChoice, SurveyArgs};
use crate::cli::charts::Charting;
use crate::cli::methods::{Method, methods};
use crate::cli::targets::{JsonTarget, check_distinct};
use crate::cli::typed::Typed;
use crate::cli::usage::usage;
use crate::record::surveyed::MadeWith;
use crate::record::{Asked, Program};
use crate::run::meshes::Depth;
use clap::error::ErrorKind;
use std::ffi::OsString;
use std::path::PathBuf;
use std::thread;

/// Everything a survey needs to know.
#[derive(Debug)]
pub(crate) struct Survey {
    /// Meshes and folders of meshes.
    pub(super) meshes: Vec<PathBuf>,
    /// How far into the folders.
    pub(super) depth: Depth,
    /// How to flatten.
    pub(super) method: Method,
    /// How to make charts of what is no disk; `None`: refuse it.
    pub(super) charting: Option<Charting>,
    /// How many meshes at a time; at least one.
    pub(super) jobs: usize,
    /// Whether to go on with what is there.
    pub(super) resume: bool,
    /// Where the results go.
    pub(super) json: Option<JsonTarget>,
    /// What hints may name.
    pub(super) typed: Typed,
}

impl Survey {
    /// Checks the arguments.
    ///
    /// # Errors
    /// A usage error: a setting out of range, results that would replace a mesh, nothing to resume from.
    pub(crate) fn new(args: SurveyArgs, typed: Typed) -> Result<Self, clap::Error> {
        let [method] = methods(&SolverChoice::Named(vec![args.solver]), &args.method)?.try_into().expect("one solver");
        let json = JsonTarget::new(args.json);
        let file = json.as_ref().and_then(JsonTarget::file);
        if args.resume && file.is_none() {
            let message = "--resume goes on with the results in a file: name it with --json FILE".to_owned();
            return Err(usage(ErrorKind::MissingRequiredArgument, message));
        }
        check_distinct(&[("--json", file)], &args.meshes)?;
        let depth = if args.flat { Depth::Inside } else { Depth::Below };
        let jobs = args.jobs.map_or_else(|| thread::available_parallelism().map_or(1, Into::into), usize::from);
        let charting = if args.disks_only { None } else { Some(Charting::new(ChartArgs::default(), &[], None)?) };
        Ok(Self { meshes: args.meshes, depth, method, charting, jobs, resume: args.resume, json, typed })
    }

    /// What results depend on. What was refused for want of memory is tried again anyway.
    pub(super) fn made_with(&self) -> MadeWith {
        let pipeline = &self.method.pipeline;
        let (program, solver) = (Program::this(), pipeline.solver.name().to_owned());
        MadeWith { program, solver, settings: Asked::new(pipeline), disks_only: self.charting.is_none() }
    }

    /// The log of finished meshes, beside the results; `None` where these go to no file.
    pub(super) fn log(&self) -> Option<PathBuf> {
        let file = self.json.as_ref().and_then(JsonTarget::file)?;
        let mut name: OsString = file.into();
        name.push(".partial");
        Some(name.into())
    }
}
