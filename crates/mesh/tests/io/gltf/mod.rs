//! glTF documents: what is read of them, and that nothing is lost when UVs are added.

mod broken;
mod builder;
mod files;
mod kept;
mod kinds;
mod scene;

pub(crate) use kinds::kinds;

use abf_mesh::io::{GltfDocument, GltfSurface};
use abf_mesh::{Point2, UvId, UvMap};

/// A document that must be readable and needs no files.
pub(crate) fn document(bytes: &[u8]) -> GltfDocument {
    let mut no_files = |_: &str, _: usize| Err(std::io::ErrorKind::NotFound.into());
    GltfDocument::parse("test", bytes, &mut no_files).unwrap_or_else(|e| panic!("{e}"))
}

/// A layout of a surface: the last faces of every primitive are a chart of their own, if there is to be a seam.
pub(crate) fn layout(surface: &GltfSurface, seam: bool) -> UvMap {
    let mut points = Vec::new();
    for faces in &surface.faces {
        let border = faces.start + faces.len() * 2 / 3;
        for face in faces.clone() {
            let beyond = seam && face >= border;
            for p in surface.mesh.triangle(abf_mesh::FaceId::new(face)) {
                points.push(Point2::new(0.3 * p.x + if beyond { 0.5 } else { 0.0 }, 0.1 + 0.3 * p.y + 0.1 * p.z));
            }
        }
    }
    let corners = (0..points.len()).map(UvId::new).collect();
    UvMap::new(points, corners)
}
