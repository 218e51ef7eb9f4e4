//! The command that flattens: one mesh or several, with one solver or several.

mod seam_lines;
mod settings;
mod write;

use crate::cli::targets::JsonTarget;
use crate::record::history::History;
use crate::record::{Outcome, Record, to_json};
use crate::run::cancel::Cancel;
use crate::run::load::{Loaded, unusable};
use crate::run::source::Source;
use crate::run::{self, Flattened};
use crate::show::show;
use crate::show::{console, files, findings, history, table};
pub(crate) use settings::Settings;
use write::{Made, write_files};

/// Flattens every mesh asked for.
pub(crate) fn flatten(settings: &Settings) -> Outcome {
    // Nobody should wait for a result that has nowhere to go.
    if let Err(failure) = files::check(settings.files()) {
        console::failure(&failure);
        return Outcome::Failed;
    }
    let cancel = Cancel::on_ctrl_c();
    let mut runs = Vec::new();
    let by_mesh: Vec<Vec<Record>> = settings
        .sources
        .iter()
        .map(|source| match settings.is_comparison() {
            true => with_all(source, settings, &cancel, &mut runs),
            false => vec![with_one(source, settings, &cancel, &mut runs)],
        })
        .collect();
    let table = match settings.is_comparison() {
        true => by_mesh.iter().map(|records| table::of_solvers(records)).collect::<Vec<_>>().join("\n"),
        false => table::of_meshes(&by_mesh.concat()),
    };
    let records = by_mesh.concat();
    let (shown, noted) = match &settings.history {
        Some(JsonTarget::Stdout) => {
            console::words(&table);
            let json = settings.json.as_ref().and_then(JsonTarget::file);
            let shown = json.map_or(Ok(()), |path| files::replace(path, to_json(&records).as_bytes()));
            (shown, console::data(&history::text(None, &runs)))
        }
        Some(JsonTarget::File(path)) => {
            let shown = show(&table, || to_json(&records), settings.json.as_ref());
            (shown, files::replace(path, history::text(Some(path), &runs).as_bytes()))
        }
        None => (show(&table, || to_json(&records), settings.json.as_ref()), Ok(())),
    };
    let worst = records.iter().map(Record::outcome).max().unwrap_or(Outcome::AsAsked);
    [shown, noted].into_iter().filter_map(Result::err).fold(worst, |_, failure| {
        console::failure(&failure);
        Outcome::Failed
    })
}

/// Flattens one mesh with every solver asked for. What they have to say stands below their table.
fn with_all(source: &Source, settings: &Settings, cancel: &Cancel, runs: &mut Vec<History>) -> Vec<Record> {
    let loaded = match Loaded::read(source, settings.max_memory(), cancel) {
        Ok(loaded) => loaded,
        Err(mut failure) => {
            settings.typed.fit_failure(&mut failure);
            console::failure(&failure);
            return vec![unusable(source.name(), failure)];
        }
    };
    let mut records = Vec::new();
    for method in &settings.methods {
        let Flattened { mut record, history, mesh_is_unusable, .. } =
            run::flatten(&loaded, method, &settings.wanted(), cancel);
        settings.typed.fit(&mut record);
        if let (true, Some(failure)) = (mesh_is_unusable, &record.error) {
            console::failure(failure);
            return vec![record];
        }
        runs.extend(history);
        records.push(record);
    }
    records
}

/// Flattens one mesh with one solver and writes what is asked for. Whatever goes wrong is in the
/// record and on stderr.
fn with_one(source: &Source, settings: &Settings, cancel: &Cancel, runs: &mut Vec<History>) -> Record {
    let mut record = match Loaded::read(source, settings.max_memory(), cancel) {
        Ok(loaded) => {
            let method = &settings.methods[0];
            let Flattened { mut record, uv, seams, sheet, history, .. } =
                run::flatten(&loaded, method, &settings.wanted(), cancel);
            if let Some(uv) = uv.filter(|_| record.error.is_none()) {
                let made = Made { uv: &uv, seams: &seams, sheet: sheet.as_ref() };
                record.error = write_files(settings, &loaded, &made, cancel, &mut record).err();
            }
            runs.extend(history);
            record
        }
        Err(failure) => unusable(source.name(), failure),
    };
    settings.typed.fit(&mut record);
    if let Some(failure) = &record.error {
        console::failure(failure);
    }
    if record.atlas.is_some() && settings.history.is_some() {
        console::note(&record.mesh, "charts are flattened many times: no iterations are kept of them");
    }
    // The table of a single mesh says it on a line of its own.
    if settings.sources.len() > 1 {
        let repairs = record.atlas.iter().flat_map(|atlas| &atlas.repairs);
        repairs.for_each(|repair| console::note(&record.mesh, repair));
    }
    for note in
        [findings::climb(&record), findings::precision(&record), findings::overlap(&record)].into_iter().flatten()
    {
        console::note(&record.mesh, &note);
    }
    if let Some(hint) = &record.hint {
        console::hint(&record.mesh, hint);
    }
    record
}
