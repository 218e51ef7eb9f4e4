//! The command that surveys: one solver, every mesh of a folder, several at a time.
//!
//! Every finished mesh is appended to a log beside the results; at the end, or after Ctrl-C, the results are
//! written whole and the log goes. So whatever ends the program leaves what was finished, and `--resume`
//! takes it from either. What is shown and written is in the order of the meshes, whichever was done first.

mod budget;
mod lock;
mod log;
mod settings;
mod summary;
mod table;

use crate::cli::targets::JsonTarget;
use crate::record::failure::Failure;
use crate::record::number::count;
use crate::record::surveyed::{FileState, Surveyed};
use crate::record::{Outcome, Record};
use crate::run::cancel::Cancel;
use crate::run::load::{Loaded, unusable};
use crate::run::source::Source;
use crate::run::{self, meshes};
use crate::show::{console, files};
use abf::predict_memory;
use budget::Budget;
use lock::lock;
use log::Log;
pub(crate) use settings::Survey;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Surveys what was asked for.
pub(crate) fn survey(survey: &Survey) -> Outcome {
    match try_survey(survey) {
        Ok(outcome) => outcome,
        Err(failure) => {
            console::failure(&failure);
            Outcome::Failed
        }
    }
}

/// Fails where nothing can be surveyed or written; a mesh that fails is a row.
fn try_survey(survey: &Survey) -> Result<Outcome, Failure> {
    files::check([survey.json.as_ref().and_then(JsonTarget::file)])?;
    let meshes = meshes::find(&survey.meshes, survey.depth)?;
    let mut log = Log::open(survey)?;
    let mut entries: Vec<Option<Surveyed>> = meshes.iter().map(|mesh| log.take(mesh)).collect();
    let kept = entries.iter().flatten().count();
    if survey.resume {
        console::words(&format!("resumed: {kept} of {} done already\n", count(meshes.len(), "mesh", "meshes")));
    }
    log.start(entries.iter().flatten())?;
    let cancel = Cancel::on_ctrl_c();
    let missing: Vec<usize> = (0..meshes.len()).filter(|&k| entries[k].is_none()).collect();
    for (k, entry) in work(survey, &meshes, &missing, &log, &cancel)? {
        entries[k] = Some(entry);
    }
    let done: Vec<Surveyed> = entries.into_iter().flatten().collect();
    let rows: Vec<&Surveyed> = done.iter().collect();
    let counts = summary::count(&rows, meshes.len());
    if cancel.is_asked() {
        console::words(&format!("cancelled: {} of {} done\n", done.len(), count(meshes.len(), "mesh", "meshes")));
    }
    let json = || log::document(survey, &counts, &done);
    let shown = crate::show::show(&summary::text(&rows, &counts), json, survey.json.as_ref());
    shown.and_then(|()| log.finish())?;
    Ok(if counts.valid == meshes.len() { Outcome::AsAsked } else { Outcome::NotAsAsked })
}

/// Flattens the meshes of these numbers, several at a time, and logs each. Leaves out what the user stopped.
///
/// # Errors
/// That the log cannot be written; going on would be work for nothing.
fn work(
    survey: &Survey,
    meshes: &[PathBuf],
    missing: &[usize],
    log: &Log,
    cancel: &Cancel,
) -> Result<Vec<(usize, Surveyed)>, Failure> {
    let budget = Budget::new(survey.method.pipeline.max_memory);
    let (next, failed) = (AtomicUsize::new(0), Mutex::new(None));
    let finished = Mutex::new(Vec::new());
    let job = || {
        while let Some(&k) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
            if cancel.is_asked() || lock(&failed).is_some() {
                break;
            }
            // Taken before it is read: who changes it meanwhile has it read again.
            let state = FileState::of(&meshes[k]);
            let record = flatten(&meshes[k], survey, &budget, cancel);
            if record.is_cancelled() {
                break;
            }
            let entry = Surveyed::new(record, state);
            match log.append(&entry) {
                Ok(()) => lock(&finished).push((k, entry)),
                Err(failure) => *lock(&failed) = Some(failure),
            }
        }
    };
    thread::scope(|scope| {
        for _ in 1..survey.jobs.min(missing.len()) {
            scope.spawn(job);
        }
        // The memory of a single job is measured, and this thread has its scratch already.
        job();
    });
    let failed = lock(&failed).take();
    let finished = std::mem::take(&mut *lock(&finished));
    failed.map_or(Ok(finished), Err)
}

/// One mesh. A defect of this program costs that mesh, not the survey.
fn flatten(path: &Path, survey: &Survey, budget: &Budget, cancel: &Cancel) -> Record {
    let name = path.display().to_string();
    let source = Source::File(path.to_owned());
    let flattened = catch_unwind(AssertUnwindSafe(|| {
        within(budget, &source, survey, cancel).unwrap_or_else(|failure| unusable(name.clone(), failure))
    }));
    let mut record = flattened.unwrap_or_else(|_| unusable(name.clone(), Failure::panicked(&name)));
    survey.typed.fit(&mut record);
    if survey.jobs > 1 {
        // There is one peak for the whole program, and one account of processor time.
        record.peak_memory_bytes = None;
        if let Some(timings) = &mut record.timings_s {
            timings.stages.flatten_cpu = None;
        }
    }
    record
}

/// One mesh, in its share of the memory: that of reading first, then what is predicted for its size. A mesh
/// that has to wait for that is given back meanwhile and read again; to wait with it in hand could be to
/// wait for each other.
///
/// # Errors
/// What is wrong with the file.
fn within(budget: &Budget, source: &Source, survey: &Survey, cancel: &Cancel) -> Result<Record, Failure> {
    let pipeline = &survey.method.pipeline;
    let (limit, to_read) = (pipeline.max_memory, source.memory_to_read());
    let wanted = run::Wanted { charting: survey.charting.as_ref(), ..run::Wanted::default() };
    let mut share = budget.wait_for(to_read);
    let mut loaded = Loaded::read(source, limit, cancel)?;
    let predicted =
        predict_memory(&pipeline.solver, loaded.mesh().face_count(), loaded.mesh().vertex_count()).max(to_read);
    // What may take more than there is either is refused or keeps within the limit by itself.
    let needed = predicted.min(limit.unwrap_or(u64::MAX));
    if !share.grow_to(needed) {
        drop(loaded);
        drop(share);
        let _share = budget.wait_for(needed);
        loaded = Loaded::read_quietly(source, limit, cancel)?;
        return Ok(run::flatten(&loaded, &survey.method, &wanted, cancel).record);
    }
    Ok(run::flatten(&loaded, &survey.method, &wanted, cancel).record)
}
