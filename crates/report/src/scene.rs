//! What every picture of one flattened mesh shares, whatever its faces are painted with.

use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{CornerId, TriMesh, UvMap};
use abf_metrics::{FaceDistortion, Orientation, per_face};
use tiny_skia::Pixmap;

use crate::PictureError;
use crate::camera::{Camera, View};
use crate::colour::Palette;
use crate::drawing::outline::Edges;
use crate::layout::Layout;
use crate::panel::Panel;
use crate::skin::Skin;
use crate::surface::Surface;

/// A mesh and its layout, judged once and ready to be drawn in any skin.
pub(crate) struct Scene<'a> {
    mesh: &'a TriMesh,
    uv: &'a UvMap,
    camera: Camera,
    /// For every face whether the layout has it upside down.
    flipped: Vec<bool>,
    /// For every face the largest angle error at its corners, radians; 0 where it has no area.
    angle_errors: Vec<f64>,
    /// Boundary and seams.
    outline: Vec<CornerId>,
    /// The width of boundaries and seams, pixels; with 0 there are none.
    line_width: f64,
}

impl<'a> Scene<'a> {
    /// Checks and judges the input; lines are `line_width` pixels wide.
    pub(crate) fn new(mesh: &'a TriMesh, uv: &'a UvMap, view: &View, line_width: f64) -> Result<Self, PictureError> {
        // The same judgement as in the figures: a red triangle is one that is counted as flipped.
        let faces = per_face(mesh, uv)?;
        Ok(Self {
            mesh,
            uv,
            camera: Camera::new(view, mesh)?,
            flipped: faces.iter().map(|f| f.orientation == Orientation::Flipped).collect(),
            angle_errors: faces.iter().map(largest_angle_error).collect(),
            outline: if line_width > 0.0 { Edges::of(mesh, uv).open } else { Vec::new() },
            line_width,
        })
    }

    /// For every face the largest angle error at its corners, radians.
    pub(crate) fn angle_errors(&self) -> &[f64] {
        &self.angle_errors
    }

    /// Draws the surface into a panel of the canvas.
    pub(crate) fn draw_surface(
        &self,
        canvas: &mut Pixmap,
        panel: &Panel,
        skin: &Skin<'_>,
        palette: &Palette,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), Cancelled> {
        let Self { mesh, uv, camera, flipped, outline, .. } = self;
        Surface { mesh, uv, camera, skin, flipped, outline }.draw(canvas, panel, palette, self.line_width, checkpoint)
    }

    /// Draws the layout into a panel of the canvas.
    pub(crate) fn draw_layout(
        &self,
        canvas: &mut Pixmap,
        panel: &Panel,
        skin: &Skin<'_>,
        palette: &Palette,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), Cancelled> {
        let Self { uv, flipped, outline, .. } = self;
        Layout { uv, skin, flipped, outline }.draw(canvas, panel, palette, self.line_width, checkpoint)
    }
}

/// The largest `|x − α°|` at the corners of a face, radians.
pub(crate) fn largest_angle_error(face: &FaceDistortion) -> f64 {
    if face.degenerate_3d { 0.0 } else { face.angle_errors().into_iter().map(f64::abs).fold(0.0, f64::max) }
}
