//! The shape that every triangle has on the surface, and shapes on the way to it.

use super::linear::{Linear, Singular};
use crate::plane::of_face;
use abf_mesh::{FaceId, Point2, Point3, Topology, TriMesh, Vector2};

/// A triangle whose height is less than this part of its longest edge is taken for one with that height: those without
/// area, too, have a shape then.
const LEAST_HEIGHT: f64 = 1e-4;

/// A triangle whose longest edge is less than this part of the side of a square as large as the surface is taken for one
/// with that edge.
const LEAST_EDGE: f64 = 1e-9;

/// What is asked of a triangle at most on the way to a drawing that is far: `s₁² + s₂² + s₁⁻² + s₂⁻²`, which is 4 where
/// lengths are kept (Liu, Ye, Ni, Fu 2018).
const REACH: f64 = 10.0;

/// A triangle at rest, in its own plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RestShape {
    /// Of the corner `i`, `b_i` with `J = Σ u_i b_iᵀ` for the drawing `u`.
    pub(crate) dual: [Vector2<f64>; 3],
    /// One over twice its area.
    pub(crate) inverse_double_area: f64,
    /// Its part of the area of the surface.
    pub(crate) weight: f64,
}

/// The shapes of all faces of a surface; the weights add up to 1.
pub(crate) fn rest_shapes(mesh: &TriMesh) -> Vec<RestShape> {
    let unit = (mesh.area() / mesh.face_count().max(1) as f64).sqrt();
    let least_edge = (LEAST_EDGE * mesh.area().sqrt()).max(f64::MIN_POSITIVE.sqrt());
    let shapes = mesh.triangles().map(|points| flattened(&points, least_edge.min(unit)));
    let mut shapes: Vec<RestShape> = shapes.map(|points| RestShape::of_plane(&points, 0.0)).collect();
    let total: f64 = shapes.iter().map(|shape| shape.inverse_double_area.recip()).sum();
    for shape in &mut shapes {
        shape.weight = shape.inverse_double_area.recip() / total;
    }
    shapes
}

/// The shapes that a drawing can reach in one go: of the triangles that are too far from their own, as much of the way as
/// [`REACH`] allows. And how many those are.
pub(crate) fn within_reach(topology: &Topology, uv: &[Point2<f64>], rest: &[RestShape]) -> (Vec<RestShape>, usize) {
    let mut limited = 0;
    let of = |(face, rest): (FaceId, &RestShape)| {
        let Singular { values, v, .. } = rest.linear(&of_face(topology, uv, face)).singular();
        let share = reachable(values);
        if share >= 1.0 {
            return *rest;
        }
        limited += 1;
        let factors = values.map(|s| s.powf(share - 1.0));
        let dual = rest.dual.map(|b| v[0] * (factors[0] * v[0].dot(&b)) + v[1] * (factors[1] * v[1].dot(&b)));
        let inverse_double_area = rest.inverse_double_area * factors[0] * factors[1];
        RestShape { dual, inverse_double_area, weight: rest.weight }
    };
    (topology.faces().zip(rest).map(of).collect(), limited)
}

/// The largest `t ≤ 1` at which `s₁^2t + s₁^−2t + s₂^2t + s₂^−2t` is within [`REACH`].
fn reachable(values: [f64; 2]) -> f64 {
    const HALVINGS: usize = 50;
    let logs = values.map(f64::ln);
    let is_within = |t: f64| logs.iter().map(|log| 2.0 * (2.0 * t * log).cosh()).sum::<f64>() <= REACH;
    if is_within(1.0) {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is_within(middle) { low = middle } else { high = middle }
    }
    low
}

impl RestShape {
    /// A counter-clockwise triangle of the plane.
    pub(crate) fn of_plane(&[a, b, c]: &[Point2<f64>; 3], weight: f64) -> Self {
        let (e, f) = (b - a, c - a);
        let inverse_double_area = e.perp(&f).recip();
        // The rows of the inverse of the matrix with the columns e and f.
        let of_b = Vector2::new(f.y, -f.x) * inverse_double_area;
        let of_c = Vector2::new(-e.y, e.x) * inverse_double_area;
        Self { dual: [-(of_b + of_c), of_b, of_c], inverse_double_area, weight }
    }

    /// The Jacobian of the map to a triangle of a drawing.
    #[inline]
    pub(crate) fn linear(&self, &[p, q, r]: &[Point2<f64>; 3]) -> Linear {
        let (e, f) = (q - p, r - p);
        let [_, of_b, of_c] = self.dual;
        Linear {
            a: e.x * of_b.x + f.x * of_c.x,
            b: e.x * of_b.y + f.x * of_c.y,
            c: e.y * of_b.x + f.y * of_c.x,
            d: e.y * of_b.y + f.y * of_c.y,
        }
    }
}

/// A triangle of space in the plane, with the height that it has at least.
fn flattened(points: &[Point3<f64>; 3], least_edge: f64) -> [Point2<f64>; 3] {
    let lengths = [0, 1, 2].map(|k| (points[(k + 2) % 3] - points[(k + 1) % 3]).norm());
    let longest = (0..3).max_by(|&i, &j| lengths[i].total_cmp(&lengths[j])).unwrap_or(0);
    let (from, to) = ((longest + 1) % 3, (longest + 2) % 3);
    let base = lengths[longest].max(least_edge);
    let along = (points[to] - points[from]) / lengths[longest];
    let side = points[longest] - points[from];
    let (foot, height) = if lengths[longest] > 0.0 {
        // The cross product keeps the digits of a flat triangle.
        (side.dot(&along), along.cross(&side).norm())
    } else {
        (0.5 * base, 0.0)
    };
    let mut flat = [Point2::origin(); 3];
    flat[to] = Point2::new(base, 0.0);
    flat[longest] = Point2::new(foot, height.max(LEAST_HEIGHT * base));
    flat
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_shapes::Shape;

    #[test]
    fn a_triangle_of_space_keeps_its_edges_and_its_orientation() {
        let points = [[0.1, 0.2, 0.3], [1.0, -0.4, 0.2], [0.5, 0.9, -0.7]].map(Point3::from);
        for turn in 0..3 {
            let points = [0, 1, 2].map(|k| points[(k + turn) % 3]);
            let flat = flattened(&points, 0.0);
            assert!((flat[1] - flat[0]).perp(&(flat[2] - flat[0])) > 0.0);
            for k in 0..3 {
                let (in_space, in_plane) =
                    ((points[k] - points[(k + 1) % 3]).norm(), (flat[k] - flat[(k + 1) % 3]).norm());
                assert!((in_space - in_plane).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn a_triangle_without_area_has_a_thin_shape_and_weighs_little() {
        let mesh = TriMesh::new(
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]
                .map(Point3::from)
                .to_vec(),
            &[[0, 1, 2], [1, 0, 3], [3, 4, 5]],
        );
        let shapes = rest_shapes(&mesh.expect("indices in range"));
        assert!((shapes.iter().map(|s| s.weight).sum::<f64>() - 1.0).abs() < 1e-15);
        assert!(shapes[1].weight < 1e-3 && shapes[1].weight > 0.0 && shapes[2].weight > 0.0);
        assert!(shapes.iter().all(|s| s.inverse_double_area.is_finite() && s.inverse_double_area > 0.0));
    }

    #[test]
    fn shapes_within_reach_are_those_of_the_surface_where_they_can_be_and_near_the_drawing_elsewhere() {
        let mesh = Shape::BumpySheet.mesh(200);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let rest = rest_shapes(&mesh);
        let drawing = |scale: f64| -> Vec<Point2<f64>> {
            mesh.positions().iter().map(|p| Point2::new(scale * p.x, scale * p.y)).collect()
        };
        let (_, limited) = within_reach(&topology, &drawing(1.0), &rest);
        assert_eq!(limited, 0);
        let far = drawing(1e6);
        let (reached, limited) = within_reach(&topology, &far, &rest);
        assert_eq!(limited, mesh.face_count());
        for face in topology.faces() {
            let shape = &reached[face.index()];
            let values = shape.linear(&of_face(&topology, &far, face)).singular().values;
            let asked: f64 = values.iter().map(|s| s * s + (s * s).recip()).sum();
            assert!((asked - REACH).abs() < 1e-6, "{asked}");
        }
    }
}
