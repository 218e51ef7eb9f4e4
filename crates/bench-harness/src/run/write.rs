//! A mesh with its UVs, to a file.

use crate::cli::targets::is_gltf;
use crate::record::failure::Failure;
use crate::record::number::count;
use crate::run::load::Loaded;
use abf_mesh::io::{GltfTexcoords, MeshFormat};
use abf_mesh::{Point3, TriMesh, UvMap, io};
use std::path::Path;

/// What else is known of a mesh that was written.
#[derive(Default)]
pub(crate) struct Kept {
    /// Where the vertices of a glTF come from, as JSON.
    pub(crate) remap: Option<String>,
    /// What there is to say.
    pub(crate) notes: Vec<String>,
}

/// Writes the mesh; a glTF or an OBJ stays what it was but for its UVs, if it goes to its own format.
///
/// # Errors
/// Why it cannot be written.
pub(crate) fn write(path: &Path, loaded: &Loaded, uv: &UvMap, overwrite: bool) -> Result<Kept, Failure> {
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
    let to_gltf = is_gltf(path);
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
