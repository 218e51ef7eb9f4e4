//! Flatten triangle meshes from the command line, compare the results and judge any UVs.
//!
//! One program with two names, `abf` and `bench-harness`. Its rooms, each of which uses only those before it:
//!
//! * `record`: everything that is known about one mesh and one solver, and its JSON;
//! * `cli`: what was typed, and what was meant by it;
//! * `show`: tables, advice and files;
//! * `run`: reading meshes, flattening them, and watching that;
//! * `commands`: flatten, `compare`, `survey`, `metrics`, `pack`, `sparsity` and `fixtures`.
//!
//! Only this crate prints and reads the clock.

mod cli;
mod commands;
mod record;
mod run;
mod show;

use cli::args::{Args, Command, Generated};
use cli::program;
use cli::typed::Typed;
use commands::compare::{Comparison, compare};
use commands::flatten::{Settings, flatten};
use commands::survey::{Survey, survey};
use commands::{fixtures, metrics, pack, sparsity};
use record::Outcome;
use record::failure::Failure;
use run::cancel;
use show::console;
use std::process::ExitCode;

/// Does what the command line asks for. Returns the program's exit code; a usage error ends the program with code 2.
pub fn main() -> ExitCode {
    let outcome = run_command();
    ExitCode::from(if cancel::is_aborted() { cancel::INTERRUPTED } else { outcome.exit_code() })
}

/// Does what was asked for.
fn run_command() -> Outcome {
    let (args, typed): (Args, Typed) = program::parse();
    if let Some(what) = args.generate {
        return print(what);
    }
    // First of all: to check settings is parallel work already.
    if let Err(failure) = start_threads(args.threads()) {
        console::failure(&failure);
        return Outcome::Failed;
    }
    // A usage error says what is wrong and leaves with code 2.
    match args.command {
        None => flatten(&Settings::new(args.flatten, typed).unwrap_or_else(|error| program::exit(error, None))),
        Some(Command::Compare(args)) => {
            compare(&Comparison::new(*args, typed).unwrap_or_else(|error| program::exit(error, Some("compare"))))
        }
        Some(Command::Survey(args)) => {
            survey(&Survey::new(*args, typed).unwrap_or_else(|error| program::exit(error, Some("survey"))))
        }
        Some(Command::Metrics(args)) => {
            metrics::check(&args).unwrap_or_else(|error| program::exit(error, Some("metrics")));
            metrics::judge_all(&args, &typed)
        }
        Some(Command::Pack(args)) => {
            pack::pack(&pack::Settings::new(*args, typed).unwrap_or_else(|error| program::exit(error, Some("pack"))))
        }
        Some(Command::Sparsity(args)) => {
            sparsity::check(&args).unwrap_or_else(|error| program::exit(error, Some("sparsity")));
            sparsity::show(&args)
        }
        Some(Command::Fixtures(args)) => fixtures::write(args),
    }
}

/// Prints a completion script or a manual page.
fn print(what: Generated) -> Outcome {
    let mut text = Vec::new();
    let made = program::generate(what, &mut text).map_err(|error| Failure::unwritable("stdout", &error));
    match made.and_then(|()| console::data(&String::from_utf8_lossy(&text))) {
        Ok(()) => Outcome::AsAsked,
        Err(failure) => {
            console::failure(&failure);
            Outcome::Failed
        }
    }
}

/// Starts the threads that all parallel work uses; without a number that is one per core.
///
/// # Errors
/// When the system has no room for that many.
fn start_threads(threads: Option<u16>) -> Result<(), Failure> {
    let Some(threads) = threads else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
    pool.build_global().map_err(|error| Failure::threads(threads, &error))
}
