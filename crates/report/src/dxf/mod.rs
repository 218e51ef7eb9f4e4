//! The layout in real units, as DXF: for CAD programs, cutters and folding machines.
//!
//! An ASCII file of release 2000 (`AC1015`), which has units (`$INSUNITS`), with three layers:
//!
//! * `CUT`: where the layout ends, as closed polylines;
//! * `FOLD`: folds, as lines; those of linetype `MOUNTAIN` come towards whoever looks at the front, those of `VALLEY` go away;
//! * `LABEL`: the number of every chart, and the numbers at both sides of every seam.
//!
//! The lower left corner of the layout is the origin. Nothing in the file depends on the time.

mod frame;

use crate::PictureError;
use crate::drawing::folds::Folds;
use crate::drawing::labels::labels;
use crate::drawing::loops::chains;
use crate::drawing::outline::Edges;
use crate::drawing::seams::marks;
use crate::drawing::{check_charts, height_at_seam, height_in_chart};
use crate::panel::bounds;
use crate::svg::SvgUnit;
use abf_mesh::{CornerId, Point2, TriMesh, UvMap};
use abf_metrics::per_face;
use frame::{Writer, file};

/// The largest layout, millimetres: ten kilometres.
const LARGEST: f64 = 1e7;

/// What a DXF layout looks like.
#[derive(Clone, Debug, PartialEq)]
pub struct DxfStyle {
    /// The unit of all coordinates.
    pub unit: SvgUnit,
    /// How many millimetres a unit of the UVs is: 1 for a model in millimetres, 1000 for metres.
    pub mm_per_uv: f64,
    /// Whether charts and seams are numbered, in the layer `LABEL`.
    pub labels: bool,
    /// Edges where the surface turns by at least so much, rad, are folds. Without it there are none.
    pub folds: Option<f64>,
    /// Digits after the point; with 8, lengths are exact to a millionth of a millimetre.
    pub decimals: usize,
}

impl Default for DxfStyle {
    fn default() -> Self {
        Self { unit: SvgUnit::default(), mm_per_uv: 1.0, labels: true, folds: None, decimals: 8 }
    }
}

/// Writes the layout as a DXF file in real units. `charts` has the chart of every face, counted from 0; without it charts
/// have no numbers. y points up as in the UVs. The same input gives the same text.
///
/// # Errors
/// A [`PictureError`] if the mesh has no faces or no area, the map or the charts belong to another mesh, a coordinate is
/// not finite, or a length is out of its range.
///
/// ```
/// use abf_mesh::{Point2, Point3, TriMesh, UvMap};
/// use abf_report::dxf::{DxfStyle, layout_dxf};
///
/// let corners = [[0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [0.0, 30.0, 0.0]].map(Point3::from);
/// let mesh = TriMesh::new(corners.to_vec(), &[[0, 1, 2]])?;
/// let uv = UvMap::per_vertex(&mesh, &corners.map(|p| Point2::new(p.x, p.y)));
/// let dxf = layout_dxf(&mesh, &uv, None, &DxfStyle::default())?;
/// assert!(dxf.contains("AcDbPolyline\n90\n3\n70\n1\n10\n0.0\n20\n0.0\n10\n40.0\n20\n0.0\n10\n0.0\n20\n30.0\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn layout_dxf(
    mesh: &TriMesh,
    uv: &UvMap,
    charts: Option<&[u32]>,
    style: &DxfStyle,
) -> Result<String, PictureError> {
    per_face(mesh, uv)?;
    check_charts(mesh, charts)?;
    let plane = Plane::new(uv, style)?;
    let edges = Edges::of(mesh, uv);
    let mut writer = Writer::new(style.decimals);
    for chain in chains(uv, &edges.open) {
        let points: Vec<[f64; 2]> = chain.points.iter().map(|&p| plane.place(p)).collect();
        writer.polyline("CUT", &points, chain.closed);
    }
    if let Some(angle) = style.folds {
        let folds = Folds::of(mesh, &edges.joined, angle);
        for (linetype, edges) in [("MOUNTAIN", &folds.mountains), ("VALLEY", &folds.valleys)] {
            for &c in edges {
                writer.line("FOLD", Some(linetype), [c, c.next()].map(|c: CornerId| plane.place(uv.corner(c))));
            }
        }
    }
    if style.labels {
        let longer = (plane.high - plane.low).max();
        for mark in marks(mesh, uv, &edges) {
            let height = height_at_seam(&mark, longer, style.mm_per_uv);
            let along = |part: f64| plane.place(mark.at + mark.inward * (part * height));
            writer.line("LABEL", None, [along(0.0), along(0.5)]);
            writer.text("LABEL", &mark.number.to_string(), along(1.2), plane.scale * height);
        }
        for label in
            charts.map(|charts| labels(uv, &edges, charts, height_in_chart(longer, style.mm_per_uv))).iter().flatten()
        {
            writer.text("LABEL", &label.number.to_string(), plane.place(label.at), plane.scale * label.height);
        }
    }
    Ok(file(&writer, style.unit, plane.place(plane.high)))
}

/// How UVs become places on the drawing.
struct Plane {
    low: Point2<f64>,
    high: Point2<f64>,
    /// Units of the drawing in one of the UVs.
    scale: f64,
}

impl Plane {
    fn new(uv: &UvMap, style: &DxfStyle) -> Result<Self, PictureError> {
        let (low, high) = bounds(uv.triangles().flatten());
        let size_mm = (high - low).max() * style.mm_per_uv;
        for (setting, value, in_range, allowed) in [
            ("mm_per_uv", style.mm_per_uv, style.mm_per_uv > 0.0, "positive"),
            ("the longer side of the layout", size_mm, true, "finite"),
        ] {
            if !in_range || !(value <= LARGEST) {
                return Err(PictureError::Length { setting, allowed, value, max: LARGEST });
            }
        }
        Ok(Self { low, high, scale: style.mm_per_uv / style.unit.millimetres() })
    }

    fn place(&self, p: Point2<f64>) -> [f64; 2] {
        [self.scale * (p.x - self.low.x), self.scale * (p.y - self.low.y)]
    }
}

#[cfg(test)]
mod tests;
