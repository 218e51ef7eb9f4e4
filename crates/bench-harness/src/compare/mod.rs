//! The command that compares: many meshes, many solvers, several runs of each.
//!
//! After every mesh its table is shown and all files are written anew, each whole or not at all, so
//! that whatever ends the program leaves everything that was finished.

mod baseline;
mod outputs;
mod repeat;
mod report;
mod settings;

use crate::cancel::Cancel;
use crate::console;
use crate::errors::Failure;
use crate::files;
use crate::load::{Loaded, unusable};
use crate::meshes::{self, Depth};
use crate::number::count;
use crate::record::Outcome;
use crate::run::Flattened;
use crate::source::Source;
use baseline::Baseline;
pub(crate) use baseline::Change;
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

/// A mesh with its results.
#[derive(Debug)]
struct Compared {
    name: String,
    loaded: Option<Loaded>,
    runs: Vec<Flattened>,
}

/// All solvers on one mesh, or one result that says why there are none.
fn compare_one(source: &Source, comparison: &Comparison, cancel: &Cancel) -> Compared {
    let name = source.name();
    let loaded = match Loaded::read(source, comparison.methods[0].pipeline.max_memory, cancel) {
        Ok(loaded) => loaded,
        Err(failure) => {
            let runs = vec![unusable(name.clone(), failure).into()];
            return Compared { name, loaded: None, runs };
        }
    };
    let mut runs = Vec::new();
    for method in &comparison.methods {
        let flattened = repeat::repeated(&loaded, method, comparison.runs, cancel);
        if flattened.mesh_is_unusable {
            runs = vec![flattened];
            break;
        }
        runs.push(flattened);
        if cancel.is_asked() {
            break;
        }
    }
    Compared { name, loaded: Some(loaded), runs }
}
