//! Flatten triangle meshes from the command line, compare the results and judge any UVs.
//!
//! What was typed ([`args`]) becomes what was meant ([`settings`]); every mesh becomes one
//! [`record::Record`] ([`run`], [`judge`]); and the records are shown as a [`table`] and as JSON.
//! Only this crate prints and reads the clock.

mod advice;
mod args;
mod cancel;
mod console;
mod errors;
mod files;
mod fixtures;
mod hints;
mod judge;
mod memory;
mod number;
mod progress;
mod record;
mod run;
mod settings;
mod source;
mod table;

use args::{Args, Command};
use cancel::Cancel;
use clap::Parser;
use record::{Outcome, Record};
use settings::{JsonTarget, Settings};
use std::process::ExitCode;

fn main() -> ExitCode {
    let args = Args::parse();
    let outcome = match args.command {
        None => match Settings::new(args.flatten) {
            Ok(settings) => flatten(&settings),
            // Says what is wrong with the usage and leaves with code 2.
            Err(error) => error.exit(),
        },
        Some(Command::Metrics(args)) => {
            let records: Vec<Record> = args.files.iter().map(|file| judge::judge(file)).collect();
            show(&records, JsonTarget::new(args.json).as_ref())
        }
        Some(Command::Fixtures(args)) => fixtures::write(args),
    };
    ExitCode::from(outcome.exit_code())
}

/// Flattens every mesh asked for.
fn flatten(settings: &Settings) -> Outcome {
    if let Err(failure) = settings.start_threads() {
        console::failure(&failure);
        return Outcome::Failed;
    }
    let cancel = Cancel::on_ctrl_c();
    let records: Vec<Record> = settings.sources.iter().map(|source| run::run(source, settings, &cancel)).collect();
    show(&records, settings.json.as_ref())
}

/// Shows the records as a table and, if asked for, as JSON; the outcome is the worst of all.
fn show(records: &[Record], json: Option<&JsonTarget>) -> Outcome {
    let table = table::table(records);
    let shown = match json {
        None => console::data(&table),
        Some(JsonTarget::Stdout) => {
            console::words(&table);
            console::data(&record::to_json(records))
        }
        Some(JsonTarget::File(path)) => {
            let printed = console::data(&table);
            files::replace(path, record::to_json(records).as_bytes()).and(printed)
        }
    };
    let worst = records.iter().map(Record::outcome).max().unwrap_or(Outcome::AsAsked);
    match shown {
        Ok(()) => worst,
        Err(failure) => {
            console::failure(&failure);
            Outcome::Failed
        }
    }
}
