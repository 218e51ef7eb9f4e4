//! Sine, cosine and exponential that give the same bits on every machine.
//!
//! IEEE 754 fixes `+ − × ÷ √` to the last bit. It does not fix `sin` and `exp`: `f64::sin` is
//! whatever the C library of the platform computes, so a fixture generated from it would differ
//! between machines now and then. The functions here use the four operations only. They are good
//! to about 1e-15, far below the nine decimals to which coordinates are rounded.

use std::f64::consts::{FRAC_2_PI, LOG2_E};

/// π/2 = high + low; `high` has 33 bits, so its product with a small integer is exact.
const HALF_PI_HIGH: f64 = 1.570_796_326_734_125_6;
const HALF_PI_LOW: f64 = 6.077_100_506_506_192e-11;

/// ln 2 = high + low, split likewise.
const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// Below this an exponential is taken as at it (1e-304), which keeps the exponent in range.
const SMALLEST_EXPONENT: f64 = -700.0;

/// `(sin x, cos x)` for `|x|` up to some thousands.
///
/// `x` is reduced to `r` in ±π/4 by a multiple of π/2; there the Taylor series, written as a
/// nested product `1 − r²/(2·3) (1 − r²/(4·5) (…))`, has an error below 1e-17 after nine terms.
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    const TERMS: u32 = 9;
    let quarters = (x * FRAC_2_PI).round();
    let r = (x - quarters * HALF_PI_HIGH) - quarters * HALF_PI_LOW;
    let nested = |first: u32| {
        (0..TERMS).rev().map(|k| f64::from(2 * k + first)).fold(1.0, |acc, n| 1.0 - r * r / (n * (n + 1.0)) * acc)
    };
    let (sin, cos) = (r * nested(2), nested(1));
    match (quarters as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// `sin x`; see [`sin_cos`].
pub(crate) fn sin(x: f64) -> f64 {
    sin_cos(x).0
}

/// `eˣ` for `x ≤ 700`, as `2ⁿ eʳ` with `|r| ≤ ln 2 / 2`.
pub(crate) fn exp(x: f64) -> f64 {
    const TERMS: u32 = 15;
    const EXPONENT_BIAS: i64 = 1023;
    const MANTISSA_BITS: u32 = 52;
    let x = x.max(SMALLEST_EXPONENT);
    let n = (x * LOG2_E).round();
    let r = (x - n * LN_2_HIGH) - n * LN_2_LOW;
    let e_to_r = (1..=TERMS).rev().fold(1.0, |acc, k| 1.0 + r / f64::from(k) * acc);
    let two_to_n = f64::from_bits(((EXPONENT_BIAS + n as i64) as u64) << MANTISSA_BITS);
    e_to_r * two_to_n
}

/// A number in `[0, 1)` that looks random, from an index: one step of splitmix64
/// (Steele, Lea, Flood, *Fast Splittable Pseudorandom Number Generators*, 2014).
pub(crate) fn hash_unit(index: u64) -> f64 {
    const STEP: u64 = 0x9E37_79B9_7F4A_7C15;
    const TWO_TO_MINUS_53: f64 = 1.0 / (1_u64 << 53) as f64;
    let mut z = index.wrapping_add(1).wrapping_mul(STEP);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 * TWO_TO_MINUS_53
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_agree_with_the_platform() {
        for i in -4000..=4000 {
            let x = f64::from(i) * 0.0131;
            let (sin, cos) = sin_cos(x);
            assert!((sin - x.sin()).abs() < 1e-15 && (cos - x.cos()).abs() < 1e-15, "at {x}");
        }
    }

    #[test]
    fn the_exponential_agrees_with_the_platform() {
        for i in -6900..=6900 {
            let x = f64::from(i) * 0.1;
            assert!((exp(x) / x.exp() - 1.0).abs() < 1e-15, "at {x}");
        }
        assert!(exp(-1e6) < 1e-300);
    }

    #[test]
    fn the_hash_is_splitmix64() {
        // First output of the reference generator seeded with 0.
        assert_eq!(hash_unit(0), (0xE220_A839_7B1D_CDAF_u64 >> 11) as f64 / (1_u64 << 53) as f64);
        let mean = (0..1000).map(hash_unit).sum::<f64>() / 1000.0;
        assert!((mean - 0.5).abs() < 0.03);
    }
}
