//! How good UVs are.

use super::figure::{self, known};
use super::text;
use abf::{Metrics, Precision};
use abf_mesh::{FaceId, VertexId};
use serde::{Deserialize, Serialize};

/// The figures of [`Metrics`] that the program reports, under the same names. A figure that is not finite is infinite.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Quality {
    /// Locally injective: no triangle flipped, none collapsed, no vertex wound around.
    pub(crate) valid: bool,
    /// Valid, and no overlap.
    pub(crate) injective: bool,
    /// Triangles on the wrong side.
    pub(crate) flips: usize,
    /// Triangles whose corners lie on one line.
    pub(crate) collapsed: usize,
    /// Triangles that another rounding could turn over.
    pub(crate) near_collapsed: usize,
    /// Interior vertices that are wound around twice.
    pub(crate) wound: usize,
    /// Places of the boundary where the map overlaps itself: the sum of the next three.
    pub(crate) overlaps: usize,
    /// Pairs of boundary edges that cross.
    pub(crate) crossings: usize,
    /// Points where the boundary meets itself and two faces cover one direction.
    pub(crate) meetings: usize,
    /// Pieces of the boundary that lie under another part.
    pub(crate) nested: usize,
    /// Whether there are more of them than were counted.
    #[serde(default)]
    pub(crate) overlaps_are_least: bool,
    /// Points where the boundary meets itself without an overlap.
    pub(crate) touches: usize,
    /// Triangles without area on the surface, which are not in the figures.
    pub(crate) degenerate_3d: usize,
    /// Triangles that repair turned around, judged so.
    #[serde(default)]
    pub(crate) turned: usize,
    /// Triangles with the vertices and the UVs of an earlier one, not judged.
    #[serde(default)]
    pub(crate) shared: usize,
    /// Triangles that the 32-bit numbers of a glTF have taken two corners or the area from; what was judged is the rest.
    #[serde(default)]
    pub(crate) lost: usize,
    /// Connected components of the UVs.
    pub(crate) charts: usize,
    /// `F / 3nt`, rad².
    #[serde(with = "figure")]
    pub(crate) f: f64,
    /// The relative angle error.
    #[serde(with = "figure")]
    pub(crate) f_weighted: f64,
    /// The largest error of an angle, rad.
    #[serde(with = "figure")]
    pub(crate) max_angle_error: f64,
    /// L² stretch.
    #[serde(with = "figure")]
    pub(crate) stretch_l2: f64,
    /// L∞ stretch.
    #[serde(with = "figure")]
    pub(crate) stretch_linf: f64,
    /// Mean of the quasi-conformal distortion.
    #[serde(with = "figure")]
    pub(crate) qc_mean: f64,
    /// The largest.
    #[serde(with = "figure")]
    pub(crate) qc_max: f64,
    /// L² of the logarithm of the area distortion.
    #[serde(with = "figure")]
    pub(crate) area_l2: f64,
    /// The area of the UVs.
    #[serde(with = "figure")]
    pub(crate) uv_area: f64,
    /// The area of the surface.
    #[serde(with = "figure")]
    pub(crate) surface_area: f64,
    /// How deep the deepest of the touches crosses, UV units.
    #[serde(with = "figure")]
    pub(crate) touch_depth: f64,
    /// The least angle of the UVs, rad.
    #[serde(with = "figure")]
    pub(crate) uv_angle_min: f64,
    /// The greatest, rad.
    #[serde(with = "figure")]
    pub(crate) uv_angle_max: f64,
    /// The first flipped triangles, counted from 0.
    pub(crate) flipped_faces: Vec<usize>,
    /// The first collapsed triangles.
    pub(crate) collapsed_faces: Vec<usize>,
    /// The first vertices that are wound around.
    pub(crate) wound_vertices: Vec<usize>,
    /// Pairs of triangles that lie over each other, those of the first overlaps.
    pub(crate) overlapping_faces: Vec<[usize; 2]>,
    /// What the coordinates are stored in.
    #[serde(with = "text")]
    pub(crate) uv_precision: Precision,
}

impl Quality {
    /// The judgement of the UVs of a mesh that was repaired.
    pub(crate) fn of_repaired(m: &Metrics, turned: usize, shared: usize) -> Self {
        Self { turned, shared, ..Self::new(m) }
    }

    /// The judgement of the UVs.
    pub(crate) fn new(m: &Metrics) -> Self {
        let proved = &m.certificate;
        let faces = |faces: &[FaceId]| faces.iter().map(|face| face.index()).collect();
        Self {
            valid: m.valid(),
            injective: m.injective(),
            flips: proved.flips,
            collapsed: proved.collapsed,
            near_collapsed: proved.near_collapsed,
            wound: proved.wound,
            overlaps: proved.overlaps(),
            crossings: proved.crossings,
            meetings: proved.meetings,
            nested: proved.nested,
            overlaps_are_least: proved.overlaps_are_least,
            touches: proved.touches,
            degenerate_3d: m.degenerate_3d,
            turned: 0,
            shared: 0,
            lost: 0,
            charts: proved.charts,
            f: known(m.f),
            f_weighted: known(m.f_weighted),
            max_angle_error: known(m.max_angle_error),
            stretch_l2: known(m.stretch_l2),
            stretch_linf: known(m.stretch_linf),
            qc_mean: known(m.qc_mean),
            qc_max: known(m.qc_max),
            area_l2: known(m.area_l2),
            uv_area: known(m.uv_area),
            surface_area: known(m.surface_area),
            touch_depth: known(proved.touch_depth),
            uv_angle_min: known(proved.uv_angle_min),
            uv_angle_max: known(proved.uv_angle_max),
            flipped_faces: faces(&proved.flipped_faces),
            collapsed_faces: faces(&proved.collapsed_faces),
            wound_vertices: proved.wound_vertices.iter().copied().map(VertexId::index).collect(),
            overlapping_faces: proved.overlapping_faces.iter().map(|pair| pair.map(FaceId::index)).collect(),
            uv_precision: proved.precision,
        }
    }
}
