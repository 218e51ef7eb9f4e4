//! Faces with the same three vertices, given vertices of their own.

use super::{Found, RepairError, Repaired, duplicates, repaired};
use abf_control::{Cancelled, Checkpoint, UnknownName};
use abf_mesh::{FaceId, TriMesh, VertexId};
use std::collections::HashMap;

/// What becomes of faces with the same three vertices, whichever way around: of the two sides of a leaf.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    Hash,
    strum::Display,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantNames,
)]
#[strum(serialize_all = "kebab-case", parse_err_ty = UnknownName, parse_err_fn = unknown)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum DoubleSided {
    /// Each has a place of its own. The second faces together are a surface of their own, and so are the third.
    #[default]
    Own,
    /// All but the first are dropped, and go where it goes.
    Shared,
}

impl DoubleSided {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::Own, Self::Shared];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<DoubleSided>("rule for double faces", given)
}

/// [`repair`](super::repair) with a choice of what becomes of faces with the same three vertices. [`DoubleSided::Shared`] is what it does
/// itself.
///
/// # Errors
/// As [`repair`](super::repair).
pub fn repair_with(mesh: &TriMesh, double_sided: DoubleSided) -> Result<Repaired, RepairError> {
    repair_asking(mesh, double_sided, &mut || Ok(()))
}

/// [`repair_with`] that asks between its parts and blocks whether to go on.
///
/// # Errors
/// As [`repair`](super::repair), and [`RepairError::Cancelled`].
pub fn repair_asking(
    mesh: &TriMesh,
    double_sided: DoubleSided,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Repaired, RepairError> {
    let layered = match double_sided {
        DoubleSided::Own => in_layers(mesh, checkpoint)?,
        DoubleSided::Shared => None,
    };
    let Some(Layered { mesh: layered, original, doubles }) = layered else { return repaired(mesh, checkpoint) };
    checkpoint()?;
    let mut repaired = repaired(&layered, checkpoint)?;
    for vertex in &mut repaired.vertices {
        *vertex = original[vertex.index()];
    }
    if let Some(first) = &mut repaired.report.split_vertices.first {
        *first = original[*first].index();
    }
    repaired.report.double_faces = Found::of(doubles.iter().map(|face| face.index()));
    Ok(repaired)
}

/// Faces at the place of an earlier one, whichever way around, with the vertices of that: the sides of a leaf that have vertices of
/// their own. `None` where there are none.
#[must_use]
pub fn paired_by_place(mesh: &TriMesh) -> Option<TriMesh> {
    let first_at = first_at_place(mesh);
    if (0..).zip(&first_at).all(|(v, first): (usize, _)| *first == VertexId::new(v)) {
        return None;
    }
    let all = mesh.faces();
    let places: Vec<[VertexId; 3]> = all.iter().map(|face| face.map(|v| first_at[v.index()])).collect();
    let mut faces: Vec<[usize; 3]> = all.iter().map(|face| face.map(VertexId::index)).collect();
    let mut is_any = false;
    let proper: Vec<FaceId> = (0..all.len()).map(FaceId::new).filter(|f| is_proper(&places[f.index()])).collect();
    for (f, first) in duplicates(&places, &proper) {
        let theirs = all[first.index()];
        let at = |v: VertexId| theirs.into_iter().find(|w| first_at[w.index()] == first_at[v.index()]).unwrap_or(v);
        let paired = all[f.index()].map(|v| at(v).index());
        is_any |= paired != faces[f.index()];
        faces[f.index()] = paired;
    }
    if is_any { TriMesh::new(mesh.positions().to_vec(), &faces).ok() } else { None }
}

/// For every vertex the lowest one in its place.
#[must_use]
pub fn first_at_place(mesh: &TriMesh) -> Vec<VertexId> {
    // Zeros of both signs are one place.
    let place = |v: usize| mesh.positions()[v].coords.map(|x| (x + 0.0).to_bits());
    let mut order: Vec<([u64; 3], VertexId)> =
        (0..mesh.vertex_count()).map(|v| (place(v).into(), VertexId::new(v))).collect();
    order.sort_unstable();
    let mut first = vec![VertexId::new(0); mesh.vertex_count()];
    for same in order.chunk_by(|a, b| a.0 == b.0) {
        same.iter().for_each(|&(_, v)| first[v.index()] = same[0].1);
    }
    first
}

fn is_proper([a, b, c]: &[VertexId; 3]) -> bool {
    a != b && b != c && c != a
}

/// A mesh in which no two faces have the same vertices.
struct Layered {
    /// The vertices of the input, then copies.
    mesh: TriMesh,
    /// For every vertex the one of the input it is at.
    original: Vec<VertexId>,
    /// The faces whose vertices are copies, ascending.
    doubles: Vec<FaceId>,
}

/// The second faces of the same vertices, with copies of their vertices that they share with each other; then the third.
/// `None` where there are none.
fn in_layers(mesh: &TriMesh, checkpoint: &mut Checkpoint<'_>) -> Result<Option<Layered>, Cancelled> {
    let all = mesh.faces();
    let layer_of = layers(all, checkpoint)?;
    if layer_of.iter().all(|&layer| layer == 0) {
        return Ok(None);
    }
    let mut original: Vec<VertexId> = (0..mesh.vertex_count()).map(VertexId::new).collect();
    let mut copies: HashMap<(VertexId, u32), usize> = HashMap::new();
    let mut vertex = |v: VertexId, layer: u32| {
        if layer == 0 {
            return v.index();
        }
        *copies.entry((v, layer)).or_insert_with(|| {
            original.push(v);
            original.len() - 1
        })
    };
    let faces: Vec<[usize; 3]> =
        all.iter().zip(&layer_of).map(|(face, &layer)| face.map(|v| vertex(v, layer))).collect();
    let positions = original.iter().map(|v| mesh.positions()[v.index()]).collect();
    let doubles = (0..all.len()).filter(|&f| layer_of[f] > 0).map(FaceId::new).collect();
    let mesh = TriMesh::new(positions, &faces).expect("vertices and copies of them");
    Ok(Some(Layered { mesh, original, doubles }))
}

/// For every face how many before it have the same vertices. One that uses a vertex twice is nobody's double.
fn layers(all: &[[VertexId; 3]], checkpoint: &mut Checkpoint<'_>) -> Result<Vec<u32>, Cancelled> {
    let mut keys: Vec<([VertexId; 3], usize)> = all
        .iter()
        .enumerate()
        .filter(|(_, face)| is_proper(face))
        .map(|(f, face)| {
            let mut key = *face;
            key.sort_unstable();
            (key, f)
        })
        .collect();
    checkpoint()?;
    keys.sort_unstable();
    checkpoint()?;
    let mut layer_of = vec![0; all.len()];
    for same in keys.chunk_by(|a, b| a.0 == b.0) {
        same.iter().zip(0..).for_each(|(&(_, f), layer)| layer_of[f] = layer);
    }
    Ok(layer_of)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repair;
    use crate::test_support::{mesh, sheet};

    /// A sheet with its back: the same faces the other way around.
    fn with_back() -> TriMesh {
        let front = sheet(3, 2);
        let of_face = |face: &[VertexId; 3]| face.map(VertexId::index);
        let mut faces: Vec<[usize; 3]> = front.faces().iter().map(of_face).collect();
        faces.extend(front.faces().iter().map(of_face).map(|[a, b, c]| [a, c, b]));
        TriMesh::new(front.positions().to_vec(), &faces).expect("indices in range")
    }

    #[test]
    fn the_back_of_a_sheet_is_a_surface_of_its_own() {
        let both = with_back();
        let repaired = repair_with(&both, DoubleSided::Own).expect("a mesh");
        assert_eq!(repaired.mesh.face_count(), both.face_count());
        assert_eq!(repaired.report.double_faces, Found { count: 12, first: Some(12) });
        assert_eq!(repaired.report.duplicate_faces.count, 0);
        assert!(repaired.turned.iter().all(|turned| !turned));
        // Two disks.
        assert_eq!(repaired.topology.euler_characteristic(), 2);
        assert_eq!(repaired.vertices.len(), 2 * both.vertex_count());
        assert!(repaired.vertices.iter().all(|v| v.index() < both.vertex_count()));
        for (v, original) in repaired.vertices.iter().enumerate() {
            assert_eq!(repaired.mesh.positions()[v], both.positions()[original.index()]);
        }
    }

    #[test]
    fn shared_sides_are_dropped_as_before() {
        let both = with_back();
        let repaired = repair_with(&both, DoubleSided::Shared).expect("a mesh");
        assert_eq!(repaired, repair(&both).expect("a mesh"));
        assert_eq!(repaired.report.duplicate_faces.count, 12);
    }

    #[test]
    fn sides_with_vertices_of_their_own_are_paired_by_their_places() {
        let both = with_back();
        // The back with vertices of its own.
        let (n, front) = (both.vertex_count(), both.face_count() / 2);
        let positions = [both.positions(), both.positions()].concat();
        let faces: Vec<[usize; 3]> = (0..both.face_count())
            .map(|f| both.faces()[f].map(|v| if f < front { v.index() } else { n + v.index() }))
            .collect();
        let apart = TriMesh::new(positions, &faces).expect("indices in range");
        assert_eq!(repair_with(&apart, DoubleSided::Shared).expect("a mesh").report.duplicate_faces.count, 0);
        let paired = paired_by_place(&apart).expect("pairs");
        assert_eq!(paired.faces(), both.faces());
        assert_eq!(repair_with(&paired, DoubleSided::Shared).expect("a mesh").report.duplicate_faces.count, 12);
        assert_eq!(paired_by_place(&both), None);
        assert_eq!(paired_by_place(&sheet(2, 2)), None);
    }

    #[test]
    fn a_third_face_is_a_third_surface_and_a_clean_mesh_comes_back_as_it_is() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let three = mesh(&points, &[[0, 1, 2], [2, 0, 1], [0, 2, 1]]);
        let repaired = repair_with(&three, DoubleSided::Own).expect("a mesh");
        assert_eq!(repaired.vertices.len(), 9);
        assert_eq!(repaired.topology.euler_characteristic(), 3);
        let clean = sheet(2, 2);
        assert_eq!(repair_with(&clean, DoubleSided::Own), repair(&clean));
    }
}
