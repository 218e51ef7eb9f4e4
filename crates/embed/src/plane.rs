//! One triangle in the plane: its orientation, its angles, their derivatives, and when it turns over.

use abf_linalg::Complex64;
pub(crate) use abf_mesh::predicates::angles;
use abf_mesh::predicates::orient2d;
use abf_mesh::{FaceId, Point2, Topology, Vector2};

/// The points, or the motions, of the three vertices of a face.
#[inline]
pub(crate) fn of_face<T: Copy>(topology: &Topology, per_vertex: &[T], face: FaceId) -> [T; 3] {
    topology.face_vertices(face).map(|v| per_vertex[v.index()])
}

/// Twice the signed area of a triangle, positive when counter-clockwise. The sign is exact, the size rounded
/// (Shewchuk's adaptive predicate).
#[inline]
pub(crate) fn orientation(&[a, b, c]: &[Point2<f64>; 3]) -> f64 {
    orient2d(a, b, c)
}

/// The faces that are not counter-clockwise: the first, and how many. Exact; NaN counts as one.
pub(crate) fn not_counter_clockwise(topology: &Topology, uv: &[Point2<f64>]) -> Option<(FaceId, usize)> {
    let mut bad = topology.faces().filter(|&f| !(orientation(&of_face(topology, uv, f)) > 0.0));
    let first = bad.next()?;
    Some((first, 1 + bad.count()))
}

/// Whether a counter-clockwise triangle has come to the resolution of doubles where it lies: so many roundings of its
/// coordinates could turn it over.
#[inline]
pub(crate) fn at_resolution(points: &[Point2<f64>; 3], roundings: f64) -> bool {
    let largest = points.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    let reach = (points[1] - points[0]).norm() + (points[2] - points[0]).norm();
    orientation(points) <= roundings * f64::EPSILON * largest * reach
}

/// The edge vectors of a triangle as complex numbers, edge `k` facing corner `k`, counter-clockwise.
#[inline]
pub(crate) fn edges([a, b, c]: &[Point2<f64>; 3]) -> [Complex64; 3] {
    [c - b, a - c, b - a].map(|e| Complex64::new(e.x, e.y))
}

/// The derivatives of the three angles by the coordinates of the three vertices, rad per unit of length.
///
/// The angle at `A` is `arg(C − A) − arg(B − A)`, and the gradient of `arg z` is `iz / |z|²`.
#[inline]
pub(crate) fn angle_derivatives(points: &[Point2<f64>; 3]) -> [[f64; 6]; 3] {
    let mut derivatives = [[0.0; 6]; 3];
    for (k, row) in derivatives.iter_mut().enumerate() {
        let (next, prev) = ((k + 1) % 3, (k + 2) % 3);
        let turned = |e: Vector2<f64>| Vector2::new(-e.y, e.x) / e.norm_squared();
        let (by_prev, by_next) = (turned(points[prev] - points[k]), -turned(points[next] - points[k]));
        for axis in 0..2 {
            row[2 * prev + axis] = by_prev[axis];
            row[2 * next + axis] = by_next[axis];
            row[2 * k + axis] = -by_prev[axis] - by_next[axis];
        }
    }
    derivatives
}

/// Adds `weight Σ |δe|² / |e|²` over the edges of a triangle to its second derivatives.
pub(crate) fn add_edge_damping(block: &mut [[f64; 6]; 6], points: &[Point2<f64>; 3], weight: f64) {
    for (k, edge) in edges(points).into_iter().enumerate() {
        let weight = weight / edge.norm_sqr();
        for axis in 0..2 {
            let (p, q) = (2 * ((k + 1) % 3) + axis, 2 * ((k + 2) % 3) + axis);
            block[p][p] += weight;
            block[q][q] += weight;
            block[p][q] -= weight;
            block[q][p] -= weight;
        }
    }
}

/// The smallest `s > 0` at which the triangle `points + s · motion` has no area; infinite if there is none.
///
/// Twice the area is the quadratic `A + B s + C s²` with the exact-signed `A > 0`; its roots are taken in the form
/// that does not cancel.
pub(crate) fn first_collapse(points: &[Point2<f64>; 3], motion: &[Vector2<f64>; 3]) -> f64 {
    let e = [points[1] - points[0], points[2] - points[0]];
    let d = [motion[1] - motion[0], motion[2] - motion[0]];
    let (a, b, c) = (orientation(points), e[0].perp(&d[1]) + d[0].perp(&e[1]), d[0].perp(&d[1]));
    let discriminant = b * b - 4.0 * a * c;
    if b >= 0.0 {
        // Growing at first: only a concave parabola comes down again.
        if c < 0.0 { (b + discriminant.sqrt()) / (-2.0 * c) } else { f64::INFINITY }
    } else if discriminant >= 0.0 {
        2.0 * a / (discriminant.sqrt() - b)
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [[f64; 2]; 3] = [[0.1, 0.2], [1.3, -0.4], [0.7, 0.9]];

    fn points() -> [Point2<f64>; 3] {
        TRIANGLE.map(Point2::from)
    }

    #[test]
    fn angles_sum_to_a_straight_one_and_change_as_their_derivatives_say() {
        let at = angles(&points());
        assert!((at.iter().sum::<f64>() - std::f64::consts::PI).abs() < 1e-15);
        let derivatives = angle_derivatives(&points());
        let step = 1e-6;
        for column in 0..6 {
            let mut moved = points();
            moved[column / 2][column % 2] += step;
            let (moved, mut back) = (angles(&moved), points());
            back[column / 2][column % 2] -= step;
            let back = angles(&back);
            for k in 0..3 {
                let slope = (moved[k] - back[k]) / (2.0 * step);
                assert!((slope - derivatives[k][column]).abs() < 1e-9, "{k} {column}");
            }
        }
    }

    #[test]
    fn a_triangle_comes_to_the_resolution_of_doubles_by_being_small_far_from_the_origin() {
        let scaled = |scale: f64, x: f64| points().map(|p| Point2::new(x + scale * p.x, scale * p.y));
        assert!(!at_resolution(&scaled(1e-13, 0.0), 32.0));
        assert!(!at_resolution(&scaled(1e-12, 1.0), 32.0));
        assert!(at_resolution(&scaled(1e-15, 1.0), 32.0));
        assert!(at_resolution(&scaled(1e-12, 1.0), 32768.0));
    }

    #[test]
    fn the_first_collapse_is_where_the_area_vanishes() {
        let motions = [[[0.0, 0.0], [0.0, 0.0], [-0.5, -2.0]], [[0.3, 0.1], [-1.0, 0.8], [0.4, -0.9]]];
        for motion in motions.map(|m| m.map(Vector2::from)) {
            let s = first_collapse(&points(), &motion);
            let at = |s: f64| orientation(&[0, 1, 2].map(|k| points()[k] + motion[k] * s));
            assert!(at(s).abs() < 1e-14 && (1..100).all(|i| at(s * f64::from(i) / 100.0) > 0.0));
        }
        let growing = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Vector2::from);
        assert_eq!(first_collapse(&points(), &growing), f64::INFINITY);
    }
}
