//! A coarser mesh of some of the same vertices, to look for seams on.

use abf_control::{Cancelled, Checkpoint, at_block};
use abf_mesh::{Point3, Topology, TriMesh, Vector3, VertexId};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A face may turn by no more than the angle with this cosine when a vertex beside it goes.
const LEAST_COSINE: f64 = 0.2;

/// What a collapse costs beside its distance from the surface: this part of the squared length of its edge times the area.
/// In planes it leaves faces of a good shape.
const LENGTH: f64 = 1e-3;

/// A mesh with fewer faces.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Simplified {
    /// It.
    pub mesh: TriMesh,
    /// Its corner table.
    pub topology: Topology,
    /// For each of its vertices the vertex it is in the mesh before.
    pub vertices: Vec<VertexId>,
}

/// Collapses edges until no more than so many faces are left, or none can be: interior vertices move onto neighbours, the
/// one whose faces' planes are nearest first (Garland and Heckbert 1997). The boundary and the topology stay.
///
/// `None` where nothing can be collapsed.
#[must_use]
pub fn simplify(mesh: &TriMesh, topology: &Topology, faces: usize) -> Option<Simplified> {
    simplify_asking(mesh, topology, faces, &mut || Ok(())).ok().flatten()
}

/// [`simplify`] that asks between its blocks whether to go on.
///
/// # Errors
/// [`Cancelled`].
pub fn simplify_asking(
    mesh: &TriMesh,
    topology: &Topology,
    faces: usize,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Option<Simplified>, Cancelled> {
    let mut work = Collapse::new(mesh, topology);
    let mut heap = BinaryHeap::with_capacity(mesh.vertex_count());
    for v in 0..mesh.vertex_count() {
        at_block(v, checkpoint)?;
        work.offer(v, &mut heap);
    }
    let mut steps = 0;
    while work.face_count > faces {
        steps += 1;
        at_block(steps, checkpoint)?;
        let Some(Reverse((_, v, version, onto))) = heap.pop() else { break };
        if work.version[v] != version {
            // Around it something has changed since: what it costs now is found out only here.
            work.offer(v, &mut heap);
        } else if work.is_allowed(v, onto) {
            for w in work.collapse(v, onto) {
                work.version[w] += 1;
                if !work.is_offered[w] {
                    work.offer(w, &mut heap);
                }
            }
        } else {
            work.is_offered[v] = false;
        }
    }
    checkpoint()?;
    Ok(work.finish(mesh).filter(|simplified| simplified.mesh.face_count() < mesh.face_count()))
}

/// The cost of a collapse as ordered bits, the vertex that goes, its version, and where it goes.
type Candidate = (u64, usize, u32, usize);

/// A sum of weighted squared distances from planes, as a polynomial: xx, xy, xz, yy, yz, zz, x, y, z, 1.
#[derive(Clone, Copy, Default)]
struct Quadric([f64; 10]);

impl Quadric {
    /// Of the plane `n · p = d`.
    fn of_plane(n: &Vector3<f64>, d: f64, weight: f64) -> Self {
        let (x, y, z) = (n.x, n.y, n.z);
        let terms = [x * x, 2.0 * x * y, 2.0 * x * z, y * y, 2.0 * y * z, z * z];
        let [xx, xy, xz, yy, yz, zz] = terms.map(|t| t * weight);
        let [x, y, z] = [x, y, z].map(|t| -2.0 * t * d * weight);
        Self([xx, xy, xz, yy, yz, zz, x, y, z, d * d * weight])
    }

    fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(x, y)| *x += y);
    }

    fn at(&self, p: &Vector3<f64>) -> f64 {
        let (x, y, z) = (p.x, p.y, p.z);
        let powers = [x * x, x * y, x * z, y * y, y * z, z * z, x, y, z, 1.0];
        self.0.iter().zip(powers).map(|(q, t)| q * t).sum::<f64>().max(0.0)
    }
}

struct Collapse<'m> {
    mesh: &'m TriMesh,
    /// Where quadrics have their origin.
    middle: Point3<f64>,
    /// The vertices of faces that are left; of others nothing that counts.
    faces: Vec<[usize; 3]>,
    is_there: Vec<bool>,
    at_vertex: Vec<Vec<u32>>,
    /// Vertices that may go.
    is_free: Vec<bool>,
    /// The sum of squared distances from the planes around, weighted by area.
    quadrics: Vec<Quadric>,
    areas: Vec<f64>,
    version: Vec<u32>,
    /// Whether the heap holds a candidate of a vertex, however old.
    is_offered: Vec<bool>,
    face_count: usize,
}

impl<'m> Collapse<'m> {
    fn new(mesh: &'m TriMesh, topology: &Topology) -> Self {
        let n = mesh.vertex_count();
        let faces: Vec<[usize; 3]> = mesh.faces().iter().map(|face| face.map(VertexId::index)).collect();
        let middle = mesh.positions().first().copied().unwrap_or_default();
        let (mut at_vertex, mut quadrics, mut areas) = (vec![Vec::new(); n], vec![Quadric::default(); n], vec![0.0; n]);
        for (f, face) in faces.iter().enumerate() {
            let [a, b, c] = face.map(|v| mesh.positions()[v]);
            let cross = (b - a).cross(&(c - a));
            let area = cross.norm();
            let normal = cross.try_normalize(0.0).unwrap_or_default();
            let quadric = Quadric::of_plane(&normal, normal.dot(&(a - middle)), area);
            for &v in face {
                at_vertex[v].push(f as u32);
                quadrics[v].add(&quadric);
                areas[v] += area;
            }
        }
        let is_free = topology.vertices().map(|v| topology.is_interior(v)).collect();
        let face_count = faces.len();
        let is_there = vec![true; face_count];
        Self {
            mesh,
            middle,
            faces,
            is_there,
            at_vertex,
            is_free,
            quadrics,
            areas,
            version: vec![0; n],
            is_offered: vec![false; n],
            face_count,
        }
    }

    fn around(&self, v: usize) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.at_vertex[v].iter().map(|&f| self.faces[f as usize])
    }

    /// The neighbours of an interior vertex, once each; of one on the boundary, all but its last are.
    fn neighbours(&self, v: usize) -> Vec<usize> {
        let mut all: Vec<usize> = self.around(v).flatten().filter(|&w| w != v).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Puts the cheapest collapse of a vertex into the heap, if there is one.
    fn offer(&mut self, v: usize, heap: &mut BinaryHeap<Reverse<Candidate>>) {
        let candidate = self.candidate(v);
        self.is_offered[v] = candidate.is_some();
        heap.extend(candidate.map(Reverse));
    }

    /// The cheapest collapse of a vertex that its faces allow.
    fn candidate(&self, v: usize) -> Option<Candidate> {
        if !self.is_free[v] || self.at_vertex[v].is_empty() {
            return None;
        }
        let cost = |w: usize| {
            let (from, to) = (self.mesh.positions()[v], self.mesh.positions()[w]);
            self.quadrics[v].at(&(to - self.middle)) + LENGTH * self.areas[v] * (to - from).norm_squared()
        };
        let mut all: Vec<(u64, usize)> = self.neighbours(v).into_iter().map(|w| (cost(w).to_bits(), w)).collect();
        all.sort_unstable();
        let best = all.into_iter().find(|&(_, w)| self.turns_nothing_over(v, w))?;
        Some((best.0, v, self.version[v], best.1))
    }

    fn turns_nothing_over(&self, v: usize, onto: usize) -> bool {
        let at = |v: usize| self.mesh.positions()[v];
        self.around(v).filter(|face| !face.contains(&onto)).all(|face| {
            let normal = |[a, b, c]: [usize; 3]| (at(b) - at(a)).cross(&(at(c) - at(a)));
            let (before, after) = (normal(face), normal(face.map(|w| if w == v { onto } else { w })));
            before.dot(&after) > LEAST_COSINE * before.norm() * after.norm()
        })
    }

    /// Whether the surface stays a manifold: the two have two neighbours in common, which have more than three faces.
    fn is_allowed(&self, v: usize, onto: usize) -> bool {
        let mine = self.neighbours(v);
        if !mine.contains(&onto) || mine.len() < 3 {
            return false;
        }
        let others = self.neighbours(onto);
        let common: Vec<usize> = mine.into_iter().filter(|w| others.binary_search(w).is_ok()).collect();
        common.len() == 2
            && common.iter().all(|&w| !self.is_free[w] || self.at_vertex[w].len() > 3)
            && self.turns_nothing_over(v, onto)
    }

    /// Moves a vertex onto another, and says whose candidates that changes.
    fn collapse(&mut self, v: usize, onto: usize) -> Vec<usize> {
        for f in std::mem::take(&mut self.at_vertex[v]) {
            let face = &mut self.faces[f as usize];
            if face.contains(&onto) {
                let third = face.iter().copied().find(|&w| w != v && w != onto);
                self.is_there[f as usize] = false;
                self.face_count -= 1;
                self.at_vertex[onto].retain(|&g| g != f);
                third.into_iter().for_each(|w| self.at_vertex[w].retain(|&g| g != f));
            } else {
                face.iter_mut().filter(|w| **w == v).for_each(|w| *w = onto);
                self.at_vertex[onto].push(f);
            }
        }
        let gone = self.quadrics[v];
        self.quadrics[onto].add(&gone);
        self.areas[onto] += self.areas[v];
        self.is_free[v] = false;
        let mut changed = self.neighbours(onto);
        changed.push(onto);
        changed
    }

    fn finish(self, mesh: &TriMesh) -> Option<Simplified> {
        let mut number = vec![usize::MAX; mesh.vertex_count()];
        let used: Vec<usize> = (0..number.len()).filter(|&v| !self.at_vertex[v].is_empty()).collect();
        used.iter().enumerate().for_each(|(new, &old)| number[old] = new);
        let faces: Vec<[usize; 3]> = self
            .faces
            .iter()
            .zip(&self.is_there)
            .filter(|&(_, &is_there)| is_there)
            .map(|(face, _)| face.map(|v| number[v]))
            .collect();
        let positions = used.iter().map(|&v| mesh.positions()[v]).collect();
        let mesh = TriMesh::new(positions, &faces).ok()?;
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).ok()?;
        Some(Simplified { mesh, topology, vertices: used.into_iter().map(VertexId::new).collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{double_torus, sheet, tetrahedron, topology, torus, without_faces};

    #[test]
    fn topology_boundary_and_places_stay() {
        for mesh in [torus(24, 16), sheet(14, 14), double_torus(), without_faces(&torus(20, 20), &[7, 100])] {
            let before = topology(&mesh);
            let simple = simplify(&mesh, &before, mesh.face_count() / 3).expect("a simpler mesh");
            simple.topology.check().expect("lawful");
            assert!(simple.mesh.face_count() <= mesh.face_count() * 2 / 3, "{}", simple.mesh.face_count());
            assert_eq!(simple.topology.euler_characteristic(), before.euler_characteristic());
            assert_eq!(simple.topology.boundary_edge_count(), before.boundary_edge_count());
            for (p, v) in simple.mesh.positions().iter().zip(&simple.vertices) {
                assert_eq!(*p, mesh.positions()[v.index()]);
            }
        }
    }

    #[test]
    fn what_cannot_be_simpler_is_left_alone() {
        let mesh = tetrahedron();
        assert!(simplify(&mesh, &topology(&mesh), 1).is_none());
    }
}
