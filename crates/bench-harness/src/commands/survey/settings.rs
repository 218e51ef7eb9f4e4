//! What was meant by a survey: the arguments, checked before any file is read.

use crate::cli::args::{ChartArgs, SolverChoice, SurveyArgs};
use crate::cli::charts::Charting;
use crate::cli::methods::{Method, methods};
use crate::cli::targets::{JsonTarget, check_distinct};
use crate::cli::usage::usage;
use crate::run::meshes::Depth;
use abf::Pipeline;
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
}

impl Survey {
    /// Checks the arguments.
    ///
    /// # Errors
    /// A usage error: a setting out of range, results that would replace a mesh, nothing to resume from.
    pub(crate) fn new(args: SurveyArgs) -> Result<Self, clap::Error> {
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
        Ok(Self { meshes: args.meshes, depth, method, charting, jobs, resume: args.resume, json })
    }

    /// The settings that results depend on, for comparing: two surveys with the same text agree. How many
    /// threads and jobs there are makes no difference, and what was refused for want of memory is tried again anyway.
    pub(super) fn settings(&self) -> String {
        let pipeline = Pipeline { max_memory: None, ..self.method.pipeline.clone() };
        format!("{} {pipeline:?} {:?}", env!("CARGO_PKG_VERSION"), self.charting)
    }

    /// The log of finished meshes, beside the results; `None` where these go to no file.
    pub(super) fn log(&self) -> Option<PathBuf> {
        let file = self.json.as_ref().and_then(JsonTarget::file)?;
        let mut name: OsString = file.into();
        name.push(".partial");
        Some(name.into())
    }
}

/// The first setting in which two surveys differ: its name, and its value in either. Takes what [`Survey::settings`]
/// writes, of this version of the program or of another.
pub(super) fn difference<'a>(before: &'a str, now: &'a str) -> Option<[&'a str; 3]> {
    if before == now {
        return None;
    }
    let [(before_version, _), (now_version, _)] = [before, now].map(|text| text.split_once(' ').unwrap_or((text, "")));
    if before_version != now_version {
        return Some(["version of the program", before_version, now_version]);
    }
    let is_same = |(a, b): &(char, char)| a == b;
    let common: usize = before.chars().zip(now.chars()).take_while(is_same).map(|(c, _)| c.len_utf8()).sum();
    // The name of a field stands before its value: what is the same ends inside a value, or in the name of its type.
    let value = before[..common].rfind(": ").map_or(0, |colon| colon + ": ".len());
    let name = before[..value].trim_end_matches(": ").rsplit(' ').next().unwrap_or_default();
    let end = |text: &'a str| text[value..].split([',', '{', '}']).next().unwrap_or_default().trim_end();
    Some([name, end(before), end(now)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf::{Ladder, LinAbf, StopCriteria};

    #[test]
    fn the_setting_that_differs_is_named_with_both_values() {
        let text = |pipeline: Pipeline| format!("1.0.0 {pipeline:?}");
        let plain = text(Pipeline::default());
        let linabf = LinAbf { passes: "1".parse().expect("one") };
        let one_pass = Ladder { linabf, ..Ladder::default() };
        let tight = StopCriteria { tolerance: 1e-9, ..StopCriteria::default() };
        for (other, expected) in [
            (Pipeline { solver: LinAbf::default().into(), ..Pipeline::default() }, ["solver", "Ladder", "LinAbf"]),
            (Pipeline { solver: one_pass.into(), ..Pipeline::default() }, ["passes", "Auto", "Exactly(1)"]),
            (Pipeline { stop: tight, ..Pipeline::default() }, ["tolerance", "1e-8", "1e-9"]),
            (Pipeline { normalize: true, ..Pipeline::default() }, ["normalize", "false", "true"]),
        ] {
            assert_eq!(difference(&plain, &text(other)), Some(expected));
        }
        assert_eq!(difference(&plain, &plain), None);
        let old = plain.replacen("1.0.0", "0.9.0", 1);
        assert_eq!(difference(&old, &plain), Some(["version of the program", "0.9.0", "1.0.0"]));
    }
}
