//! A surface in two parts.

use crate::seams::interior_edges;
use crate::{FaceWalks, Seams};
use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{CornerId, FaceId, Point3, Topology, TriMesh, Vector3};

/// A crease of 60° or more makes the way across an edge longer by so many times.
const CREASE: f64 = 4.0;

/// The seams between two connected parts of one component: the faces nearer to the one and to the other of two faces far
/// apart, by ways from middle to middle that avoid creases. Edges that are forbidden are cut only where there are no
/// others: the faces beside them stay together.
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
    if mesh.face_count() == 0 {
        return Ok(Seams::none(topology));
    }
    let walks = FaceWalks::new(ways(mesh, topology), |f, k| is_forbidden(FaceId::new(f).corner(k)));
    checkpoint()?;
    let one = walks.farthest_from(0, checkpoint)?;
    let other = walks.farthest_from(one, checkpoint)?;
    let is_others = walks.nearer_to_second(one, other, checkpoint)?;
    let side = |c: CornerId| is_others[c.face().index()];
    Ok(Seams::where_edges(topology, |c, o| side(c) != side(o)))
}

/// The face beyond every side of every face, and the length of the way there.
fn ways(mesh: &TriMesh, topology: &Topology) -> Vec<[Option<(usize, f64)>; 3]> {
    let middles: Vec<Point3<f64>> =
        mesh.triangles().map(|[a, b, c]| Point3::from((a.coords + b.coords + c.coords) / 3.0)).collect();
    let normals: Vec<Vector3<f64>> = mesh.triangles().map(|[a, b, c]| (b - a).cross(&(c - a))).collect();
    let mut ways = vec![[None; 3]; mesh.face_count()];
    for (c, o) in interior_edges(topology) {
        let [f, g] = [c, o].map(|c| c.face().index());
        let turn = normals[f].cross(&normals[g]).norm().atan2(normals[f].dot(&normals[g]));
        let crease = (turn / std::f64::consts::FRAC_PI_3).min(1.0);
        let length = (middles[g] - middles[f]).norm() * (1.0 + CREASE * crease);
        ways[f][c.place()] = Some((g, length));
        ways[g][o.place()] = Some((f, length));
    }
    ways
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

    #[test]
    fn the_squares_of_a_sheet_are_not_cut_across_though_both_halves_are_equally_far() {
        for (m, n) in [(6, 6), (5, 5), (7, 4), (3, 1)] {
            let mesh = sheet(m, n);
            let topology = topology(&mesh);
            let is_diagonal = |c: CornerId| {
                let ends = crate::seams::ends(&topology, c).map(|v| mesh.positions()[v.index()]);
                ends[0].x != ends[1].x && ends[0].y != ends[1].y
            };
            let seams = two_parts(&mesh, &topology, is_diagonal);
            assert!(!seams.edges(&topology).any(is_diagonal), "{m} × {n}");
            assert_eq!(split(&mesh, &topology, &seams).expect("parts").len(), 2);
        }
    }
}
