//! What is proved of packed charts, and how distorted they are.

use abf_cut::{DoubleSided, RepairError, Repaired, Weld, first_at_place, repair_with, weld_within};
use abf_mesh::{FaceId, Point2, TriMesh, UvMap, VertexId};
use abf_metrics::{Certificate, Metrics, MetricsError, Precision, certify_stored, measure_certified};
use std::borrow::Cow;
use std::collections::HashSet;

/// What was proved of a chart before it was packed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proved {
    pub(crate) is_valid: bool,
    pub(crate) is_injective: bool,
}

impl Proved {
    pub(crate) fn of(certificate: &Certificate) -> Self {
        Self { is_valid: certificate.valid(), is_injective: certificate.injective() }
    }
}

/// Judges faces of a mesh with its map: exactly, as stored.
pub(crate) struct Judge<'a> {
    parts: Parts<'a>,
    precision: Precision,
}

impl<'a> Judge<'a> {
    /// Faces in `turned` are judged the other way around: as repair turned them.
    pub(crate) fn new(mesh: &'a TriMesh, turned: &[FaceId], uv: &'a UvMap, precision: Precision) -> Self {
        Self { parts: Parts::new(mesh, turned, uv), precision }
    }

    /// What is proved of the faces of each page, together.
    pub(crate) fn certificate(&self, pages: &[Vec<FaceId>]) -> Result<Certificate, MetricsError> {
        let mut whole: Option<Certificate> = None;
        for faces in pages.iter().filter(|faces| !faces.is_empty()).map(|faces| sorted(faces)) {
            let (part, map, vertices) = self.parts.of(&faces);
            let found = in_input(certify_stored(&part, &map, self.precision)?, &faces, &vertices);
            whole = Some(match whole {
                None => found,
                Some(before) => together(before, found),
            });
        }
        whole.ok_or(MetricsError::NoFaces)
    }

    /// What is proved of some faces alone.
    pub(super) fn certificate_of(&self, faces: &[FaceId]) -> Result<Certificate, MetricsError> {
        let (part, map, _) = self.parts.of(faces);
        certify_stored(&part, &map, self.precision)
    }

    /// The charts that were valid or injective, and are so no longer as they are stored. Each has its faces and what it was
    /// before; `whole` is what is proved of all.
    pub(crate) fn spoilt<'c>(
        &self,
        charts: impl Iterator<Item = (&'c [FaceId], Proved)>,
        whole: &Certificate,
    ) -> Result<Vec<usize>, MetricsError> {
        let mut spoilt = Vec::new();
        for (i, (faces, before)) in charts.enumerate().filter(|_| !whole.injective()) {
            let stored = self.certificate_of(faces)?;
            if (before.is_valid && !stored.valid()) || (before.is_injective && !stored.injective()) {
                spoilt.push(i);
            }
        }
        Ok(spoilt)
    }

    /// The distortion of some faces in the proportions of a page of `sides` texels, with what is proved of them.
    pub(crate) fn metrics(
        &self,
        faces: &[FaceId],
        certificate: Certificate,
        sides: [u32; 2],
    ) -> Result<Metrics, MetricsError> {
        let (part, map, _) = self.parts.of(&sorted(faces));
        let [width, height] = sides.map(|side| f64::from(side) / f64::from(sides[0].max(sides[1])));
        measure_certified(&part, &map.mapped(|p| Point2::new(p.x * width, p.y * height)), certificate)
    }
}

/// A mesh with vertices in one place joined, and what repair makes of that: as [`Unwrap`](crate::Unwrap) begins. Faces on
/// others are kept.
pub(crate) fn as_repaired<'m>(
    mesh: &'m TriMesh,
    rule: Weld,
    objects: Option<&[u32]>,
) -> Result<(Cow<'m, TriMesh>, Repaired), RepairError> {
    let joined = as_joined(mesh, rule, objects);
    let repaired = repair_with(&joined, DoubleSided::Own)?;
    Ok((joined, repaired))
}

/// A mesh with vertices in one place joined, in the range of numbers that can be worked with.
pub(crate) fn as_joined<'m>(mesh: &'m TriMesh, rule: Weld, objects: Option<&[u32]>) -> Cow<'m, TriMesh> {
    let (working, scale) = match mesh.in_range() {
        Some((scaled, scale)) => (Cow::Owned(scaled), scale),
        None => (Cow::Borrowed(mesh), 1.0),
    };
    match weld_within(&working, rule.scaled(scale), objects) {
        Some(welded) => Cow::Owned(welded.mesh),
        None => working,
    }
}

/// For every face of the mesh whether an earlier one has its place and its UVs.
pub(crate) fn sharing(joined: &TriMesh, uv: &UvMap) -> Vec<bool> {
    let first_at = first_at_place(joined);
    let at_places = |vertices: &[VertexId; 3]| vertices.map(|v| first_at[v.index()]);
    let mut order: Vec<([VertexId; 3], FaceId)> = Vec::with_capacity(joined.face_count());
    for (f, vertices) in joined.faces().iter().enumerate() {
        let mut key = at_places(vertices);
        key.sort_unstable();
        // One that uses a place twice is nobody's double.
        if key[0] != key[1] && key[1] != key[2] {
            order.push((key, FaceId::new(f)));
        }
    }
    order.sort_unstable();
    let mut is_shared = vec![false; joined.face_count()];
    let place = |p: Point2<f64>| [p.x, p.y].map(|x| (x + 0.0).to_bits());
    for same in order.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
        let mut known = HashSet::new();
        for &(_, face) in same {
            let at = at_places(&joined.faces()[face.index()]);
            let mut key = face.corners().map(|c| (at[c.place()], place(uv.corner(c))));
            key.sort_unstable();
            is_shared[face.index()] = !known.insert(key);
        }
    }
    is_shared
}

fn sorted(faces: &[FaceId]) -> Vec<FaceId> {
    let mut faces = faces.to_vec();
    faces.sort_unstable();
    faces
}

/// Takes parts of a mesh and its map, with their own vertices and points only.
pub(crate) struct Parts<'a> {
    mesh: &'a TriMesh,
    uv: &'a UvMap,
    is_turned: Vec<bool>,
}

impl<'a> Parts<'a> {
    /// With the faces that repair turned around.
    pub(crate) fn new(mesh: &'a TriMesh, turned: &[FaceId], uv: &'a UvMap) -> Self {
        let mut is_turned = vec![false; mesh.face_count()];
        turned.iter().for_each(|f| is_turned[f.index()] = true);
        Self { mesh, uv, is_turned }
    }

    /// Some faces, those that repair turned around as it turned them, with the vertices of the mesh for theirs.
    pub(crate) fn of(&self, faces: &[FaceId]) -> (TriMesh, UvMap, Vec<VertexId>) {
        let in_order = |face: &FaceId| {
            let [a, b, c] = face.corners();
            if self.is_turned[face.index()] { [a, c, b] } else { [a, b, c] }
        };
        let part = self.mesh.submesh(faces.iter().map(in_order));
        (part.mesh, self.uv.submap(faces.iter().map(in_order)), part.vertices)
    }
}

/// A certificate of some faces in the numbers of all.
pub(crate) fn in_input(mut certificate: Certificate, faces: &[FaceId], vertices: &[VertexId]) -> Certificate {
    let input = |f: &mut FaceId| *f = faces[f.index()];
    certificate.flipped_faces.iter_mut().for_each(input);
    certificate.collapsed_faces.iter_mut().for_each(input);
    certificate.near_collapsed_faces.iter_mut().for_each(input);
    certificate.overlapping_faces.iter_mut().flatten().for_each(input);
    certificate.wound_vertices.iter_mut().for_each(|v| *v = vertices[v.index()]);
    certificate
}

/// One certificate of two pages.
fn together(mut one: Certificate, other: Certificate) -> Certificate {
    fn append<T>(list: &mut Vec<T>, more: Vec<T>) {
        list.extend(more);
        list.truncate(Certificate::LISTED);
    }
    one.charts += other.charts;
    one.flips += other.flips;
    one.collapsed += other.collapsed;
    one.near_collapsed += other.near_collapsed;
    one.wound += other.wound;
    one.crossings += other.crossings;
    one.meetings += other.meetings;
    one.nested += other.nested;
    one.overlaps_are_least |= other.overlaps_are_least;
    one.touches += other.touches;
    one.touch_depth = one.touch_depth.max(other.touch_depth);
    one.uv_angle_min = one.uv_angle_min.min(other.uv_angle_min);
    one.uv_angle_max = one.uv_angle_max.max(other.uv_angle_max);
    one.spread = one.spread.max(other.spread);
    append(&mut one.flipped_faces, other.flipped_faces);
    append(&mut one.collapsed_faces, other.collapsed_faces);
    append(&mut one.near_collapsed_faces, other.near_collapsed_faces);
    append(&mut one.wound_vertices, other.wound_vertices);
    append(&mut one.overlapping_faces, other.overlapping_faces);
    one
}
