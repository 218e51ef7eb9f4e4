//! The results of a survey: the log that grows mesh by mesh, and the file at the end.
//!
//! The log's first line has the settings, every other one a finished mesh. A line that was cut short when
//! the program ended is no entry.

use super::lock::lock;
use super::row::{Entry, FileState};
use super::settings::{Survey, difference};
use super::summary::Counts;
use crate::record::failure::Failure;
use crate::record::{SCHEMA, pretty};
use crate::show::files;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
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
    settings: String,
    earlier: BTreeMap<String, Entry>,
    file: Mutex<Option<File>>,
}

#[derive(Serialize, Deserialize)]
struct Head {
    schema: String,
    settings: String,
}

impl Log {
    /// Reads what there is to resume.
    ///
    /// # Errors
    /// Results that are none of a survey or of one with other settings, and a log that would be lost.
    pub(super) fn open(survey: &Survey) -> Result<Self, Failure> {
        let (path, settings) = (survey.log(), survey.settings());
        let mut log = Self { path, settings, earlier: BTreeMap::new(), file: Mutex::new(None) };
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
    pub(super) fn take(&mut self, mesh: &Path) -> Option<Entry> {
        let entry = self.earlier.remove(&mesh.display().to_string())?;
        let is_current = entry.row.file.is_some() && entry.row.file == FileState::of(mesh);
        (is_current && !entry.is_for_want_of_memory()).then_some(entry)
    }

    /// Begins the log with what is kept.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn start<'a>(&mut self, kept: impl Iterator<Item = &'a Entry>) -> Result<(), Failure> {
        let Some(path) = &self.path else { return Ok(()) };
        let head = Head { schema: SCHEMA.to_owned(), settings: self.settings.clone() };
        let head = serde_json::to_string(&head).expect("text");
        let lines: String = std::iter::once(head.as_str())
            .chain(kept.map(|entry| entry.json.as_str()))
            .flat_map(|line| [line, "\n"])
            .collect();
        files::replace(path, lines.as_bytes())?;
        let file = OpenOptions::new().append(true).open(path).map_err(|error| unwritable(path, &error))?;
        *lock(&self.file) = Some(file);
        Ok(())
    }

    /// Adds a finished mesh.
    ///
    /// # Errors
    /// When the log cannot be written.
    pub(super) fn append(&self, entry: &Entry) -> Result<(), Failure> {
        let (Some(path), Some(file)) = (&self.path, &mut *lock(&self.file)) else { return Ok(()) };
        // One write: two entries never mix, and half a line is no entry.
        let line = format!("{}\n", entry.json);
        file.write_all(line.as_bytes()).map_err(|error| unwritable(path, &error))
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
        #[derive(Deserialize)]
        struct Document {
            schema: String,
            survey: Head,
            results: Vec<Box<RawValue>>,
        }
        let Some(text) = read(path)? else { return Ok(()) };
        let document: Document =
            serde_json::from_str(&text).map_err(|error| Failure::no_survey(path, &error.to_string()))?;
        if document.schema != SCHEMA {
            return Err(Failure::no_survey(path, &format!("its \"schema\" is not \"{SCHEMA}\"")));
        }
        self.add(path, &document.survey, document.results.iter().map(|result| result.get()))
    }

    fn add_log(&mut self, path: &Path) -> Result<(), Failure> {
        let Some(text) = read(path)? else { return Ok(()) };
        let (head, lines) = text.split_once('\n').unwrap_or((&text, ""));
        let head: Head = serde_json::from_str(head).map_err(|error| Failure::no_survey(path, &error.to_string()))?;
        self.add(path, &head, lines.lines())
    }

    fn add<'a>(&mut self, path: &Path, head: &Head, entries: impl Iterator<Item = &'a str>) -> Result<(), Failure> {
        // Results of two kinds in one file would be compared as one; to do the others again would lose them unasked.
        if let Some([what, before, now]) = difference(&head.settings, &self.settings) {
            return Err(Failure::other_settings(path, what, before, now));
        }
        let entries = entries.filter_map(|text| Entry::read(text.to_owned()));
        self.earlier.extend(entries.map(|entry| (entry.row.mesh.clone(), entry)));
        Ok(())
    }
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
pub(super) fn document(survey: &Survey, counts: &Counts, done: &[Entry]) -> String {
    #[derive(Serialize)]
    struct Document<'a> {
        schema: &'static str,
        survey: About<'a>,
        results: Vec<&'a RawValue>,
    }
    #[derive(Serialize)]
    struct About<'a> {
        schema: &'static str,
        settings: String,
        solver: &'static str,
        #[serde(flatten)]
        counts: &'a Counts,
    }
    let results = done.iter().map(|entry| serde_json::from_str(&entry.json).expect("one JSON value")).collect();
    let about =
        About { schema: SCHEMA, settings: survey.settings(), solver: survey.method.pipeline.solver.name(), counts };
    pretty(&Document { schema: SCHEMA, survey: about, results })
}
