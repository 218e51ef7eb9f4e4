//! The UV islands of a file, laid out anew.

use crate::cli::args::PackArgs;
use crate::cli::packing::atlas_of;
use crate::cli::targets::{JsonTarget, check_distinct, check_extension, check_uv_set, is_gltf};
use crate::cli::typed::Typed;
use crate::cli::usage::usage;
use crate::record::failure::Failure;
use crate::record::{Outcome, Quality, Record, Repacked, Timings, to_json};
use crate::run::cancel::Cancel;
use crate::run::charts::stored;
use crate::run::judge::Judging;
use crate::run::load::{Loaded, unusable};
use crate::run::source::Source;
use crate::run::write::{How, write};
use crate::show::{advice, console, files, show, table};
use abf::{AtlasPages, Precision, Repack, Weld};
use abf_mesh::io::{GltfTexcoords, MeshFormat};
use clap::error::ErrorKind;
use std::path::PathBuf;
use std::time::Instant;

/// Everything the command needs to know.
#[derive(Debug)]
pub(crate) struct Settings {
    mesh: PathBuf,
    uv_set: Option<u32>,
    repack: Repack,
    output: Option<PathBuf>,
    remap: Option<PathBuf>,
    json: Option<JsonTarget>,
    typed: Typed,
}

impl Settings {
    /// Checks the arguments.
    ///
    /// # Errors
    /// A usage error that names the option.
    pub(crate) fn new(args: PackArgs, typed: Typed) -> Result<Self, clap::Error> {
        let repack = Repack { atlas: atlas_of(&args.packing)?, stack: args.stack };
        let json = JsonTarget::new(args.json);
        if let Some(path) = &args.output {
            check_extension("--output", path, &MeshFormat::extensions(MeshFormat::is_written))?;
        }
        if let Some(path) = &args.remap {
            check_extension("--remap", path, &["json"])?;
            if !(is_gltf(&args.mesh) && args.output.as_deref().is_some_and(is_gltf)) {
                let message = "--remap concerns a glTF that is read and written as one: name it, and -o FILE.glb";
                return Err(usage(ErrorKind::ArgumentConflict, message));
            }
        }
        let targets = [
            ("--output", args.output.as_deref()),
            ("--remap", args.remap.as_deref()),
            ("--json", json.as_ref().and_then(JsonTarget::file)),
        ];
        check_distinct(&targets, std::slice::from_ref(&args.mesh))?;
        check_uv_set(args.uv_set, std::slice::from_ref(&args.mesh))?;
        Ok(Self { mesh: args.mesh, uv_set: args.uv_set, repack, output: args.output, remap: args.remap, json, typed })
    }
}

/// Packs the islands of a file.
pub(crate) fn pack(settings: &Settings) -> Outcome {
    let json = settings.json.as_ref();
    let targets = [settings.output.as_deref(), settings.remap.as_deref(), json.and_then(JsonTarget::file)];
    if let Err(failure) = files::check(targets) {
        console::failure(&failure);
        return Outcome::Failed;
    }
    let cancel = Cancel::on_ctrl_c();
    let source = match settings.uv_set {
        Some(set) => Source::UvSet(settings.mesh.clone(), set),
        None => Source::File(settings.mesh.clone()),
    };
    let record = match Loaded::read(&source, None, &cancel) {
        Ok(loaded) => {
            let mut record = loaded.record();
            record.error = fill(settings, &loaded, &mut record, &cancel).err();
            settings.typed.fit(&mut record);
            record
        }
        Err(failure) => unusable(source.name(), failure),
    };
    if let Some(failure) = &record.error {
        console::failure(failure);
    }
    let records = [record];
    match show(&table::of_meshes(&records), || to_json(&records), json) {
        Ok(()) => records[0].outcome(),
        Err(failure) => {
            console::failure(&failure);
            Outcome::Failed
        }
    }
}

/// Packs and writes, and fills the record as far as it gets.
fn fill(settings: &Settings, loaded: &Loaded, record: &mut Record, cancel: &Cancel) -> Result<(), Failure> {
    let heap = loaded.watch_memory();
    let begin = Instant::now();
    let uv = loaded.uv().ok_or_else(|| Failure::no_uv(&loaded.name, loaded.uv_dropped(), "pack"))?;
    let by_material = settings.repack.atlas.pages == AtlasPages::PerMaterial;
    let materials = loaded.known_of_faces(false).materials.filter(|_| by_material);
    let to_gltf = settings.output.as_deref().is_some_and(is_gltf);
    let labels = (materials.as_deref(), loaded.objects());
    let packed = settings.repack.run_within(loaded.sized(), uv, labels, stored(to_gltf, Precision::Double));
    let packed = packed.map_err(|error| Failure::atlas(&loaded.name, &error))?;
    // Packing is one call: who asks to stop during it gets no file.
    if cancel.is_asked() {
        return Err(Failure::cancelled(&loaded.name));
    }
    let atlas = begin.elapsed().as_secs_f64();
    record.quality = Some(Quality::of_repaired(&packed.metrics, packed.turned, packed.shared));
    record.repacked = Some(Repacked::new(&packed, &settings.repack.atlas));
    if let Some(path) = &settings.output {
        let texcoords = GltfTexcoords { set: loaded.gltf().map(|gltf| gltf.uv_set), overwrite: true };
        let (page, repair) = (Some(settings.repack.atlas.page), Some(Weld::default()));
        let judging = Judging { precision: Precision::Single, page, repair };
        // Of islands upon each other each shape is judged once, and a file does not say which were laid so.
        let how = How { texcoords, judging: Some(judging).filter(|_| !settings.repack.stack) };
        let mut kept = write(path, loaded, &packed.uv, how)?;
        kept.correct(&mut record.quality);
        record.hint = advice::lost(record);
        record.written.push(path.display().to_string());
        kept.notes.iter().for_each(|note| console::note(&record.mesh, note));
        record.notes.extend(kept.notes);
        if let (Some(path), Some(remap)) = (&settings.remap, kept.remap) {
            files::replace(path, remap.as_bytes())?;
            record.written.push(path.display().to_string());
        }
    }
    let all = begin.elapsed().as_secs_f64();
    let read = loaded.read_s;
    record.timings_s = Some(Timings { read, atlas, write: all - atlas, total: read + all, ..Timings::default() });
    record.peak_memory_bytes = Some(loaded.peak_bytes(heap));
    Ok(())
}
