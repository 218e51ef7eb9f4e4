//! The charts of a page as files of their own.

use crate::record::failure::Failure;
use crate::show::files;
use abf_report::page::MeshSection;
use abf_report::{Plot, plots};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A folder of charts: `MESH-CHART.svg`.
#[derive(Debug)]
pub(super) struct Plots {
    folder: PathBuf,
    /// The names of meshes so far.
    names: BTreeSet<String>,
}

impl Plots {
    /// Into that folder, which is made where it is not there.
    pub(super) fn into(folder: PathBuf) -> Self {
        Self { folder, names: BTreeSet::new() }
    }

    /// Writes the charts of a mesh. The second mesh of one name is numbered.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub(super) fn add(&mut self, section: &MeshSection<'_>) -> Result<(), Failure> {
        let unwritable = |error: &std::io::Error| Failure::unwritable(&self.folder.display().to_string(), error);
        std::fs::create_dir_all(&self.folder).map_err(|error| unwritable(&error))?;
        let stem = Path::new(section.name).file_stem().and_then(|stem| stem.to_str()).unwrap_or("mesh");
        let numbered = std::iter::once(stem.to_owned()).chain((2..).map(|n| format!("{stem}-{n}")));
        let name = numbered.into_iter().find(|name| self.names.insert(name.clone())).expect("numbers do not end");
        for Plot { name: chart, svg } in plots(section) {
            files::replace(&self.folder.join(format!("{name}-{chart}.svg")), svg.as_bytes())?;
        }
        Ok(())
    }
}
