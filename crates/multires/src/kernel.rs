//! Where a vertex can be with all of its triangles counter-clockwise.

use abf_mesh::Point2;
use abf_mesh::predicates::orient2d;

/// A point to the left of all edges, counter-clockwise segments; `None` where doubles hold none.
///
/// It is the mean of the corners of the polygon that is left of a box when all edges have cut from it what is to their
/// right. The box is that of the edges; where they are no closed curve, three times as large.
pub(crate) fn inside(edges: &[[Point2<f64>; 2]], is_closed: bool) -> Option<Point2<f64>> {
    let mut polygon = enclosing(edges, if is_closed { 0.0 } else { 1.0 });
    for edge in edges {
        polygon = left_of(edge, &polygon);
    }
    let sum = polygon.iter().fold(Point2::origin(), |sum, p| sum + p.coords);
    let mean = sum / polygon.len() as f64;
    (!polygon.is_empty() && edges.iter().all(|&[a, b]| orient2d(a, b, mean) > 0.0)).then_some(mean)
}

/// The box of the edges, wider on every side by so many times its size.
fn enclosing(edges: &[[Point2<f64>; 2]], wider: f64) -> Vec<Point2<f64>> {
    let ends = edges.iter().flatten();
    let first = edges[0][0];
    let (low, high) = ends.fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    let margin = (high - low).amax() * wider;
    let (x, y) = ([low.x - margin, high.x + margin], [low.y - margin, high.y + margin]);
    vec![Point2::new(x[0], y[0]), Point2::new(x[1], y[0]), Point2::new(x[1], y[1]), Point2::new(x[0], y[1])]
}

/// The part of a convex polygon to the left of an edge (Sutherland and Hodgman 1974).
fn left_of(&[a, b]: &[Point2<f64>; 2], polygon: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &from) in polygon.iter().enumerate() {
        let to = polygon[(i + 1) % polygon.len()];
        let (here, there) = (orient2d(a, b, from), orient2d(a, b, to));
        if here >= 0.0 {
            kept.push(from);
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            kept.push(from + (to - from) * (here / (here - there)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(points: &[[f64; 2]], is_closed: bool) -> Vec<[Point2<f64>; 2]> {
        let count = if is_closed { points.len() } else { points.len() - 1 };
        (0..count).map(|i| [points[i].into(), points[(i + 1) % points.len()].into()]).collect()
    }

    #[test]
    fn the_kernel_of_a_star_is_found() {
        // An L: seen as a whole from its corner only.
        let l = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        let p = inside(&edges(&l, true), true).expect("a kernel");
        assert!(p.x > 0.0 && p.x < 1.0 && p.y > 0.0 && p.y < 1.0, "{p}");
    }

    #[test]
    fn a_polygon_that_is_no_star_has_no_kernel() {
        // A U.
        let u = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 3.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        assert_eq!(inside(&edges(&u, true), true), None);
    }

    #[test]
    fn an_open_curve_has_one_on_its_left_even_if_it_is_one_edge() {
        let p = inside(&edges(&[[1.0, 0.0], [2.0, 0.0]], false), false).expect("half a plane");
        assert!(p.y > 0.0, "{p}");
    }
}
