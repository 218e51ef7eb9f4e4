//! Charts side by side in units of the mesh: what is cut from a sheet.

use crate::Flattening;
use crate::atlas::judge::Judge;
use crate::atlas::{AtlasError, Placement, Stored, outline_of, proved};
use crate::unwrap::Unwrapped;
use abf_control::UnknownName;
use abf_mesh::{CornerId, FaceId, Point2, TriMesh, UvId, UvMap};
use abf_metrics::{Metrics, measure_certified};
use abf_pack::{Piece, SideBySide, side_by_side};
use abf_parallel::prelude::*;

/// A fiftieth of the longest chart stays free between two charts, if nothing is said.
const GAP: f64 = 0.02;
/// By how much a scale may differ from 1 by rounding.
const SCALE_ROUNDING: f64 = 1e-6;

/// How charts are laid out in real units: side by side, at the scale of the mesh.
///
/// A length on the sheet is a length on the surface wherever the surface can be unrolled. Elsewhere every chart has the area of
/// its surface.
///
/// ```
/// use abf::mesh::{Point3, TriMesh};
/// use abf::{Pattern, Silent, SurfaceHints, Unwrap};
///
/// // A tetrahedron whose edges have the length √2.
/// let points = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]].map(Point3::from);
/// let mesh = TriMesh::new(points.to_vec(), &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])?;
/// let unwrapped = Unwrap::default().run(&mesh, &SurfaceHints::default(), &mut Silent)?;
/// let sheet = Pattern::default().lay(&mesh, &unwrapped)?;
/// // Its net has edges of that length, too.
/// let [a, b, _] = sheet.uv.triangles().next().expect("four faces");
/// assert!(((b - a).norm() - 2.0_f64.sqrt()).abs() < 1e-6);
/// assert!(sheet.metrics.injective());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Pattern {
    /// How charts are turned.
    pub orient: Orient,
    /// What stays free between the boxes of two charts, in units of the mesh. Without it a fiftieth of the longest chart.
    pub gap: Option<f64>,
}

/// How charts are turned.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    Hash,
    strum::Display,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantNames,
)]
#[strum(serialize_all = "kebab-case", parse_err_ty = UnknownName, parse_err_fn = unknown)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Orient {
    /// Each into its tightest box, a single one lying on the longer side of it.
    #[default]
    Tight,
    /// Not at all.
    Keep,
}

/// Charts in real units.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Laid {
    /// One UV for every corner of the input, in units of the mesh, as it will be stored.
    pub uv: UvMap,
    /// Where every chart is, in the order of [`Unwrapped::charts`]. `texel` is in units of the mesh.
    pub placements: Vec<Placement>,
    /// The number of the chart of every face of the input. Faces of no chart have none: they were dropped by repair, or are
    /// of components without any area.
    pub chart_of: Vec<Option<u32>>,
    /// The faces that run the other way in the UVs: those that repair turned around, ascending.
    pub turned: Vec<FaceId>,
    /// Width and height of all, in units of the mesh. The lower left corner is the origin, but for a disk that is not turned.
    pub size: [f64; 2],
    /// Distortion of all charts together, and what is proved of the UVs as stored.
    pub metrics: Metrics,
}

/// The surface that is laid out, for drawing: the faces that are in charts, each as it is in the plane.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Developed {
    /// The vertices of the input, and the faces that are in charts, counter-clockwise in the plane.
    pub mesh: TriMesh,
    /// Its UVs.
    pub uv: UvMap,
    /// The chart of every face, counted from 0.
    pub charts: Vec<u32>,
}

impl Pattern {
    /// Lays out the charts of a mesh, with UVs in doubles.
    ///
    /// # Errors
    /// [`AtlasError`]: the gap is no length, or the UVs cannot be judged.
    pub fn lay(&self, mesh: &TriMesh, unwrapped: &Unwrapped) -> Result<Laid, AtlasError> {
        self.lay_stored(mesh, unwrapped, Stored::default())
    }

    /// The same for a format that stores points in its own way; they are certified in its precision.
    ///
    /// A chart that is valid before, and would not be after turning and rounding, is not turned.
    ///
    /// # Errors
    /// As [`Self::lay`].
    pub fn lay_stored(&self, mesh: &TriMesh, unwrapped: &Unwrapped, stored: Stored) -> Result<Laid, AtlasError> {
        let charts = &unwrapped.charts;
        let keeps_its_angle = self.orient == Orient::Keep;
        let piece = |chart| Piece { polygons: outline_of(chart), group: 0, keeps_its_angle };
        let mut pieces: Vec<Piece> = charts.par_iter().map(piece).collect();
        let gap = self.gap.unwrap_or_else(|| GAP * longest(charts.iter().map(|chart| &chart.uv)));
        let every_face = [charts.iter().flat_map(|chart| chart.faces.iter().copied()).collect()];
        loop {
            let SideBySide { placements, size, .. } = side_by_side(&pieces, gap).map_err(AtlasError::Pack)?;
            let placements: Vec<Placement> = placements.into_iter().map(Placement::from).collect();
            let uv = unwrapped.assemble(|i, p| stored.point(placed(placements[i], p)));
            let judge = Judge::new(mesh, &unwrapped.turned, &uv, stored.precision());
            let certificate = judge.certificate(&every_face)?;
            let mut spoilt = judge.spoilt(proved(charts), &certificate)?;
            spoilt.retain(|&i| !pieces[i].keeps_its_angle);
            if spoilt.is_empty() {
                let mut chart_of = vec![None; mesh.face_count()];
                for (i, chart) in charts.iter().enumerate() {
                    chart.faces.iter().for_each(|f| chart_of[f.index()] = Some(i as u32));
                }
                let metrics = judge.metrics(&every_face[0], certificate, [1, 1])?;
                let turned = unwrapped.turned.clone();
                return Ok(Laid { uv, placements, chart_of, turned, size, metrics });
            }
            spoilt.iter().for_each(|&i| pieces[i].keeps_its_angle = true);
        }
    }

    /// Lays out a disk. UVs at another scale, as those of [`Pipeline::normalize`](crate::Pipeline::normalize), get the
    /// area of the surface. A map that would be less valid for being turned stays as it is.
    ///
    /// # Errors
    /// As [`Self::lay`]; and when `mesh` is not the mesh that was flattened.
    pub fn lay_disk(&self, mesh: &TriMesh, flat: &Flattening) -> Result<Laid, AtlasError> {
        let precision = flat.certificate.precision;
        let scale = to_scale(mesh, &flat.uv);
        let scaled = flat.uv.clone().mapped(|p| p * scale);
        let piece = Piece { keeps_its_angle: self.orient == Orient::Keep, ..Piece::new(vec![places(&scaled)]) };
        let SideBySide { placements, size, .. } =
            side_by_side(&[piece], self.gap.unwrap_or(0.0)).map_err(AtlasError::Pack)?;
        let placement = Placement::from(placements[0]);
        let as_it_was = Placement { turn: [1.0, 0.0], low: Point2::origin(), ..placement };
        let place = |at: Placement| {
            let uv = scaled.clone().mapped(|p| placed(at, p).map(|x| precision.round(x)));
            abf_metrics::certify_stored(mesh, &uv, precision).map(|certificate| (uv, certificate, at))
        };
        let first = if self.orient == Orient::Keep { as_it_was } else { placement };
        let (uv, certificate, at) = match place(first)? {
            (_, certificate, _) if flat.certificate.valid() && !certificate.valid() => place(as_it_was)?,
            placed => placed,
        };
        let metrics = measure_certified(mesh, &uv, certificate)?;
        let size = if at == placement { size } else { extent(&uv) };
        let chart_of = vec![Some(0); mesh.face_count()];
        Ok(Laid { uv, placements: vec![at], chart_of, turned: Vec::new(), size, metrics })
    }
}

impl Laid {
    /// The surface that is laid out, without faces of no chart, and with those that were turned as they were turned.
    ///
    /// # Panics
    /// If `mesh` is not the mesh that this is of.
    #[must_use]
    pub fn developed(&self, mesh: &TriMesh) -> Developed {
        let (mut faces, mut corners, mut charts) = (Vec::new(), Vec::new(), Vec::new());
        for (index, chart) in self.chart_of.iter().enumerate() {
            let (face, Some(chart)) = (FaceId::new(index), chart) else { continue };
            let [a, b, c] = face.corners();
            let is_turned = self.turned.binary_search(&face).is_ok();
            let in_order: [CornerId; 3] = if is_turned { [a, c, b] } else { [a, b, c] };
            faces.push(in_order.map(|corner| mesh.faces()[index][corner.place()].index()));
            corners.extend(in_order.map(|corner| self.uv.corners()[corner.index()]));
            charts.push(*chart);
        }
        let mesh = TriMesh::new(mesh.positions().to_vec(), &faces).expect("faces of a mesh");
        Developed { mesh, uv: UvMap::new(self.uv.points().to_vec(), corners), charts }
    }

    /// Three places in the plane for every triangle of the input, in units of the mesh.
    #[must_use]
    pub fn triangles(&self) -> Vec<[[f64; 2]; 3]> {
        let place = |&id: &UvId| {
            let p = self.uv.points()[id.index()];
            [p.x, p.y]
        };
        self.uv.corners().as_chunks::<3>().0.iter().map(|three| three.each_ref().map(place)).collect()
    }
}

/// Where a point of a chart is put, in units of the mesh.
fn placed(at: Placement, p: Point2<f64>) -> Point2<f64> {
    at.scaled(p, 1.0)
}

/// By what the UVs have to be multiplied to have the area of the surface; 1 if they have it.
fn to_scale(mesh: &TriMesh, uv: &UvMap) -> f64 {
    let scale = (mesh.area() / uv.area()).sqrt();
    let is_another = scale.is_finite() && scale > 0.0 && (scale - 1.0).abs() > SCALE_ROUNDING;
    if is_another { scale } else { 1.0 }
}

fn places(uv: &UvMap) -> Vec<[f64; 2]> {
    uv.points().iter().map(|p| [p.x, p.y]).collect()
}

/// The longer side of the longest box.
fn longest<'a>(maps: impl Iterator<Item = &'a UvMap>) -> f64 {
    maps.map(|uv| extent(uv).into_iter().fold(0.0, f64::max)).fold(0.0, f64::max)
}

fn extent(uv: &UvMap) -> [f64; 2] {
    uv.bounds().map_or([0.0; 2], |(low, high)| [high.x - low.x, high.y - low.y])
}

impl Orient {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::Tight, Self::Keep];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<Orient>("orientation", given)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SurfaceHints, Unwrap, flatten};
    use abf_control::Silent;
    use abf_mesh::Point3;

    /// Half a tube of the radius 50 and the length 100, in facets.
    fn half_tube(facets: usize) -> TriMesh {
        let angle = |i: usize| i as f64 * std::f64::consts::PI / facets as f64;
        let ring = |i: usize| [0.0, 100.0].map(|z| Point3::new(50.0 * angle(i).cos(), 50.0 * angle(i).sin(), z));
        let points = (0..=facets).flat_map(ring).collect();
        let faces: Vec<[usize; 3]> =
            (0..facets).map(|i| 2 * i).flat_map(|a| [[a, a + 2, a + 3], [a, a + 3, a + 1]]).collect();
        TriMesh::new(points, &faces).expect("indices in range")
    }

    fn cube() -> TriMesh {
        let corner = |i: usize| Point3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64) * 10.0;
        let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces: Vec<[usize; 3]> = squares.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriMesh::new((0..8).map(corner).collect(), &faces).expect("indices in range")
    }

    /// The largest difference between the lengths of an edge in the plane and on the surface.
    fn worst(mesh: &TriMesh, uv: &UvMap) -> f64 {
        let side = |(p, q): ([Point3<f64>; 3], [Point2<f64>; 3])| {
            let differ = |i: usize, k: usize| ((p[k] - p[i]).norm() - (q[k] - q[i]).norm()).abs();
            differ(0, 1).max(differ(1, 2)).max(differ(2, 0))
        };
        mesh.triangles().zip(uv.triangles()).map(side).fold(0.0, f64::max)
    }

    #[test]
    fn half_a_tube_lies_unrolled_in_its_box() {
        let mesh = half_tube(36);
        let flat = flatten(&mesh).expect("a disk");
        let laid = Pattern::default().lay_disk(&mesh, &flat).expect("a layout");
        let girth = 36.0 * 100.0 * (std::f64::consts::PI / 72.0).sin();
        assert!((laid.size[0] - girth).abs() < 1e-9 && (laid.size[1] - 100.0).abs() < 1e-9, "{:?}", laid.size);
        assert!(worst(&mesh, &laid.uv) < 1e-9);
        let (low, _) = laid.uv.bounds().expect("points");
        assert_eq!([low.x, low.y], [0.0; 2]);
        assert!(laid.metrics.injective());
    }

    #[test]
    fn a_disk_that_keeps_its_angle_keeps_its_bits() {
        let mesh = half_tube(12);
        let flat = flatten(&mesh).expect("a disk");
        let keep = Pattern { orient: Orient::Keep, ..Pattern::default() };
        assert_eq!(keep.lay_disk(&mesh, &flat).expect("a layout").uv, flat.uv);
    }

    #[test]
    fn a_disk_in_the_unit_square_comes_back_to_scale() {
        let mesh = half_tube(12);
        let flat = crate::Pipeline { normalize: true, ..crate::Pipeline::default() }.run(&mesh, &mut Silent);
        let laid = Pattern::default().lay_disk(&mesh, &flat.expect("a disk")).expect("a layout");
        assert!(worst(&mesh, &laid.uv) < 1e-9);
    }

    #[test]
    fn charts_of_a_box_and_a_tube_lie_apart_at_scale_one() {
        let (tube, cube) = (half_tube(12), cube());
        let moved = cube.positions().iter().map(|p| Point3::new(p.x + 200.0, p.y, p.z));
        let points: Vec<Point3<f64>> = tube.positions().iter().copied().chain(moved).collect();
        let faces = tube.faces().iter().map(|f| f.map(abf_mesh::VertexId::index));
        let shifted = cube.faces().iter().map(|f| f.map(|v| v.index() + tube.vertex_count()));
        let mesh = TriMesh::new(points, &faces.chain(shifted).collect::<Vec<_>>()).expect("indices in range");
        let unwrapped = Unwrap::default().run(&mesh, &SurfaceHints::default(), &mut Silent).expect("charts");
        let laid = Pattern { gap: Some(3.0), ..Pattern::default() }.lay(&mesh, &unwrapped).expect("a layout");
        assert_eq!(unwrapped.charts.len(), 2);
        assert!(worst(&mesh, &laid.uv) < 1e-8 && laid.metrics.injective());
        let box_of = |chart: u32| {
            let faces = laid.chart_of.iter().enumerate().filter(|(_, of)| **of == Some(chart));
            abf_mesh::bounds(faces.flat_map(|(f, _)| laid.uv.triangle(FaceId::new(f)))).expect("points")
        };
        let ((a, b), (c, d)) = (box_of(0), box_of(1));
        let apart = (c.x - b.x).max(a.x - d.x).max(c.y - b.y).max(a.y - d.y);
        assert!((apart - 3.0).abs() < 1e-9, "{apart}");
    }

    #[test]
    fn what_is_developed_leaves_out_dropped_faces_and_turns_what_was_turned() {
        // A square whose second face is turned around, and a face that uses a vertex twice.
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
        let mesh = TriMesh::new(points.to_vec(), &[[0, 1, 2], [0, 3, 2], [0, 1, 1]]).expect("indices in range");
        let unwrapped = Unwrap::default().run(&mesh, &SurfaceHints::default(), &mut Silent).expect("charts");
        let laid = Pattern::default().lay(&mesh, &unwrapped).expect("a layout");
        let developed = laid.developed(&mesh);
        assert_eq!((developed.mesh.face_count(), developed.charts.as_slice()), (2, &[0, 0][..]));
        let is_upright = |[a, b, c]: [Point2<f64>; 3]| (b - a).perp(&(c - a)) > 0.0;
        assert!(developed.uv.triangles().all(is_upright));
        assert!(worst(&developed.mesh, &developed.uv) < 1e-9);
        assert_eq!(laid.triangles().len(), 3);
    }
}
