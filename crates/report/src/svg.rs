//! The layout in real units, as SVG: for cutters, plotters and drawing programs.
//!
//! A file has up to eight layers, in this order: `mesh` (edges within, to engrave or to leave out), `mountain` and `valley`
//! (folds), `cut` (where the layout ends, joined to loops so that a tool need not lift), `marks` (seams and flipped
//! triangles, for the eye only), `numbers` (the same number at both sides of a seam), `charts` (the number of every chart) and `scale` (a bar).
//! A seam is in `cut` on both of its sides, because the
//! material ends there; `marks` only says which of the cuts are seams. Inkscape shows the groups
//! as layers.

mod scale;

use std::fmt::Write;
use std::str::FromStr;

use abf_mesh::{CornerId, Point2, TriMesh, UvMap};
use abf_metrics::{FaceDistortion, Orientation, per_face};

use crate::PictureError;
use crate::drawing::folds::Folds;
use crate::drawing::labels::labels;
use crate::drawing::loops::{Chain, chains};
use crate::drawing::outline::Edges;
use crate::drawing::{check_charts, height_in_chart, seams};
use crate::panel::bounds;

/// Millimetres in an inch.
const MM_PER_INCH: f64 = 25.4;
/// Millimetres in a centimetre.
const MM_PER_CM: f64 = 10.0;
/// The largest page, millimetres: ten kilometres, far beyond any tool, still exact to a micrometre.
const LARGEST: f64 = 1e7;

/// The unit of length of a drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum SvgUnit {
    /// `mm`
    #[default]
    Millimetre,
    /// `cm`
    Centimetre,
    /// `in`
    Inch,
}

impl SvgUnit {
    /// How SVG writes the unit.
    #[must_use]
    pub const fn suffix(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Inch => "in",
        }
    }

    /// Its length in millimetres.
    #[must_use]
    pub const fn millimetres(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Centimetre => MM_PER_CM,
            Self::Inch => MM_PER_INCH,
        }
    }
}

impl FromStr for SvgUnit {
    type Err = UnknownUnit;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        [Self::Millimetre, Self::Centimetre, Self::Inch]
            .into_iter()
            .find(|unit| unit.suffix() == text)
            .ok_or_else(|| UnknownUnit { text: text.to_owned() })
    }
}

/// A unit of length that SVG does not have or this crate does not write.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{text:?} is no unit of length: use mm, cm or in")]
pub struct UnknownUnit {
    text: String,
}

/// What an SVG layout looks like.
#[derive(Clone, Debug, PartialEq)]
pub struct SvgStyle {
    /// The unit of the page and of all coordinates.
    pub unit: SvgUnit,
    /// How many millimetres a unit of the UVs is: 1 for a model in millimetres, 1000 for metres.
    pub mm_per_uv: f64,
    /// The empty border around the layout, millimetres.
    pub margin_mm: f64,
    /// The width of lines, millimetres. Cutters mostly want a hairline.
    pub line_width_mm: f64,
    /// Whether edges within the layout are written, in the layer `mesh`.
    pub mesh_edges: bool,
    /// Whether seams and flipped triangles are marked, in the layer `marks`.
    pub marks: bool,
    /// Whether a bar of a known length is drawn below the layout, in the layer `scale`.
    pub scale_bar: bool,
    /// Edges where the surface turns by at least so much, rad, are folds, in the layers `mountain`, where the front of the sheet is
    /// outside, and `valley`, where it is inside. Without it there are none.
    pub folds: Option<f64>,
    /// Digits after the point; with 8, lengths are exact to a millionth of a millimetre.
    pub decimals: usize,
}

impl Default for SvgStyle {
    fn default() -> Self {
        Self {
            unit: SvgUnit::default(),
            mm_per_uv: 1.0,
            margin_mm: 5.0,
            line_width_mm: 0.1,
            mesh_edges: true,
            marks: true,
            scale_bar: false,
            folds: None,
            decimals: 8,
        }
    }
}

/// Writes the layout as an SVG file in real units.
///
/// The page is as large as the layout and its margin; y points up as in the UVs, so nothing is
/// mirrored. Loops start at the edge of the lowest corner index. `charts` has the chart of every face, counted from 0;
/// without it charts have no numbers. The same input gives the same text.
///
/// # Errors
/// A [`PictureError`] if the mesh has no faces or no area, the map or the charts belong to another mesh, a
/// coordinate is not finite, or a length of the style is out of its range.
///
/// ```
/// use abf_mesh::{Point2, Point3, TriMesh, UvMap};
/// use abf_report::svg::{SvgStyle, layout_svg};
///
/// let corners = [[0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [0.0, 30.0, 0.0]].map(Point3::from);
/// let mesh = TriMesh::new(corners.to_vec(), &[[0, 1, 2]])?;
/// let uv = UvMap::per_vertex(&mesh, &corners.map(|p| Point2::new(p.x, p.y)));
/// let svg = layout_svg(&mesh, &uv, None, &SvgStyle::default())?;
/// assert!(svg.contains(r#"width="50mm" height="40mm" viewBox="0 0 50 40""#));
/// assert!(svg.contains(r#"d="M5 35L45 35L5 5Z""#));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn layout_svg(
    mesh: &TriMesh,
    uv: &UvMap,
    charts: Option<&[u32]>,
    style: &SvgStyle,
) -> Result<String, PictureError> {
    let faces = per_face(mesh, uv)?;
    check_charts(mesh, charts)?;
    let sheet = Sheet::new(uv, style)?;
    let edges = Edges::of(mesh, uv);
    let mut out = sheet.head();
    if style.mesh_edges && !edges.joined.is_empty() {
        let lines = sheet.lines(&edges.joined.iter().map(|&[c, _]| c).collect::<Vec<_>>());
        sheet.layer(&mut out, "mesh", r##"fill="none" stroke="#2f6fb0""##, &[("edges", lines)]);
    }
    if let Some(angle) = style.folds {
        sheet.folds(&mut out, &Folds::of(mesh, &edges.joined, angle));
    }
    let cut = sheet.chains(&chains(uv, &edges.open));
    sheet.layer(&mut out, "cut", r##"fill="none" stroke="#d4001a""##, &[("outline", cut)]);
    if style.marks {
        sheet.marks(&mut out, &edges.seams, &faces);
        sheet.numbers(&mut out, &seams::marks(mesh, uv, &edges));
    }
    if let Some(charts) = charts {
        let highest = height_in_chart((sheet.high - sheet.low).max(), style.mm_per_uv);
        sheet.chart_numbers(&mut out, &labels(uv, &edges, charts, highest));
    }
    if style.scale_bar {
        sheet.scale_bar(&mut out);
    }
    out.push_str("</svg>\n");
    Ok(out)
}

/// The page: how UVs become places on it, and how those are written.
struct Sheet<'a> {
    uv: &'a UvMap,
    style: &'a SvgStyle,
    low: Point2<f64>,
    high: Point2<f64>,
    /// Units of the page in one of the UVs.
    scale: f64,
}

impl<'a> Sheet<'a> {
    fn new(uv: &'a UvMap, style: &'a SvgStyle) -> Result<Self, PictureError> {
        let (low, high) = bounds(uv.triangles().flatten());
        let size_mm = (high - low).max() * style.mm_per_uv;
        for (setting, value, in_range, allowed) in [
            ("mm_per_uv", style.mm_per_uv, style.mm_per_uv > 0.0, "positive"),
            ("margin_mm", style.margin_mm, style.margin_mm >= 0.0, "not negative"),
            ("line_width_mm", style.line_width_mm, style.line_width_mm > 0.0, "positive"),
            ("the longer side of the layout", size_mm, true, "finite"),
        ] {
            if !in_range || !(value <= LARGEST) {
                return Err(PictureError::Length { setting, allowed, value, max: LARGEST });
            }
        }
        Ok(Self { uv, style, low, high, scale: style.mm_per_uv / style.unit.millimetres() })
    }

    /// A length in millimetres as one in the unit of the page.
    fn in_unit(&self, length: f64) -> f64 {
        length / self.style.unit.millimetres()
    }

    fn number(&self, x: f64) -> String {
        decimal(x, self.style.decimals)
    }

    /// The place of a UV point, with y down.
    fn place(&self, uv: Point2<f64>) -> String {
        let margin = self.in_unit(self.style.margin_mm);
        let (right, down) = (self.scale * (uv.x - self.low.x), self.scale * (self.high.y - uv.y));
        format!("{} {}", self.number(margin + right), self.number(margin + down))
    }

    /// The file up to its first layer.
    fn head(&self) -> String {
        let margins = 2.0 * self.in_unit(self.style.margin_mm);
        let [width, height] =
            [self.high.x - self.low.x, self.high.y - self.low.y].map(|side| margins + self.scale * side);
        let strip = if self.style.scale_bar { self.in_unit(scale::STRIP_MM) } else { 0.0 };
        let [width, height] = [width, height + strip].map(|side| self.number(side));
        let unit = self.style.unit.suffix();
        format!(
            concat!(
                "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
                "<svg xmlns=\"http://www.w3.org/2000/svg\" ",
                "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" version=\"1.1\" ",
                "width=\"{0}{2}\" height=\"{1}{2}\" viewBox=\"0 0 {0} {1}\">\n",
            ),
            width, height, unit
        )
    }

    /// Writes a layer of named paths.
    fn layer(&self, out: &mut String, name: &str, look: &str, paths: &[(&str, String)]) {
        let width = self.number(self.in_unit(self.style.line_width_mm).max(0.1_f64.powi(self.style.decimals as i32)));
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "<g id=\"{name}\" inkscape:groupmode=\"layer\" inkscape:label=\"{name}\" {look} \
             stroke-width=\"{width}\" stroke-linejoin=\"round\" stroke-linecap=\"round\">"
        );
        for (id, data) in paths {
            let _ = writeln!(out, "<path id=\"{id}\" d=\"{data}\"/>");
        }
        out.push_str("</g>\n");
    }

    /// Writes the layer of what is wrong or worth knowing, if there is anything.
    fn marks(&self, out: &mut String, seams: &[CornerId], faces: &[FaceDistortion]) {
        let is_flipped = |face: &FaceDistortion| face.orientation == Orientation::Flipped;
        let mut paths = Vec::new();
        if faces.iter().any(is_flipped) {
            paths.push(("flipped", self.triangles(faces, Orientation::Flipped)));
        }
        if !seams.is_empty() {
            paths.push(("seams", self.lines(seams)));
        }
        if !paths.is_empty() {
            self.layer(out, "marks", r##"fill="#f5a300" stroke="#7a4bc2""##, &paths);
        }
    }

    /// Writes folds: mountains dashed and dotted, valleys dashed.
    fn folds(&self, out: &mut String, folds: &Folds) {
        let kinds =
            [("mountain", &folds.mountains, &[3.0, 1.0, 0.5, 1.0][..]), ("valley", &folds.valleys, &[2.0, 1.0][..])];
        for (name, edges, dash) in kinds.into_iter().filter(|(_, edges, _)| !edges.is_empty()) {
            let dash: Vec<String> = dash.iter().map(|&mm| self.number(self.in_unit(mm))).collect();
            let look = format!(r##"fill="none" stroke="#1f8a4c" stroke-dasharray="{}""##, dash.join(" "));
            self.layer(out, name, &look, &[(&format!("{name}-folds"), self.lines(edges))]);
        }
    }

    /// Every edge as a line of its own.
    fn lines(&self, edges: &[CornerId]) -> String {
        let line = |&c: &CornerId| {
            let [from, to] = [c, c.next()].map(|c| self.place(self.uv.corner(c)));
            format!("M{from}L{to}")
        };
        edges.iter().map(line).collect()
    }

    /// Chains of edges as polylines, closed where they are.
    fn chains(&self, chains: &[Chain]) -> String {
        let mut data = String::new();
        for chain in chains {
            for (k, &point) in chain.points.iter().enumerate() {
                data.push(if k == 0 { 'M' } else { 'L' });
                data.push_str(&self.place(point));
            }
            if chain.closed {
                data.push('Z');
            }
        }
        data
    }

    /// The faces that lie in one way, as closed triangles.
    fn triangles(&self, faces: &[FaceDistortion], orientation: Orientation) -> String {
        let lying = self.uv.triangles().zip(faces).filter(|(_, face)| face.orientation == orientation);
        lying.map(|(triangle, _)| triangle.map(|p| self.place(p))).map(|[a, b, c]| format!("M{a}L{b}L{c}Z")).collect()
    }
}

/// A number with at most so many digits after the point, without trailing zeros and without −0.
pub(crate) fn decimal(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests;
