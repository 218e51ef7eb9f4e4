//! Charts that lie over themselves, taken apart.

use super::finish::{Finished, excerpt};
use crate::FlattenError;
use abf_control::Checkpoint;
use abf_cut::Chart;
use abf_mesh::{FaceId, TriMesh, UvId, UvMap, Vector2};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// Parts of a valid map of a piece none of which lies over itself.
///
/// Of two faces that lie over each other each gets the faces that are nearer to it in the plane, walking from face to
/// face. Both parts are connected, and disks if the chart is one. UVs stay but for the scale.
pub(super) fn take_apart(
    piece: &Chart,
    whole: Finished,
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
        let is_others = nearer_to_the_other(&chart.uv, one, other);
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

/// For every face whether it is nearer to `other` than to `one`: shortest ways from middle to middle of neighbours.
fn nearer_to_the_other(uv: &UvMap, one: FaceId, other: FaceId) -> Vec<bool> {
    let neighbours = neighbours(uv);
    let middle = |f: usize| uv.triangle(FaceId::new(f)).iter().fold(Vector2::zeros(), |sum, p| sum + p.coords);
    let mut distance = vec![f64::INFINITY; neighbours.len()];
    let mut is_others = vec![false; neighbours.len()];
    let mut heap = BinaryHeap::new();
    for (face, is_other) in [(one, false), (other, true)] {
        distance[face.index()] = 0.0;
        is_others[face.index()] = is_other;
        heap.push(Reverse((0_u64, face.index())));
    }
    while let Some(Reverse((key, f))) = heap.pop() {
        let here = f64::from_bits(key);
        if here > distance[f] {
            continue;
        }
        for g in neighbours[f].into_iter().flatten() {
            let there = here + (middle(g) - middle(f)).norm();
            if there < distance[g] {
                distance[g] = there;
                is_others[g] = is_others[f];
                heap.push(Reverse((there.to_bits(), g)));
            }
        }
    }
    is_others
}

/// For every face the faces that share two UV points with it.
pub(super) fn neighbours(uv: &UvMap) -> Vec<[Option<usize>; 3]> {
    let faces = uv.corners().as_chunks::<3>().0;
    let mut first: HashMap<[UvId; 2], (usize, usize)> = HashMap::with_capacity(3 * faces.len() / 2);
    let mut neighbours = vec![[None; 3]; faces.len()];
    for (f, [a, b, c]) in faces.iter().enumerate() {
        for (k, [p, q]) in [[b, c], [c, a], [a, b]].into_iter().enumerate() {
            if let Some((g, l)) = first.insert([*p.min(q), *p.max(q)], (f, k)) {
                neighbours[f][k] = Some(g);
                neighbours[g][l] = Some(f);
            }
        }
    }
    neighbours
}
