//! What is proved of a UV map: which triangles are turned over, wind, or lie over each other.

use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{CornerId, FaceId, Topology, TriMesh, UvId, UvMap, VertexId};
use abf_overlap::{Fan, Overlaps, Sheet, turns, winds_twice};
use abf_parallel::prelude::*;
use std::borrow::Cow;
use std::cell::OnceCell;

use crate::face::{Orientation, Survey};
use crate::interval::Interval;
#[cfg(feature = "serde")]
use crate::serialise;
use crate::triangle::{cotangents, is_within_rounding};
use crate::{MetricsError, Precision};

/// Fewer corners are not worth a thread.
const CORNERS_PER_TASK: usize = 1 << 13;

/// What is proved of a UV map as it is stored.
///
/// Every count comes from signs of areas and comparisons of the stored coordinates, all exact (as long as
/// products of coordinate differences do not underflow: differences above 1e-120 of the largest
/// coordinate). So [`valid`](Self::valid) and [`injective`](Self::injective) are proofs, not measurements.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Certificate {
    /// What the coordinates were rounded to before.
    #[cfg_attr(feature = "serde", serde(serialize_with = "serialise::text"))]
    pub precision: Precision,
    /// How many charts: connected components of the UV points, where a face connects its three.
    pub charts: usize,
    /// Triangles whose orientation is opposite to the area-weighted majority of their chart. A chart that
    /// is mirrored as a whole has none.
    pub flips: usize,
    /// Triangles whose three UVs lie on one line.
    pub collapsed: usize,
    /// Triangles on the right side whose area `A₂ ≤ 4 ε · max |coordinate| · (|e₁| + |e₂|)` is within the
    /// rounding of their own coordinates, with e₁, e₂ the edges at the first corner and ε that of
    /// [`precision`](Self::precision): valid as stored, but not safe from another rounding. Every
    /// triangle that could collapse or turn over when each of its coordinates moves by one unit in the
    /// last place of the largest is among them.
    pub near_collapsed: usize,
    /// Interior vertices around which the triangles wind more than once: every triangle is on the right
    /// side, and yet the map turns around the vertex like a screw. Vertices with a flipped or collapsed
    /// triangle are not counted. A boundary vertex whose triangles turn further than once is not among
    /// them: there the boundary overlaps itself ([`meetings`](Self::meetings)).
    pub wound: usize,
    /// Pairs of boundary edges that cross inside both; edges between the same places are one.
    pub crossings: usize,
    /// Points at ends of boundary edges where the boundary meets itself and two faces cover one direction:
    /// edges that lie on each other with their faces on the same side, corners that reach into others,
    /// boundary vertices whose triangles turn by more than a full turn.
    pub meetings: usize,
    /// Connected pieces of the boundary whose leftmost point lies under a part of the map that does not
    /// touch it: a chart inside a triangle of another chart, the rim of a hole over another part.
    pub nested: usize,
    /// Whether there are more overlaps than were counted: after millions the search ends.
    pub overlaps_are_least: bool,
    /// Points where the boundary meets itself and nothing is covered twice, and pairs of its edges that cross no deeper than
    /// [`TOUCH_ULPS`](Self::TOUCH_ULPS) units in the last place, of [`precision`](Self::precision), of the largest
    /// coordinate of their chart. These are no overlaps. Where a fold, or a face on another, lies deeper anywhere along the
    /// same piece of the boundary, they are [`crossings`](Self::crossings).
    pub touches: usize,
    /// How deep the deepest of those pairs crosses, in UV units: how far the nearest end of one is from the other.
    pub touch_depth: f64,
    /// `max |h|` of the constraints of the angles the map was laid out from, rad; `None` where there are
    /// none, as for a file that was read.
    pub constraint_residual: Option<f64>,
    /// The least angle of all UV triangles, rad, without sign.
    pub uv_angle_min: f64,
    /// The greatest, rad.
    pub uv_angle_max: f64,
    /// How much more lengths shrink in one place than in another: the largest `√(A₂ / A₃)` over the smallest, over the
    /// faces that have an area in 3-D ([`Metrics::degenerate_3d`](crate::Metrics::degenerate_3d)). Infinite with a
    /// collapsed one.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub spread: f64,
    /// The first flipped faces, at most [`LISTED`](Self::LISTED) of them.
    #[cfg_attr(feature = "serde", serde(serialize_with = "serialise::faces"))]
    pub flipped_faces: Vec<FaceId>,
    /// The first collapsed faces.
    #[cfg_attr(feature = "serde", serde(serialize_with = "serialise::faces"))]
    pub collapsed_faces: Vec<FaceId>,
    /// The first faces within rounding of it.
    #[cfg_attr(feature = "serde", serde(serialize_with = "serialise::faces"))]
    pub near_collapsed_faces: Vec<FaceId>,
    /// The first vertices that are wound around.
    #[cfg_attr(feature = "serde", serde(serialize_with = "serialise::vertices"))]
    pub wound_vertices: Vec<VertexId>,
    /// Pairs of faces that lie over each other, those of the first overlaps; a pair that overlaps in several places is
    /// there once.
    #[cfg_attr(feature = "serde", serde(serialize_with = "serialise::pairs"))]
    pub overlapping_faces: Vec<[FaceId; 2]>,
}

impl Certificate {
    /// How many offenders of each kind are listed by name.
    pub const LISTED: usize = 10;

    /// How many units in the last place sides that meet may cross.
    pub const TOUCH_ULPS: f64 = 4.0;

    /// Whether the map is locally one to one inside the surface: no triangle flipped, none collapsed, no
    /// vertex wound around.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.flips == 0 && self.collapsed == 0 && self.wound == 0
    }

    /// How many overlaps there are: crossings, meetings and nested pieces; at least so many where
    /// [`overlaps_are_least`](Self::overlaps_are_least).
    ///
    /// For a valid map this is zero if and only if no point of the plane is covered twice by the inside
    /// of triangles, but for what is within rounding of the boundary at [`touches`](Self::touches).
    #[must_use]
    pub fn overlaps(&self) -> usize {
        self.crossings + self.meetings + self.nested
    }

    /// Whether the map is one to one everywhere: valid and without overlap. Charts may touch.
    #[must_use]
    pub fn injective(&self) -> bool {
        self.valid() && self.overlaps() == 0 && !self.overlaps_are_least
    }
}

/// Certifies a UV map as a format of this precision stores it.
///
/// Takes time linear in the number of faces, and `O(b log b)` for b boundary edges that are short against
/// the whole; more where many long ones run side by side.
///
/// # Errors
/// [`MetricsError`] as for [`measure`](crate::measure), also when rounding makes a coordinate infinite.
pub fn certify(mesh: &TriMesh, uv: &UvMap, precision: Precision) -> Result<Certificate, MetricsError> {
    certify_asking(mesh, uv, precision, &mut || Ok(()))
}

/// [`certify`] that asks between its parts whether to go on.
///
/// # Errors
/// As for `certify`, and [`MetricsError::Cancelled`].
pub fn certify_asking(
    mesh: &TriMesh,
    uv: &UvMap,
    precision: Precision,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Certificate, MetricsError> {
    let uv = rounded(uv, precision);
    certify_stored_asking(mesh, &uv, precision, checkpoint)
}

/// The same for UVs that are what the format stores already, and need not be numbers of this precision: glTF stores `1 − v`.
///
/// # Errors
/// As for [`certify`].
pub fn certify_stored(mesh: &TriMesh, uv: &UvMap, precision: Precision) -> Result<Certificate, MetricsError> {
    certify_stored_asking(mesh, uv, precision, &mut || Ok(()))
}

/// [`certify_stored`] that asks between its parts whether to go on.
///
/// # Errors
/// As for `certify`, and [`MetricsError::Cancelled`].
pub fn certify_stored_asking(
    mesh: &TriMesh,
    uv: &UvMap,
    precision: Precision,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Certificate, MetricsError> {
    checkpoint()?;
    Ok(of_survey(&Survey::new(mesh, uv)?, None, precision, checkpoint)?)
}

/// The same certificate in less time, for a connected manifold whose corner table is at hand. A map that has not one
/// point for each vertex, in their order, is certified as any other.
///
/// # Errors
/// As for [`certify`].
pub fn certify_connected(
    mesh: &TriMesh,
    topology: &Topology,
    uv: &UvMap,
    precision: Precision,
) -> Result<Certificate, MetricsError> {
    certify_connected_asking(mesh, topology, uv, precision, &mut || Ok(()))
}

/// [`certify_connected`] that asks between its parts whether to go on.
///
/// # Errors
/// As for [`certify`], and [`MetricsError::Cancelled`].
pub fn certify_connected_asking(
    mesh: &TriMesh,
    topology: &Topology,
    uv: &UvMap,
    precision: Precision,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Certificate, MetricsError> {
    if !is_per_vertex(mesh, topology, uv) {
        return certify_asking(mesh, uv, precision, checkpoint);
    }
    let uv = rounded(uv, precision);
    checkpoint()?;
    Ok(of_survey(&Survey::of_one_chart(mesh, &uv)?, Some(topology), precision, checkpoint)?)
}

fn rounded(uv: &UvMap, precision: Precision) -> Cow<'_, UvMap> {
    match precision {
        Precision::Double => Cow::Borrowed(uv),
        Precision::Single => Cow::Owned(uv.clone().mapped(|p| p.map(|x| precision.round(x)))),
    }
}

/// Whether the corner table is that of the mesh, and every vertex has one UV point, in their order.
fn is_per_vertex(mesh: &TriMesh, topology: &Topology, uv: &UvMap) -> bool {
    let (vertices, points) = (mesh.faces().as_flattened(), uv.corners());
    if points.len() != vertices.len() || topology.corner_count() != vertices.len() {
        return false;
    }
    let point_of = |v: VertexId| topology.fan_start(v).map(|c| points[c.index()]);
    let same =
        |(c, (&v, &p)): (usize, (&VertexId, &UvId))| topology.vertex(CornerId::new(c)) == v && point_of(v) == Some(p);
    let corners = vertices.par_iter().zip(points).with_min_len(CORNERS_PER_TASK).enumerate();
    topology.vertex_count() == mesh.vertex_count()
        && corners.all(same)
        && topology.vertices().filter_map(point_of).is_sorted_by(|a, b| a < b)
}

/// The certificate of a map that has been looked at; of one with a point per vertex the corner table may be given.
pub(crate) fn of_survey(
    survey: &Survey<'_>,
    topology: Option<&Topology>,
    precision: Precision,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Certificate, Cancelled> {
    checkpoint()?;
    let faces = Faces::of(survey, precision.epsilon());
    checkpoint()?;
    let topology = topology.filter(|_| !survey.is_mirrored(FaceId::new(0)));
    let (mesh, uv, scale) = (survey.mesh(), survey.uv(), survey.uv_scale());
    let sheet = match topology {
        Some(topology) => Sheet::of_manifold(mesh, topology, uv, scale),
        None => Sheet::new(mesh, uv, scale, |f| survey.is_mirrored(FaceId::new(f))),
    };
    checkpoint()?;
    // Where a triangle is flipped or collapsed, the triangles of a fan do not all turn one way.
    let is_kept = |fan: Fan| sheet.fan_corners(fan).all(|c| survey.lies(c.face()) == Orientation::Kept);
    let twice = |fan: &Fan| is_kept(*fan) && winds_twice(&sheet, *fan);
    let (open, closed_twice) = match topology {
        Some(topology) => fans_of_manifold(&sheet, topology, faces.all_kept(), twice),
        None => {
            let (closed, open): (Vec<Fan>, Vec<Fan>) = sheet.fans().partition(|fan| fan.is_closed);
            (open, closed.into_iter().filter(twice).collect())
        }
    };
    checkpoint()?;
    let open_twice: Vec<Fan> = open.iter().copied().filter(twice).collect();
    let mut wound: Vec<VertexId> = closed_twice.iter().map(|fan| sheet.vertex(fan.first)).collect();
    wound.sort_unstable();
    wound.dedup();
    let largest = OnceCell::new();
    let rounding = |face: FaceId| {
        let largest: f64 = largest.get_or_init(|| survey.largest_coordinates())[survey.chart_of(face)];
        if largest > 0.0 { Certificate::TOUCH_ULPS * precision.epsilon() * largest.log2().floor().exp2() } else { 0.0 }
    };
    let overlaps = Overlaps::find(&sheet, &open, &open_twice, Certificate::LISTED, rounding, checkpoint)?;
    let wound_count = wound.len();
    wound.truncate(Certificate::LISTED);
    Ok(Certificate {
        precision,
        charts: survey.chart_count(),
        flips: faces.flipped.count,
        collapsed: faces.collapsed.count,
        near_collapsed: faces.near_collapsed.count,
        wound: wound_count,
        crossings: overlaps.crossings,
        meetings: overlaps.meetings,
        nested: overlaps.nested,
        overlaps_are_least: overlaps.are_least,
        touches: overlaps.touches,
        touch_depth: overlaps.touch_depth / scale,
        constraint_residual: None,
        uv_angle_min: angle_of(faces.cotangents.high),
        uv_angle_max: angle_of(faces.cotangents.low),
        spread: if faces.ratios.high > 0.0 { (faces.ratios.high / faces.ratios.low).sqrt() } else { 1.0 },
        flipped_faces: faces.flipped.first,
        collapsed_faces: faces.collapsed.first,
        near_collapsed_faces: faces.near_collapsed.first,
        wound_vertices: wound,
        overlapping_faces: overlaps.faces,
    })
}

/// The fans on the boundary, and those that close and wind more than once.
fn fans_of_manifold(
    sheet: &Sheet<'_>,
    topology: &Topology,
    all_kept: bool,
    twice: impl Fn(&Fan) -> bool,
) -> (Vec<Fan>, Vec<Fan>) {
    let fan = |v: VertexId| topology.fan_start(v).map(|first| sheet.fan_from(first));
    let open = topology.vertices().filter(|&v| topology.is_boundary(v)).filter_map(fan).collect();
    // Around a point among counter-clockwise triangles is at least one turn: as many turns as points are one for each.
    let once_each = || all_kept && turns(sheet, |v| topology.is_interior(v)) == topology.interior_vertex_count();
    if once_each() {
        return (open, Vec::new());
    }
    let closed = topology.vertices().filter(|&v| topology.is_interior(v)).filter_map(fan);
    (open, closed.filter(twice).collect())
}

/// What there is to say of all faces together.
#[derive(Default)]
struct Faces {
    flipped: Listed,
    collapsed: Listed,
    near_collapsed: Listed,
    cotangents: Interval,
    /// Of areas, `A₂ / A₃`.
    ratios: Interval,
}

impl Faces {
    fn of(survey: &Survey<'_>, epsilon: f64) -> Self {
        let blocks = survey.by_block(|all: &mut Self, face| all.take(survey, face, epsilon));
        blocks.into_iter().fold(Self::default(), Self::followed_by)
    }

    fn all_kept(&self) -> bool {
        self.flipped.count == 0 && self.collapsed.count == 0
    }

    fn take(&mut self, survey: &Survey<'_>, face: FaceId, epsilon: f64) {
        let (flat, area) = survey.flat_triangle(face);
        match survey.lies(face) {
            Orientation::Flipped => self.flipped.take(face),
            Orientation::Collapsed => self.collapsed.take(face),
            Orientation::Kept if is_within_rounding(&flat, area, epsilon) => self.near_collapsed.take(face),
            Orientation::Kept => {}
        }
        cotangents(&flat, area).into_iter().for_each(|cot| self.cotangents.take(cot));
        survey.area_ratio(face).into_iter().for_each(|ratio| self.ratios.take(ratio));
    }

    fn followed_by(mut self, later: Self) -> Self {
        self.flipped.append(later.flipped);
        self.collapsed.append(later.collapsed);
        self.near_collapsed.append(later.near_collapsed);
        self.cotangents.join(&later.cotangents);
        self.ratios.join(&later.ratios);
        self
    }
}

/// How many faces there are of a kind, and the first of them.
#[derive(Default)]
struct Listed {
    count: usize,
    first: Vec<FaceId>,
}

impl Listed {
    fn take(&mut self, face: FaceId) {
        self.count += 1;
        if self.first.len() < Certificate::LISTED {
            self.first.push(face);
        }
    }

    fn append(&mut self, later: Self) {
        self.count += later.count;
        let room = Certificate::LISTED - self.first.len();
        self.first.extend(later.first.into_iter().take(room));
    }
}

/// An angle falls as its cotangent grows, so only the two ends of an interval need an arctangent.
fn angle_of(cotangent: f64) -> f64 {
    match cotangent {
        f64::INFINITY => 0.0,
        f64::NEG_INFINITY => std::f64::consts::PI,
        cotangent => 1.0_f64.atan2(cotangent),
    }
}
