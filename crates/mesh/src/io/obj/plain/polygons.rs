//! Faces of more than three corners, which the fast reader takes for fans until it has all positions.

use abf_parallel::prelude::*;

use super::super::super::ReadNotes;
use super::super::super::polygon::{self, Inside};
use crate::{Point3, UvId, VertexId};

/// A face of more than three corners, cut into a fan.
#[derive(Clone, Copy)]
pub(super) struct Polygon {
    /// Its number among the faces.
    pub(super) number: usize,
    /// Its first triangle.
    pub(super) first: usize,
    /// How many it has.
    pub(super) triangles: usize,
}

/// Cuts the polygons that are no fans inside their outline, in place.
pub(super) fn cut(
    positions: &[Point3<f64>],
    polygons: &[Polygon],
    triangles: &mut [[VertexId; 3]],
    uv_corners: &mut [UvId],
    notes: &mut ReadNotes,
) -> Inside {
    let look = |p: &Polygon| {
        let fan = &triangles[p.first..p.first + p.triangles];
        let points: Vec<_> = of_fan(fan).into_iter().map(|v| positions[v.index()]).collect();
        polygon::cut(&points)
    };
    let cuts: Vec<_> = polygons.par_iter().map(look).collect();
    let mut inside = Inside::new();
    for (p, cut) in polygons.iter().zip(cuts) {
        notes.polygon(p.triangles, &cut);
        let Some(own) = cut.inside else { continue };
        let range = p.first..p.first + p.triangles;
        place(&own, &mut triangles[range.clone()]);
        if let Some(uvs) = uv_corners.as_chunks_mut().0.get_mut(range) {
            place(&own, uvs);
        }
        inside.insert(p.number, own);
    }
    inside
}

/// The corners of a polygon from its fan.
fn of_fan<T: Copy>(fan: &[[T; 3]]) -> Vec<T> {
    fan[..1].iter().flatten().copied().chain(fan[1..].iter().map(|face| face[2])).collect()
}

/// Replaces a fan by other triangles of the same polygon.
fn place<T: Copy>(own: &[[u32; 3]], fan: &mut [[T; 3]]) {
    let corners = of_fan(fan);
    fan.iter_mut().zip(own).for_each(|(face, own)| *face = own.map(|c| corners[c as usize]));
}
