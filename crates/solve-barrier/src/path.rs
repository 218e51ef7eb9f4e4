//! The path along which angles follow a direction.
//!
//! A wheel sums logarithms of sines: near 0 and π these are linear in the logarithm of the distance to that end, and a
//! straight line leaves them at once. So an angle at the distance `r` from the nearer end moves, with `t = δ/r`, to the
//! distance
//!
//! ```text
//! r (1 + t + b (eᵗ − 1 − t)),        b = 1 / (1 + (r / ½)²), r after the step if it grows:
//! ```
//!
//! as an exponential close to the end, straight (`b → 0`) far from it, where the sums of angles are what counts. To first
//! order it is `x + δ`.

use std::f64::consts::{FRAC_PI_2, PI};

/// Distances well below this, rad, move as an exponential.
const BENDING: f64 = 0.5;

/// No angle moves further than this many times its distance to the nearer end, or [`BENDING`] if that is more.
const GROWTH: f64 = 3.0;

/// Where every angle is after this share of the direction.
pub(crate) fn advance(angles: &[f64], delta: &[f64], share: f64) -> Vec<f64> {
    angles.iter().zip(delta).map(|(&x, &d)| moved(x, share * d)).collect()
}

/// About the largest share, at most 1, of which no angle loses more than `fraction` of its distance to 0 or π
/// (Wächter, Biegler 2006, eq. (15)).
pub(crate) fn longest(angles: &[f64], delta: &[f64], fraction: f64) -> f64 {
    angles.iter().zip(delta).fold(1.0, |longest: f64, (&x, &d)| {
        let fits = |share: f64| {
            let to = moved(x, share * d);
            let keeps_away = to >= (1.0 - fraction) * x && PI - to >= (1.0 - fraction) * (PI - x);
            keeps_away && share * d.abs() <= GROWTH * nearer_end(x).max(BENDING)
        };
        if fits(longest) { longest } else { largest_that(fits, longest) }
    })
}

/// The distance to the nearer of 0 and π.
pub(crate) fn nearer_end(x: f64) -> f64 {
    x.min(PI - x)
}

/// Bisects for the largest share below `high` that fits. Zero does.
fn largest_that(fits: impl Fn(f64) -> bool, mut high: f64) -> f64 {
    /// Shares are wanted to this part of themselves.
    const PRECISION: f64 = 1e-2;
    /// A share can be very small: each of the first tries quarters it.
    const TRIES: usize = 60;
    let mut low = 0.0;
    for _ in 0..TRIES {
        let middle = if low > 0.0 { 0.5 * (low + high) } else { 0.25 * high };
        if fits(middle) {
            low = middle;
        } else {
            high = middle;
        }
        if high - low <= PRECISION * high {
            break;
        }
    }
    low
}

fn moved(x: f64, d: f64) -> f64 {
    if x <= FRAC_PI_2 { x * growth(x, d / x) } else { PI - (PI - x) * growth(PI - x, -d / (PI - x)) }
}

/// What the distance `r` is multiplied by.
fn growth(r: f64, t: f64) -> f64 {
    let bent = 1.0 / (1.0 + (r * t.max(0.0).exp() / BENDING).powi(2));
    // Beyond the range of the exponential the straight part is what is left.
    if bent > 0.0 { 1.0 + t + bent * (t.exp() - 1.0 - t) } else { 1.0 + t }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_leaves_in_the_direction_asked_for() {
        for x in [1e-6, 1e-3, 0.3, 1.5, 1.6, 3.0, PI - 1e-5] {
            let d = 1e-4 * nearer_end(x);
            for d in [d, -d] {
                assert!((moved(x, d) - x - d).abs() < 1e-3 * d.abs(), "{x} {d}");
            }
        }
    }

    #[test]
    fn the_sine_of_a_small_angle_moves_by_its_linearisation_in_the_logarithm() {
        for x in [1e-6_f64, 1e-3, PI - 1e-3] {
            let d = -2.0 * nearer_end(x);
            let change = (moved(x, d).sin() / x.sin()).ln();
            assert!((change - d / x.tan()).abs() < 1e-3, "{x}: {change}");
        }
    }

    #[test]
    fn the_longest_share_keeps_a_fraction_of_every_distance() {
        let angles = [0.01, 1.0, 3.1, 1.5];
        let delta = [-0.2, -1.5, 0.3, 40.0];
        let share = longest(&angles, &delta, 0.9);
        assert!(share > 0.0 && share < 1.0);
        for (x, y) in angles.iter().zip(advance(&angles, &delta, share)) {
            assert!(y >= 0.1 * x && PI - y >= 0.1 * (PI - x), "{x} {y}");
        }
        assert_eq!(longest(&angles, &[0.0, 0.1, -0.1, 0.2], 0.9), 1.0);
    }

    #[test]
    fn no_direction_makes_a_nan() {
        for (x, d) in [(1e-9, 1.0), (1e-12, 3.0), (PI - 1e-9, -2.0), (1e-9, -1.0)] {
            assert!(moved(x, d).is_finite(), "{x} {d}");
        }
    }
}
