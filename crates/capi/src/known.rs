//! What a caller knows of a mesh besides its vertices and triangles.

use crate::options::Settings;
use crate::status::{AbfStatus, Failure};
use abf::mesh::{Point2, UvId, UvMap};
use abf::{AtlasPages, SeamRule, SurfaceHints};

/// The caller's arrays.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Known<'a> {
    /// Edges that are seams, by their vertices.
    pub(crate) seams: Option<&'a [[u32; 2]]>,
    /// UVs.
    pub(crate) uv: Option<&'a [[f32; 2]]>,
    /// For every index of the mesh that of its UV.
    pub(crate) uv_indices: Option<&'a [u32]>,
    /// A number for every triangle.
    pub(crate) materials: Option<&'a [u32]>,
    /// The same.
    pub(crate) objects: Option<&'a [u32]>,
    /// The same.
    pub(crate) polygons: Option<&'a [u32]>,
}

/// What the library is told of it, corner by corner.
#[derive(Debug, Default)]
pub(crate) struct Read {
    uv: Option<UvMap>,
    seams: Option<Vec<bool>>,
    forbidden: Option<Vec<bool>>,
}

impl Known<'_> {
    /// Checks that it goes with the settings.
    pub(crate) fn check(&self, settings: &Settings) -> Result<(), Failure> {
        let wrong = |text: &str| Err(Failure::new(AbfStatus::Setting, text));
        if self.uv.is_none() && self.uv_indices.is_some() {
            return wrong("uv_indices are those of uv, which is not given");
        }
        let is_blank = self.seams.is_none() && self.uv.is_none() && self.materials.is_none();
        let unwrapper = &settings.unwrapper;
        // Without materials, pages per material have more to say.
        let says_more = unwrapper.atlas.pages == AtlasPages::PerMaterial;
        if unwrapper.unwrap.seams == SeamRule::Keep && is_blank && !says_more {
            return wrong("seams 'keep' keeps those of seam_vertices, uv and materials, and none of them is given");
        }
        Ok(())
    }

    /// Reads it for a mesh, whose indices need not be in range.
    pub(crate) fn read(&self, vertices: usize, indices: &[u32]) -> Result<Read, Failure> {
        let triangles = indices.as_chunks::<3>().0;
        if let Some(seams) = self.seams {
            check_range(seams.as_flattened(), vertices, "seam_vertices", "vertices")?;
        }
        Ok(Read {
            uv: self.uv.map(|uv| map(uv, self.uv_indices, vertices, indices)).transpose()?,
            seams: self.seams.map(|seams| SurfaceHints::corners_facing(triangles, seams)),
            forbidden: self.polygons.map(|polygons| SurfaceHints::corners_inside(triangles, polygons)),
        })
    }
}

impl Read {
    /// All that is known.
    pub(crate) fn hints<'a>(&'a self, known: &Known<'a>) -> SurfaceHints<'a> {
        SurfaceHints {
            uv: self.uv.as_ref(),
            face_labels: known.materials,
            objects: known.objects,
            forbidden: self.forbidden.as_deref(),
            seams: self.seams.as_deref(),
        }
    }
}

fn map(uv: &[[f32; 2]], corners: Option<&[u32]>, vertices: usize, indices: &[u32]) -> Result<UvMap, Failure> {
    if corners.is_none() && uv.len() != vertices {
        let text = format!(
            "uv_count must be the number of vertices, {vertices}, got {}; give uv_indices where UVs are per corner",
            uv.len()
        );
        return Err(Failure::new(AbfStatus::Setting, text));
    }
    match corners {
        Some(corners) => check_range(corners, uv.len(), "uv_indices", "UVs")?,
        None => check_range(indices, vertices, "indices", "vertices")?,
    }
    if let Some(at) = uv.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
        return Err(Failure::new(AbfStatus::NotFinite, format!("uv {at} has a coordinate that is not finite")));
    }
    let points = uv.iter().map(|&[u, v]| Point2::new(f64::from(u), f64::from(v))).collect();
    let corners = corners.unwrap_or(indices).iter().map(|&i| UvId::new(i as usize)).collect();
    Ok(UvMap::new(points, corners))
}

pub(crate) fn check_range(indices: &[u32], count: usize, name: &str, what: &str) -> Result<(), Failure> {
    match indices.iter().position(|&i| i as usize >= count) {
        None => Ok(()),
        Some(at) => {
            let text = format!("{name} {at} has the index {}, and there are {count} {what}", indices[at]);
            Err(Failure::new(AbfStatus::IndexRange, text))
        }
    }
}
