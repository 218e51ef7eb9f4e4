//! A scale of colours for distortion: from pale yellow over green and teal to dark violet.
//!
//! The scale is a curve in Oklab (Ottosson 2020), a space in which distance is close to what is
//! seen: lightness falls linearly, so that more is darker, evenly, for every kind of colour vision
//! and in grey. No colour on it is near the red of a flipped triangle.

use crate::colour::Colour;

/// Lightness at both ends, in `[0, 1]`.
const LIGHTNESS: [f64; 2] = [0.965, 0.31];
/// Hue at both ends, degrees.
const HUE: [f64; 2] = [108.0, 288.0];
/// Chroma at both ends, and how much more there is half-way.
const CHROMA: [f64; 2] = [0.045, 0.10];
const BULGE: f64 = 0.02;
/// How many colours the scale has.
const STEPS: usize = 256;

/// A scale of colours for values from 0 to a limit; larger values have its last colour.
#[derive(Clone, Debug)]
pub(crate) struct ColourScale {
    limit: f64,
    colours: Vec<Colour>,
}

impl ColourScale {
    /// The scale up to a positive limit.
    pub(crate) fn up_to(limit: f64) -> Self {
        let colours = (0..STEPS).map(|k| Colour::from_linear(at(k as f64 / (STEPS - 1) as f64))).collect();
        Self { limit, colours }
    }

    /// The colour of a value that is not negative.
    pub(crate) fn colour(&self, value: f64) -> Colour {
        let place = (value / self.limit).min(1.0) * (STEPS - 1) as f64;
        // A cast from NaN gives 0.
        self.colours[place.round() as usize]
    }

    /// So many colours from the first to the last one, sRGB.
    pub(crate) fn samples(count: usize) -> Vec<[u8; 3]> {
        let scale = Self::up_to(1.0);
        (0..count).map(|k| scale.colour(k as f64 / (count - 1) as f64).to_srgb()).collect()
    }
}

/// The colour at `t` in `[0, 1]`, in linear light.
fn at(t: f64) -> [f64; 3] {
    let between = |[first, last]: [f64; 2]| first + t * (last - first);
    let chroma = between(CHROMA) + BULGE * 4.0 * t * (1.0 - t);
    let hue = between(HUE).to_radians();
    linear_light(between(LIGHTNESS), chroma * hue.cos(), chroma * hue.sin())
}

/// From Oklab to linear sRGB, with the matrices of its author.
fn linear_light(lightness: f64, a: f64, b: f64) -> [f64; 3] {
    let [l, m, s] = [
        lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b,
        lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b,
        lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b,
    ]
    .map(|x| x * x * x);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance, which is linear light weighted by the eye's sensitivity.
    fn luminance([r, g, b]: [f64; 3]) -> f64 {
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    fn steps() -> impl Iterator<Item = f64> {
        (0..=100).map(|k| f64::from(k) / 100.0)
    }

    #[test]
    fn every_colour_of_the_scale_can_be_shown() {
        for t in steps() {
            assert!(at(t).iter().all(|x| (0.0..=1.0).contains(x)), "{t}: {:?}", at(t));
        }
    }

    #[test]
    fn a_larger_value_is_always_darker() {
        let all: Vec<f64> = steps().map(|t| luminance(at(t))).collect();
        assert!(all.windows(2).all(|w| w[0] > w[1]), "{all:?}");
    }

    #[test]
    fn white_and_grey_come_back_from_oklab() {
        for (lightness, expected) in [(1.0, 1.0), (0.5, 0.125), (0.0, 0.0)] {
            assert!(linear_light(lightness, 0.0, 0.0).iter().all(|x| (x - expected).abs() < 1e-6));
        }
    }

    #[test]
    fn values_beyond_the_limit_have_the_last_colour() {
        let scale = ColourScale::up_to(2.0);
        assert_eq!(scale.colour(2.0), scale.colour(f64::INFINITY));
        assert_ne!(scale.colour(2.0), scale.colour(1.9));
        assert_eq!(ColourScale::samples(2), [scale.colour(0.0), scale.colour(9.0)].map(Colour::to_srgb));
    }
}
