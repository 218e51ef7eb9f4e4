//! What was meant by a comparison: the arguments, checked before any file is read.

use super::repeat::Runs;
use crate::cli::args::{CompareArgs, Lowest};
use crate::cli::methods::{Method, methods};
use crate::cli::targets::{JsonTarget, check_distinct, check_one_stdout};
use crate::cli::typed::Typed;
use crate::cli::usage::usage;
use clap::error::ErrorKind;
use std::path::{Path, PathBuf};

/// Everything a comparison needs to know.
#[derive(Debug)]
pub(crate) struct Comparison {
    /// Meshes and folders of meshes.
    pub(super) meshes: Vec<PathBuf>,
    /// How to flatten each; at least one.
    pub(super) methods: Vec<Method>,
    /// How often.
    pub(super) runs: Runs,
    /// An earlier comparison.
    pub(super) baseline: Option<PathBuf>,
    /// Where the JSON goes.
    pub(super) json: Option<JsonTarget>,
    /// Where the Markdown goes.
    pub(super) markdown: Option<JsonTarget>,
    /// Where the comma-separated values go.
    pub(super) csv: Option<JsonTarget>,
    /// Where every iteration goes.
    pub(super) history: Option<JsonTarget>,
    /// Where the page goes.
    pub(super) report: Option<PathBuf>,
    /// The folder that charts go to.
    pub(super) plots: Option<PathBuf>,
    /// Which results the lowest F is looked for among.
    pub(super) lowest: Lowest,
    /// What hints may name.
    pub(super) typed: Typed,
}

impl Comparison {
    /// The files that will be written.
    pub(super) fn files(&self) -> [Option<&Path>; 5] {
        let texts = [&self.json, &self.markdown, &self.csv, &self.history];
        let [json, markdown, csv, history] = texts.map(|target| target.as_ref().and_then(JsonTarget::file));
        [json, markdown, csv, history, self.report.as_deref()]
    }

    /// Checks the arguments.
    ///
    /// # Errors
    /// A usage error: a setting out of range, an output that would replace an input or another
    /// output.
    pub(crate) fn new(args: CompareArgs, typed: Typed) -> Result<Self, clap::Error> {
        let methods = methods(&args.solver, &args.method)?;
        let [json, markdown, csv, history] = [args.json, args.markdown, args.csv, args.history].map(JsonTarget::new);
        let texts = [
            ("--json", json.as_ref()),
            ("--markdown", markdown.as_ref()),
            ("--csv", csv.as_ref()),
            ("--history", history.as_ref()),
        ];
        check_one_stdout(&texts)?;
        if args.report.as_ref().is_some_and(|path| path.as_os_str() == "-") {
            return Err(usage(ErrorKind::ValueValidation, "--report -: a page needs a file of its own".to_owned()));
        }
        let files = texts.map(|(option, target)| (option, target.and_then(JsonTarget::file)));
        let targets: Vec<_> = files.into_iter().chain([("--report", args.report.as_deref())]).collect();
        // A baseline that is replaced row by row would be lost when the comparison is stopped.
        let inputs: Vec<PathBuf> = args.meshes.iter().chain(&args.baseline).cloned().collect();
        check_distinct(&targets, &inputs)?;
        let with_history = history.is_some() || args.report.is_some() || args.plots.is_some();
        Ok(Self {
            meshes: args.meshes,
            methods,
            runs: Runs { warmup: args.warmup, repeats: args.repeats, with_history },
            baseline: args.baseline,
            json,
            markdown,
            csv,
            history,
            plots: args.plots,
            lowest: args.lowest,
            report: args.report,
            typed,
        })
    }
}
