//! What a flattening writes.

use super::seam_lines::seam_lines;
use super::settings::Settings;
use crate::record::Record;
use crate::record::failure::Failure;
use crate::run::cancel::Cancel;
use crate::run::judge::Judging;
use crate::run::load::Loaded;
use crate::run::write::{How, write};
use crate::show::errors::{self, ErrorFormat};
use crate::show::{advice, console, files};
use abf::metrics::per_face;
use abf::{Atlas, Developed, Precision};
use abf_mesh::io::GltfTexcoords;
use abf_mesh::{TriMesh, UvMap, VertexId};
use abf_report::dxf::{DxfStyle, layout_dxf};
use abf_report::svg::{SvgStyle, layout_svg};
use abf_report::{PictureError, PictureStyle, error_svg, picture_unless};
use std::path::Path;
use std::time::Instant;

/// What a flattening came to.
pub(super) struct Made<'a> {
    /// The UVs.
    pub(super) uv: &'a UvMap,
    /// The edges it was cut along.
    pub(super) seams: &'a [[VertexId; 2]],
    /// Its charts side by side, if they are to be drawn.
    pub(super) sheet: Option<&'a Developed>,
}

/// Writes the mesh and the pictures. One file that cannot be written does not keep the others from
/// being tried; the last failure is returned, those before it are shown.
pub(super) fn write_files(
    settings: &Settings,
    loaded: &Loaded,
    &Made { uv, seams, sheet }: &Made<'_>,
    cancel: &Cancel,
    record: &mut Record,
) -> Result<(), Failure> {
    let (mesh, charting) = (loaded.mesh(), &settings.charting);
    let begin = Instant::now();
    let mut remap = None;
    let page = record.atlas.as_ref().and_then(|atlas| atlas.page);
    let judging = Judging { precision: Precision::Single, page, repair: Some(charting.unwrap.weld) };
    let texcoords = GltfTexcoords { set: None, overwrite: charting.overwrite };
    let written = settings.output.as_deref().map(|path| {
        let written = write(path, loaded, uv, How { texcoords, judging: Some(judging) });
        (
            path,
            written.map(|mut kept| {
                kept.correct(&mut record.quality);
                if record.atlas.is_some() {
                    record.hint = advice::next_for_charts(record);
                }
                remap = kept.remap;
                kept.notes.iter().for_each(|note| console::note(&record.mesh, note));
                record.notes.extend(kept.notes);
            }),
        )
    });
    if let (Some(timings), Some(_)) = (&mut record.timings_s, &written) {
        timings.write = begin.elapsed().as_secs_f64();
        timings.total += timings.write;
    }
    let pages = record.atlas.as_ref().map_or(1, |atlas| atlas.pages);
    let one_page = |path: &Path| if pages == 1 { Ok(()) } else { Err(Failure::several_pages(path, pages)) };
    let placed = loaded.placed();
    let png = settings.png.as_deref().map(|path| (path, one_page(path).and_then(|()| draw(path, placed, uv, cancel))));
    let errors = settings.errors.as_deref().map(|path| (path, write_errors(path, loaded, uv, page)));
    let (folds, mm_per_uv) =
        settings.sheet.as_ref().map_or((None, 1.0), |sheet| (sheet.folds, sheet.mm_per_unit(loaded.is_gltf())));
    let svg = settings.svg.as_deref().zip(sheet).map(|(path, sheet)| {
        let style = SvgStyle { mm_per_uv, folds, scale_bar: true, ..SvgStyle::default() };
        (path, replace(path, layout_svg(&sheet.mesh, &sheet.uv, Some(&sheet.charts), &style)))
    });
    let dxf = settings.dxf.as_deref().zip(sheet).map(|(path, sheet)| {
        let style = DxfStyle { mm_per_uv, folds, ..DxfStyle::default() };
        (path, replace(path, layout_dxf(&sheet.mesh, &sheet.uv, Some(&sheet.charts), &style)))
    });
    let lines = charting.seam_lines.as_deref();
    let lines = lines.map(|path| (path, files::replace(path, seam_lines(mesh, seams).as_bytes())));
    let remap = charting.remap.as_deref().zip(remap);
    let remap = remap.map(|(path, json)| (path, files::replace(path, json.as_bytes())));
    let mut end = Ok(());
    for (path, result) in [written, png, errors, svg, dxf, lines, remap].into_iter().flatten() {
        match (result, &end) {
            (Ok(()), _) => record.written.push(path.display().to_string()),
            (Err(failure), Ok(())) => end = Err(failure),
            (Err(failure), Err(_)) => console::failure(&failure),
        }
    }
    end
}

fn draw(path: &Path, mesh: &TriMesh, uv: &UvMap, cancel: &Cancel) -> Result<(), Failure> {
    let failed = |error| match error {
        PictureError::Cancelled(_) => Failure::picture_cancelled(path),
        error => Failure::picture(path, &error),
    };
    let png = picture_unless(mesh, uv, &PictureStyle::default(), &mut cancel.since_now()).map_err(failed)?;
    files::replace(path, &png)
}

/// Errors are measured on the surface as large as in its scene, and in texels where a page is no square.
fn write_errors(path: &Path, loaded: &Loaded, uv: &UvMap, page: Option<[u32; 2]>) -> Result<(), Failure> {
    let uv = Atlas::in_proportions(uv, page.unwrap_or([1; 2]));
    let faces = || per_face(loaded.sized(), &uv).map_err(|error| Failure::metrics(&loaded.name, &error));
    match path.extension().and_then(|ending| ending.to_str()).and_then(ErrorFormat::of) {
        Some(ErrorFormat::Svg) => replace(path, error_svg(loaded.sized(), &uv)),
        Some(ErrorFormat::Ply) => files::replace(path, &errors::to_ply(loaded.placed(), &faces()?)),
        Some(ErrorFormat::Csv) | None => files::replace(path, errors::to_csv(loaded.placed(), &faces()?).as_bytes()),
    }
}

fn replace(path: &Path, drawing: Result<String, PictureError>) -> Result<(), Failure> {
    let drawing = drawing.map_err(|error| Failure::picture(path, &error))?;
    files::replace(path, drawing.as_bytes())
}
