//! The charts of a page as files of their own.

use crate::record::failure::Failure;
use crate::show::files;
use abf_report::page::MeshSection;
use abf_report::{Plot, plots};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A folder of charts: `MESH-CHART.svg`.
#[derive(Debug)]
pub(super) struct Plots {
    folder: PathBuf,
    /// How many meshes had that name.
    names: BTreeMap<String, usize>,
}

impl Plots {
    /// Into that folder, which is made where it is not there.
    pub(super) fn into(folder: PathBuf) -> Self {
        Self { folder, names: BTreeMap::new() }
    }

    /// Writes the charts of a mesh. The second mesh of one name is numbered.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub(super) fn add(&mut self, section: &MeshSection<'_>) -> Result<(), Failure> {
        let unwritable = |error: &std::io::Error| Failure::unwritable(&self.folder.display().to_string(), error);
        std::fs::create_dir_all(&self.folder).map_err(|error| unwritable(&error))?;
        let stem = Path::new(section.name).file_stem().and_then(|stem| stem.to_str()).unwrap_or("mesh");
        let seen = self.names.entry(stem.to_owned()).or_default();
        *seen += 1;
        let name = if *seen == 1 { stem.to_owned() } else { format!("{stem}-{seen}") };
        for Plot { name: chart, svg } in plots(section) {
            files::replace(&self.folder.join(format!("{name}-{chart}.svg")), svg.as_bytes())?;
        }
        Ok(())
    }
}
