//! The right panel: the layout in the UV plane.

use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{CornerId, Point3, UvMap, Vector2};
use tiny_skia::{LineCap, Paint, PathBuilder, Pixmap, Stroke, Transform};

use crate::colour::Palette;
use crate::panel::{Fit, Panel, bounds};
use crate::raster::Visibility;
use crate::skin::Skin;

/// Flipped triangles lie above the others.
const FLIPPED: f64 = 1.0;
/// The least radius at which a flipped triangle is marked, pixels.
const MARK: f64 = 1.5;
/// Edges stroked at once: long paths cost more than their length.
const EDGES_PER_PATH: usize = 512;

/// What the panel shows.
#[derive(Clone, Copy)]
pub(crate) struct Layout<'a> {
    pub(crate) uv: &'a UvMap,
    pub(crate) skin: &'a Skin<'a>,
    /// For every face whether the layout has it upside down.
    pub(crate) flipped: &'a [bool],
    /// The edges at which the layout ends.
    pub(crate) outline: &'a [CornerId],
}

impl Layout<'_> {
    /// Draws the layout into its panel; `line_width` is in pixels.
    pub(crate) fn draw(
        &self,
        canvas: &mut Pixmap,
        panel: &Panel,
        palette: &Palette,
        line_width: f64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), Cancelled> {
        let fit = panel.fit(bounds(self.uv.triangles().flatten()));
        let seen = self.visibility(panel, &fit, checkpoint)?;
        let footprint = Vector2::from_element(1.0 / fit.scale);
        panel.resolve(canvas, palette.background, &seen, checkpoint, |face, at| {
            if self.flipped[face as usize] { palette.flipped } else { self.skin.front(face, fit.invert(at), footprint) }
        })?;
        self.stroke_outline(canvas, panel, &fit, palette, line_width, checkpoint)
    }

    /// What is seen at every sample. A flipped triangle leaves a mark however small it is.
    fn visibility(&self, panel: &Panel, fit: &Fit, checkpoint: &mut Checkpoint<'_>) -> Result<Visibility, Cancelled> {
        let mut seen = panel.grid();
        let radius = panel.length(MARK);
        for (face, (triangle, &flipped)) in self.uv.triangles().zip(self.flipped).enumerate() {
            checkpoint()?;
            let depth = if flipped { FLIPPED } else { 0.0 };
            let corners = triangle.map(|p| fit.apply(p)).map(|p| Point3::new(p.x, p.y, depth));
            seen.triangle(&corners, face as u32);
            if flipped {
                let [a, b, c] = corners.map(|p| p.coords / 3.0);
                seen.dot(Point3::from(a + b + c), radius, face as u32);
            }
        }
        Ok(seen)
    }

    /// Strokes the outline with anti-aliased lines. Round ends join edges at any angle.
    fn stroke_outline(
        &self,
        canvas: &mut Pixmap,
        panel: &Panel,
        fit: &Fit,
        palette: &Palette,
        line_width: f64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), Cancelled> {
        let mut paint = Paint::default();
        let [r, g, b] = palette.ink.to_srgb();
        paint.set_color_rgba8(r, g, b, u8::MAX);
        let stroke = Stroke { width: line_width as f32, line_cap: LineCap::Round, ..Stroke::default() };
        let on_canvas = |c: CornerId| panel.on_canvas(fit.apply(self.uv.corner(c)));
        for edges in self.outline.chunks(EDGES_PER_PATH) {
            checkpoint()?;
            let mut path = PathBuilder::new();
            for &edge in edges {
                let [from, to] = [edge, edge.next()].map(on_canvas);
                path.move_to(from.x as f32, from.y as f32);
                path.line_to(to.x as f32, to.y as f32);
            }
            if let Some(path) = path.finish() {
                canvas.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
            }
        }
        Ok(())
    }
}
