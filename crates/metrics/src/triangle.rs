//! One triangle in space, one in the plane, and the affine map between them.

use abf_mesh::predicates::orient2d;
use abf_mesh::{Point2, Point3};
use nalgebra::{Point, SVector as Vector};
use std::f64::consts::PI;

/// The power of two `s` that brings `largest` into `[1, 2)`.
///
/// Scaling coordinates by it keeps every bit of them, where dividing by a length would move points
/// and could turn triangles over. Zero and subnormal numbers get the largest power there is, and
/// the topmost binade of f64 lands in `[2, 4)`.
pub(crate) fn power_of_two_scale(largest: f64) -> f64 {
    const MANTISSA_BITS: u32 = f64::MANTISSA_DIGITS - 1;
    const EXPONENT_MASK: u64 = 0x7ff;
    /// The biased exponents of `x` and `1/x` add up to this when both are powers of two.
    const TWICE_BIAS: u64 = 2 * 1023;
    let exponent = (largest.to_bits() >> MANTISSA_BITS) & EXPONENT_MASK;
    f64::from_bits(TWICE_BIAS.saturating_sub(exponent).max(1) << MANTISSA_BITS)
}

/// The corners in the same cyclic order, the one that faces the longest edge first.
///
/// Edge vectors taken from there are the two shorter ones: their product loses the least.
fn shortest_edges_first<const D: usize>(&[a, b, c]: &[Point<f64, D>; 3]) -> [Point<f64, D>; 3] {
    let (ab, bc, ca) = ((b - a).norm_squared(), (c - b).norm_squared(), (a - c).norm_squared());
    if bc >= ab && bc >= ca {
        [a, b, c]
    } else if ca >= ab {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// The area of a triangle in space.
pub(crate) fn surface_area(corners: &[Point3<f64>; 3]) -> f64 {
    let [a, b, c] = shortest_edges_first(corners);
    0.5 * (b - a).cross(&(c - a)).norm()
}

/// The area of a triangle in the plane, positive when counter-clockwise.
///
/// The size is rounded, the sign is exact: zero if and only if the three points lie on one line.
/// That holds as long as products of coordinate differences do not underflow, which after
/// [`power_of_two_scale`] asks for differences above 1e-120.
pub(crate) fn signed_uv_area(corners: &[Point2<f64>; 3]) -> f64 {
    // The predicate takes its differences from its last argument.
    let [a, b, c] = shortest_edges_first(corners);
    0.5 * orient2d(b, c, a)
}

/// The three angles, in radians, of a triangle of this area: `atan2(2A, e₁ · e₂)` at every corner.
///
/// The two-argument arctangent keeps full relative accuracy for angles near 0, where the arc
/// cosine of a normalised dot product has none. An angle between edges of which one has no length
/// is 0.
pub(crate) fn angles<const D: usize>([a, b, c]: &[Point<f64, D>; 3], area: f64) -> [f64; 3] {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    // Adding zero makes −0 positive: atan2(0, −0) would be π.
    let angle = |e: Vector<f64, D>, f: Vector<f64, D>| (2.0 * area).atan2(e.dot(&-f) + 0.0);
    if !(area > 0.0) {
        return [angle(ab, ca), angle(bc, ab), angle(ca, bc)];
    }
    // The angle that faces the longest edge is at least π/3: what the other two leave of π has all its digits.
    let [facing_a, facing_b, facing_c] = [bc, ca, ab].map(|edge| edge.norm_squared());
    if facing_a >= facing_b && facing_a >= facing_c {
        let (at_b, at_c) = (angle(bc, ab), angle(ca, bc));
        [PI - at_b - at_c, at_b, at_c]
    } else if facing_b >= facing_c {
        let (at_a, at_c) = (angle(ab, ca), angle(ca, bc));
        [at_a, PI - at_a - at_c, at_c]
    } else {
        let (at_a, at_b) = (angle(ab, ca), angle(bc, ab));
        [at_a, at_b, PI - at_a - at_b]
    }
}

/// The cotangents of the three angles of a triangle of this area, `e₁ · e₂ / 2A`, in `[−∞, ∞]`; as for
/// [`angles`], the angle between edges of which one has no length is 0.
pub(crate) fn cotangents([a, b, c]: &[Point2<f64>; 3], area: f64) -> [f64; 3] {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    [ab.dot(&-ca), bc.dot(&-ab), ca.dot(&-bc)].map(|dot| match dot / (2.0 * area) {
        cot if cot.is_nan() => f64::INFINITY,
        cot => cot,
    })
}

/// The larger singular value of the affine map from a UV triangle of area `uv_area > 0` to a
/// triangle in space.
///
/// The map's Jacobian is `E D⁻¹` with the edge vectors as columns of E (3 × 2) and D (2 × 2), and
/// `D⁻¹ = adj D / det D`. The largest eigenvalue of its Gram matrix `[a b; b c]` is
/// `(a + c + √((a − c)² + 4b²)) / 2` (Sander et al. 2001, §3). The smaller singular value need not
/// be computed from the same matrix, where it would cancel: the product of both is the ratio of
/// the areas.
pub(crate) fn largest_singular_value(surface: &[Point3<f64>; 3], uv: &[Point2<f64>; 3], uv_area: f64) -> f64 {
    let [e1, e2] = [surface[1] - surface[0], surface[2] - surface[0]];
    let [d1, d2] = [uv[1] - uv[0], uv[2] - uv[0]];
    // The columns of E adj D; its determinant is divided by at the end, once.
    let along_u = e1 * d2.y - e2 * d1.y;
    let along_v = e2 * d1.x - e1 * d2.x;
    let (a, b, c) = (along_u.norm_squared(), along_u.dot(&along_v), along_v.norm_squared());
    (0.5 * (a + c + (a - c).hypot(2.0 * b))).sqrt() / (2.0 * uv_area)
}

/// Whether a UV triangle has no more area than the rounding of its coordinates can make:
/// `A₂ ≤ 4 ε · max |coordinate| · (|e₁| + |e₂|)`, with the edges at the first corner.
///
/// Coordinates that move by δ each change the area by at most `√2 δ (|e₁| + |e₂|) + 4 δ²`, so with
/// `δ = ε · max |coordinate|` no triangle that this could turn over is missed; the last term matters for
/// edges of less than 2 δ only, whose area is below the bound anyway.
pub(crate) fn is_within_rounding(corners: &[Point2<f64>; 3], uv_area: f64, epsilon: f64) -> bool {
    const ROUNDING: f64 = 4.0;
    let largest = corners.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    let edges = (corners[1] - corners[0]).norm() + (corners[2] - corners[0]).norm();
    uv_area <= ROUNDING * epsilon * largest * edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    #[test]
    fn the_scale_is_a_power_of_two_and_lands_near_one() {
        for x in [1.0, 1.5, 0.3, 1e-300, 1e300, f64::MIN_POSITIVE] {
            let scale = power_of_two_scale(x);
            assert_eq!(scale.to_bits() << 12, 0, "{x} gives {scale}");
            assert!((1.0..2.0).contains(&(x * scale)), "{x} gives {}", x * scale);
        }
        assert!((2.0..4.0).contains(&(f64::MAX * power_of_two_scale(f64::MAX))));
        assert!(power_of_two_scale(0.0).is_finite() && power_of_two_scale(5e-324).is_finite());
    }

    #[test]
    fn the_sign_of_an_area_is_exact_where_the_rounded_area_is_not() {
        // The last point is one unit in the last place off the diagonal through the others.
        let corners = |y: f64| [Point2::new(12.0, 12.0), Point2::new(24.0, 24.0), Point2::new(0.5, y)];
        assert_eq!(signed_uv_area(&corners(0.5)), 0.0);
        assert!(signed_uv_area(&corners(0.5_f64.next_up())) > 0.0);
        assert!(signed_uv_area(&corners(0.5_f64.next_down())) < 0.0);
    }

    #[test]
    fn the_sign_of_an_area_does_not_depend_on_the_first_corner() {
        let [a, b, c] = [Point2::new(0.0, 0.0), Point2::new(3.0, 0.1), Point2::new(1.0, 2.0)];
        for turned in [[a, b, c], [b, c, a], [c, a, b]] {
            assert!(signed_uv_area(&turned) > 0.0);
        }
        assert!(signed_uv_area(&[a, c, b]) < 0.0);
    }

    #[test]
    fn angles_in_the_plane_and_in_space_agree_with_the_right_triangle() {
        let expected = [FRAC_PI_2, FRAC_PI_4, FRAC_PI_4];
        let flat = [Point2::new(1.0, 1.0), Point2::new(2.0, 1.0), Point2::new(1.0, 2.0)];
        let spatial = flat.map(|p| Point3::new(p.x, p.y, 7.0));
        let both = [angles(&flat, signed_uv_area(&flat)), angles(&spatial, surface_area(&spatial))];
        for (found, wanted) in both.iter().flat_map(|found| found.iter().zip(expected)) {
            assert!((found - wanted).abs() < 1e-15, "{found} instead of {wanted}");
        }
    }

    #[test]
    fn a_needle_keeps_its_small_angle_to_full_relative_accuracy() {
        let thin = 1e-12;
        let needle = [Point3::new(0.0, 0.0, 0.0), Point3::new(1.0, 0.0, 0.0), Point3::new(1.0, 0.0, thin)];
        let tip = angles(&needle, surface_area(&needle))[0];
        assert!((tip / thin - 1.0).abs() < 1e-14, "{tip}");
    }

    #[test]
    fn the_angles_of_coinciding_corners_are_zero() {
        let p = Point2::new(-0.25, 0.5);
        assert_eq!(angles(&[Point2::new(1.0, -3.0), p, p], 0.0), [0.0; 3]);
        assert_eq!(angles(&[p; 3], 0.0), [0.0; 3]);
    }
}
