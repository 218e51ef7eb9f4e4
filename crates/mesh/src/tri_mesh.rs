//! Coordinates and faces, as read: no promise about topology.

use abf_parallel::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use crate::{FaceId, Point3, VertexId};

/// Fewer faces are not worth a thread.
const FACES_PER_TASK: usize = 1 << 13;

/// A triangle mesh as a file gives it: vertices in their order, faces in theirs.
///
/// Faces refer to existing vertices (that is checked on construction); nothing else is promised.
/// Vertices that no face uses are kept.
#[derive(Clone, Debug, PartialEq)]
pub struct TriMesh {
    positions: Vec<Point3<f64>>,
    faces: Vec<[VertexId; 3]>,
}

/// What is wrong with the coordinates or indices of a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// A face names a vertex that does not exist.
    #[error("face {face} refers to vertex {vertex}, but there are only {vertex_count} vertices (both counted from 0)")]
    IndexOutOfRange {
        /// The face.
        face: FaceId,
        /// The index it names.
        vertex: usize,
        /// How many vertices there are.
        vertex_count: usize,
    },
    /// NaN or infinite coordinates.
    #[error("vertex {first} has a coordinate that is not finite ({count} in all)")]
    NotFinite {
        /// The first such vertex.
        first: VertexId,
        /// How many there are.
        count: usize,
    },
    /// Triangles whose corners lie on one line (or in one point) to rounding.
    #[error("face {first} has no area: its corners lie on one line ({count} in all)")]
    ZeroArea {
        /// The first such face.
        first: FaceId,
        /// How many there are.
        count: usize,
    },
}

impl TriMesh {
    /// A mesh of these vertices and faces (vertex indices counted from zero).
    ///
    /// # Errors
    /// [`GeometryError::IndexOutOfRange`] for the first face that names a missing vertex.
    pub fn new(positions: Vec<Point3<f64>>, faces: &[[usize; 3]]) -> Result<Self, GeometryError> {
        let vertex_count = positions.len();
        for (f, face) in faces.iter().enumerate() {
            if let Some(&vertex) = face.iter().find(|&&v| v >= vertex_count) {
                return Err(GeometryError::IndexOutOfRange { face: FaceId::new(f), vertex, vertex_count });
            }
        }
        let faces = faces.iter().map(|face| face.map(VertexId::new)).collect();
        Ok(Self { positions, faces })
    }

    /// A mesh of faces that are known to name vertices.
    pub(crate) fn of_ids(positions: Vec<Point3<f64>>, faces: Vec<[VertexId; 3]>) -> Self {
        debug_assert!(faces.iter().flatten().all(|v| v.index() < positions.len()));
        Self { positions, faces }
    }

    /// The vertices, in the order of the input.
    #[must_use]
    pub fn positions(&self) -> &[Point3<f64>] {
        &self.positions
    }

    /// The faces, in the order of the input, corners counter-clockwise.
    #[must_use]
    pub fn faces(&self) -> &[[VertexId; 3]] {
        &self.faces
    }

    /// How many vertices there are, used or not.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// How many faces there are.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// The three corner positions of a face.
    #[inline]
    #[must_use]
    pub fn triangle(&self, face: FaceId) -> [Point3<f64>; 3] {
        self.corners_of(&self.faces[face.index()])
    }

    /// Every face with its three corner positions.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = [Point3<f64>; 3]> + '_ {
        self.faces.iter().map(|face| self.corners_of(face))
    }

    fn corners_of(&self, face: &[VertexId; 3]) -> [Point3<f64>; 3] {
        face.map(|v| self.positions[v.index()])
    }

    /// The angle of every corner, in radians: `atan2(|e₁ × e₂|, e₁ · e₂)`, length `3 nt`.
    ///
    /// They sum to π in every triangle. Where two corners of one lie on each other its angles are the limit π/2, π/2, 0,
    /// where all three do, π/3. The two-argument arctangent keeps full relative accuracy for angles near 0, where the
    /// arc cosine of a normalised dot product has none.
    #[must_use]
    pub fn corner_angles(&self) -> Vec<f64> {
        let mut angles = vec![0.0; 3 * self.face_count()];
        let into = angles.as_chunks_mut::<3>().0.par_iter_mut().with_min_len(FACES_PER_TASK);
        into.zip(&self.faces).for_each(|(angles, face)| *angles = triangle_angles(&self.corners_of(face)));
        angles
    }

    /// The same mesh with every coordinate multiplied by a power of two, for coordinates so large or small that their
    /// products leave the range of doubles, and that power; `None` where they are not. Nothing is rounded but what is
    /// below 1e-290 of the largest coordinate.
    #[must_use]
    pub fn in_range(&self) -> Option<(Self, f64)> {
        let largest = self.positions.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
        let scale = power_into_range(largest)?;
        let positions = self.positions.iter().map(|p| p * scale).collect();
        Some((Self { positions, faces: self.faces.clone() }, scale))
    }

    /// The total area of the surface.
    #[must_use]
    pub fn area(&self) -> f64 {
        sum_by_block(&self.faces, |face| {
            let [a, b, c] = self.corners_of(face);
            0.5 * (b - a).cross(&(c - a)).norm()
        })
    }

    /// How many vertices no face refers to.
    #[must_use]
    pub fn unreferenced_vertices(&self) -> usize {
        let mut used = vec![false; self.vertex_count()];
        self.faces.iter().flatten().for_each(|v| used[v.index()] = true);
        used.iter().filter(|&&u| !u).count()
    }

    /// Checks that every coordinate is finite.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`] with the first vertex and the count.
    pub fn check_finite(&self) -> Result<(), GeometryError> {
        let bad = |p: &&Point3<f64>| !p.iter().all(|x| x.is_finite());
        let Some(first) = self.positions.iter().position(|p| bad(&p)) else { return Ok(()) };
        let count = self.positions.iter().filter(bad).count();
        Err(GeometryError::NotFinite { first: VertexId::new(first), count })
    }

    /// Checks that every coordinate is finite and every face has an area.
    ///
    /// A face has no area when `|e₁ × e₂|` is within the rounding of the product of its two
    /// longest edges; the test does not depend on the scale of the mesh.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`] or [`GeometryError::ZeroArea`], with the first and the count.
    pub fn check_geometry(&self) -> Result<(), GeometryError> {
        self.check_finite()?;
        let is_flat = |&f: &usize| has_no_area(&self.corners_of(&self.faces[f]));
        let faces = (0..self.face_count()).into_par_iter().with_min_len(FACES_PER_TASK);
        let flat: Vec<usize> = faces.filter(is_flat).collect();
        match flat.first() {
            Some(&first) => Err(GeometryError::ZeroArea { first: FaceId::new(first), count: flat.len() }),
            None => Ok(()),
        }
    }
}

/// The power of two that brings coordinates of which the largest has this size to a size of about 1; `None` where their
/// products are well within the range of doubles as they are.
pub(crate) fn power_into_range(largest: f64) -> Option<f64> {
    /// Fourth powers of what is in here, and of 1e-20 of it, are doubles.
    const SAFE: std::ops::RangeInclusive<f64> = 1e-50..=1e50;
    if largest == 0.0 || SAFE.contains(&largest) || !largest.is_finite() {
        return None;
    }
    // Subnormal numbers have no exponent of their own; 2^1000 brings them up as well as is needed.
    Some((-largest.log2().floor().clamp(-1000.0, 1000.0)).exp2())
}

/// The edges, multiplied by a power of two where their products would leave the range of doubles: a mesh may have
/// triangles of any size side by side.
fn in_range(edges: [nalgebra::Vector3<f64>; 3]) -> [nalgebra::Vector3<f64>; 3] {
    /// The fourth power of a length, which the norm of a cross product takes, is a normal number.
    const RANGE: std::ops::Range<f64> = 1e-70..1e70;
    let longest = edges.iter().fold(0.0, |max: f64, edge| max.max(edge.amax()));
    if RANGE.contains(&longest) || longest == 0.0 || !longest.is_finite() {
        return edges;
    }
    // In two halves, as one may be out of range itself.
    let half = (-longest.log2() / 2.0).round().exp2();
    edges.map(|edge| edge * half * half)
}

/// The three angles of one triangle, radians.
fn triangle_angles([a, b, c]: &[Point3<f64>; 3]) -> [f64; 3] {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    if a == b || b == c || c == a {
        return match (a == b, b == c, c == a) {
            (true, true, _) => [FRAC_PI_3; 3],
            (true, ..) => [FRAC_PI_2, FRAC_PI_2, 0.0],
            (_, true, _) => [0.0, FRAC_PI_2, FRAC_PI_2],
            _ => [FRAC_PI_2, 0.0, FRAC_PI_2],
        };
    }
    let [ab, bc, ca] = in_range([ab, bc, ca]);
    let angle = |out: nalgebra::Vector3<f64>, back: nalgebra::Vector3<f64>| {
        let back = -back;
        out.cross(&back).norm().atan2(out.dot(&back))
    };
    [angle(ab, ca), angle(bc, ab), angle(ca, bc)]
}

/// Whether the corners lie on one line, to the rounding of the cross product.
pub(crate) fn has_no_area([a, b, c]: &[Point3<f64>; 3]) -> bool {
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let longest = ab.norm_squared().max(ac.norm_squared()).max(bc.norm_squared());
    // The cross product of the two shorter edges loses the least.
    ab.cross(&ac).norm() <= ROUNDING * longest
}

/// The sum of a term for each face, taken block by block so that it has the same bits on any number of threads.
pub(crate) fn sum_by_block<F: Sync>(faces: &[F], term: impl Fn(&F) -> f64 + Sync) -> f64 {
    let blocks: Vec<f64> = faces.par_chunks(FACES_PER_TASK).map(|block| block.iter().map(&term).sum()).collect();
    blocks.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(points: &[[f64; 3]], faces: &[[usize; 3]]) -> TriMesh {
        TriMesh::new(points.iter().map(|&p| Point3::from(p)).collect(), faces).expect("indices in range")
    }

    #[test]
    fn angles_of_a_right_triangle_are_exact() {
        let m = mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
        let a = m.corner_angles();
        assert!((a[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert!((a[1] - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
        assert!((m.area() - 0.5).abs() < 1e-15);
    }

    #[test]
    fn angles_do_not_depend_on_the_size_of_the_triangle() {
        // Found by fuzzing: beside a vertex at 1e151 all three angles of an ordinary triangle were 0.
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.25, 0.75, 0.5]];
        let angles = |scale: f64| mesh(&points.map(|p| p.map(|x| x * scale)), &[[0, 1, 2]]).corner_angles();
        for exponent in [-1000, -700, -500, -300, 300, 500, 700, 1000] {
            assert_eq!(angles(2.0_f64.powi(exponent)), angles(1.0), "2^{exponent}");
        }
    }

    #[test]
    fn a_missing_vertex_is_named() {
        let e = TriMesh::new(vec![Point3::origin(); 3], &[[0, 1, 3]]).unwrap_err();
        assert_eq!(e, GeometryError::IndexOutOfRange { face: FaceId::new(0), vertex: 3, vertex_count: 3 });
    }

    #[test]
    fn faces_without_area_are_counted_at_any_scale() {
        for scale in [1e-30, 1.0, 1e30] {
            let points = [[0.0; 3], [scale, 0.0, 0.0], [2.0 * scale, 0.0, 0.0], [0.0, 1e-9 * scale, 0.0]];
            let m = mesh(&points, &[[0, 1, 3], [0, 1, 2], [1, 2, 0]]);
            let e = m.check_geometry().unwrap_err();
            assert_eq!(e, GeometryError::ZeroArea { first: FaceId::new(1), count: 2 });
        }
    }

    #[test]
    fn the_angles_of_collapsed_triangles_sum_to_a_straight_one() {
        let (p, q, r) = ([0.1, 0.2, 0.3], [1.0, 0.0, 2.0], [1.9, -0.2, 3.7]);
        let m = mesh(&[p, q, r, q, q], &[[0, 1, 3], [1, 0, 3], [1, 3, 0], [1, 3, 4], [0, 1, 2]]);
        let angles = m.corner_angles();
        for face in angles.chunks(3) {
            assert!((face.iter().sum::<f64>() - std::f64::consts::PI).abs() < 1e-14, "{face:?}");
        }
        assert_eq!(angles[..3], [0.0, FRAC_PI_2, FRAC_PI_2]);
        assert_eq!(angles[9..12], [FRAC_PI_3; 3]);
    }

    #[test]
    fn coordinates_at_the_ends_of_the_range_are_brought_back_by_a_power_of_two() {
        let points = [[0.0; 3], [1.0, 0.0, 0.3], [0.0, 0.7, 0.0]];
        assert_eq!(mesh(&points, &[[0, 1, 2]]).in_range(), None);
        for scale in [1e-300, 1e-150, 1e150, 1e300] {
            let extreme = mesh(&points.map(|p| p.map(|x| x * scale)), &[[0, 1, 2]]);
            let (inside, factor) = extreme.in_range().expect("out of range");
            assert!(inside.area() > 0.1 && inside.area() < 10.0);
            let back = inside.positions().iter().map(|p| p / factor);
            assert!(back.zip(extreme.positions()).all(|(p, q)| p == *q));
        }
    }

    #[test]
    fn coordinates_that_are_not_finite_are_counted() {
        let m = mesh(&[[0.0; 3], [f64::NAN, 0.0, 0.0], [0.0, f64::INFINITY, 0.0]], &[[0, 1, 2]]);
        let e = m.check_geometry().unwrap_err();
        assert_eq!(e, GeometryError::NotFinite { first: VertexId::new(1), count: 2 });
    }
}
