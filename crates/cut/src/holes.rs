//! Holes, closed by virtual faces.

use crate::seams::edges_at;
use abf_control::UnknownName;
use abf_mesh::{BoundaryLoop, Point3, Topology, TopologyError, TriMesh, Vector3, VertexId};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

/// How a hole is closed.
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
pub enum HoleFilling {
    /// A fan around a new vertex in the middle of the rim.
    Fan,
    /// Triangles between vertices of the rim, the sharpest ear first; a fan where that would make an edge that is there.
    /// Keeps the rims of larger holes better (`docs/seams.md`).
    #[default]
    Ears,
}

impl HoleFilling {
    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<HoleFilling>("way to fill a hole", given)
}

/// A mesh whose holes are closed.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Filled {
    /// The vertices and faces of the mesh, then those that are virtual.
    pub mesh: TriMesh,
    /// Its corner table.
    pub topology: Topology,
    /// The number of its first virtual face: how many real ones there are.
    pub first_virtual: usize,
}

/// Closes these boundary loops.
///
/// Real vertices and faces keep their numbers; virtual ones come after them.
///
/// # Errors
/// [`TopologyError`] never, for boundary loops of this topology; it is checked again.
pub fn fill(
    mesh: &TriMesh,
    topology: &Topology,
    holes: &[BoundaryLoop],
    filling: HoleFilling,
) -> Result<Filled, TopologyError> {
    if holes.is_empty() {
        let first_virtual = mesh.face_count();
        return Ok(Filled { mesh: mesh.clone(), topology: topology.clone(), first_virtual });
    }
    let mut positions = mesh.positions().to_vec();
    let mut faces: Vec<[usize; 3]> = mesh.faces().iter().map(|face| face.map(VertexId::index)).collect();
    for hole in holes {
        let ears = (filling == HoleFilling::Ears).then(|| ears(mesh, topology, hole)).flatten();
        match ears {
            Some(ears) => faces.extend(ears.iter().map(|face| face.map(VertexId::index))),
            None => {
                faces.extend(fan(hole, positions.len()));
                positions.push(middle(mesh, hole));
            }
        }
    }
    let filled = TriMesh::new(positions, &faces).expect("virtual faces name vertices of the rim or their own");
    let topology = Topology::build(filled.vertex_count(), filled.faces())?;
    Ok(Filled { mesh: filled, topology, first_virtual: mesh.face_count() })
}

/// The length of a boundary loop, in units of the mesh.
#[must_use]
pub fn loop_length(mesh: &TriMesh, rim: &BoundaryLoop) -> f64 {
    sides(rim).map(|[a, b]| (mesh.positions()[b.index()] - mesh.positions()[a.index()]).norm()).sum()
}

/// The loop that stays open when holes are filled: the longest; of equals the first. `None` of none.
#[must_use]
pub fn outer_loop(mesh: &TriMesh, loops: &[BoundaryLoop]) -> Option<usize> {
    let lengths: Vec<f64> = loops.iter().map(|l| loop_length(mesh, l)).collect();
    (0..loops.len()).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b]).then(b.cmp(&a)))
}

/// The edges of a loop, the surface on their left.
fn sides(rim: &BoundaryLoop) -> impl Iterator<Item = [VertexId; 2]> + '_ {
    let next = rim.vertices.iter().cycle().skip(1);
    rim.vertices.iter().zip(next).map(|(&a, &b)| [a, b])
}

/// The mean of the rim, every piece of it weighted by its length.
fn middle(mesh: &TriMesh, rim: &BoundaryLoop) -> Point3<f64> {
    let at = |v: VertexId| mesh.positions()[v.index()];
    let (mut sum, mut total) = (Vector3::zeros(), 0.0);
    for [a, b] in sides(rim) {
        let length = (at(b) - at(a)).norm();
        sum += (at(a).coords + at(b).coords) * (0.5 * length);
        total += length;
    }
    if total > 0.0 { Point3::from(sum / total) } else { at(rim.vertices[0]) }
}

fn fan(rim: &BoundaryLoop, middle: usize) -> impl Iterator<Item = [usize; 3]> + '_ {
    sides(rim).map(move |[a, b]| [b.index(), a.index(), middle])
}

/// Cuts ears off the hole, the sharpest first. `None` where none can be cut without an edge that is there already.
fn ears(mesh: &TriMesh, topology: &Topology, rim: &BoundaryLoop) -> Option<Vec<[VertexId; 3]>> {
    let n = rim.vertices.len();
    let mut polygon = Polygon {
        before: (0..n).map(|i| (i + n - 1) % n).collect(),
        after: (0..n).map(|i| (i + 1) % n).collect(),
        version: vec![0; n],
        rim: &rim.vertices,
        mesh,
    };
    let mut heap: BinaryHeap<_> = (0..n).map(|i| Reverse((polygon.sharpness(i), i, 0_u32))).collect();
    let mut made: HashSet<[VertexId; 2]> = HashSet::new();
    let mut faces = Vec::with_capacity(n - 2);
    let mut left = n;
    while left > 3 {
        let Reverse((_, i, version)) = heap.pop()?;
        if polygon.version[i] != version {
            continue;
        }
        let [a, b, c] = polygon.ear(i);
        let is_there = edges_at(topology, a).any(|(_, w)| w == c);
        if is_there || !made.insert([a.min(c), a.max(c)]) {
            continue;
        }
        faces.push([c, b, a]);
        left -= 1;
        for neighbour in polygon.cut(i) {
            heap.push(Reverse((polygon.sharpness(neighbour), neighbour, polygon.version[neighbour])));
        }
        if left == 3 {
            let [a, b, c] = polygon.ear(polygon.after[i]);
            faces.push([c, b, a]);
        }
    }
    if n == 3 {
        faces.push([rim.vertices[2], rim.vertices[1], rim.vertices[0]]);
    }
    Some(faces)
}

/// What is left of a rim while ears are cut off.
struct Polygon<'a> {
    before: Vec<usize>,
    after: Vec<usize>,
    /// How often the ear at a place has changed; gone places count on.
    version: Vec<u32>,
    rim: &'a [VertexId],
    mesh: &'a TriMesh,
}

impl Polygon<'_> {
    fn ear(&self, i: usize) -> [VertexId; 3] {
        [self.before[i], i, self.after[i]].map(|j| self.rim[j])
    }

    /// The angle of an ear at its tip, rad, as the bits of a double: in the same order.
    fn sharpness(&self, i: usize) -> u64 {
        let [a, b, c] = self.ear(i).map(|v| self.mesh.positions()[v.index()]);
        let (u, v) = (a - b, c - b);
        u.cross(&v).norm().atan2(u.dot(&v)).to_bits()
    }

    /// Takes the tip out and says whose ears that changes.
    fn cut(&mut self, i: usize) -> [usize; 2] {
        let (a, c) = (self.before[i], self.after[i]);
        self.after[a] = c;
        self.before[c] = a;
        [i, a, c].into_iter().for_each(|j| self.version[j] += 1);
        [a, c]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{octahedron, sheet, tetrahedron, topology, without_faces};

    #[test]
    fn both_ways_close_every_hole_and_number_virtual_faces_last() {
        // A hole of one face, one of a whole ring around (6, 6).
        let in_ring = |f: &usize| (4..8).contains(&(f / 24)) && (4..8).contains(&(f / 2 % 12));
        let ring: Vec<usize> = (0..288).filter(in_ring).collect();
        let holed = without_faces(&sheet(12, 12), &[ring, vec![2 * 13]].concat());
        let before = topology(&holed);
        let loops = before.boundary_loops();
        assert_eq!(loops.len(), 3);
        let outer = outer_loop(&holed, &loops).expect("a loop");
        assert_eq!(loops[outer].vertices.len(), 48);
        let holes: Vec<_> = loops.iter().enumerate().filter(|&(i, _)| i != outer).map(|(_, l)| l.clone()).collect();
        for (filling, vertices, faces) in [(HoleFilling::Fan, 2, 16 + 3), (HoleFilling::Ears, 0, 14 + 1)] {
            let filled = fill(&holed, &before, &holes, filling).expect("a manifold");
            filled.topology.check().expect("lawful");
            filled.topology.require_disk().expect("a disk");
            assert_eq!(filled.first_virtual, holed.face_count());
            assert_eq!(filled.mesh.faces()[..filled.first_virtual], *holed.faces());
            assert_eq!(filled.mesh.face_count(), holed.face_count() + faces, "{filling}");
            assert_eq!(filled.mesh.vertex_count(), holed.vertex_count() + vertices);
        }
    }

    #[test]
    fn a_hole_whose_ears_are_taken_gets_a_fan() {
        // Two faces of a tetrahedron: the other two are two ears, whose common edge is there already.
        let mesh = without_faces(&tetrahedron(), &[0, 1]);
        let topology_of = topology(&mesh);
        let loops = topology_of.boundary_loops();
        let filled = fill(&mesh, &topology_of, &loops, HoleFilling::Ears).expect("a manifold");
        assert_eq!(filled.topology.euler_characteristic(), 2);
        let mesh = without_faces(&octahedron(), &[2]);
        let topology_of = topology(&mesh);
        let filled = fill(&mesh, &topology_of, &topology_of.boundary_loops(), HoleFilling::Ears).expect("a manifold");
        assert_eq!((filled.topology.euler_characteristic(), filled.mesh.face_count()), (2, 8));
    }

    #[test]
    fn names_are_read_back() {
        for filling in [HoleFilling::Fan, HoleFilling::Ears] {
            assert_eq!(filling.name().parse(), Ok(filling));
        }
        assert!("cork".parse::<HoleFilling>().is_err());
    }
}
