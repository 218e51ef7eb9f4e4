//! What a comparison shows and writes.

use super::report::Report;
use super::{Compared, Comparison};
use crate::errors::Failure;
use crate::record::{Record, to_json};
use crate::settings::JsonTarget;
use crate::{console, files, table};
use std::path::Path;

/// Everything that is finished, and where it goes.
#[derive(Debug)]
pub(super) struct Outputs<'a> {
    comparison: &'a Comparison,
    records: Vec<Record>,
    report: Option<Report>,
}

impl<'a> Outputs<'a> {
    /// Outputs without results.
    pub(super) fn new(comparison: &'a Comparison) -> Self {
        Self { comparison, records: Vec::new(), report: comparison.report.clone().map(Report::new) }
    }

    /// Shows the table of a mesh and writes every file anew with all that is finished.
    ///
    /// # Errors
    /// When something cannot be written; going on would be work for nothing.
    pub(super) fn add(&mut self, mesh: &Compared) -> Result<(), Failure> {
        let records: Vec<Record> = mesh.runs.iter().map(|run| run.record.clone()).collect();
        let gap = if self.records.is_empty() { "" } else { "\n" };
        self.show(&format!("{gap}{}", table::of_repeats(&records)))?;
        self.records.extend(records);
        if let Some(report) = &mut self.report {
            report.add(&mesh.name, mesh.loaded.as_ref(), &mesh.runs);
        }
        self.write()
    }

    /// Prints what could not be printed before, and returns all records.
    ///
    /// # Errors
    /// When stdout cannot be written.
    pub(super) fn finish(self) -> Result<Vec<Record>, Failure> {
        if let Some(JsonTarget::Stdout) = self.comparison.json {
            console::data(&to_json(&self.records))?;
        }
        Ok(self.records)
    }

    /// On stdout, unless JSON goes there.
    fn show(&self, text: &str) -> Result<(), Failure> {
        match self.comparison.json {
            Some(JsonTarget::Stdout) => {
                console::words(text);
                Ok(())
            }
            _ => console::data(text),
        }
    }

    fn write(&self) -> Result<(), Failure> {
        let write = |path: Option<&Path>, text: fn(&[Record]) -> String| match path {
            Some(path) => files::replace(path, text(&self.records).as_bytes()),
            None => Ok(()),
        };
        write(self.comparison.json.as_ref().and_then(JsonTarget::file), to_json)?;
        write(self.comparison.markdown.as_deref(), table::comparison_markdown)?;
        write(self.comparison.csv.as_deref(), table::comparison_csv)?;
        self.report.as_ref().map_or(Ok(()), Report::write)
    }
}
