//! What a comparison shows and writes.

use super::one::Compared;
use super::page::{self, Report};
use super::plots::Plots;
use super::settings::Comparison;
use crate::cli::targets::JsonTarget;
use crate::record::failure::Failure;
use crate::record::history::History;
use crate::record::{Record, to_json};
use crate::show::{console, files, history, table};

/// Everything that is finished, and where it goes.
#[derive(Debug)]
pub(super) struct Outputs<'a> {
    comparison: &'a Comparison,
    records: Vec<Record>,
    histories: Vec<History>,
    report: Option<Report>,
    plots: Option<Plots>,
}

impl<'a> Outputs<'a> {
    /// Outputs without results.
    pub(super) fn new(comparison: &'a Comparison) -> Self {
        let report = comparison.report.clone().map(Report::new);
        let plots = comparison.plots.clone().map(Plots::into);
        Self { comparison, records: Vec::new(), histories: Vec::new(), report, plots }
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
        if self.comparison.history.is_some() {
            self.histories.extend(mesh.runs.iter().filter_map(|run| run.history.clone()));
        }
        let section = page::section(mesh, self.comparison.lowest);
        if let Some(report) = &mut self.report {
            report.add(&section);
        }
        self.write()?;
        self.plots.as_mut().map_or(Ok(()), |plots| plots.add(&section))
    }

    /// Prints what could not be printed before, and returns all records.
    ///
    /// # Errors
    /// When stdout cannot be written.
    pub(super) fn finish(self) -> Result<Vec<Record>, Failure> {
        let is_stdout = |target: &Option<JsonTarget>| matches!(target, Some(JsonTarget::Stdout));
        let (records, asked) = (&self.records, self.comparison);
        if is_stdout(&asked.json) {
            console::data(&to_json(records))?;
        } else if is_stdout(&asked.markdown) {
            console::data(&table::comparison_markdown(records))?;
        } else if is_stdout(&asked.csv) {
            console::data(&table::comparison_csv(records))?;
        } else if is_stdout(&asked.history) {
            console::data(&history::text(None, &self.histories))?;
        }
        Ok(self.records)
    }

    /// On stdout, unless something for programs goes there.
    fn show(&self, text: &str) -> Result<(), Failure> {
        let asked = self.comparison;
        if [&asked.json, &asked.markdown, &asked.csv, &asked.history]
            .iter()
            .any(|t| matches!(t, Some(JsonTarget::Stdout)))
        {
            console::words(text);
            return Ok(());
        }
        console::data(text)
    }

    fn write(&self) -> Result<(), Failure> {
        let write = |target: &Option<JsonTarget>, text: fn(&[Record]) -> String| match target {
            Some(JsonTarget::File(path)) => files::replace(path, text(&self.records).as_bytes()),
            _ => Ok(()),
        };
        write(&self.comparison.json, to_json)?;
        write(&self.comparison.markdown, table::comparison_markdown)?;
        write(&self.comparison.csv, table::comparison_csv)?;
        if let Some(JsonTarget::File(path)) = &self.comparison.history {
            files::replace(path, history::text(Some(path), &self.histories).as_bytes())?;
        }
        self.report.as_ref().map_or(Ok(()), Report::write)
    }
}
