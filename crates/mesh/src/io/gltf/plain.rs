//! A mesh of any other origin as the least document that holds it.

use std::borrow::Cow;
use std::path::Path;

use serde_json::json;

use super::super::WriteError;
use super::super::blocks::check_finite;
use super::accessor::Component;
use super::append::{Appended, object};
use super::{GltfDocument, GltfTexcoords};
use crate::{TriMesh, UvMap};

impl GltfDocument {
    /// A document of one mesh with one primitive: the vertices in their order, rounded to 32 bits, with further ones
    /// behind them where a seam splits some.
    ///
    /// # Errors
    /// [`WriteError::NotFinite`] for numbers beyond 32 bits, [`WriteError::UvMismatch`].
    pub fn of_mesh(mesh: &TriMesh, uv: Option<&UvMap>) -> Result<Self, WriteError> {
        let json = json!({
            "asset": {"version": "2.0", "generator": concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"))},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
        });
        let mut document = Self {
            file: "output".to_owned(),
            folder: None,
            json: object(json),
            in_lines: false,
            buffers: Vec::new(),
            chunks: Vec::new(),
        };
        if mesh.face_count() == 0 {
            // No accessor may be empty.
            document.json.insert("nodes".to_owned(), json!([{}]));
            return Ok(document);
        }
        let positions: Vec<[f32; 3]> = mesh.positions().iter().map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect();
        check_finite("vertex (in 32 bits)", positions.iter().map(|p| p.iter().all(|x| x.is_finite())))?;
        let bound = |pick: fn(f32, f32) -> f32| {
            let bound = positions.iter().skip(1).fold(positions[0], |a, b| [0, 1, 2].map(|k| pick(a[k], b[k])));
            bound.map(f64::from)
        };
        let accessor = json!({
            "componentType": Component::F32.code(), "type": "VEC3", "min": bound(f32::min), "max": bound(f32::max),
        });
        let mut appended = Appended::to(&document);
        let elements = positions.iter().map(|p| Cow::Owned(p.map(f32::to_le_bytes).as_flattened().to_vec()));
        let position = appended.attribute(object(accessor), 3 * Component::F32.size(), elements);
        // Ids are made of 32 bits.
        let triangles: Vec<[u32; 3]> = mesh.faces().iter().map(|face| face.map(|v| v.index() as u32)).collect();
        let indices = appended.indices(object(json!({})), &triangles, positions.len(), Component::U16);
        appended.commit(&mut document);
        let primitive = json!({"attributes": {"POSITION": position}, "indices": indices});
        document.json.insert("meshes".to_owned(), json!([{"primitives": [primitive]}]));
        if let Some(uv) = uv {
            document.set_uvs(uv, GltfTexcoords::default())?;
        }
        Ok(document)
    }
}

/// Writes a mesh as glTF.
pub(crate) fn write_plain(path: &Path, mesh: &TriMesh, uv: Option<&UvMap>) -> Result<(), WriteError> {
    GltfDocument::of_mesh(mesh, uv)?.write(path)
}
