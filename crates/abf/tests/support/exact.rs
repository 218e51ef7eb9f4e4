//! On which side of a line a point is, in whole numbers of any size: a second opinion on `robust`, by which certificates are
//! made. The fuzz targets use this file, too.

use abf::mesh::Point2;
use num_bigint::BigInt;
pub(crate) use num_bigint::Sign;

/// A finite double as a whole number of units of 2⁻¹⁰⁷⁴.
fn whole(x: f64) -> BigInt {
    let bits = x.to_bits();
    let (exponent, fraction) = ((bits >> 52) & 0x7ff, bits & ((1 << 52) - 1));
    let magnitude = match exponent {
        0 => BigInt::from(fraction),
        _ => BigInt::from(fraction | (1 << 52)) << (exponent - 1),
    };
    if x < 0.0 { -magnitude } else { magnitude }
}

/// The sign of the area of a triangle, without rounding.
pub(crate) fn turns(triangle: &[Point2<f64>; 3]) -> Sign {
    let [a, b, c] = triangle.map(|p| [whole(p.x), whole(p.y)]);
    let difference = |p: &[BigInt; 2], k: usize| &p[k] - &a[k];
    (difference(&b, 0) * difference(&c, 1) - difference(&b, 1) * difference(&c, 0)).sign()
}
