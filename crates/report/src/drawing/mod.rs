//! What is drawn of a layout, whatever the format: where it ends, folds, numbers at seams and in charts.

pub(crate) mod folds;
pub(crate) mod labels;
pub(crate) mod loops;
pub(crate) mod outline;
pub(crate) mod seams;

use crate::PictureError;
use abf_mesh::TriMesh;
use seams::Mark;

/// The height of letters, millimetres, at most.
pub(crate) const LETTERS_MM: f64 = 3.0;
/// Letters are no higher than this part of the longer side of the layout.
const LETTERS: f64 = 0.02;
/// And those of a seam no higher than this part of its length.
const OF_SEAM: f64 = 0.4;
/// The height of the number of a chart, millimetres, at most.
const CHART_MM: f64 = 6.0;

/// How high the number of a seam is, in units of the UVs, on a layout whose longer side is `longer`.
pub(crate) fn height_at_seam(mark: &Mark, longer: f64, mm_per_uv: f64) -> f64 {
    (LETTERS_MM / mm_per_uv).min(LETTERS * longer).min(OF_SEAM * mark.length)
}

/// How high the number of a chart is at most, in units of the UVs.
pub(crate) fn height_in_chart(longer: f64, mm_per_uv: f64) -> f64 {
    (CHART_MM / mm_per_uv).min(2.0 * LETTERS * longer)
}

/// Checks that there is a chart for every face.
pub(crate) fn check_charts(mesh: &TriMesh, charts: Option<&[u32]>) -> Result<(), PictureError> {
    match charts {
        Some(charts) if charts.len() != mesh.face_count() => {
            Err(PictureError::Charts { given: charts.len(), faces: mesh.face_count() })
        }
        _ => Ok(()),
    }
}
