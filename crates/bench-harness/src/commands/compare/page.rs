//! The page of a comparison: one HTML file with pictures, curves and tables.

use super::one::Compared;
use crate::cli::args::Lowest;
use crate::record::failure::Failure;
use crate::record::history::History;
use crate::record::{Machine, Program, Record};
use crate::run::Flattened;
use crate::run::load::Loaded;
use crate::show::files;
use crate::show::table;
use abf_report::page::{MeshFragment, MeshSection, SolverRun, assemble};
use std::path::PathBuf;

const TITLE: &str = "Comparison of flattenings";
/// The solver of a row that no solver is to blame for.
const NO_SOLVER: &str = "none";

/// A page that grows mesh by mesh. Neither meshes nor layouts are kept.
#[derive(Debug)]
pub(super) struct Report {
    path: PathBuf,
    machine: Vec<(String, String)>,
    meshes: Vec<MeshFragment>,
}

impl Report {
    /// A page without meshes.
    pub(super) fn new(path: PathBuf) -> Self {
        Self { path, machine: machine(), meshes: Vec::new() }
    }

    /// Adds a mesh with its results.
    pub(super) fn add(&mut self, section: &MeshSection<'_>) {
        self.meshes.push(MeshFragment::render(section));
    }

    /// Writes the page with what there is.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(super) fn write(&self) -> Result<(), Failure> {
        files::replace(&self.path, assemble(TITLE, &self.machine, &self.meshes).as_bytes())
    }
}

/// What a page says of a mesh with its results; a mesh that could not be read has none.
pub(super) fn section(mesh: &Compared, lowest: Lowest) -> MeshSection<'_> {
    MeshSection {
        name: &mesh.name,
        mesh: mesh.loaded.as_ref().map(Loaded::mesh),
        runs: mesh.runs.iter().map(row).collect(),
        injective_only: lowest == Lowest::Injective,
    }
}

fn row(flattened: &Flattened) -> SolverRun<'_> {
    let Flattened { record, uv, history, .. } = flattened;
    SolverRun {
        solver: record.solver.as_deref().unwrap_or(NO_SOLVER),
        settings: record.run.as_ref().map(|run| run.settings.listed()).unwrap_or_default(),
        uv: uv.as_ref(),
        columns: table::page_cells(record),
        failure: failure(record),
        outer: history.as_ref().map(History::outer).unwrap_or_default(),
        inner: history.as_ref().map(History::inner).unwrap_or_default(),
        timed: history.as_ref().map(History::timed).unwrap_or_default(),
        energies: history.as_ref().map(History::energies).unwrap_or_default(),
    }
}

/// Why there is no result. A solver that was left out has not failed.
fn failure(record: &Record) -> Option<String> {
    record.error.as_ref().map(|failure| format!("{}: {}", failure.message, failure.hint))
}

/// What the runs are made on.
fn machine() -> Vec<(String, String)> {
    let (Program { name, version }, machine) = (Program::this(), Machine::this());
    let cores = machine.cores.map_or_else(|| "unknown".to_owned(), |cores| cores.to_string());
    let mut lines = vec![
        ("program".to_owned(), format!("{name} {version}")),
        ("system".to_owned(), format!("{} on {}", machine.os, machine.arch)),
        ("cores".to_owned(), cores),
        ("threads".to_owned(), rayon::current_num_threads().to_string()),
    ];
    lines.extend(machine.cpu.map(|name| ("processor".to_owned(), name)));
    lines
}
