//! The command that flattens: one mesh or several, with one solver or several.

use crate::cancel::Cancel;
use crate::errors::Failure;
use crate::history::{self, History};
use crate::load::{Loaded, unusable};
use crate::record::{Outcome, Record, to_json};
use crate::run::{self, Flattened};
use crate::settings::{JsonTarget, Settings};
use crate::show::show;
use crate::source::Source;
use crate::{console, files, table};
use abf_mesh::{TriMesh, UvMap, io};
use abf_report::svg::{SvgStyle, layout_svg};
use abf_report::{PictureStyle, picture};
use std::path::Path;
use std::time::Instant;

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
            (shown, console::data(&history::to_json(&runs)))
        }
        Some(JsonTarget::File(path)) => {
            let shown = show(&table, || to_json(&records), settings.json.as_ref());
            (shown, files::replace(path, history::to_json(&runs).as_bytes()))
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
        Err(failure) => {
            console::failure(&failure);
            return vec![unusable(source.name(), failure)];
        }
    };
    let mut records = Vec::new();
    for method in &settings.methods {
        let Flattened { record, history, mesh_is_unusable, .. } =
            run::flatten(&loaded, method, settings.history.is_some(), cancel);
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
    let record = match Loaded::read(source, settings.max_memory(), cancel) {
        Ok(loaded) => {
            let method = &settings.methods[0];
            let Flattened { mut record, uv, history, .. } =
                run::flatten(&loaded, method, settings.history.is_some(), cancel);
            if let Some(uv) = uv.filter(|_| record.error.is_none()) {
                record.error = write_files(settings, &loaded.mesh, &uv, &mut record).err();
            }
            runs.extend(history);
            record
        }
        Err(failure) => unusable(source.name(), failure),
    };
    if let Some(failure) = &record.error {
        console::failure(failure);
    }
    for note in [&record.climb, &record.precision, &record.overlap].into_iter().flatten() {
        console::note(&record.mesh, note);
    }
    if let Some(hint) = &record.hint {
        console::hint(&record.mesh, hint);
    }
    record
}

/// Writes the mesh and the pictures. One file that cannot be written does not keep the others from
/// being tried; the last failure is returned, those before it are shown.
fn write_files(settings: &Settings, mesh: &TriMesh, uv: &UvMap, record: &mut Record) -> Result<(), Failure> {
    let begin = Instant::now();
    let written = settings.output.as_deref().map(|path| (path, write(path, mesh, uv)));
    if let (Some(timings), Some(_)) = (&mut record.timings_s, &written) {
        timings.write = begin.elapsed().as_secs_f64();
        timings.total += timings.write;
    }
    let png = settings.png.as_deref().map(|path| (path, draw(path, mesh, uv)));
    let svg = settings.svg.as_deref().map(|path| (path, draw_layout(path, mesh, uv)));
    let mut end = Ok(());
    for (path, result) in [written, png, svg].into_iter().flatten() {
        match (result, &end) {
            (Ok(()), _) => record.written.push(path.display().to_string()),
            (Err(failure), Ok(())) => end = Err(failure),
            (Err(failure), Err(_)) => console::failure(&failure),
        }
    }
    end
}

fn write(path: &Path, mesh: &TriMesh, uv: &UvMap) -> Result<(), Failure> {
    io::write(path, mesh, Some(uv)).map_err(|error| Failure::write(path, &error))
}

fn draw(path: &Path, mesh: &TriMesh, uv: &UvMap) -> Result<(), Failure> {
    let png = picture(mesh, uv, &PictureStyle::default()).map_err(|error| Failure::picture(path, &error))?;
    files::replace(path, &png)
}

fn draw_layout(path: &Path, mesh: &TriMesh, uv: &UvMap) -> Result<(), Failure> {
    let svg = layout_svg(mesh, uv, &SvgStyle::default()).map_err(|error| Failure::picture(path, &error))?;
    files::replace(path, svg.as_bytes())
}
