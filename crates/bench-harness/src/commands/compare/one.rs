//! One mesh of a comparison.

use super::repeat;
use super::settings::Comparison;
use crate::run::Flattened;
use crate::run::cancel::Cancel;
use crate::run::load::{Loaded, unusable};
use crate::run::source::Source;

/// A mesh with its results.
#[derive(Debug)]
pub(super) struct Compared {
    /// Its name.
    pub(super) name: String,
    /// The mesh, if it could be read.
    pub(super) loaded: Option<Loaded>,
    /// The results, one for each solver.
    pub(super) runs: Vec<Flattened>,
}

/// All solvers on one mesh, or one result that says why there are none.
pub(super) fn compare_one(source: &Source, comparison: &Comparison, cancel: &Cancel) -> Compared {
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
