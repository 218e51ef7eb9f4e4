//! What the faces are painted with: a checkerboard, or one colour each.

use abf_mesh::{Point2, Vector2};

use crate::checker::Checker;
use crate::colour::{Colour, Palette};

/// Light that comes from everywhere, as a part of the whole, on a checkerboard.
const AMBIENT: f64 = 0.42;
/// The same on a scale of colours, where shade must not be taken for a value.
const AMBIENT_ON_SCALE: f64 = 0.66;
/// How much of its colour a face shows on its back.
const SEEN_FROM_BEHIND: f64 = 0.35;

/// What the faces of surface and layout are painted with.
pub(crate) enum Skin<'a> {
    /// A checkerboard over the layout.
    Checker(&'a Checker),
    /// One colour for every face.
    Faces(&'a [Colour]),
}

impl Skin<'_> {
    /// The colour of a face's front at a place of the layout, averaged over a footprint.
    #[inline]
    pub(crate) fn front(&self, face: u32, uv: Point2<f64>, footprint: Vector2<f64>) -> Colour {
        match self {
            Self::Checker(checker) => checker.colour(uv, footprint),
            Self::Faces(colours) => colours[face as usize],
        }
    }

    /// The colour of a face's back, muted.
    #[inline]
    pub(crate) fn back(&self, face: u32, uv: Point2<f64>, footprint: Vector2<f64>, palette: &Palette) -> Colour {
        match self {
            Self::Checker(checker) => palette.back.mix(palette.back_light, checker.lightness(uv, footprint)),
            Self::Faces(colours) => palette.back.mix(colours[face as usize], SEEN_FROM_BEHIND),
        }
    }

    /// Light that comes from everywhere, as a part of the whole.
    pub(crate) fn ambient(&self) -> f64 {
        match self {
            Self::Checker(_) => AMBIENT,
            Self::Faces(_) => AMBIENT_ON_SCALE,
        }
    }
}
