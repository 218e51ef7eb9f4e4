//! How good UVs are, as it is in the JSON.

use abf::Metrics;
use abf_mesh::FaceId;
use serde::{Serialize, Serializer};

/// The figures of [`Metrics`] that the program reports, under the same names.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Quality {
    /// No triangle flipped, none collapsed, no vertex wound around.
    pub(crate) valid: bool,
    /// Valid, and no overlap.
    pub(crate) injective: bool,
    #[serde(flatten)]
    figures: Figures,
}

impl Quality {
    /// The judgement of the UVs.
    pub(crate) fn new(metrics: Metrics) -> Self {
        Self { valid: metrics.valid(), injective: metrics.injective(), figures: Figures(metrics) }
    }

    /// The figures.
    pub(crate) fn metrics(&self) -> &Metrics {
        &self.figures.0
    }
}

/// [`Metrics`] without the number of triangles, which a record has anyway.
#[derive(Clone, Debug)]
struct Figures(Metrics);

impl Serialize for Figures {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeMap;
        let m = &self.0;
        let indices = |faces: &[FaceId]| faces.iter().map(|face| face.index()).collect::<Vec<_>>();
        let mut map = serializer.serialize_map(None)?;
        for (name, count) in [
            ("flips", m.flips),
            ("collapsed", m.collapsed),
            ("near_collapsed", m.near_collapsed),
            ("wound", m.wound),
            ("overlaps", m.overlaps()),
            ("crossings", m.crossings),
            ("meetings", m.meetings),
            ("nested", m.nested),
            ("touches", m.touches),
            ("degenerate_3d", m.degenerate_3d),
            ("charts", m.charts),
        ] {
            map.serialize_entry(name, &count)?;
        }
        for (name, figure) in [
            ("f", m.f),
            ("f_weighted", m.f_weighted),
            ("max_angle_error", m.max_angle_error),
            ("stretch_l2", m.stretch_l2),
            ("stretch_linf", m.stretch_linf),
            ("qc_mean", m.qc_mean),
            ("qc_max", m.qc_max),
            ("area_l2", m.area_l2),
            ("uv_area", m.uv_area),
            ("surface_area", m.surface_area),
            ("touch_depth", m.touch_depth),
            ("uv_angle_min", m.uv_angle_min),
            ("uv_angle_max", m.uv_angle_max),
        ] {
            map.serialize_entry(name, &figure)?;
        }
        map.serialize_entry("flipped_faces", &indices(&m.flipped_faces))?;
        map.serialize_entry("collapsed_faces", &indices(&m.collapsed_faces))?;
        map.serialize_entry("wound_vertices", &m.wound_vertices.iter().map(|v| v.index()).collect::<Vec<_>>())?;
        let pairs: Vec<[usize; 2]> = m.overlapping_faces.iter().map(|pair| pair.map(FaceId::index)).collect();
        map.serialize_entry("overlapping_faces", &pairs)?;
        map.serialize_entry("uv_precision", m.precision.name())?;
        map.end()
    }
}
