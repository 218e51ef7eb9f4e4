//! A mesh made into charts and an atlas.

use crate::cli::args::SeamsFrom;
use crate::cli::charts::Charting;
use crate::cli::sheet::Sheet;
use crate::record::failure::Failure;
use crate::record::number::{count, significant};
use crate::record::{Atlas as AtlasRecord, ChartSettings, Charted, Narrow};
use crate::run::load::Loaded;
use crate::run::progress::Progress;
use abf::cut::RepairReport;
use abf::{
    AtlasPages, Developed, Laid, Metrics, Parted, Parting, Pipeline, Placement, Precision, Stored, SurfaceHints,
    Unwrap, Unwrapped, UnwrappedChart,
};
use abf_mesh::UvMap;
use abf_mesh::io::stored_uv;
use std::time::Instant;

/// Charts in an atlas, and what there is to say of them.
#[derive(Debug)]
pub(crate) struct Charts {
    /// The UVs.
    pub(crate) uv: UvMap,
    /// How good they are.
    pub(crate) metrics: Metrics,
    /// The charts side by side in units of the mesh, if they are to be drawn.
    pub(crate) sheet: Option<Developed>,
    pub(crate) record: AtlasRecord,
    /// The ends of every edge that is a seam.
    pub(crate) seams: Vec<[abf_mesh::VertexId; 2]>,
    /// How many faces repair turned around.
    pub(crate) turned: usize,
    /// How many faces share the UVs of another.
    pub(crate) shared: usize,
    /// How long it took to make them, without the packing, seconds.
    pub(crate) charts_s: f64,
}

/// Makes charts and an atlas of a mesh.
///
/// # Errors
/// Why there are none.
pub(crate) fn charts(
    charting: &Charting,
    sheet: Option<&Sheet>,
    loaded: &Loaded,
    pipeline: &Pipeline,
    progress: &mut Progress<'_>,
) -> Result<Charts, Failure> {
    let begin = Instant::now();
    let mesh = loaded.sized();
    let known = loaded.known_of_faces(charting.seams == SeamsFrom::File);
    let keeps = charting.seams != SeamsFrom::Auto;
    let hints = SurfaceHints {
        uv: loaded.uv().filter(|_| keeps),
        face_labels: known.labels.as_deref().filter(|_| keeps),
        forbidden: known.forbidden.as_deref(),
        objects: loaded.objects(),
        seams: None,
    };
    // Without materials the packing has more to say.
    let says_more = charting.atlas.pages == AtlasPages::PerMaterial;
    if keeps && !says_more && hints.uv.is_none() && hints.face_labels.is_none() {
        return Err(Failure::no_seams(&loaded.name));
    }
    // In an atlas, disks are pieces like all others.
    let cut_disks = charting.unwrap.cut_disks || charting.is_for(loaded.is_gltf());
    // A sheet has no pages.
    let max_chart_length = charting.unwrap.max_chart_length.filter(|_| !sheet.is_some_and(|sheet| sheet.is_for_uvs));
    let pipeline_of_charts = Pipeline { normalize: false, ..pipeline.clone() };
    let unwrap = Unwrap { pipeline: pipeline_of_charts, cut_disks, max_chart_length, ..charting.unwrap.clone() };
    let unwrapped = unwrap.run(mesh, &hints, progress).map_err(|e| Failure::unwrap(&loaded.name, &e, loaded.fanned))?;
    let charts_s = begin.elapsed().as_secs_f64();
    let stored = stored(charting.to_gltf, pipeline.precision);
    let failed = |error| Failure::atlas(&loaded.name, &error);
    progress.say("packing");
    let materials = known.materials.as_deref();
    let is_for_uvs = sheet.is_some_and(|sheet| sheet.is_for_uvs);
    let (unwrapped, packed) = match &charting.parting {
        _ if is_for_uvs => (unwrapped, None),
        None => {
            let packed = charting.atlas.pack(mesh, &unwrapped, materials, stored).map_err(failed)?;
            (unwrapped, Some((packed, Vec::new())))
        }
        Some(parting) => {
            let known = (materials, hints.forbidden);
            let is_in_time = || pipeline.stop.time_limit.is_none_or(|limit| begin.elapsed() < limit);
            let may_go_on: &mut dyn FnMut() -> bool = &mut || progress.may_go_on() && is_in_time();
            let how = (parting, may_go_on);
            let parted = charting.atlas.pack_parting_while(mesh, unwrapped, known, stored, how).map_err(failed)?;
            let said = parting_said(parting, &parted);
            (parted.unwrapped, Some((parted.packed, said)))
        }
    };
    let laid = sheet.map(|sheet| sheet.pattern.lay_stored(mesh, &unwrapped, stored)).transpose().map_err(failed)?;
    let drawn = laid.as_ref().filter(|_| sheet.is_some_and(|sheet| sheet.is_drawn)).map(|laid| laid.developed(mesh));
    let (uv, metrics, record) = match (packed, laid) {
        (None, Some(laid)) => {
            let coverage = covered(&laid);
            let record = record((&unwrap, charting), &unwrapped, (&laid.placements, None), coverage, progress);
            (laid.uv, laid.metrics, AtlasRecord { sheet: Some(laid.size), ..record })
        }
        (Some((packed, said)), _) => {
            let places = (packed.placements.as_slice(), Some(packed.scales.as_slice()));
            let record = record((&unwrap, charting), &unwrapped, places, packed.coverage, progress);
            let (page, margin) = (Some(charting.atlas.page), Some(charting.atlas.margin));
            let narrow = Narrow::new(&packed.narrow);
            let under_a_texel = packed.under_a_texel.len();
            let texels_per_unit = Some(packed.texels_per_unit);
            let mut repairs = record.repairs;
            repairs.extend(said);
            let record = AtlasRecord { pages: packed.pages, page, narrow, under_a_texel, repairs, ..record };
            let record = AtlasRecord { margin, texels_per_unit, ..record };
            (packed.uv, packed.metrics, record)
        }
        (None, None) => unreachable!("without a sheet, charts are packed"),
    };
    let (turned, shared) = (unwrapped.turned.len(), unwrapped.shared);
    Ok(Charts { uv, metrics, sheet: drawn, record, seams: unwrapped.seams, turned, shared, charts_s })
}

/// The part of a sheet that charts cover, with numbers that stay in range.
fn covered(laid: &Laid) -> f64 {
    let unit = laid.size[0].max(laid.size[1]);
    let part = laid.size.map(|side| side / unit).iter().product::<f64>();
    match laid.metrics.uv_area / laid.size.iter().product::<f64>() {
        covered if covered.is_finite() => covered,
        _ => laid.uv.clone().mapped(|p| p / unit).area() / part,
    }
}

/// What was cut when charts were packed, and what was aimed at and missed.
fn parting_said(parting: &Parting, parted: &Parted) -> Vec<String> {
    let cut = |cuts: usize, why: &str| (cuts > 0).then(|| format!("{} {why}", count(cuts, "chart", "charts")));
    let packed = &parted.packed;
    let in_time = if parted.is_unfinished { " in the time there was" } else { "" };
    let uncovered = parting.coverage.filter(|aim| packed.coverage < *aim).map(|aim| {
        let covered = significant(packed.coverage, 3);
        format!("{covered} of the atlas covered{in_time}, and not {aim} (--coverage)")
    });
    let narrow = packed.narrow.len();
    let unkept = (parting.keeps_inner_margin && narrow > 0).then(|| {
        let places = count(narrow, "place", "places");
        format!("{places} of charts left narrower than the margin{in_time} (--inner-margin)")
    });
    [
        cut(parted.for_coverage, "parted to cover more (--coverage)"),
        uncovered,
        cut(parted.for_margin, "parted to keep the margin inside (--inner-margin)"),
        unkept,
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// What a file makes of UVs, and what is proved of them there.
pub(crate) fn stored(to_gltf: bool, precision: Precision) -> Stored {
    if to_gltf { Stored::converted(stored_uv, Precision::Single) } else { Stored::in_precision(precision) }
}

/// What there is to say of charts on one page.
fn record(
    (unwrap, charting): (&Unwrap, &Charting),
    unwrapped: &Unwrapped,
    (placements, scales): (&[Placement], Option<&[f64]>),
    coverage: f64,
    progress: &Progress<'_>,
) -> AtlasRecord {
    let repairs: &RepairReport = &unwrapped.repairs;
    let mut said = repairs.sentences();
    if unwrapped.without_area > 0 {
        let faces = count(unwrapped.without_area, "face", "faces");
        said.push(format!("{faces} of components without any area put into one point"));
    }
    if let Some(length) = charting.unwrap.max_chart_length.filter(|_| unwrapped.parted > 0) {
        let charts = count(unwrapped.parted, "chart", "charts");
        said.push(format!("{charts} longer than {length} page widths parted (--max-chart-length)"));
    }
    said.extend(scales.map(|scales| resized(charting, unwrapped, scales)).unwrap_or_default());
    if unwrapped.shared > 0 {
        said.push(format!("{} the texels of another", count(unwrapped.shared, "face shares", "faces share")));
    }
    let charted = |(i, (chart, at)): (usize, (&UnwrappedChart, &Placement))| {
        let scale = scales.map_or(1.0, |scales| scales[i]);
        Charted::new(&unwrap.pipeline, chart, (at, scale), progress.stages_of(chart.component, chart.piece))
    };
    AtlasRecord {
        settings: ChartSettings::new(unwrap, &charting.atlas),
        charts: unwrapped.charts.iter().zip(placements).enumerate().map(charted).collect(),
        pages: 1,
        page: None,
        narrow: Narrow::new(&[]),
        under_a_texel: 0,
        margin: None,
        texels_per_unit: None,
        sheet: None,
        coverage,
        seam_edges: unwrapped.seams.len(),
        seam_length: unwrapped.seam_length,
        diagonal: unwrapped.diagonal,
        max_stretch: unwrap.max_stretch,
        is_bound: unwrap.max_seam.is_none(),
        may_overlap: charting.may_overlap,
        repairs: said,
    }
}

/// What is said of charts that are smaller or larger than the others.
fn resized(charting: &Charting, unwrapped: &Unwrapped, scales: &[f64]) -> Vec<String> {
    let mut said = Vec::new();
    let smaller = unwrapped.charts.iter().filter(|chart| chart.scale < 1.0).count();
    if let Some(length) = charting.unwrap.max_chart_length.filter(|_| smaller > 0) {
        let charts = count(smaller, "chart", "charts");
        said.push(format!(
            "{charts} with faces longer than {length} page widths made smaller than the others (--max-chart-length)"
        ));
    }
    let larger = unwrapped.charts.iter().zip(scales).filter(|(chart, scale)| **scale > chart.scale).count();
    if larger > 0 {
        let charts = count(larger, "chart", "charts");
        said.push(format!("{charts} of triangles too small for the precision of the file made larger than the others"));
    }
    said
}
