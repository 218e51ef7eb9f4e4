//! The results of a survey: the log that grows mesh by mesh, and the file at the end.
//!
//! The log's first line has the settings, every other one a finished mesh. A line that was cut short when
//! the program ended is no entry.

use super::lock::lock;
use super::settings::Survey;
use crate::record::failure::Failure;
use crate::record::kind::Refused;
use crate::record::surveyed::{About, Counts, FileState, LogHead, MadeWith, SurveyDocument, Surveyed};
use crate::record::{Head, SCHEMA, pretty};
use crate::show::files;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// The log of a survey, with what is there from an earlier run.
#[derive(Debug)]
pub(super) struct Log {
    /// `None` where the results go to no file, and nothing is kept.
    path: Option<PathBuf>,
    made_with: MadeWith,
    earlier: BTreeMap<String, Surveyed>,
    file: Mutex<Option<File>>,
}

impl Log {
    /// Reads what there is to resume.
    ///
    /// # Errors
    /// Results that are none of a survey or of one with other settings, and a log that would be lost.
    pub(super) fn open(survey: &Survey) -> Result<Self, Failure> {
        let (path, made_with) = (survey.log(), survey.made_with());
        let mut log = Self { path, made_with, earlier: BTreeMap::new(), file: Mutex::new(None) };
        let Some(path) = log.path.clone() else { return Ok(log) };
        files::check([Some(path.as_path())])?;
        if survey.resume {
            if let Some(results) = survey.json.as_ref().and_then(|target| target.file()) {
                log.add_results(results)?;
            }
            log.add_log(&path)?;
        } else if path.exists() {
            return Err(Failure::unfinished_survey(&path));
        }
        Ok(log)
    }

    /// The entry of a mesh that is done already, and has not changed since.
    pub(super) fn take(&mut self, mesh: &Path) -> Option<Surveyed> {
        let entry = self.earlier.remove(&mesh.display().to_string())?;
        let is_current = entry.file.is_some() && entry.file == FileState::of(mesh);
        // More memory may be there now.
        (is_current && entry.refused != Some(Refused::Memory)).then_some(entry)
    }

    /// Begins the log with what is kept.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn start<'a>(&mut self, kept: impl Iterator<Item = &'a Surveyed>) -> Result<(), Failure> {
        let Some(path) = &self.path else { return Ok(()) };
        let head = LogHead { schema: SCHEMA.to_owned(), made_with: self.made_with.clone() };
        let lines: String = std::iter::once(line(&head)).chain(kept.map(line)).collect();
        files::replace(path, lines.as_bytes())?;
        let file = OpenOptions::new().append(true).open(path).map_err(|error| unwritable(path, &error))?;
        *lock(&self.file) = Some(file);
        Ok(())
    }

    /// Adds a finished mesh.
    ///
    /// # Errors
    /// When the log cannot be written.
    pub(super) fn append(&self, entry: &Surveyed) -> Result<(), Failure> {
        let (Some(path), Some(file)) = (&self.path, &mut *lock(&self.file)) else { return Ok(()) };
        // One write: two entries never mix, and half a line is no entry.
        file.write_all(line(entry).as_bytes()).map_err(|error| unwritable(path, &error))
    }

    /// Removes the log, for the results are written.
    ///
    /// # Errors
    /// When the system refuses.
    pub(super) fn finish(self) -> Result<(), Failure> {
        let Some(path) = &self.path else { return Ok(()) };
        drop(self.file);
        fs::remove_file(path).map_err(|error| unwritable(path, &error))
    }

    fn add_results(&mut self, path: &Path) -> Result<(), Failure> {
        let Some(text) = read(path)? else { return Ok(()) };
        let document: SurveyDocument = parse(path, &text)?;
        self.add(path, &document.survey.made_with, document.results.into_iter())
    }

    fn add_log(&mut self, path: &Path) -> Result<(), Failure> {
        let Some(text) = read(path)? else { return Ok(()) };
        let (head, lines) = text.split_once('\n').unwrap_or((&text, ""));
        let head: LogHead = parse(path, head)?;
        // Half of a line is no entry.
        self.add(path, &head.made_with, lines.lines().filter_map(|line| serde_json::from_str(line).ok()))
    }

    fn add(
        &mut self,
        path: &Path,
        made_with: &MadeWith,
        entries: impl Iterator<Item = Surveyed>,
    ) -> Result<(), Failure> {
        // Results of two kinds in one file would be compared as one; to do the others again would lose them unasked.
        if let Some([what, before, now]) = made_with.difference(&self.made_with) {
            return Err(Failure::other_settings(path, &what, &before, &now));
        }
        self.earlier.extend(entries.map(|entry| (entry.record.mesh.clone(), entry)));
        Ok(())
    }
}

/// One line of the log.
fn line(entry: &impl Serialize) -> String {
    let mut text = serde_json::to_string(entry).expect("records have text keys only");
    text.push('\n');
    text
}

/// A document of this schema.
fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, Failure> {
    /// What tells whether the rest can be understood.
    #[derive(Deserialize)]
    struct Top {
        schema: String,
    }
    let none = |error: serde_json::Error| Failure::no_survey(path, &error.to_string());
    let top: Top = serde_json::from_str(text).map_err(none)?;
    if top.schema != SCHEMA {
        return Err(Failure::no_survey(path, &format!("its \"schema\" is not \"{SCHEMA}\"")));
    }
    serde_json::from_str(text).map_err(none)
}

/// The text of a file, if there is one.
fn read(path: &Path) -> Result<Option<String>, Failure> {
    match fs::read(path) {
        // What is cut inside a character is cut inside a line.
        Ok(bytes) => Ok(Some(String::from_utf8_lossy(&bytes).into_owned())),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Failure::unreadable(path, &error)),
    }
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::unwritable(&path.display().to_string(), error)
}

/// The results as a JSON document: that of every other command, and what was counted.
pub(super) fn document(survey: &Survey, counts: &Counts, done: &[Surveyed]) -> String {
    let solver = survey.method.pipeline.solver.name().to_owned();
    let about = About { solver, made_with: survey.made_with(), counts: counts.clone() };
    pretty(&SurveyDocument { head: Head::new(SCHEMA), survey: about, results: done.to_vec() })
}
