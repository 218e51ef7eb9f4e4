//! The whole picture: its style, its checks, and the two panels on one canvas.

use abf_control::Checkpoint;
use abf_mesh::{TriMesh, UvMap};
use tiny_skia::{Color, Pixmap};

use crate::PictureError;
use crate::camera::View;
use crate::checker::Checker;
use crate::colour::Palette;
use crate::panel::{Panel, bounds};
use crate::scene::Scene;
use crate::skin::Skin;

/// The shortest side of a canvas, pixels: below, the margins leave nothing to see.
const MIN_SIDE: u32 = 16;
/// The most samples of a canvas: half of them at a time, of eight bytes each.
const MAX_SAMPLES: u64 = 1 << 27;
/// The most samples along each side of a pixel.
const MAX_SUPERSAMPLING: u32 = 8;
/// The most squares across a layout.
const MAX_CHECKS: u32 = 10_000;

/// What a picture looks like.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureStyle {
    /// Width of the canvas, pixels; the surface has the left half, the layout the right one.
    pub width: u32,
    /// Height of the canvas, pixels.
    pub height: u32,
    /// Squares of the checkerboard along the longer side of the layout.
    pub checks: u32,
    /// Samples along each side of a pixel; `n` of them make `n²` samples.
    pub supersampling: u32,
    /// From where the surface is seen.
    pub view: View,
    /// The colour around the drawings, sRGB.
    pub background: [u8; 3],
    /// The width of boundaries and seams in pixels; 0 draws none.
    pub line_width: f64,
}

impl Default for PictureStyle {
    fn default() -> Self {
        Self {
            width: 1600,
            height: 800,
            checks: 24,
            supersampling: 3,
            view: View::Auto,
            background: [250, 250, 248],
            line_width: 1.8,
        }
    }
}

/// Draws the checkered surface next to its layout and returns a PNG.
///
/// Left: the surface, lit, its back side in a neutral tone. Right: the layout as it is, neither
/// turned nor mirrored. Boundaries and seams are dark lines on both sides, and triangles that the
/// layout has upside down are red on both; in the layout, each leaves a mark of three pixels at
/// least. Time is linear in samples and, but for three sorts, in faces; faces that lie in one place are drawn once.
///
/// The same input gives the same bytes.
///
/// # Errors
/// A [`PictureError`] if the mesh has no faces or no area, the map belongs to another mesh, a
/// coordinate is not finite, or a setting of the style is out of its range.
///
/// ```
/// use abf_mesh::{Point2, Point3, TriMesh, UvMap};
/// use abf_report::{PictureStyle, picture};
///
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [0.0, 1.0, 0.0]].map(Point3::from);
/// let mesh = TriMesh::new(corners.to_vec(), &[[0, 1, 2]])?;
/// let uv = UvMap::per_vertex(&mesh, &corners.map(|p| Point2::new(p.x, p.y)));
/// let png = picture(&mesh, &uv, &PictureStyle { width: 320, height: 160, ..Default::default() })?;
/// assert_eq!(&png[1..4], b"PNG");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn picture(mesh: &TriMesh, uv: &UvMap, style: &PictureStyle) -> Result<Vec<u8>, PictureError> {
    picture_unless(mesh, uv, style, &mut || Ok(()))
}

/// [`picture`] that asks between its parts whether to go on.
///
/// # Errors
/// As [`picture`], and [`PictureError::Cancelled`].
pub fn picture_unless(
    mesh: &TriMesh,
    uv: &UvMap,
    style: &PictureStyle,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Vec<u8>, PictureError> {
    check_style(style)?;
    let scene = Scene::new(mesh, uv, &style.view, style.line_width)?;
    let checker = Checker::over(bounds(uv.triangles().flatten()), style.checks);
    let skin = Skin::Checker(&checker);

    let [left, right] = panels(style);
    let palette = Palette::on(Some(style.background));
    let mut canvas = blank(style)?;
    scene.draw_surface(&mut canvas, &left, &skin, &palette, checkpoint)?;
    scene.draw_layout(&mut canvas, &right, &skin, &palette, checkpoint)?;
    canvas.encode_png().map_err(|e| PictureError::Encoding { reason: e.to_string() })
}

/// The halves of the canvas for the surface and the layout.
fn panels(style: &PictureStyle) -> [Panel; 2] {
    let half = style.width / 2;
    let panel = |left, width| Panel { left, width, height: style.height, samples: style.supersampling };
    [panel(0, half), panel(half, style.width - half)]
}

/// A canvas of nothing but background.
fn blank(style: &PictureStyle) -> Result<Pixmap, PictureError> {
    let mut canvas = Pixmap::new(style.width, style.height).ok_or_else(|| too_large(style))?;
    let [r, g, b] = style.background;
    canvas.fill(Color::from_rgba8(r, g, b, u8::MAX));
    Ok(canvas)
}

fn too_large(style: &PictureStyle) -> PictureError {
    let &PictureStyle { width, height, supersampling, .. } = style;
    PictureError::CanvasTooLarge { width, height, supersampling, max: MAX_SAMPLES }
}

/// Checks every setting but the view, which needs the mesh.
fn check_style(style: &PictureStyle) -> Result<(), PictureError> {
    let &PictureStyle { width, height, .. } = style;
    for (setting, value, max) in
        [("supersampling", style.supersampling, MAX_SUPERSAMPLING), ("checks", style.checks, MAX_CHECKS)]
    {
        if value < 1 || value > max {
            return Err(PictureError::OutOfRange { setting, value, min: 1, max });
        }
    }
    if !(0.0..=f64::from(MIN_SIDE)).contains(&style.line_width) {
        return Err(PictureError::LineWidth { pixels: style.line_width, max: MIN_SIDE });
    }
    if width < MIN_SIDE || height < MIN_SIDE {
        return Err(PictureError::CanvasTooSmall { width, height, min: MIN_SIDE });
    }
    let pixels = u64::from(width) * u64::from(height);
    match pixels.checked_mul(u64::from(style.supersampling).pow(2)) {
        Some(samples) if samples <= MAX_SAMPLES => Ok(()),
        _ => Err(too_large(style)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::{FaceId, Point2, Point3, UvId};
    use abf_metrics::MetricsError;

    /// The unit square in the plane `z = 0`, seen face on, as its own layout.
    fn square() -> (TriMesh, UvMap) {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Point2::from);
        let positions = corners.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
        let mesh = TriMesh::new(positions, &[[0, 1, 2], [0, 2, 3]]).expect("indices in range");
        let uv = UvMap::per_vertex(&mesh, &corners);
        (mesh, uv)
    }

    /// Two squares by two, seen face on: each covers 44 × 44 pixels of the panel from pixel 6 on.
    fn small() -> PictureStyle {
        let view = View::Direction { towards_viewer: [0.0, 0.0, 1.0].into(), up: [0.0, 1.0, 0.0].into() };
        PictureStyle { width: 200, height: 100, checks: 2, view, ..PictureStyle::default() }
    }

    fn draw(mesh: &TriMesh, uv: &UvMap, style: &PictureStyle) -> Pixmap {
        let png = picture(mesh, uv, style).expect("a picture");
        Pixmap::decode_png(&png).expect("a readable PNG")
    }

    fn pixel(canvas: &Pixmap, x: u32, y: u32) -> [u8; 3] {
        let p = canvas.pixel(x, y).expect("inside");
        [p.red(), p.green(), p.blue()]
    }

    fn luminance(canvas: &Pixmap, x: u32, y: u32) -> u32 {
        pixel(canvas, x, y).map(u32::from).iter().sum::<u32>() / 3
    }

    #[test]
    fn the_picture_has_the_size_asked_for_and_an_empty_margin() {
        let (mesh, uv) = square();
        let canvas = draw(&mesh, &uv, &small());
        assert_eq!((canvas.width(), canvas.height()), (200, 100));
        for (x, y) in [(0, 0), (100, 50), (199, 99), (50, 2)] {
            assert_eq!(pixel(&canvas, x, y), small().background);
        }
    }

    #[test]
    fn parts_in_one_place_cost_what_one_of_them_costs_and_an_interrupt_is_heard_between_any_two_faces() {
        let (mesh, uv) = square();
        let positions: Vec<_> = (0..50).flat_map(|_| mesh.positions().iter().copied()).collect();
        let faces: Vec<_> =
            (0..50).flat_map(|k| [[4 * k, 4 * k + 1, 4 * k + 2], [4 * k, 4 * k + 2, 4 * k + 3]]).collect();
        let many = TriMesh::new(positions, &faces).expect("indices in range");
        let corners: Vec<Point2<f64>> = (0..50).flat_map(|_| uv.points().iter().copied()).collect();
        let of_many = UvMap::per_vertex(&many, &corners);
        let style = PictureStyle { line_width: 0.0, ..small() };
        assert_eq!(picture(&many, &of_many, &style), picture(&mesh, &uv, &style));
        let mut asked = 0;
        let mut after_thirty = || {
            asked += 1;
            if asked > 30 { Err(abf_control::Cancelled) } else { Ok(()) }
        };
        let drawn = picture_unless(&many, &of_many, &style, &mut after_thirty);
        assert_eq!((drawn, asked), (Err(PictureError::Cancelled(abf_control::Cancelled)), 31));
    }

    #[test]
    fn surface_and_layout_have_the_same_checkerboard() {
        let (mesh, uv) = square();
        let canvas = draw(&mesh, &uv, &small());
        for panel in [0, 100] {
            // The lower left square is dark, so is the upper right one.
            let at = |x: u32, y: u32| luminance(&canvas, panel + x, y);
            assert!(at(28, 72) < 150 && at(72, 28) < 150);
            assert!(at(28, 28) > 180 && at(72, 72) > 180);
        }
        // A light square of the layout is not shaded.
        assert_eq!(pixel(&canvas, 128, 28), [241, 239, 232]);
    }

    #[test]
    fn a_boundary_is_drawn_and_the_edge_between_two_faces_is_not() {
        let (mesh, uv) = square();
        let style = PictureStyle { line_width: 3.0, ..small() };
        let canvas = draw(&mesh, &uv, &style);
        for x in [6, 106] {
            assert!(luminance(&canvas, x, 60) < 60);
        }
        // On the diagonal, in the dark lower left square.
        assert_eq!(
            pixel(&canvas, 130, 69),
            pixel(&draw(&mesh, &uv, &PictureStyle { line_width: 0.0, ..style }), 130, 69)
        );
    }

    #[test]
    fn what_lies_behind_the_surface_is_hidden_with_its_boundary() {
        let (mesh, uv) = square();
        let inner = [[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]];
        let stacked = |z: f64| {
            let positions = mesh.positions().iter().copied().chain(inner.map(|[x, y]| Point3::new(x, y, z))).collect();
            let faces = [[4, 5, 6], [4, 6, 7], [0, 1, 2], [0, 2, 3]];
            let mesh = TriMesh::new(positions, &faces).expect("indices in range");
            let points: Vec<_> = uv.points().iter().copied().chain(inner.map(Point2::from)).collect();
            draw(&mesh, &UvMap::per_vertex(&mesh, &points), &small())
        };
        let (alone, behind, before) = (draw(&mesh, &uv, &small()), stacked(-1.0), stacked(1.0));
        // The left edge of the inner square lies between columns 23 and 24.
        let row = |canvas: &Pixmap| [20, 23, 24, 30].map(|x| pixel(canvas, x, 60));
        assert_eq!(row(&behind), row(&alone));
        assert_ne!(row(&before), row(&alone));
    }

    #[test]
    fn a_flipped_triangle_is_red_and_the_others_are_not() {
        let (mesh, _) = square();
        let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 4]];
        let mut positions = mesh.positions().to_vec();
        positions.push(Point3::new(-1.0, 0.5, 0.0));
        let mesh = TriMesh::new(positions, &faces).expect("indices in range");
        // The last face is folded back over the square.
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]].map(Point2::from);
        let canvas = draw(&mesh, &UvMap::per_vertex(&mesh, &corners), &small());
        let is_red = |[r, g, b]: [u8; 3]| r > 200 && g < 80 && b < 80;
        assert!(is_red(pixel(&canvas, 115, 50)));
        assert!(!is_red(pixel(&canvas, 185, 50)));
    }

    #[test]
    fn a_flipped_triangle_leaves_a_mark_however_small_it_is() {
        let (mesh, _) = square();
        let mut positions = mesh.positions().to_vec();
        positions.push(Point3::new(2.0, 0.5, 0.0));
        let mesh = TriMesh::new(positions, &[[0, 1, 2], [0, 2, 3], [1, 4, 2]]).expect("indices in range");
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0 - 1e-9, 0.5]].map(Point2::from);
        let canvas = draw(&mesh, &UvMap::per_vertex(&mesh, &corners), &PictureStyle { line_width: 0.0, ..small() });
        let [r, g, b] = pixel(&canvas, 193, 50);
        assert!(r > 200 && g < 80 && b < 80);
    }

    #[test]
    fn a_surface_seen_from_its_back_is_grey() {
        let (mesh, uv) = square();
        let view = View::Direction { towards_viewer: [0.0, 0.0, -1.0].into(), up: [0.0, 1.0, 0.0].into() };
        let canvas = draw(&mesh, &uv, &PictureStyle { view, ..small() });
        let [r, g, b] = pixel(&canvas, 28, 72);
        assert!(r.abs_diff(g) < 12 && g.abs_diff(b) < 12 && r < 140);
    }

    #[test]
    fn the_same_input_gives_the_same_bytes() {
        let (mesh, uv) = square();
        assert_eq!(picture(&mesh, &uv, &small()), picture(&mesh, &uv, &small()));
    }

    #[test]
    fn a_layout_without_extent_or_beyond_all_bounds_is_drawn_without_panic() {
        let (mesh, _) = square();
        for z in [0.0, f64::MAX] {
            let corners = [[z, 0.0], [-z, 0.0], [0.0, z], [0.0, -z]].map(Point2::from);
            assert_eq!(draw(&mesh, &UvMap::per_vertex(&mesh, &corners), &small()).width(), 200);
        }
    }

    #[test]
    fn rejects_an_empty_mesh_and_one_without_area() {
        let empty = TriMesh::new(vec![Point3::origin()], &[]).expect("no faces");
        let uv = UvMap::new(Vec::new(), Vec::new());
        assert_eq!(picture(&empty, &uv, &small()), Err(MetricsError::NoFaces.into()));
        let point = TriMesh::new(vec![Point3::new(1.0, 2.0, 3.0); 3], &[[0, 1, 2]]).expect("indices in range");
        let uv = UvMap::per_vertex(&point, &[Point2::origin(); 3]);
        assert_eq!(picture(&point, &uv, &small()), Err(MetricsError::NoArea { faces: 1 }.into()));
    }

    #[test]
    fn rejects_the_map_of_another_mesh() {
        let (mesh, _) = square();
        let uv = UvMap::new(vec![Point2::origin()], vec![UvId::new(0); 3]);
        assert_eq!(picture(&mesh, &uv, &small()), Err(MetricsError::CornerCount { corners: 3, faces: 2 }.into()));
    }

    #[test]
    fn counts_faces_whose_coordinates_are_not_finite() {
        let (mesh, uv) = square();
        let broken = uv.clone().mapped(|p| if p.x > 0.5 { Point2::new(f64::NAN, p.y) } else { p });
        let error = MetricsError::UvNotFinite { first: FaceId::new(0), count: 2 };
        assert_eq!(picture(&mesh, &broken, &small()), Err(error.into()));
        let mut positions = mesh.positions().to_vec();
        positions[3].z = f64::INFINITY;
        let broken = TriMesh::new(positions, &[[0, 1, 2], [0, 2, 3]]).expect("indices in range");
        let error = MetricsError::PositionNotFinite { first: FaceId::new(1), count: 1 };
        assert_eq!(picture(&broken, &uv, &small()), Err(error.into()));
    }

    #[test]
    fn rejects_a_canvas_without_room_or_beyond_memory() {
        let (mesh, uv) = square();
        let sized = |width, height| picture(&mesh, &uv, &PictureStyle { width, height, ..small() });
        assert!(matches!(sized(0, 100), Err(PictureError::CanvasTooSmall { width: 0, .. })));
        assert!(matches!(sized(100, 1), Err(PictureError::CanvasTooSmall { height: 1, .. })));
        assert!(matches!(sized(u32::MAX, u32::MAX), Err(PictureError::CanvasTooLarge { .. })));
    }

    #[test]
    fn rejects_settings_outside_their_range() {
        let (mesh, uv) = square();
        let with = |change: fn(&mut PictureStyle)| {
            let mut style = small();
            change(&mut style);
            picture(&mesh, &uv, &style).expect_err("out of range").to_string()
        };
        assert_eq!(with(|s| s.supersampling = 0), "supersampling must be in 1..=8, got 0");
        assert_eq!(with(|s| s.checks = 0), "checks must be in 1..=10000, got 0");
        assert_eq!(with(|s| s.line_width = f64::NAN), "line_width must be in 0..=16 pixels, got NaN");
    }
}
