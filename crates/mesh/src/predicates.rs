//! Predicates of the plane whose sign is exact.

use crate::Point2;
use robust::Coord;

/// Twice the signed area of a triangle: positive when it is counter-clockwise, zero on one line.
///
/// The sign is exact, the size is rounded (Shewchuk 1997, adaptive `orient2d`). That holds as long as products of
/// coordinate differences do not underflow, which differences above 1e-120 never do. The differences are taken from `c`.
#[inline]
#[must_use]
pub fn orient2d(a: Point2<f64>, b: Point2<f64>, c: Point2<f64>) -> f64 {
    let coord = |p: Point2<f64>| Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// The angles of a counter-clockwise triangle, rad: `atan2(2A, e₁ · e₂)` at every corner. They are in (0, π) where
/// [`orient2d`] is positive.
#[inline]
#[must_use]
pub fn angles(&[a, b, c]: &[Point2<f64>; 3]) -> [f64; 3] {
    let double_area = orient2d(a, b, c);
    let (ab, bc, ca) = (b - a, c - b, a - c);
    [-ab.dot(&ca), -bc.dot(&ab), -ca.dot(&bc)].map(|dot| double_area.atan2(dot))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sign_is_exact_where_the_rounded_area_is_not() {
        // The last point is one unit in the last place off the diagonal through the others.
        let at = |y: f64| orient2d(Point2::new(12.0, 12.0), Point2::new(24.0, 24.0), Point2::new(0.5, y));
        assert_eq!(at(0.5), 0.0);
        assert!(at(0.5_f64.next_up()) > 0.0 && at(0.5_f64.next_down()) < 0.0);
    }
}
