//! The angles of a polygon whose vertices are on a circle, from the lengths of its edges.

use std::f64::consts::{PI, TAU};

/// Halvings of an interval until doubles hold no smaller one.
const HALVINGS: usize = 64;

/// The inner angles, rad, of a polygon on a circle with these edges, in their order: that of vertex `j` is between the edges
/// `j − 1` and `j`.
///
/// An edge of length `ℓ` is seen from the centre under `θ = 2 asin(ℓ / 2R)`, and the angle between two edges is
/// `π − (θ + θ′)/2`. `R` follows from `Σθ = 2π`. Where the longest edge is longer than a circle with its centre inside the polygon
/// allows, `θ = 2π ℓ/Σℓ`, which is what many short edges tend to.
pub(super) fn angles_on_a_circle(lengths: &[f64]) -> Vec<f64> {
    let n = lengths.len();
    let seen = seen_from_the_centre(lengths);
    (0..n).map(|j| PI - 0.5 * (seen[j] + seen[(j + n - 1) % n])).collect()
}

fn seen_from_the_centre(lengths: &[f64]) -> Vec<f64> {
    let total: f64 = lengths.iter().sum();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    // With `t = 1/2R`. As x ≤ asin x ≤ πx/2 it is between these; its largest value makes the longest edge a diameter.
    let seen = |t: f64| lengths.iter().map(move |l| 2.0 * (l * t).min(1.0).asin());
    let (mut low, mut high) = (2.0 / total, (PI / total).min(1.0 / longest));
    // But for rounding, where the longest edge is a diameter.
    let reaches_around = |t: f64| seen(t).sum::<f64>() >= TAU * (1.0 - 1e-12);
    if !reaches_around(high) {
        return lengths.iter().map(|l| TAU * l / total).collect();
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if reaches_around(middle) { high = middle } else { low = middle }
    }
    let angles: Vec<f64> = seen(high).collect();
    // The last digits: as many edges as there are may add up their rounding.
    let sum: f64 = angles.iter().sum();
    angles.into_iter().map(|angle| angle * (TAU / sum)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polygon_on_a_circle_has_its_angles() {
        // On the unit circle, at these angles.
        let at = [0.0, 0.3, 1.7, 3.0, 5.5_f64];
        let n = at.len();
        let arc = |j: usize| if j + 1 == n { TAU - at[j] } else { at[j + 1] - at[j] };
        let lengths: Vec<f64> = (0..n).map(|j| 6.0 * (0.5 * arc(j)).sin()).collect();
        for (j, angle) in angles_on_a_circle(&lengths).into_iter().enumerate() {
            let exact = PI - 0.5 * (arc(j) + arc((j + n - 1) % n));
            assert!((angle - exact).abs() < 1e-12, "{j}: {angle} for {exact}");
        }
    }

    #[test]
    fn angles_sum_to_those_of_a_polygon_whatever_the_lengths() {
        let right = [3.0, 4.0, 5.0];
        let obtuse = [1.0, 1.0, 1.9];
        let many: Vec<f64> = (0..100_000).map(|j| 1e-5 * (1.5 + f64::from(j).sin())).collect();
        for lengths in [&right[..], &obtuse, &many, &[1e-200, 1e-200, 1e-200], &[1e200, 1e200, 1e200]] {
            let angles = angles_on_a_circle(lengths);
            let turn: f64 = angles.iter().map(|angle| PI - angle).sum();
            assert!((turn - TAU).abs() < 1e-9, "{turn}");
        }
        // Thales: the angle between the two shorter sides is a right one.
        assert!((angles_on_a_circle(&right)[1] - 0.5 * PI).abs() < 1e-6);
    }
}
