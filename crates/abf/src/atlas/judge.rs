//! What is proved of packed charts, and how distorted they are.

use crate::unwrap::Unwrapped;
use abf_mesh::{FaceId, TriMesh, UvId, UvMap};
use abf_metrics::{Certificate, Metrics, MetricsError, Precision, certify_stored, measure_certified};

/// The judgement of all charts together.
pub(super) struct Judged {
    pub(super) metrics: Metrics,
    /// Charts that are not valid as stored.
    pub(super) invalid_charts: Vec<usize>,
}

/// Judges the faces of all charts, page by page, those that repair turned around as it turned them.
pub(super) fn judge(
    mesh: &TriMesh,
    unwrapped: &Unwrapped,
    page_of: &[usize],
    uv: &UvMap,
    precision: Precision,
) -> Result<Judged, MetricsError> {
    let mut is_turned = vec![false; mesh.face_count()];
    unwrapped.turned.iter().for_each(|f| is_turned[f.index()] = true);
    let pages = page_of.iter().max().map_or(0, |last| last + 1);
    let mut whole: Option<Certificate> = None;
    for page in 0..pages {
        let charts = unwrapped.charts.iter().zip(page_of).filter(|&(_, &p)| p == page);
        let mut faces: Vec<FaceId> = charts.flat_map(|(chart, _)| chart.faces.iter().copied()).collect();
        faces.sort_unstable();
        let (part, map) = part_of(mesh, uv, &faces, &is_turned);
        let found = in_input(certify_stored(&part, &map, precision)?, &faces);
        whole = Some(match whole {
            None => found,
            Some(before) => together(before, found),
        });
    }
    let mut faces: Vec<FaceId> = unwrapped.charts.iter().flat_map(|chart| chart.faces.iter().copied()).collect();
    faces.sort_unstable();
    let (part, map) = part_of(mesh, uv, &faces, &is_turned);
    let certificate = whole.ok_or(MetricsError::NoFaces)?;
    let invalid_charts = match certificate.valid() {
        true => Vec::new(),
        false => invalid_charts(mesh, unwrapped, uv, &is_turned, precision)?,
    };
    Ok(Judged { metrics: measure_certified(&part, &map, certificate)?, invalid_charts })
}

fn invalid_charts(
    mesh: &TriMesh,
    unwrapped: &Unwrapped,
    uv: &UvMap,
    is_turned: &[bool],
    precision: Precision,
) -> Result<Vec<usize>, MetricsError> {
    let mut invalid = Vec::new();
    for (i, chart) in unwrapped.charts.iter().enumerate() {
        let (part, map) = part_of(mesh, uv, &chart.faces, is_turned);
        if !certify_stored(&part, &map, precision)?.valid() {
            invalid.push(i);
        }
    }
    Ok(invalid)
}

/// Some faces of a mesh with their UVs.
fn part_of(mesh: &TriMesh, uv: &UvMap, faces: &[FaceId], is_turned: &[bool]) -> (TriMesh, UvMap) {
    let in_order = |f: &FaceId| {
        let [a, b, c] = f.corners();
        if is_turned[f.index()] { [a, c, b] } else { [a, b, c] }
    };
    let vertices: Vec<[usize; 3]> =
        faces.iter().map(|f| in_order(f).map(|c| mesh.faces()[f.index()][c.place()].index())).collect();
    // Points of other pages are not taken along.
    let mut number = vec![None; uv.points().len()];
    let mut points = Vec::new();
    let corners = faces.iter().flat_map(in_order).map(|c| {
        let id = uv.corners()[c.index()];
        *number[id.index()].get_or_insert_with(|| {
            points.push(uv.points()[id.index()]);
            UvId::new(points.len() - 1)
        })
    });
    let corners = corners.collect();
    let part = TriMesh::new(mesh.positions().to_vec(), &vertices).expect("faces of a mesh");
    (part, UvMap::new(points, corners))
}

/// A certificate of some faces in the numbers of all.
fn in_input(mut certificate: Certificate, faces: &[FaceId]) -> Certificate {
    let input = |f: &mut FaceId| *f = faces[f.index()];
    certificate.flipped_faces.iter_mut().for_each(input);
    certificate.collapsed_faces.iter_mut().for_each(input);
    certificate.near_collapsed_faces.iter_mut().for_each(input);
    certificate.overlapping_faces.iter_mut().flatten().for_each(input);
    certificate
}

/// One certificate of two pages.
fn together(mut one: Certificate, other: Certificate) -> Certificate {
    fn append<T>(list: &mut Vec<T>, more: Vec<T>) {
        list.extend(more);
        list.truncate(Certificate::LISTED);
    }
    one.charts += other.charts;
    one.flips += other.flips;
    one.collapsed += other.collapsed;
    one.near_collapsed += other.near_collapsed;
    one.wound += other.wound;
    one.crossings += other.crossings;
    one.meetings += other.meetings;
    one.nested += other.nested;
    one.touches += other.touches;
    one.uv_angle_min = one.uv_angle_min.min(other.uv_angle_min);
    one.uv_angle_max = one.uv_angle_max.max(other.uv_angle_max);
    one.spread = one.spread.max(other.spread);
    append(&mut one.flipped_faces, other.flipped_faces);
    append(&mut one.collapsed_faces, other.collapsed_faces);
    append(&mut one.near_collapsed_faces, other.near_collapsed_faces);
    append(&mut one.wound_vertices, other.wound_vertices);
    append(&mut one.overlapping_faces, other.overlapping_faces);
    one
}
