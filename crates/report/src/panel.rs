//! One half of the canvas: fitting a drawing into it, and averaging its samples to pixels.

use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{Point2, Vector2};
use tiny_skia::{Pixmap, PremultipliedColorU8};

use crate::colour::Colour;
use crate::raster::Visibility;

/// The empty border around a drawing, as a part of the panel's shorter side.
const MARGIN: f64 = 0.06;

/// An upright strip of the canvas, `samples × samples` of them in each pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Panel {
    /// Its first pixel column on the canvas.
    pub(crate) left: u32,
    /// Its width, pixels.
    pub(crate) width: u32,
    /// Its height, pixels: that of the canvas.
    pub(crate) height: u32,
    /// Samples along each side of a pixel.
    pub(crate) samples: u32,
}

impl Panel {
    /// A grid of all its samples.
    pub(crate) fn grid(&self) -> Visibility {
        let [columns, rows] = [self.width, self.height].map(|pixels| (pixels * self.samples) as usize);
        Visibility::new(columns, rows)
    }

    /// How many samples a length in pixels is.
    pub(crate) fn length(&self, pixels: f64) -> f64 {
        pixels * f64::from(self.samples)
    }

    /// The place on the canvas of a place in the panel: pixels, y down.
    pub(crate) fn on_canvas(&self, place: Point2<f64>) -> Point2<f64> {
        let at = place / f64::from(self.samples);
        Point2::new(f64::from(self.left) + at.x, f64::from(self.height) - at.y)
    }

    /// The uniform scaling that centres the box from `low` to `high` within the margins.
    pub(crate) fn fit(&self, (low, high): (Point2<f64>, Point2<f64>)) -> Fit {
        let room = Vector2::new(f64::from(self.width), f64::from(self.height)) * f64::from(self.samples);
        let inner = room.add_scalar(-2.0 * MARGIN * room.min());
        let size = high - low;
        let scale = (inner.x / size.x).min(inner.y / size.y);
        Fit {
            middle: low + 0.5 * size,
            centre: Point2::from(0.5 * room),
            scale: if scale.is_finite() { scale } else { 1.0 },
        }
    }

    /// Colours the panel's pixels on the canvas: each is the mean of its samples.
    ///
    /// `shade` gets the number of what is seen and the place of the sample. Pixels where nothing
    /// is seen are left alone; without a background, pixels at the rim are partly transparent.
    pub(crate) fn resolve(
        &self,
        canvas: &mut Pixmap,
        background: Option<Colour>,
        seen: &Visibility,
        checkpoint: &mut Checkpoint<'_>,
        mut shade: impl FnMut(u32, Point2<f64>) -> Colour,
    ) -> Result<(), Cancelled> {
        let n = self.samples as usize;
        let share = 1.0 / (n * n) as f64;
        let stride = canvas.width() as usize;
        let pixels = canvas.pixels_mut();
        for y in 0..self.height as usize {
            checkpoint()?;
            let bottom = (self.height as usize - 1 - y) * n;
            for x in 0..self.width as usize {
                let (mut sum, mut covered) = (Colour::default(), 0);
                for (row, column) in (0..n * n).map(|k| (bottom + k / n, x * n + k % n)) {
                    if let Some(item) = seen.at(column, row) {
                        sum = sum + shade(item, Point2::new(column as f64 + 0.5, row as f64 + 0.5));
                        covered += 1;
                    }
                }
                if covered > 0 {
                    pixels[y * stride + self.left as usize + x] = match background {
                        Some(behind) => pixel((sum + behind * (n * n - covered) as f64) * share, 1.0),
                        None => pixel(sum * (1.0 / covered as f64), covered as f64 * share),
                    };
                }
            }
        }
        Ok(())
    }
}

/// A moved and uniformly scaled plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit {
    middle: Point2<f64>,
    centre: Point2<f64>,
    /// Samples per unit of the plane.
    pub(crate) scale: f64,
}

impl Fit {
    /// The place of a point in the panel, samples.
    #[inline]
    pub(crate) fn apply(&self, point: Point2<f64>) -> Point2<f64> {
        self.centre + self.scale * (point - self.middle)
    }

    /// The point at a place of the panel.
    #[inline]
    pub(crate) fn invert(&self, place: Point2<f64>) -> Point2<f64> {
        self.middle + (place - self.centre) / self.scale
    }
}

/// The smallest box around all points; one that holds nothing where there are none.
pub(crate) fn bounds(points: impl IntoIterator<Item = Point2<f64>>) -> (Point2<f64>, Point2<f64>) {
    let nothing = (Point2::from([f64::INFINITY; 2]), Point2::from([f64::NEG_INFINITY; 2]));
    abf_mesh::bounds(points).unwrap_or(nothing)
}

/// A pixel of which a part is covered by a colour.
fn pixel(colour: Colour, covered: f64) -> PremultipliedColorU8 {
    let [r, g, b] = colour.to_srgb();
    tiny_skia::ColorU8::from_rgba(r, g, b, (f64::from(u8::MAX) * covered).round() as u8).premultiply()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PANEL: Panel = Panel { left: 0, width: 20, height: 10, samples: 2 };

    #[test]
    fn a_fitted_box_is_centred_and_keeps_its_proportions() {
        let fit = PANEL.fit((Point2::new(1.0, 1.0), Point2::new(3.0, 2.0)));
        let (low, high) = (fit.apply(Point2::new(1.0, 1.0)), fit.apply(Point2::new(3.0, 2.0)));
        assert!((low + (high - low) * 0.5 - Point2::new(20.0, 10.0)).norm() < 1e-12);
        assert!(((high.x - low.x) / (high.y - low.y) - 2.0).abs() < 1e-12);
        assert!(low.y >= 1.0 && high.y <= 19.0);
        assert!((fit.invert(low) - Point2::new(1.0, 1.0)).norm() < 1e-12);
    }

    #[test]
    fn a_pixel_is_the_mean_of_its_samples_in_linear_light() {
        let mut canvas = Pixmap::new(20, 10).expect("not empty");
        let mut seen = PANEL.grid();
        // The lower half of the lowest row of pixels.
        seen.line(abf_mesh::Point3::new(0.0, 0.0, 0.0), abf_mesh::Point3::new(40.0, 0.0, 0.0), 1.0, 0);
        let (black, white) = (Colour::from_srgb([0; 3]), Colour::from_srgb([255; 3]));
        PANEL.resolve(&mut canvas, Some(white), &seen, &mut || Ok(()), |_, _| black).expect("not cancelled");
        let pixel = canvas.pixel(7, 9).expect("inside");
        assert_eq!([pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()], [188, 188, 188, 255]);
        assert_eq!(canvas.pixel(7, 8).expect("inside").alpha(), 0);
        PANEL.resolve(&mut canvas, None, &seen, &mut || Ok(()), |_, _| black).expect("not cancelled");
        assert_eq!(canvas.pixel(7, 9).expect("inside").alpha(), 128);
    }
}
