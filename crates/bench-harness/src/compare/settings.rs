//! What was meant by a comparison: the arguments, checked before any file is read.

use super::repeat::Runs;
use crate::args::CompareArgs;
use crate::methods::{Method, methods};
use crate::settings::{JsonTarget, check_distinct};
use std::path::PathBuf;

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
    pub(super) markdown: Option<PathBuf>,
    /// Where the comma-separated values go.
    pub(super) csv: Option<PathBuf>,
    /// Where the page goes.
    pub(super) report: Option<PathBuf>,
}

impl Comparison {
    /// Checks the arguments.
    ///
    /// # Errors
    /// A usage error: a setting out of range, an output that would replace an input or another
    /// output.
    pub(crate) fn new(args: CompareArgs) -> Result<Self, clap::Error> {
        let methods = methods(&args.solver, &args.method)?;
        let json = JsonTarget::new(args.json);
        let targets = [
            ("--json", json.as_ref().and_then(JsonTarget::file)),
            ("--markdown", args.markdown.as_deref()),
            ("--csv", args.csv.as_deref()),
            ("--report", args.report.as_deref()),
        ];
        // A baseline that is replaced row by row would be lost when the comparison is stopped.
        let inputs: Vec<PathBuf> = args.meshes.iter().chain(&args.baseline).cloned().collect();
        check_distinct(&targets, &inputs)?;
        Ok(Self {
            meshes: args.meshes,
            methods,
            runs: Runs { warmup: args.warmup, repeats: args.repeats, with_curves: args.report.is_some() },
            baseline: args.baseline,
            json,
            markdown: args.markdown,
            csv: args.csv,
            report: args.report,
        })
    }
}
