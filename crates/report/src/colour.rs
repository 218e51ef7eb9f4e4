//! Colours in linear light, where averaging and shading are plain arithmetic.

use std::ops::{Add, Mul};

/// A colour in linear light, each channel in `[0, 1]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Colour([f32; 3]);

impl Colour {
    /// The colour that a screen shows for these sRGB bytes.
    pub(crate) fn from_srgb(bytes: [u8; 3]) -> Self {
        Self(bytes.map(|byte| decode(f32::from(byte) / 255.0)))
    }

    /// The colour of this linear light.
    pub(crate) fn from_linear(light: [f64; 3]) -> Self {
        Self(light.map(|x| x as f32))
    }

    /// The nearest sRGB bytes.
    pub(crate) fn to_srgb(self) -> [u8; 3] {
        self.0.map(|x| (255.0 * encode(x.clamp(0.0, 1.0))).round() as u8)
    }

    /// `self` at `t = 0`, `other` at `t = 1`.
    pub(crate) fn mix(self, other: Self, t: f64) -> Self {
        self * (1.0 - t) + other * t
    }
}

impl Add for Colour {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl Mul<f64> for Colour {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|x| x * factor as f32))
    }
}

/// The colours besides those of a skin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Palette {
    /// What is around the drawings; `None` leaves it transparent.
    pub(crate) background: Option<Colour>,
    /// Boundaries and seams.
    pub(crate) ink: Colour,
    /// Flipped triangles.
    pub(crate) flipped: Colour,
    /// Dark squares seen from the back.
    pub(crate) back: Colour,
    /// Light squares seen from the back.
    pub(crate) back_light: Colour,
}

impl Palette {
    /// The colours on a background; `None` leaves it transparent.
    pub(crate) fn on(background: Option<[u8; 3]>) -> Self {
        Self {
            background: background.map(Colour::from_srgb),
            ink: Colour::from_srgb([38, 42, 50]),
            flipped: Colour::from_srgb(FLIPPED),
            back: Colour::from_srgb([104, 106, 112]),
            back_light: Colour::from_srgb([130, 132, 138]),
        }
    }
}

/// The red of a flipped triangle, sRGB.
pub(crate) const FLIPPED: [u8; 3] = [226, 42, 38];

/// The sRGB transfer function (IEC 61966-2-1), from the encoded value to linear light.
fn decode(x: f32) -> f32 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// The inverse of [`decode`].
fn encode(x: f32) -> f32 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_srgb_byte_survives_the_way_through_linear_light() {
        for byte in 0..=u8::MAX {
            assert_eq!(Colour::from_srgb([byte; 3]).to_srgb(), [byte; 3]);
        }
    }

    #[test]
    fn mixing_black_and_white_is_brighter_than_the_mean_of_the_bytes() {
        let grey = Colour::from_srgb([0; 3]).mix(Colour::from_srgb([255; 3]), 0.5);
        assert_eq!(grey.to_srgb(), [188; 3]);
    }
}
