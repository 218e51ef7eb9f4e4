//! Where the layout ends: boundary edges and seams; and where it does not: edges within.

use abf_mesh::{CornerId, TriMesh, UvMap};

/// The edges of a layout, each named by the corner it starts at, in ascending order.
///
/// Edge `c` runs from corner `c` to the next corner of its face. Two faces are joined at an edge
/// of the surface if no third one is there and the UVs of both its ends agree; otherwise the edge
/// is a boundary or a seam. What counts is the place of a vertex, not its index: files that repeat
/// a vertex for every face have no other outline.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Edges {
    /// Edges with the layout on one side only. Each face at a seam has its own.
    pub(crate) open: Vec<CornerId>,
    /// Those of the open edges that are none on the surface.
    pub(crate) seams: Vec<CornerId>,
    /// For each of the seams the places of its ends, the lower one first.
    pub(crate) seam_ends: Vec<[u32; 2]>,
    /// Edges between two faces of the layout, with their corners in both.
    pub(crate) joined: Vec<[CornerId; 2]>,
    /// The places on the boundary of the surface, ascending.
    pub(crate) rims: Vec<u32>,
    place: Vec<u32>,
}

impl Edges {
    /// Sorts out the edges of a layout.
    pub(crate) fn of(mesh: &TriMesh, uv: &UvMap) -> Self {
        let place = places(mesh);
        let place_of = |c: CornerId| place[mesh.faces()[c.face().index()][c.place()].index()];
        let ends = |c: CornerId| {
            let (from, to) = (place_of(c), place_of(c.next()));
            [from.min(to), from.max(to)]
        };
        // Whether the layout, too, has both ends of two edges of the surface in common.
        let agree = |c: CornerId, d: CornerId| {
            let [from, to, start, end] = [c, c.next(), d, d.next()].map(|c| uv.corner(c));
            if place_of(c) == place_of(d) { (from, to) == (start, end) } else { (from, to) == (end, start) }
        };
        let mut all: Vec<([u32; 2], CornerId)> =
            (0..3 * mesh.face_count()).map(CornerId::new).map(|c| (ends(c), c)).collect();
        all.sort_unstable();
        let (mut open, mut seams, mut joined, mut rims) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for same in all.chunk_by(|(a, _), (b, _)| a == b) {
            let (ends, _) = same[0];
            let mut left: Vec<CornerId> = same.iter().map(|&(_, c)| c).collect();
            // Of several faces at an edge, two that agree are joined.
            while let Some(c) = (!left.is_empty()).then(|| left.remove(0)) {
                match left.iter().position(|&d| agree(c, d)) {
                    Some(other) => joined.push([c, left.remove(other)]),
                    None => {
                        open.push(c);
                        if same.len() > 1 {
                            seams.push((c, ends));
                        } else {
                            rims.extend(ends);
                        }
                    }
                }
            }
        }
        open.sort_unstable();
        seams.sort_unstable();
        joined.sort_unstable();
        rims.sort_unstable();
        rims.dedup();
        let (seams, seam_ends) = seams.into_iter().unzip();
        Self { open, seams, seam_ends, joined, rims, place }
    }

    /// The lowest vertex in the place where an edge begins.
    pub(crate) fn place_of(&self, mesh: &TriMesh, c: CornerId) -> u32 {
        self.place[mesh.faces()[c.face().index()][c.place()].index()]
    }
}

/// For every vertex the lowest index among the vertices in exactly its place.
fn places(mesh: &TriMesh) -> Vec<u32> {
    // Adding zero makes −0 and +0 the same bits.
    let bits = |v: u32| mesh.positions()[v as usize].coords.map(|x| (x + 0.0).to_bits());
    let mut order: Vec<([u64; 3], u32)> = (0..mesh.vertex_count() as u32).map(|v| (bits(v).into(), v)).collect();
    order.sort_unstable();
    let mut place = vec![0; order.len()];
    for same in order.chunk_by(|(a, _), (b, _)| a == b) {
        let (_, lowest) = same[0];
        same.iter().for_each(|&(_, v)| place[v as usize] = lowest);
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::{Point2, Point3, UvId};

    fn square() -> TriMesh {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        TriMesh::new(corners.map(Point3::from).to_vec(), &[[0, 1, 2], [0, 2, 3]]).expect("indices in range")
    }

    /// The UVs of the square with a point of its own for every corner, the second face moved by `shift`.
    fn unwelded(shift: f64) -> UvMap {
        let mesh = square();
        let points = mesh
            .triangles()
            .flatten()
            .enumerate()
            .map(|(c, p)| Point2::new(p.x + if c < 3 { 0.0 } else { shift }, p.y));
        UvMap::new(points.collect(), (0..6).map(UvId::new).collect())
    }

    /// The open edges, the seams and the joined edges of a layout of the square.
    fn edges(uv: &UvMap) -> [Vec<usize>; 3] {
        let Edges { open, seams, joined, .. } = Edges::of(&square(), uv);
        let joined = joined.into_iter().map(|[c, _]| c).collect();
        [open, seams, joined].map(|list| list.into_iter().map(CornerId::index).collect())
    }

    #[test]
    fn the_diagonal_of_a_square_is_not_part_of_its_outline() {
        assert_eq!(edges(&unwelded(0.0)), [vec![0, 1, 4, 5], vec![], vec![2]]);
    }

    #[test]
    fn vertices_repeated_for_every_face_do_not_change_the_outline() {
        let corners: Vec<Point3<f64>> = square().triangles().flatten().collect();
        let soup = TriMesh::new(corners, &[[0, 1, 2], [3, 4, 5]]).expect("indices in range");
        let (one, other) = (Edges::of(&soup, &unwelded(0.0)), Edges::of(&square(), &unwelded(0.0)));
        assert_eq!((one.open, one.seams, one.joined), (other.open, other.seams, other.joined));
    }

    #[test]
    fn both_sides_of_a_seam_are_part_of_the_outline() {
        assert_eq!(edges(&unwelded(3.0)), [vec![0, 1, 2, 3, 4, 5], vec![2, 3], vec![]]);
    }
}
