//! The checkerboard over the layout, averaged over the footprint of a sample.

use abf_mesh::{Point2, Vector2};

use crate::colour::Colour;

/// The dark squares at the four corners of the layout's box; in between they are blended.
///
/// All have about the same lightness, and none is near the red of a flipped triangle.
const DARK: [[[u8; 3]; 2]; 2] = [[[52, 84, 158], [18, 124, 134]], [[124, 70, 150], [124, 128, 38]]];
/// The light squares, the same everywhere.
const LIGHT: [u8; 3] = [241, 239, 232];
/// A footprint this small, in squares, counts as a point.
const POINT: f64 = 1e-6;

/// A checkerboard laid over a box of the UV plane, its first square at the lower left corner.
#[derive(Clone, Debug)]
pub(crate) struct Checker {
    origin: Point2<f64>,
    size: Vector2<f64>,
    squares_per_unit: f64,
    dark: [[Colour; 2]; 2],
    light: Colour,
}

impl Checker {
    /// `checks` squares along the longer side of the box from `low` to `high`.
    pub(crate) fn over((low, high): (Point2<f64>, Point2<f64>), checks: u32) -> Self {
        let size = high - low;
        let side = size.max();
        Self {
            origin: low,
            size: size.map(|x| if x > 0.0 { x } else { 1.0 }),
            squares_per_unit: if side > 0.0 { f64::from(checks) / side } else { 0.0 },
            dark: DARK.map(|row| row.map(Colour::from_srgb)),
            light: Colour::from_srgb(LIGHT),
        }
    }

    /// The colour at `uv`, averaged over a box of the size `footprint` around it.
    pub(crate) fn colour(&self, uv: Point2<f64>, footprint: Vector2<f64>) -> Colour {
        self.dark_at(uv).mix(self.light, self.lightness(uv, footprint))
    }

    /// How much of the footprint lies in light squares, in `[0, 1]`.
    ///
    /// The checkerboard is `½ − ½ s(x) s(y)` with a square wave `s = ±1` of period 2, and the
    /// average of a product over a box is the product of the averages. Squares too small to be
    /// seen fade to an even tone instead of a moiré pattern.
    pub(crate) fn lightness(&self, uv: Point2<f64>, footprint: Vector2<f64>) -> f64 {
        let at = (uv - self.origin) * self.squares_per_unit;
        let width = footprint * self.squares_per_unit;
        0.5 - 0.5 * square_wave(at.x, width.x) * square_wave(at.y, width.y)
    }

    /// The tone of the dark squares at `uv`.
    fn dark_at(&self, uv: Point2<f64>) -> Colour {
        let place = (uv - self.origin).component_div(&self.size).map(|x| x.clamp(0.0, 1.0));
        let [bottom, top] = self.dark.map(|[left, right]| left.mix(right, place.x));
        bottom.mix(top, place.y)
    }
}

/// The mean over `[x − w/2, x + w/2]` of the wave that is `+1` on `[0, 1)` and `−1` on `[1, 2)`.
fn square_wave(x: f64, width: f64) -> f64 {
    let width = width.max(POINT);
    (triangle_wave(x + 0.5 * width) - triangle_wave(x - 0.5 * width)) / width
}

/// The integral of the square wave from 0: rises to 1 at `x = 1` and falls back to 0 at `x = 2`.
fn triangle_wave(x: f64) -> f64 {
    1.0 - (x.rem_euclid(2.0) - 1.0).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn board() -> Checker {
        Checker::over((Point2::new(-1.0, 2.0), Point2::new(7.0, 6.0)), 8)
    }

    #[test]
    fn squares_alternate_from_a_dark_one_at_the_lower_left() {
        let lightness = |x, y| board().lightness(Point2::new(x, y), Vector2::zeros());
        for (x, y, expected) in [(-0.5, 2.5, 0.0), (0.5, 2.5, 1.0), (-0.5, 3.5, 1.0), (0.5, 3.5, 0.0)] {
            assert!((lightness(x, y) - expected).abs() < 1e-6, "at ({x}, {y})");
        }
    }

    #[test]
    fn a_footprint_across_an_edge_sees_half_of_each_square() {
        let half = board().lightness(Point2::new(0.0, 2.5), Vector2::new(0.2, 0.2));
        assert!((half - 0.5).abs() < 1e-12);
    }

    #[test]
    fn squares_far_below_a_sample_fade_to_an_even_tone() {
        for k in 0..20 {
            let uv = Point2::new(0.37 * f64::from(k), 3.0);
            assert!((board().lightness(uv, Vector2::new(301.3, 77.7)) - 0.5).abs() < 1e-4);
        }
    }

    #[test]
    fn a_layout_without_extent_has_one_colour() {
        let point = Point2::new(3.0, 3.0);
        let board = Checker::over((point, point), 8);
        assert_eq!(board.colour(point, Vector2::zeros()), board.colour(point, Vector2::new(1.0, 1.0)));
    }
}
