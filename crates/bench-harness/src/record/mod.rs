//! What is known about one result: the one source of every table and of the JSON.

mod accuracy;
mod atlas;
mod change;
pub(crate) mod failure;
mod figure;
mod head;
pub(crate) mod hints;
pub(crate) mod history;
mod json;
pub(crate) mod kind;
mod location;
mod made_injective;
pub(crate) mod misread;
mod not_run;
pub(crate) mod number;
mod outcome;
mod pins;
mod quality;
#[cfg(test)]
mod reads_back;
mod repacked;
mod result;
mod run;
mod settings;
mod size;
pub(crate) mod surveyed;
mod text;
mod times;

pub(crate) use accuracy::InnerAccuracy;
pub(crate) use atlas::{Atlas, ChartSettings, Charted, Narrow};
pub(crate) use change::Change;
pub(crate) use head::{Head, Machine, Program};
pub(crate) use json::{Document, SCHEMA, pretty, to_json};
pub(crate) use made_injective::MadeInjective;
pub(crate) use not_run::NotRun;
pub(crate) use outcome::Outcome;
pub(crate) use pins::Pinned;
pub(crate) use quality::Quality;
pub(crate) use repacked::Repacked;
pub(crate) use result::Record;
pub(crate) use run::{Relaxed, RunRecord, RungRecord};
pub(crate) use settings::Asked;
pub(crate) use size::{Kkt, Size};
pub(crate) use times::{Repeats, Spread, Stages, Timings};
