//! What is proved of packed charts, and how distorted they are.

use super::Atlas;
use abf_cut::{DoubleSided, RepairError, Weld, first_at_place, repair_with, weld_within};
use abf_mesh::predicates::orient2d;
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
        let mut lines = Vec::new();
        for faces in pages.iter().filter(|faces| !faces.is_empty()).map(|faces| sorted(faces)) {
            let (part, map, vertices) = self.parts.of(&faces);
            let found = match certify_stored(&part, &map, self.precision) {
                // A page of faces without an area in space, beside others.
                Err(MetricsError::NoArea { .. }) => {
                    lines.extend(faces);
                    continue;
                }
                found => in_input(found?, &faces, &vertices),
            };
            whole = Some(match whole {
                None => found,
                Some(before) => together(before, found),
            });
        }
        let mut whole = whole.ok_or(match lines.len() {
            0 => MetricsError::NoFaces,
            faces => MetricsError::NoArea { faces },
        })?;
        for face in lines.into_iter().filter(|&f| self.parts.is_flat(f)) {
            whole.collapsed += 1;
            append(&mut whole.collapsed_faces, vec![face]);
        }
        Ok(whole)
    }

    /// Whether the UVs of some faces, one by one, lie on lines.
    pub(super) fn are_flat(&self, faces: &[FaceId]) -> bool {
        faces.iter().all(|&face| self.parts.is_flat(face))
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
        let charts = charts.enumerate().filter(|(_, (_, before))| before.is_valid || before.is_injective);
        for (i, (faces, before)) in charts.filter(|_| !whole.injective()) {
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
        measure_certified(&part, &Atlas::in_proportions(&map, sides), certificate)
    }
}

/// Which faces of a mesh are judged, and which way around.
pub(crate) struct Selected {
    /// Those that are, ascending: without shared ones, those that use a vertex twice, and those without area in one point.
    pub(crate) faces: Vec<FaceId>,
    /// Those of them that repair turns around, ascending.
    pub(crate) turned: Vec<FaceId>,
    /// For every face whether it has the place and the UVs of an earlier one.
    pub(crate) is_shared: Vec<bool>,
}

impl Selected {
    /// All faces as they are, where repair leaves nothing.
    pub(crate) fn all(faces: usize) -> Self {
        Self { faces: (0..faces).map(FaceId::new).collect(), turned: Vec::new(), is_shared: vec![false; faces] }
    }

    /// After the repair with which [`Unwrap`](crate::Unwrap) begins.
    pub(crate) fn of(mesh: &TriMesh, uv: &UvMap, rule: Weld, objects: Option<&[u32]>) -> Result<Self, RepairError> {
        let joined = as_joined(mesh, rule, objects);
        // Faces that share the texels of others are dropped before the repair, as `Unwrap` drops them.
        let is_shared = sharing(&joined, uv);
        let kept = not_shared((0..mesh.face_count()).map(FaceId::new), &is_shared);
        let repaired = if kept.len() == mesh.face_count() {
            repair_with(&joined, DoubleSided::Own)?
        } else {
            let corners = |f: &FaceId| joined.faces()[f.index()].map(VertexId::index);
            let faces: Vec<[usize; 3]> = kept.iter().map(corners).collect();
            let part = TriMesh::new(joined.positions().to_vec(), &faces).map_err(RepairError::from)?;
            repair_with(&part, DoubleSided::Own)?
        };
        let judged = |faces: &[FaceId]| {
            let of_kept = faces.iter().map(|f| kept[f.index()]);
            let mut judged: Vec<FaceId> = of_kept.filter(|&f| !is_in_one_point(mesh, uv, f)).collect();
            judged.sort_unstable();
            judged
        };
        Ok(Self { faces: judged(&repaired.faces), turned: judged(&repaired.turned_faces()), is_shared })
    }

    /// How many faces are not judged for what they share.
    pub(crate) fn shared(&self) -> usize {
        self.is_shared.iter().filter(|shared| **shared).count()
    }
}

/// Those of some faces that do not share the texels of earlier ones.
fn not_shared(faces: impl Iterator<Item = FaceId>, is_shared: &[bool]) -> Vec<FaceId> {
    faces.filter(|f| !is_shared[f.index()]).collect()
}

/// Whether a face without area has its corners in one point, as those of components without area have.
fn is_in_one_point(mesh: &TriMesh, uv: &UvMap, face: FaceId) -> bool {
    let [a, b, c] = uv.triangle(face);
    a == b && b == c && !has_area(mesh, face)
}

/// Whether a face has an area in space.
pub(crate) fn has_area(mesh: &TriMesh, face: FaceId) -> bool {
    let [p, q, r] = mesh.faces()[face.index()].map(|v| mesh.positions()[v.index()]);
    (q - p).cross(&(r - p)).norm() > 0.0
}

/// A mesh with vertices in one place joined, in the range of numbers that can be worked with.
fn as_joined<'m>(mesh: &'m TriMesh, rule: Weld, objects: Option<&[u32]>) -> Cow<'m, TriMesh> {
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
fn sharing(joined: &TriMesh, uv: &UvMap) -> Vec<bool> {
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

    /// Whether the UVs of a face lie on one line.
    pub(super) fn is_flat(&self, face: FaceId) -> bool {
        let [a, b, c] = self.uv.triangle(face);
        orient2d(a, b, c) == 0.0
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

/// Adds to a list of offenders as many as are listed.
fn append<T>(list: &mut Vec<T>, more: Vec<T>) {
    list.extend(more);
    list.truncate(Certificate::LISTED);
}
