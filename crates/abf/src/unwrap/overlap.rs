//! Charts that lie over themselves, taken apart.

use super::finish::{Finished, excerpt};
use crate::FlattenError;
use crate::run::{Part, taken_apart, walks};
use abf_control::Checkpoint;
use abf_cut::{Chart, FaceWalks};
use abf_mesh::{CornerId, FaceId, TriMesh};
use abf_metrics::Certificate;

/// Parts of a valid map of a piece none of which lies over itself.
///
/// Of two faces that lie over each other each gets the faces that are nearer to it in the plane, walking from face to
/// face. Both parts are connected, and disks if the chart is one. UVs stay but for the scale. `may_not_cut` says of the corners
/// of the component which edges they face are inside of a polygon: it goes to one side, unless it lies over itself.
pub(super) fn take_apart(
    piece: &Chart,
    whole: Finished,
    may_not_cut: &dyn Fn(CornerId) -> bool,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Vec<Finished>, FlattenError> {
    let in_mesh = (0..whole.uv.corners().len() / 3).map(FaceId::new).collect();
    let parts = taken_apart(PartOfPiece { piece, may_not_cut, in_mesh, chart: whole }, checkpoint)?;
    let mut charts: Vec<Finished> = parts.into_iter().map(|part| part.chart).collect();
    charts.sort_by_key(|chart| chart.faces[0]);
    Ok(charts)
}

struct PartOfPiece<'p> {
    piece: &'p Chart,
    may_not_cut: &'p dyn Fn(CornerId) -> bool,
    /// Its faces in the mesh of the piece.
    in_mesh: Vec<FaceId>,
    chart: Finished,
}

impl Part for PartOfPiece<'_> {
    fn certificate(&self) -> &Certificate {
        &self.chart.metrics.certificate
    }

    fn walks(&self) -> FaceWalks {
        walks(&self.chart.uv, |f, k| (self.may_not_cut)(self.chart.faces[f].corner(k)))
    }

    fn some_faces(&self, faces: &[usize], checkpoint: &mut Checkpoint<'_>) -> Result<Self, FlattenError> {
        let chart = part_of(&self.piece.mesh, &self.chart, &self.in_mesh, faces, checkpoint)?;
        Ok(Self { in_mesh: faces.iter().map(|&f| self.in_mesh[f]).collect(), chart, ..*self })
    }
}

pub(super) fn part_of(
    mesh: &TriMesh,
    chart: &Finished,
    in_mesh: &[FaceId],
    places: &[usize],
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Finished, FlattenError> {
    // The mesh of the chart: its faces in its own order.
    let of_chart = mesh.submesh(in_mesh.iter().map(|f| f.corners()));
    let kept: Vec<FaceId> = places.iter().map(|&f| FaceId::new(f)).collect();
    let (uv, mut metrics) =
        excerpt(&of_chart.mesh, &chart.uv, &chart.metrics.certificate, &kept, chart.layout.scaled, checkpoint)?;
    metrics.certificate.wound_vertices.iter_mut().for_each(|v| *v = of_chart.vertices[v.index()]);
    let faces = places.iter().map(|&f| chart.faces[f]).collect();
    Ok(Finished { faces, uv, metrics, rungs: chart.rungs.clone(), ..chart.clone() })
}
