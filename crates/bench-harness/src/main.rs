//! Flatten triangle meshes from the command line, compare the results and judge any UVs.
//!
//! What was typed ([`args`]) becomes what was meant ([`settings`], [`methods`]); every mesh and solver
//! becomes one [`record::Record`] ([`run`], [`judge`]); and the records are shown as a [`table`] and as
//! JSON, mesh by mesh ([`flatten`]), repeated and written to files ([`compare`]), or counted over many
//! meshes ([`survey`]). Only this crate
//! prints and reads the clock.

mod advice;
mod args;
mod cancel;
mod charting;
mod compare;
mod console;
mod errors;
mod files;
mod fixtures;
mod flatten;
mod hints;
mod history;
mod judge;
mod load;
mod memory;
mod meshes;
mod methods;
mod number;
mod progress;
mod record;
mod run;
mod settings;
mod show;
mod source;
mod survey;
mod table;

use args::{Args, Command};
use clap::Parser;
use compare::Comparison;
use errors::Failure;
use record::Outcome;
use settings::Settings;
use std::process::ExitCode;
use survey::Survey;

fn main() -> ExitCode {
    ExitCode::from(run_command().exit_code())
}

/// Does what was asked for.
fn run_command() -> Outcome {
    let args = Args::parse();
    // First of all: to check settings is parallel work already.
    if let Err(failure) = start_threads(args.threads()) {
        console::failure(&failure);
        return Outcome::Failed;
    }
    // A usage error says what is wrong and leaves with code 2.
    match args.command {
        None => flatten::flatten(&Settings::new(args.flatten).unwrap_or_else(|error| error.exit())),
        Some(Command::Compare(args)) => compare::compare(&Comparison::new(*args).unwrap_or_else(|error| error.exit())),
        Some(Command::Survey(args)) => survey::survey(&Survey::new(*args).unwrap_or_else(|error| error.exit())),
        Some(Command::Metrics(args)) => judge::judge_all(&args),
        Some(Command::Fixtures(args)) => fixtures::write(args),
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
