//! The command that compares: many meshes, many solvers, several runs of each.
//!
//! After every mesh its table is shown and all files are written anew, each whole or not at all, so
//! that whatever ends the program leaves everything that was finished.

mod baseline;
mod one;
mod outputs;
mod page;
mod plots;
mod repeat;
mod settings;

use crate::record::Outcome;
use crate::record::failure::Failure;
use crate::record::number::count;
use crate::run::cancel::Cancel;
use crate::run::meshes::{self, Depth};
use crate::run::source::Source;
use crate::show::{console, files};
use baseline::Baseline;
use one::compare_one;
use outputs::Outputs;
pub(crate) use settings::Comparison;

/// Compares what was asked for.
pub(crate) fn compare(comparison: &Comparison) -> Outcome {
    match try_compare(comparison) {
        Ok(outcome) => outcome,
        Err(failure) => {
            console::failure(&failure);
            Outcome::Failed
        }
    }
}

/// Fails where nothing can be compared or written; a mesh that fails is a row.
fn try_compare(comparison: &Comparison) -> Result<Outcome, Failure> {
    files::check(comparison.files())?;
    let baseline = comparison.baseline.as_deref().map(Baseline::read).transpose()?;
    let meshes = meshes::find(&comparison.meshes, Depth::Below)?;
    let cancel = Cancel::on_ctrl_c();
    let mut outputs = Outputs::new(comparison);
    for (done, file) in meshes.iter().enumerate() {
        let mut mesh = compare_one(&Source::File(file.clone()), comparison, &cancel);
        mesh.runs.iter_mut().for_each(|run| comparison.typed.fit(&mut run.record));
        // What the user stopped says nothing about the solver.
        mesh.runs.retain(|run| !run.record.is_cancelled());
        if let Some(baseline) = &baseline {
            mesh.runs.iter_mut().for_each(|run| run.record.baseline = Some(baseline.change(&run.record)));
        }
        if !mesh.runs.is_empty() {
            outputs.add(&mesh)?;
        }
        if cancel.is_asked() {
            console::words(&format!("cancelled: {done} of {} done\n", count(meshes.len(), "mesh", "meshes")));
            break;
        }
    }
    let records = outputs.finish()?;
    if let Some(baseline) = &baseline {
        console::words(&baseline.summary(&records));
    }
    let has_failed = records.iter().any(|record| record.outcome() == Outcome::Failed);
    Ok(match (has_failed, cancel.is_asked()) {
        (true, _) => Outcome::Failed,
        (false, true) => Outcome::NotAsAsked,
        (false, false) => Outcome::AsAsked,
    })
}
