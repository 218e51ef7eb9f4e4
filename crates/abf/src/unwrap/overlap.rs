//! Charts that lie over themselves, taken apart.

use super::finish::{Finished, excerpt};
use crate::FlattenError;
use crate::run::walks;
use abf_control::Checkpoint;
use abf_cut::Chart;
use abf_mesh::{CornerId, FaceId, TriMesh};

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
    let all: Vec<FaceId> = (0..whole.uv.corners().len() / 3).map(FaceId::new).collect();
    let mut waiting = vec![(all, whole)];
    let mut done: Vec<(Vec<FaceId>, Finished)> = Vec::new();
    while let Some((in_mesh, chart)) = waiting.pop() {
        // Of a single face there is no pair.
        let pair = chart.metrics.certificate.overlapping_faces.first().copied().filter(|[one, other]| one != other);
        let [one, other] = match pair {
            Some(pair) if chart.metrics.certificate.overlaps() > 0 => pair,
            _ => {
                done.push((in_mesh, chart));
                continue;
            }
        };
        checkpoint()?;
        let walks = walks(&chart.uv, |f, k| may_not_cut(chart.faces[f].corner(k)));
        let is_others = walks.nearer_to_second(one.index(), other.index(), checkpoint)?;
        for side in [true, false] {
            let places: Vec<usize> = (0..in_mesh.len()).filter(|&f| is_others[f] == side).collect();
            if places.is_empty() {
                continue;
            }
            let part: Vec<FaceId> = places.iter().map(|&f| in_mesh[f]).collect();
            waiting.push((part.clone(), part_of(&piece.mesh, &chart, &in_mesh, &places, checkpoint)?));
        }
    }
    done.sort_by_key(|(_, chart)| chart.faces[0]);
    Ok(done.into_iter().map(|(_, chart)| chart).collect())
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
