//! Which four boundary vertices are best made the corners of a rectangle.
//!
//! Seen from the free solution, the boundary edge `e` has the direction `T`, the sum of the turns `π − Σx` up to it. In
//! the rectangle it has one of four, a quarter turn apart. The corners are where the direction changes so that
//!
//! ```text
//! Σ ℓ (T − T₀ − k π/2)²        k = 0 … 4, never less than at the edge before,
//! ```
//!
//! is least, for the best `T₀`: dynamic programming along the boundary, the side it begins on being also the one it ends on.

use abf_constraints::{BoundaryError, boundary_loop};
use abf_mesh::{Topology, TriMesh, VertexId};
use std::f64::consts::{FRAC_PI_2, PI};

/// In so many steps of a half turn the direction of the first side is tried.
const DIRECTIONS: usize = 64;

/// The side the boundary begins on comes again at its end.
const SIDES: usize = 5;

/// The four vertices, in the order of the boundary.
///
/// # Errors
/// [`BoundaryError`] when the boundary has fewer than four vertices, more than four of them are in one triangle only, or the
/// angles are no numbers.
pub(super) fn best_corners(mesh: &TriMesh, topology: &Topology, angles: &[f64]) -> Result<[u32; 4], BoundaryError> {
    let all = boundary_loop(topology);
    let n = all.len();
    if n < 4 {
        return Err(BoundaryError::TooFew(n));
    }
    let at = |j: usize| mesh.positions()[all[j % n].index()];
    let edges = Edges {
        lengths: (0..n).map(|j| (at(j + 1) - at(j)).norm()).collect(),
        directions: directions(topology, &all, angles),
        is_ear: all.iter().map(|&v| topology.fan(v).count() == 1).collect(),
    };
    let start = |k: usize| -FRAC_PI_2 + PI * k as f64 / DIRECTIONS as f64;
    let best = (0..DIRECTIONS).filter_map(|k| edges.corners(start(k))).min_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        Some((_, corners)) => Ok(corners.map(|j| all[j].index() as u32)),
        None => Err(match (0..n).filter(|&j| edges.is_ear[j]).nth(4) {
            Some(ear) => BoundaryError::Ear { vertex: all[ear].index() as u32, angle: PI },
            None => BoundaryError::NoCorners,
        }),
    }
}

/// The direction of every boundary edge, rad, that of the first being 0: edge `j` runs from vertex `j` to the next.
fn directions(topology: &Topology, all: &[VertexId], angles: &[f64]) -> Vec<f64> {
    let turn = |v: VertexId| PI - topology.fan(v).map(|c| angles[c.index()]).sum::<f64>();
    let mut direction = 0.0;
    let mut directions = vec![0.0];
    for &v in &all[1..] {
        direction += turn(v);
        directions.push(direction);
    }
    directions
}

/// The boundary, edge by edge.
struct Edges {
    lengths: Vec<f64>,
    directions: Vec<f64>,
    /// Whether the vertex an edge begins at is in one triangle only: it has to be a corner.
    is_ear: Vec<bool>,
}

impl Edges {
    /// The least cost with the first side in this direction, and where the sides begin.
    fn corners(&self, start: f64) -> Option<(f64, [usize; 4])> {
        let n = self.lengths.len();
        let cost = |j: usize, k: usize| self.lengths[j] * (self.directions[j] - start - k as f64 * FRAC_PI_2).powi(2);
        // Whether the first vertex is a corner is decided at the end: the last side is then the fourth.
        let mut costs = [f64::INFINITY; SIDES];
        costs[0] = cost(0, 0);
        let mut turned = vec![[false; SIDES]; n];
        for (j, turned) in turned.iter_mut().enumerate().skip(1) {
            let before = costs;
            for (k, turned) in turned.iter_mut().enumerate() {
                let stays = if self.is_ear[j] { f64::INFINITY } else { before[k] };
                let turns = if k > 0 { before[k - 1] } else { f64::INFINITY };
                *turned = turns < stays;
                costs[k] = cost(j, k) + stays.min(turns);
            }
        }
        // Four turns within, or three and one at the first vertex, which an ear there insists on.
        let last = if self.is_ear[0] || costs[SIDES - 2] < costs[SIDES - 1] { SIDES - 2 } else { SIDES - 1 };
        if !costs[last].is_finite() {
            return None;
        }
        let mut corners = Vec::new();
        let mut k = last;
        for j in (1..n).rev().filter(|_| last > 0) {
            if turned[j][k] {
                corners.push(j);
                k -= 1;
            }
        }
        if last < SIDES - 1 {
            corners.push(0);
        }
        corners.reverse();
        corners.try_into().ok().map(|corners| (costs[last], corners))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::Point3;

    /// A flat grid of `w` × `h` squares, and the numbers of its corners.
    fn grid(w: usize, h: usize) -> (TriMesh, [u32; 4]) {
        let index = |i: usize, j: usize| j * (w + 1) + i;
        let points = (0..=h).flat_map(|j| (0..=w).map(move |i| Point3::new(i as f64, j as f64, 0.0))).collect();
        let squares = (0..h).flat_map(|j| (0..w).map(move |i| (i, j)));
        // The diagonals run so that no corner is in one triangle only.
        let faces: Vec<[usize; 3]> = squares
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
                if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
            })
            .collect();
        let corners = [index(0, 0), index(w, 0), index(w, h), index(0, h)].map(|v| v as u32);
        (TriMesh::new(points, &faces).expect("indices in range"), corners)
    }

    #[test]
    fn the_corners_of_a_flat_rectangle_are_found() {
        let (mesh, mut expected) = grid(6, 3);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let mut corners = best_corners(&mesh, &topology, &mesh.corner_angles()).expect("four");
        corners.sort_unstable();
        expected.sort_unstable();
        assert_eq!(corners, expected);
    }

    #[test]
    fn angles_that_are_no_numbers_are_blamed_on_no_vertex() {
        let (mesh, _) = grid(6, 3);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let error = best_corners(&mesh, &topology, &vec![f64::NAN; 3 * mesh.face_count()]).unwrap_err();
        assert_eq!(error, BoundaryError::NoCorners);
    }

    #[test]
    fn more_than_four_ears_are_refused_by_name() {
        let ring = |k: usize| {
            let (y, x) = (k as f64).sin_cos();
            Point3::new(x, y, 0.0)
        };
        // A hexagon inside, and a triangle on each of its sides.
        let mut faces: Vec<[usize; 3]> = (1..5).map(|k| [0, k, k + 1]).collect();
        faces.extend((0..6).map(|k| [(k + 1) % 6, k, 6 + k]));
        let mesh = TriMesh::new((0..12).map(ring).collect(), &faces).expect("indices in range");
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let error = best_corners(&mesh, &topology, &vec![1.0; 3 * faces.len()]).unwrap_err();
        assert!(matches!(error, BoundaryError::Ear { .. }), "{error}");
    }
}
