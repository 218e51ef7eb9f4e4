//! A mesh with its UVs, to a file.

use crate::cli::targets::is_gltf;
use crate::record::Quality;
use crate::record::failure::Failure;
use crate::record::number::count;
use crate::run::judge::Judging;
use crate::run::load::Loaded;
use abf::Precision;
use abf_mesh::io::{GltfDocument, GltfTexcoords, MeshFormat, WriteError};
use abf_mesh::{Point3, TriMesh, UvMap, io};
use std::path::Path;

/// How to write.
#[derive(Clone, Copy, Debug)]
pub(crate) struct How {
    /// Where the UVs of a glTF go.
    pub(crate) texcoords: GltfTexcoords,
    /// How the file is judged, if what is known of its UVs is to be judged by it.
    pub(crate) judging: Option<Judging>,
}

/// What else is known of a mesh that was written.
#[derive(Default)]
pub(crate) struct Kept {
    /// Where the vertices of a glTF come from, as JSON.
    pub(crate) remap: Option<String>,
    /// What there is to say.
    pub(crate) notes: Vec<String>,
    /// The figures of the UVs as a reader finds them, where the file does not hold the numbers of the mesh.
    pub(crate) quality: Option<Quality>,
    /// How many triangles have no area there, or two corners in one place, and had before.
    pub(crate) lost: usize,
}

impl Kept {
    fn saying(notes: Vec<String>) -> Self {
        Self { notes, ..Self::default() }
    }

    /// The figures of the file, in the place of those before it was written.
    pub(crate) fn correct(&mut self, quality: &mut Option<Quality>) {
        if let Some(read) = self.quality.take() {
            *quality = Some(read);
        }
        quality.iter_mut().for_each(|quality| quality.lost = self.lost);
    }
}

/// Writes the mesh; a glTF or an OBJ stays what it was but for its UVs, if it goes to its own format.
///
/// # Errors
/// Why it cannot be written.
pub(crate) fn write(path: &Path, loaded: &Loaded, uv: &UvMap, how: How) -> Result<Kept, Failure> {
    let failed = |error| Failure::write(path, &error);
    match (MeshFormat::from_path(path), loaded.gltf()) {
        (Some(format), Some(gltf)) if format.is_gltf() => {
            let mut document = gltf.document.clone();
            let remap = document.set_uvs(uv, how.texcoords).map_err(failed)?;
            document.write(path).map_err(failed)?;
            let added = count(remap.vertices_added, "vertex", "vertices");
            let notes = vec![format!("the UVs are TEXCOORD_{}; {added} added at seams", remap.set)];
            return Ok(Kept { remap: Some(remap.to_json()), ..Kept::saying(notes) });
        }
        (Some(MeshFormat::Obj), _) => {
            if let Some(document) = loaded.obj() {
                let written = document.write(path, uv).map_err(failed)?;
                let split = count(written.polygons_split, "polygon", "polygons");
                let notes = vec![format!("{split} written as triangles, because seams cross them")];
                return Ok(Kept::saying(notes.into_iter().filter(|_| written.polygons_split > 0).collect()));
            }
        }
        _ => {}
    }
    let mut kept = if is_gltf(path) {
        to_gltf(path, loaded.mesh(), uv, how.judging).map_err(failed)?
    } else {
        io::write_coloured(path, loaded.mesh(), Some(uv), loaded.colours()).map_err(failed)?;
        Kept::default()
    };
    if loaded.colours().is_some() && MeshFormat::from_path(path) != Some(MeshFormat::Ply) {
        kept.notes.push("the colours of the vertices are not written: a ply keeps them".to_owned());
    }
    if loaded.holds_more() {
        kept.notes.push(
            "only vertices, faces and UVs are written to another format: materials, normals and the like are not"
                .to_owned(),
        );
    }
    Ok(kept)
}

/// Writes a mesh that was no glTF as one, in numbers of 32 bits.
fn to_gltf(path: &Path, mesh: &TriMesh, uv: &UvMap, judging: Option<Judging>) -> Result<Kept, WriteError> {
    let document = GltfDocument::of_mesh(mesh, Some(uv))?;
    document.write(path)?;
    let is_held = mesh.positions().iter().all(|p| single(p) == *p);
    let mut kept = Kept { lost: lost_faces(mesh), ..Kept::default() };
    if let (Some(judging), false) = (judging, is_held) {
        let surface = document.surface()?;
        let objects = surface.mesh_of_faces();
        let judging = Judging { precision: Precision::Single, ..judging };
        // Where no triangle is left there is nothing to judge, and all of them are lost.
        let judged = surface.uv.map(|uv| judging.judged(&surface.mesh, Some(&objects), &uv));
        match judged.transpose() {
            Ok(quality) => kept.quality = quality,
            Err(error) => kept.notes.push(format!("the file could not be judged as it was written: {error}")),
        }
    }
    Ok(kept)
}

/// A point in numbers of 32 bits.
fn single(p: &Point3<f64>) -> Point3<f64> {
    p.map(|x| f64::from(x as f32))
}

/// Faces of which two corners are in one place when their coordinates have 32 bits, and not before; or that have no area then.
fn lost_faces(mesh: &TriMesh) -> usize {
    const SIDES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];
    let has_area = |[a, b, c]: &[Point3<f64>; 3]| (b - a).cross(&(c - a)).norm() > 0.0;
    let is_lost = |corners: &[Point3<f64>; 3]| {
        let rounded = corners.each_ref().map(single);
        let merged = SIDES.iter().any(|&(i, k)| rounded[i] == rounded[k] && corners[i] != corners[k]);
        merged || (has_area(corners) && !has_area(&rounded))
    };
    mesh.triangles().filter(is_lost).count()
}
