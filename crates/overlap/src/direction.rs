//! Directions around a point of the plane, compared exactly.

use abf_mesh::Point2;
use abf_mesh::predicates::orient2d;
use std::cmp::Ordering;

/// Whether the direction from `centre` to `p` lies in the half-turn that begins at the positive x axis.
pub(crate) fn is_upper(centre: Point2<f64>, p: Point2<f64>) -> bool {
    p.y > centre.y || (p.y == centre.y && p.x > centre.x)
}

/// The order of two directions counter-clockwise from the positive x axis. Neither point may be `centre`.
pub(crate) fn compare(centre: Point2<f64>, a: Point2<f64>, b: Point2<f64>) -> Ordering {
    match (is_upper(centre, a), is_upper(centre, b)) {
        (true, false) => Ordering::Less,
        (false, true) => Ordering::Greater,
        // To turn left from a to b means that a comes first.
        _ => 0.0.partial_cmp(&orient2d(centre, a, b)).unwrap_or(Ordering::Equal),
    }
}
