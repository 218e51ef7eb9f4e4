//! An oriented manifold with boundary from whatever faces there are, and a count of what that took.
//!
//! * A face that uses a vertex twice is dropped, and so is one whose three vertices an earlier face has, whichever way
//!   around.
//! * An edge of three or more faces is split. Two of its faces stay joined where that works out: pairs in one piece of
//!   the surface before others, pairs oriented alike before others, then the most coplanar. Where both ends of the edge
//!   cannot be told apart after that, all of its faces are let go.
//! * Every connected piece is oriented one way, the way of most of its faces. Where it has one side only, it is cut
//!   where the two orientations meet.
//! * A vertex is there once for each fan of faces around it.

mod layers;
mod orient;
mod pairs;
mod report;

use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{CornerId, DisjointSets, FaceId, GeometryError, Topology, TopologyError, TriMesh, VertexId};
pub use layers::{DoubleSided, first_at_place, paired_by_place, repair_asking, repair_with};
use pairs::Pairs;
pub use report::{Found, RepairReport};

/// A mesh that [`Topology::build`] accepts, with the way back to the one it was made from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Repaired {
    /// The repaired mesh. All vertices of the input in their order, then copies of those that were split.
    pub mesh: TriMesh,
    /// Its corner table.
    pub topology: Topology,
    /// For every face the face of the input it was.
    pub faces: Vec<FaceId>,
    /// For every face whether it was turned around. Corner `k` of a face that was not is corner `k` in the input; corners
    /// 0, 1, 2 of one that was are corners 0, 2, 1 ([`input_corner`](Self::input_corner)).
    pub turned: Vec<bool>,
    /// For every vertex the vertex of the input it is at.
    pub vertices: Vec<VertexId>,
    /// Faces of the input that were dropped, each with the earlier one that has the same three vertices.
    pub duplicates: Vec<(FaceId, FaceId)>,
    /// Faces of the input that were dropped because they use a vertex twice.
    pub repeated: Vec<FaceId>,
    /// What was done.
    pub report: RepairReport,
}

/// Why there is nothing left to work with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RepairError {
    /// No face, or none that uses three different vertices.
    #[error("the mesh has no face with three different vertices ({faces} faces in all)")]
    NoFaces {
        /// How many faces there are.
        faces: usize,
    },
    /// Coordinates that are not finite.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Too many faces for 32-bit corners.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// The observer aborted it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Repaired {
    /// The corner of the input that a corner of the repaired mesh was.
    #[must_use]
    pub fn input_corner(&self, corner: CornerId) -> CornerId {
        let face = corner.face().index();
        let place = if self.turned[face] { [0, 2, 1][corner.place()] } else { corner.place() };
        self.faces[face].corner(place)
    }

    /// The faces of the input that were turned around, ascending.
    #[must_use]
    pub fn turned_faces(&self) -> Vec<FaceId> {
        let turned = self.faces.iter().zip(&self.turned).filter(|&(_, &turned)| turned);
        let mut turned: Vec<FaceId> = turned.map(|(&face, _)| face).collect();
        turned.sort_unstable();
        turned
    }
}

/// Makes an oriented manifold with boundary of a mesh. One that is such a manifold comes back as it is.
///
/// Takes time `O(n log n)`. Zero-area faces and unused vertices are counted and kept.
///
/// # Errors
/// [`RepairError`] when no face is left, or coordinates are not finite.
pub fn repair(mesh: &TriMesh) -> Result<Repaired, RepairError> {
    repaired(mesh, &mut || Ok(()))
}

fn repaired(mesh: &TriMesh, checkpoint: &mut Checkpoint<'_>) -> Result<Repaired, RepairError> {
    mesh.check_finite()?;
    checkpoint()?;
    if let Ok(topology) = Topology::build_asking(mesh.vertex_count(), mesh.faces(), checkpoint)? {
        let faces: Vec<FaceId> = topology.faces().collect();
        let turned = vec![false; faces.len()];
        let mut report = RepairReport::default();
        report.note_kept(mesh);
        let (duplicates, repeated) = (Vec::new(), Vec::new());
        let vertices = topology.vertices().collect();
        return Ok(Repaired { mesh: mesh.clone(), topology, faces, turned, vertices, duplicates, repeated, report });
    }
    Repair::begin(mesh, checkpoint)?.run(checkpoint)
}

/// A repair under way.
struct Repair<'m> {
    input: &'m TriMesh,
    /// The faces that are kept, as they are.
    faces: Vec<FaceId>,
    corners: Vec<[VertexId; 3]>,
    duplicates: Vec<(FaceId, FaceId)>,
    repeated: Vec<FaceId>,
    report: RepairReport,
}

impl<'m> Repair<'m> {
    fn begin(input: &'m TriMesh, checkpoint: &mut Checkpoint<'_>) -> Result<Self, RepairError> {
        let all = input.faces();
        if all.len() > (u32::MAX as usize - 1) / 3 {
            return Err(TopologyError::TooLarge { faces: all.len() }.into());
        }
        let (mut faces, repeated): (Vec<FaceId>, Vec<FaceId>) = (0..all.len()).map(FaceId::new).partition(|f| {
            let [a, b, c] = all[f.index()];
            a != b && b != c && c != a
        });
        let duplicates = duplicates(all, &faces);
        checkpoint()?;
        let mut is_dropped = vec![false; all.len()];
        duplicates.iter().for_each(|(f, _)| is_dropped[f.index()] = true);
        faces.retain(|f| !is_dropped[f.index()]);
        if faces.is_empty() {
            return Err(RepairError::NoFaces { faces: all.len() });
        }
        let corners = faces.iter().map(|f| all[f.index()]).collect();
        let mut report = RepairReport {
            duplicate_faces: Found::of(duplicates.iter().map(|(f, _)| f.index())),
            repeated_vertex_faces: Found::of(repeated.iter().map(|f| f.index())),
            ..RepairReport::default()
        };
        report.note_kept(input);
        Ok(Self { input, faces, corners, duplicates, repeated, report })
    }

    fn run(mut self, checkpoint: &mut Checkpoint<'_>) -> Result<Repaired, RepairError> {
        checkpoint()?;
        let mut pairs = Pairs::of_edges(&self.corners);
        checkpoint()?;
        let face_at = |c: CornerId| self.faces[c.face().index()].index();
        self.report.non_manifold_edges = Found::of(pairs.crowded.iter().map(|edge| face_at(edge.corners[0])));
        pairs.join_crowded(self.input, &self.corners);
        checkpoint()?;
        let turned = self.orient(&mut pairs);
        checkpoint()?;
        let (corners, vertices) = self.separate(&mut pairs, checkpoint)?;
        let around = |(face, turned): (&[VertexId; 3], &bool)| {
            let [a, b, c] = face.map(VertexId::index);
            if *turned { [a, c, b] } else { [a, b, c] }
        };
        let faces: Vec<[usize; 3]> = corners.iter().zip(&turned).map(around).collect();
        let positions = vertices.iter().map(|v| self.input.positions()[v.index()]).collect();
        let mesh = TriMesh::new(positions, &faces)?;
        let topology = Topology::build_asking(mesh.vertex_count(), mesh.faces(), checkpoint)??;
        let Self { faces, duplicates, repeated, report, .. } = self;
        Ok(Repaired { mesh, topology, faces, turned, vertices, duplicates, repeated, report })
    }

    /// Which faces are to be turned around; pairs that no choice agrees with are let go.
    fn orient(&mut self, pairs: &mut Pairs) -> Vec<bool> {
        let oriented = orient::orient(&self.corners, pairs);
        let original = |f: usize| self.faces[f].index();
        let turned = oriented.turned.iter().enumerate().filter(|(_, turned)| **turned);
        self.report.turned_faces = Found::of(turned.map(|(f, _)| original(f)));
        self.report.one_sided_cuts = Found::of(oriented.cut.iter().map(|c| original(c.face().index())));
        oriented.turned
    }

    /// A vertex for each fan: for every face its vertices, and for every vertex the one it was.
    fn separate(
        &mut self,
        pairs: &mut Pairs,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(Vec<[VertexId; 3]>, Vec<VertexId>), Cancelled> {
        loop {
            checkpoint()?;
            let (corners, vertices) = fans(self.input.vertex_count(), &self.corners, pairs);
            if !pairs.let_go_of_conflicts(&self.corners, &corners) {
                let copies = &vertices[self.input.vertex_count()..];
                let mut split = copies.to_vec();
                split.sort_unstable();
                split.dedup();
                self.report.split_vertices = Found::of(split.iter().map(|v| v.index()));
                return Ok((corners, vertices));
            }
        }
    }
}

/// Faces with the vertices of an earlier one, whichever way around.
fn duplicates(all: &[[VertexId; 3]], kept: &[FaceId]) -> Vec<(FaceId, FaceId)> {
    let mut keys: Vec<([VertexId; 3], FaceId)> = kept
        .iter()
        .map(|&f| {
            let mut key = all[f.index()];
            key.sort_unstable();
            (key, f)
        })
        .collect();
    keys.sort_unstable();
    let mut found: Vec<_> =
        keys.chunk_by(|a, b| a.0 == b.0).flat_map(|same| same[1..].iter().map(|&(_, f)| (f, same[0].1))).collect();
    found.sort_unstable();
    found
}

/// Gives every fan of paired faces a vertex of its own: the fan of the lowest corner keeps the vertex, others get copies,
/// in the order of their corners.
fn fans(vertex_count: usize, faces: &[[VertexId; 3]], pairs: &Pairs) -> (Vec<[VertexId; 3]>, Vec<VertexId>) {
    let corner_vertex = faces.as_flattened();
    let mut joined = DisjointSets::new(corner_vertex.len());
    for (c, o) in pairs.all() {
        for end in [c.next(), c.prev()] {
            let v = corner_vertex[end.index()];
            let across = if corner_vertex[o.next().index()] == v { o.next() } else { o.prev() };
            // A corner on its own is in no fan but its own.
            if !pairs.is_alone(end) && !pairs.is_alone(across) {
                joined.unite(end.index(), across.index());
            }
        }
    }
    let mut vertices: Vec<VertexId> = (0..vertex_count).map(VertexId::new).collect();
    let mut is_taken = vec![false; vertex_count];
    let mut of_corner = vec![VertexId::new(0); corner_vertex.len()];
    for (c, &v) in corner_vertex.iter().enumerate() {
        let lowest = joined.find(c);
        of_corner[c] = if lowest != c {
            of_corner[lowest]
        } else if std::mem::replace(&mut is_taken[v.index()], true) {
            vertices.push(v);
            VertexId::new(vertices.len() - 1)
        } else {
            v
        };
    }
    (of_corner.as_chunks::<3>().0.to_vec(), vertices)
}

#[cfg(test)]
mod tests;
