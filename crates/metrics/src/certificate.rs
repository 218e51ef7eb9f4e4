//! What is proved of a UV map: which triangles are turned over, wind, or lie over each other.

use abf_mesh::{FaceId, TriMesh, UvMap, VertexId};
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

use crate::MetricsError;
use crate::face::{Orientation, Survey};
use crate::overlap::Overlaps;
use crate::sheet::{Fan, Sheet};
use crate::triangle::cotangents;
use crate::winding::winds_twice;

/// What a format keeps of a coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 24 bits, as graphics memory and some formats do.
    Single,
    /// 53 bits, all there are.
    #[default]
    Double,
}

impl Precision {
    /// The name on the command line and in JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Double => "double",
        }
    }

    /// The coordinate as it is stored, to the nearest.
    #[must_use]
    pub fn round(self, x: f64) -> f64 {
        match self {
            Self::Single => f64::from(x as f32),
            Self::Double => x,
        }
    }

    /// The distance from 1 to the next number: one unit in the last place of `x` is at most `ε |x|`.
    #[must_use]
    pub const fn epsilon(self) -> f64 {
        match self {
            Self::Single => f32::EPSILON as f64,
            Self::Double => f64::EPSILON,
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Precision {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let known = [Self::Single, Self::Double];
        known
            .into_iter()
            .find(|p| p.name() == s)
            .ok_or_else(|| format!("'{s}' is no precision; there are: single, double"))
    }
}

/// What is proved of a UV map as it is stored.
///
/// Every count comes from signs of areas and comparisons of the stored coordinates, all exact (as long as
/// products of coordinate differences do not underflow: differences above 1e-120 of the largest
/// coordinate). So [`valid`](Self::valid) and [`injective`](Self::injective) are proofs, not measurements.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Certificate {
    /// What the coordinates were rounded to before.
    #[serde(serialize_with = "as_text")]
    pub precision: Precision,
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
    /// Points where the boundary meets itself and nothing is covered twice. These are no overlaps.
    pub touches: usize,
    /// `max |h|` of the constraints of the angles the map was laid out from, rad; `None` where there are
    /// none, as for a file that was read.
    pub constraint_residual: Option<f64>,
    /// The least angle of all UV triangles, rad, without sign.
    pub uv_angle_min: f64,
    /// The greatest, rad.
    pub uv_angle_max: f64,
    /// The first flipped faces, at most [`LISTED`](Self::LISTED) of them.
    #[serde(serialize_with = "as_indices")]
    pub flipped_faces: Vec<FaceId>,
    /// The first collapsed faces.
    #[serde(serialize_with = "as_indices")]
    pub collapsed_faces: Vec<FaceId>,
    /// The first vertices that are wound around.
    #[serde(serialize_with = "as_vertex_indices")]
    pub wound_vertices: Vec<VertexId>,
    /// Pairs of faces that lie over each other, one for each of the first overlaps.
    #[serde(serialize_with = "as_pairs")]
    pub overlapping_faces: Vec<[FaceId; 2]>,
}

impl Certificate {
    /// How many offenders of each kind are listed by name.
    pub const LISTED: usize = 10;

    /// Whether the map is locally one to one inside the surface: no triangle flipped, none collapsed, no
    /// vertex wound around.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.flips == 0 && self.collapsed == 0 && self.wound == 0
    }

    /// How many overlaps there are: crossings, meetings and nested pieces.
    ///
    /// For a valid map this is zero if and only if no point of the plane is covered twice by the inside
    /// of triangles.
    #[must_use]
    pub fn overlaps(&self) -> usize {
        self.crossings + self.meetings + self.nested
    }

    /// Whether the map is one to one everywhere: valid and without overlap. Charts may touch.
    #[must_use]
    pub fn injective(&self) -> bool {
        self.valid() && self.overlaps() == 0
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
    let rounded;
    let uv = match precision {
        Precision::Double => uv,
        Precision::Single => {
            rounded = uv.clone().mapped(|p| p.map(|x| precision.round(x)));
            &rounded
        }
    };
    Ok(of_survey(&Survey::new(mesh, uv)?, precision))
}

/// The certificate of a map that has been looked at.
pub(crate) fn of_survey(survey: &Survey<'_>, precision: Precision) -> Certificate {
    let orientations: Vec<Orientation> = survey.orientations().collect();
    let (flips, flipped_faces) = faces_that_are(&orientations, Orientation::Flipped);
    let (collapsed, collapsed_faces) = faces_that_are(&orientations, Orientation::Collapsed);
    let sheet = Sheet::new(survey.mesh(), survey.uv(), survey.uv_scale(), |f| survey.is_mirrored(FaceId::new(f)));
    let fans: Vec<Fan> = sheet.fans().collect();
    // Where a triangle is flipped or collapsed, the triangles of a fan do not all turn one way.
    let is_kept = |fan: Fan| sheet.fan_corners(fan).all(|c| orientations[c.face().index()] == Orientation::Kept);
    let twice: Vec<Fan> = fans.iter().copied().filter(|&fan| is_kept(fan) && winds_twice(&sheet, fan)).collect();
    let mut wound: Vec<VertexId> =
        twice.iter().filter(|fan| fan.is_closed).map(|fan| sheet.vertex(fan.first)).collect();
    wound.sort_unstable();
    wound.dedup();
    let overlaps = Overlaps::find(&sheet, &fans, &twice, Certificate::LISTED);
    let (uv_angle_min, uv_angle_max) = angle_interval(survey);
    let wound_count = wound.len();
    wound.truncate(Certificate::LISTED);
    Certificate {
        precision,
        flips,
        collapsed,
        near_collapsed: survey.near_collapsed(&orientations, precision.epsilon()),
        wound: wound_count,
        crossings: overlaps.crossings,
        meetings: overlaps.meetings,
        nested: overlaps.nested,
        touches: overlaps.touches,
        constraint_residual: None,
        uv_angle_min,
        uv_angle_max,
        flipped_faces,
        collapsed_faces,
        wound_vertices: wound,
        overlapping_faces: overlaps.faces,
    }
}

/// How many faces lie that way, and the first of them.
fn faces_that_are(orientations: &[Orientation], which: Orientation) -> (usize, Vec<FaceId>) {
    let faces = || orientations.iter().enumerate().filter(|&(_, &o)| o == which).map(|(f, _)| FaceId::new(f));
    (faces().count(), faces().take(Certificate::LISTED).collect())
}

/// The least and the greatest angle. An angle falls as its cotangent grows, so only two arctangents are taken.
fn angle_interval(survey: &Survey<'_>) -> (f64, f64) {
    let all = survey.flat_triangles().flat_map(|(triangle, area)| cotangents(&triangle, area));
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), cot| (cot.min(low), cot.max(high)));
    let angle = |cot: f64| match cot {
        f64::INFINITY => 0.0,
        f64::NEG_INFINITY => std::f64::consts::PI,
        cot => 1.0_f64.atan2(cot),
    };
    (angle(high), angle(low))
}

fn as_text<S: Serializer>(value: &impl fmt::Display, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

fn as_indices<S: Serializer>(faces: &[FaceId], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(faces.iter().map(|face| face.index()))
}

fn as_vertex_indices<S: Serializer>(vertices: &[VertexId], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(vertices.iter().map(|vertex| vertex.index()))
}

fn as_pairs<S: Serializer>(pairs: &[[FaceId; 2]], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(pairs.iter().map(|pair| pair.map(FaceId::index)))
}
