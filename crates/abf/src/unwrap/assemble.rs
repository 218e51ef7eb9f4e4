//! From charts back to the corners of the input.

use super::finish::Finished;
use super::order::InOrder;
use super::{Unwrapped, UnwrappedChart};
use abf_control::{Cancelled, Checkpoint, at_block};
use abf_cut::{Repaired, uv_borders};
use abf_mesh::{CornerId, FaceId, Point2, TriMesh, UvId, UvMap, VertexId};
use abf_metrics::{Certificate, Precision};

/// Everything in terms of the input, whose coordinates were multiplied by `scale` to work with. `joined` has its faces with
/// vertices in one place made one.
#[allow(clippy::too_many_arguments, reason = "what a run has made")]
pub(super) fn unwrapped(
    input: &TriMesh,
    joined: &TriMesh,
    repaired: &Repaired,
    parts: &[InOrder],
    finished: Vec<Vec<Finished>>,
    scale: f64,
    precision: Precision,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Unwrapped, Cancelled> {
    let mut charts = Vec::new();
    let without_area = in_no_chart(parts, repaired, &finished);
    for (i, (finished, part)) in finished.into_iter().zip(parts).enumerate() {
        for one in finished {
            checkpoint()?;
            charts.push(in_input(i, one, part, repaired, scale, precision));
        }
    }
    checkpoint()?;
    let anchor = charts.first().map_or(CornerId::new(0), |chart: &UnwrappedChart| chart.faces[0].corner(0));
    let in_one_point = without_area.iter().flat_map(|face| face.corners()).map(|corner| (corner, anchor));
    let mut whole = Unwrapped {
        charts,
        repairs: repaired.report,
        seams: Vec::new(),
        seam_length: 0.0,
        diagonal: input.diagonal(),
        without_area: without_area.len(),
        // These first: others may go where they are.
        followers: in_one_point.chain(followers(joined, repaired)).collect(),
        turned: repaired.turned_faces(),
        shared: repaired.duplicates.len(),
        parted: 0,
        corner_count: 3 * input.face_count(),
    };
    find_seams(&mut whole, input, repaired, checkpoint)?;
    Ok(whole)
}

fn in_input(
    component: usize,
    finished: Finished,
    part: &InOrder,
    repaired: &Repaired,
    scale: f64,
    precision: Precision,
) -> UnwrappedChart {
    // Its faces in the order of the input, each with its place in the chart.
    let in_repaired = |f: &FaceId| part.chart.faces[f.index()];
    let mut order: Vec<(FaceId, usize)> =
        finished.faces.iter().enumerate().map(|(i, f)| (repaired.faces[in_repaired(f).index()], i)).collect();
    order.sort_unstable();
    let mut corners = vec![UvId::new(0); 3 * order.len()];
    for (three, &(_, place)) in corners.chunks_exact_mut(3).zip(&order) {
        for c in finished.faces[place].corners() {
            let of_map = FaceId::new(place).corner(c.place());
            let in_input = repaired.input_corner(part.corner(c));
            three[in_input.place()] = finished.uv.corners()[of_map.index()];
        }
    }
    let mut number = vec![FaceId::new(0); order.len()];
    order.iter().enumerate().for_each(|(i, &(_, place))| number[place] = FaceId::new(i));
    let faces = order.into_iter().map(|(face, _)| face).collect();
    let mut metrics = finished.metrics;
    renumber(&mut metrics.certificate, &number);
    let to_input = |x: f64| if scale == 1.0 { x } else { precision.round(x / scale) };
    let points = finished.uv.points().iter().map(|p| p.map(to_input)).collect();
    UnwrappedChart {
        component,
        piece: finished.piece,
        faces,
        uv: UvMap::new(points, corners),
        metrics,
        solver: finished.solver,
        termination: finished.termination,
        solve: finished.solve,
        layout: finished.layout,
        rungs: finished.rungs,
        layout_error: finished.layout_error,
        relaxed: finished.relaxed,
        injective: finished.injective,
        seam_length: 0.0,
        rounds: finished.rounds,
        holes_filled: finished.holes_filled,
        virtual_faces: finished.virtual_faces,
        scale: 1.0,
        unfinished: finished.is_unfinished,
    }
}

/// Names the faces of a certificate anew.
fn renumber(certificate: &mut Certificate, number: &[FaceId]) {
    let anew = |f: &mut FaceId| *f = number[f.index()];
    certificate.flipped_faces.iter_mut().for_each(anew);
    certificate.collapsed_faces.iter_mut().for_each(anew);
    certificate.near_collapsed_faces.iter_mut().for_each(anew);
    certificate.overlapping_faces.iter_mut().flatten().for_each(anew);
}

/// The faces, by their numbers in the input, that are in no chart.
fn in_no_chart(parts: &[InOrder], repaired: &Repaired, finished: &[Vec<Finished>]) -> Vec<FaceId> {
    let mut nowhere = Vec::new();
    for (part, finished) in parts.iter().zip(finished) {
        let part = &part.chart;
        let mut is_somewhere = vec![false; part.faces.len()];
        finished.iter().flat_map(|chart| &chart.faces).for_each(|f| is_somewhere[f.index()] = true);
        let left = part.faces.iter().zip(is_somewhere).filter(|&(_, is_somewhere)| !is_somewhere);
        nowhere.extend(left.map(|(f, _)| repaired.faces[f.index()]));
    }
    nowhere
}

/// Where corners of dropped faces go: with those of their twins; where a vertex is used twice, all three to the first
/// corner at that vertex, or to the very first corner where there is none.
fn followers(input: &TriMesh, repaired: &Repaired) -> Vec<(CornerId, CornerId)> {
    let faces = input.faces();
    let mut followers = Vec::new();
    for &(dropped, kept) in &repaired.duplicates {
        for c in dropped.corners() {
            let v = faces[dropped.index()][c.place()];
            let twin = kept.corners().into_iter().find(|k| faces[kept.index()][k.place()] == v);
            followers.extend(twin.map(|twin| (c, twin)));
        }
    }
    if repaired.repeated.is_empty() {
        return followers;
    }
    let mut at_vertex: Vec<Option<CornerId>> = vec![None; input.vertex_count()];
    for c in repaired.faces.iter().flat_map(|f| f.corners()) {
        at_vertex[faces[c.face().index()][c.place()].index()].get_or_insert(c);
    }
    let any = repaired.faces[0].corner(0);
    for &face in &repaired.repeated {
        let [a, b, c] = faces[face.index()];
        let twice = if a == b || a == c { a } else { b.max(c) };
        let place = at_vertex[twice.index()].unwrap_or(any);
        followers.extend(face.corners().map(|corner| (corner, place)));
    }
    followers
}

/// The edges of the repaired mesh whose sides have different UVs, and their length in all and per chart.
fn find_seams(
    whole: &mut Unwrapped,
    input: &TriMesh,
    repaired: &Repaired,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<(), Cancelled> {
    let topology = &repaired.topology;
    let uv = whole.uv();
    checkpoint()?;
    let of_corner = |c| uv.corners()[repaired.input_corner(c).index()];
    let borders = uv_borders(topology, &topology.corners().map(of_corner).collect::<Vec<_>>());
    let mut chart_of = vec![0; input.face_count()];
    for (i, chart) in whole.charts.iter().enumerate() {
        chart.faces.iter().for_each(|f| chart_of[f.index()] = i);
    }
    checkpoint()?;
    for (i, c) in borders.edges(topology).enumerate() {
        at_block(i, checkpoint)?;
        let ends = [c.next(), c.prev()].map(|e| repaired.vertices[topology.vertex(e).index()]);
        let [a, b] = ends.map(|v: VertexId| input.positions()[v.index()]);
        let length = (b - a).norm();
        whole.seam_length += length;
        whole.seams.push([ends[0].min(ends[1]), ends[0].max(ends[1])]);
        let chart_at = |c: CornerId| chart_of[repaired.faces[c.face().index()].index()];
        let (one, other) = (chart_at(c), topology.opposite(c).map_or(usize::MAX, chart_at));
        whole.charts[one].seam_length += length;
        if let Some(chart) = whole.charts.get_mut(other).filter(|_| other != one) {
            chart.seam_length += length;
        }
    }
    whole.seams.sort_unstable();
    whole.seams.dedup();
    checkpoint()
}

impl Unwrapped {
    /// One UV for every corner of the input: the points of all charts, one chart after the other, where `place` puts them.
    /// It is told the number of the chart, and the point in the coordinates of the chart.
    ///
    /// Corners of faces that repair dropped are with other corners ([`followers`](Self::followers)): those of a duplicate
    /// with its twin, so that it lies on it; the three of a face that uses a vertex twice in one point.
    #[must_use]
    pub fn assemble(&self, place: impl Fn(usize, Point2<f64>) -> Point2<f64>) -> UvMap {
        let mut points = Vec::new();
        let mut corners = vec![UvId::new(0); self.corner_count];
        for (i, chart) in self.charts.iter().enumerate() {
            let first = points.len();
            points.extend(chart.uv.points().iter().map(|&p| place(i, p)));
            for (three, face) in chart.uv.corners().as_chunks::<3>().0.iter().zip(&chart.faces) {
                face.corners()
                    .into_iter()
                    .zip(three)
                    .for_each(|(c, id)| corners[c.index()] = UvId::new(first + id.index()));
            }
        }
        for &(follower, leader) in &self.followers {
            corners[follower.index()] = corners[leader.index()];
        }
        UvMap::new(points, corners)
    }

    /// The same with every chart where it came out: charts lie over each other.
    #[must_use]
    pub fn uv(&self) -> UvMap {
        self.assemble(|_, p| p)
    }

    /// Whether every chart is what was asked for: valid UVs of a solver that ended as asked.
    #[must_use]
    pub fn is_certified(&self) -> bool {
        self.charts.iter().all(UnwrappedChart::is_certified)
    }
}
