//! What a flattening writes.

use super::seam_lines::seam_lines;
use super::settings::Settings;
use crate::record::Record;
use crate::record::failure::Failure;
use crate::record::number::count;
use crate::run::cancel::Cancel;
use crate::run::load::Loaded;
use crate::show::{console, files};
use abf_mesh::io::{GltfTexcoords, MeshFormat};
use abf_mesh::{Point3, TriMesh, UvMap, VertexId, io};
use abf_report::svg::{SvgStyle, layout_svg};
use abf_report::{PictureError, PictureStyle, picture_unless};
use std::path::Path;
use std::time::Instant;

/// Writes the mesh and the pictures. One file that cannot be written does not keep the others from
/// being tried; the last failure is returned, those before it are shown.
pub(super) fn write_files(
    settings: &Settings,
    loaded: &Loaded,
    uv: &UvMap,
    seams: &[[VertexId; 2]],
    cancel: &Cancel,
    record: &mut Record,
) -> Result<(), Failure> {
    let (mesh, charting) = (loaded.mesh(), &settings.charting);
    let begin = Instant::now();
    let mut remap = None;
    let written = settings.output.as_deref().map(|path| {
        let written = write(path, loaded, uv, charting.overwrite);
        (
            path,
            written.map(|kept| {
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
    let png = settings.png.as_deref().map(|path| (path, one_page(path).and_then(|()| draw(path, mesh, uv, cancel))));
    let svg = settings.svg.as_deref().map(|path| (path, one_page(path).and_then(|()| draw_layout(path, mesh, uv))));
    let lines = charting.seam_lines.as_deref();
    let lines = lines.map(|path| (path, files::replace(path, seam_lines(mesh, seams).as_bytes())));
    let remap = charting.remap.as_deref().zip(remap);
    let remap = remap.map(|(path, json)| (path, files::replace(path, json.as_bytes())));
    let mut end = Ok(());
    for (path, result) in [written, png, svg, lines, remap].into_iter().flatten() {
        match (result, &end) {
            (Ok(()), _) => record.written.push(path.display().to_string()),
            (Err(failure), Ok(())) => end = Err(failure),
            (Err(failure), Err(_)) => console::failure(&failure),
        }
    }
    end
}

/// What else is known of a mesh that was written.
#[derive(Default)]
struct Kept {
    /// Where the vertices of a glTF come from, as JSON.
    remap: Option<String>,
    /// What there is to say.
    notes: Vec<String>,
}

/// Writes the mesh; a glTF or an OBJ stays what it was but for its UVs, if it goes to its own format.
fn write(path: &Path, loaded: &Loaded, uv: &UvMap, overwrite: bool) -> Result<Kept, Failure> {
    let failed = |error| Failure::write(path, &error);
    match (MeshFormat::from_path(path), loaded.gltf()) {
        (Some(format), Some(gltf)) if format.is_gltf() => {
            let mut document = gltf.document.clone();
            let remap = document.set_uvs(uv, GltfTexcoords { set: None, overwrite }).map_err(failed)?;
            document.write(path).map_err(failed)?;
            let added = count(remap.vertices_added, "vertex", "vertices");
            let notes = vec![format!("the UVs are TEXCOORD_{}; {added} added at seams", remap.set)];
            return Ok(Kept { remap: Some(remap.to_json()), notes });
        }
        (Some(MeshFormat::Obj), _) => {
            if let Some(document) = loaded.obj() {
                let written = document.write(path, uv).map_err(failed)?;
                let split = count(written.polygons_split, "polygon", "polygons");
                let notes = vec![format!("{split} written as triangles, because seams cross them")];
                return Ok(Kept {
                    notes: notes.into_iter().filter(|_| written.polygons_split > 0).collect(),
                    remap: None,
                });
            }
        }
        _ => {}
    }
    io::write_coloured(path, loaded.mesh(), Some(uv), loaded.colours()).map_err(failed)?;
    let mut notes = Vec::new();
    if loaded.colours().is_some() && MeshFormat::from_path(path) != Some(MeshFormat::Ply) {
        notes.push("the colours of the vertices are not written: a ply keeps them".to_owned());
    }
    if loaded.holds_more() {
        notes.push(
            "only vertices, faces and UVs are written to another format: materials, normals and the like are not"
                .to_owned(),
        );
    }
    let to_gltf = MeshFormat::from_path(path).is_some_and(MeshFormat::is_gltf);
    let merged = if to_gltf { merged_faces(loaded.mesh()) } else { 0 };
    if merged > 0 {
        let faces = count(merged, "face has", "faces have");
        let way_out = "move the mesh to the origin, or write an obj or ply";
        notes.push(format!("{faces} corners in one place in the 32-bit numbers of glTF: {way_out}"));
    }
    Ok(Kept { remap: None, notes })
}

/// Faces of which two corners are in one place when their coordinates have 32 bits, and not before.
fn merged_faces(mesh: &TriMesh) -> usize {
    let pairs = [(0, 1), (1, 2), (2, 0)];
    let merged = |corners: [Point3<f64>; 3]| {
        let single = corners.map(|p| p.map(|x| x as f32));
        pairs.iter().any(|&(i, k)| single[i] == single[k] && corners[i] != corners[k])
    };
    mesh.triangles().filter(|&corners| merged(corners)).count()
}

fn draw(path: &Path, mesh: &TriMesh, uv: &UvMap, cancel: &Cancel) -> Result<(), Failure> {
    let failed = |error| match error {
        PictureError::Cancelled(_) => Failure::picture_cancelled(path),
        error => Failure::picture(path, &error),
    };
    let png = picture_unless(mesh, uv, &PictureStyle::default(), &mut cancel.since_now()).map_err(failed)?;
    files::replace(path, &png)
}

fn draw_layout(path: &Path, mesh: &TriMesh, uv: &UvMap) -> Result<(), Failure> {
    let svg = layout_svg(mesh, uv, &SvgStyle::default()).map_err(|error| Failure::picture(path, &error))?;
    files::replace(path, svg.as_bytes())
}
