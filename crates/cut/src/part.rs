//! A surface in two parts.

use crate::Seams;
use crate::seams::interior_edges;
use abf_control::{Cancelled, Checkpoint, at_block};
use abf_mesh::{CornerId, Point3, Topology, TriMesh, Vector3};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A crease of 60° or more makes the way across an edge longer by so many times.
const CREASE: f64 = 4.0;

/// The seams between two connected parts of one component: the faces nearer to the one and to the other of two faces far
/// apart, by ways from middle to middle that avoid creases. Edges that are forbidden have no length, so that they are cut
/// only where nothing else is.
///
/// There are no seams when there is only one face.
#[must_use]
pub fn two_parts(mesh: &TriMesh, topology: &Topology, is_forbidden: impl Fn(CornerId) -> bool) -> Seams {
    let seams = two_parts_asking(mesh, topology, is_forbidden, &mut || Ok(()));
    seams.unwrap_or_else(|_: Cancelled| Seams::none(topology))
}

/// [`two_parts`] that asks between its blocks whether to go on.
///
/// # Errors
/// [`Cancelled`].
pub fn two_parts_asking(
    mesh: &TriMesh,
    topology: &Topology,
    is_forbidden: impl Fn(CornerId) -> bool,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Seams, Cancelled> {
    let ways = Ways::new(mesh, topology, is_forbidden);
    checkpoint()?;
    let one = ways.farthest(&ways.from(&[0], checkpoint)?.0, None);
    let (distance, _) = ways.from(&[one], checkpoint)?;
    let other = ways.farthest(&distance, Some(one));
    let (_, is_others) = ways.from(&[one, other], checkpoint)?;
    let side = |c: CornerId| is_others[c.face().index()];
    Ok(Seams::where_edges(topology, |c, o| side(c) != side(o)))
}

/// The faces and the lengths of the ways between neighbours.
struct Ways<'t> {
    topology: &'t Topology,
    /// By corner, across the edge that it faces.
    lengths: Vec<f64>,
}

impl<'t> Ways<'t> {
    fn new(mesh: &TriMesh, topology: &'t Topology, is_forbidden: impl Fn(CornerId) -> bool) -> Self {
        let middles: Vec<Point3<f64>> =
            mesh.triangles().map(|[a, b, c]| Point3::from((a.coords + b.coords + c.coords) / 3.0)).collect();
        let normals: Vec<Vector3<f64>> = mesh.triangles().map(|[a, b, c]| (b - a).cross(&(c - a))).collect();
        let mut lengths = vec![0.0; topology.corner_count()];
        for (c, o) in interior_edges(topology) {
            let [f, g] = [c, o].map(|c| c.face().index());
            let turn = normals[f].cross(&normals[g]).norm().atan2(normals[f].dot(&normals[g]));
            let crease = (turn / std::f64::consts::FRAC_PI_3).min(1.0);
            let length = if is_forbidden(c) { 0.0 } else { (middles[g] - middles[f]).norm() * (1.0 + CREASE * crease) };
            (lengths[c.index()], lengths[o.index()]) = (length, length);
        }
        Self { topology, lengths }
    }

    /// The distance of every face from the nearest source, and whether that is the last of them.
    fn from(&self, sources: &[usize], checkpoint: &mut Checkpoint<'_>) -> Result<(Vec<f64>, Vec<bool>), Cancelled> {
        let n = self.topology.face_count();
        let mut distance = vec![f64::INFINITY; n];
        let mut is_last = vec![false; n];
        let mut heap = BinaryHeap::new();
        for (i, &f) in sources.iter().enumerate() {
            distance[f] = 0.0;
            is_last[f] = i > 0;
            heap.push(Reverse((0_u64, f)));
        }
        let mut steps = 0;
        while let Some(Reverse((key, f))) = heap.pop() {
            at_block(steps, checkpoint)?;
            steps += 1;
            // The order of the bits of doubles that are not negative is that of the doubles.
            let here = f64::from_bits(key);
            if here > distance[f] {
                continue;
            }
            for c in abf_mesh::FaceId::new(f).corners() {
                let Some(o) = self.topology.opposite(c) else { continue };
                let (g, there) = (o.face().index(), here + self.lengths[c.index()]);
                if there < distance[g] {
                    distance[g] = there;
                    is_last[g] = is_last[f];
                    heap.push(Reverse((there.to_bits(), g)));
                }
            }
        }
        Ok((distance, is_last))
    }

    /// The farthest face that is reached, other than `but`; of equals the last.
    fn farthest(&self, distance: &[f64], but: Option<usize>) -> usize {
        let reached = (0..self.topology.face_count()).filter(|&f| distance[f].is_finite() && Some(f) != but);
        reached.max_by(|&f, &g| distance[f].total_cmp(&distance[g])).or(but).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::split;
    use crate::test_support::{octahedron, sheet, tetrahedron, topology, torus};

    #[test]
    fn any_surface_of_more_than_one_face_comes_apart_in_two() {
        for mesh in [octahedron(), sheet(5, 4), tetrahedron(), torus(7, 5)] {
            let topology = topology(&mesh);
            for is_forbidden in [false, true] {
                let seams = two_parts(&mesh, &topology, |_| is_forbidden);
                let parts = split(&mesh, &topology, &seams).expect("parts");
                assert_eq!(parts.len(), 2);
                parts.iter().for_each(|part| part.topology.check().expect("lawful"));
            }
        }
    }
}
