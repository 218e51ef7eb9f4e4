//! From faces to a corner table: half-edges are paired, and the fans around vertices found.

use abf_parallel::prelude::*;

use super::{NONE, TopologyError};
use crate::{CornerId, FaceId, VertexId};
use abf_control::{Cancelled, Checkpoint, at_block};

/// Fewer vertices are not worth a thread.
const VERTICES_PER_TASK: usize = 1 << 13;

/// Why there is no corner table.
pub(super) enum End {
    Cancelled(Cancelled),
    Refused(TopologyError),
}

impl From<Cancelled> for End {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

impl From<TopologyError> for End {
    fn from(error: TopologyError) -> Self {
        Self::Refused(error)
    }
}

/// Refuses faces that name a vertex twice.
pub(super) fn reject_repeated_vertices(faces: &[[VertexId; 3]]) -> Result<(), TopologyError> {
    let repeated = |face: &[VertexId; 3]| {
        let [a, b, c] = *face;
        if a == b || a == c { Some(a) } else { (b == c).then_some(b) }
    };
    let mut found = faces.iter().enumerate().filter_map(|(f, face)| repeated(face).map(|v| (f, v)));
    match found.next() {
        None => Ok(()),
        Some((f, vertex)) => {
            Err(TopologyError::RepeatedVertex { face: FaceId::new(f), vertex, count: 1 + found.count() })
        }
    }
}

/// A directed edge as its lower vertex keeps it: the upper vertex, then the corner facing it. In this
/// order the edges between the same vertices stand together, lower corners first.
fn half_edge(upper: VertexId, corner: usize) -> u64 {
    (upper.index() as u64) << u32::BITS | corner as u64
}

/// The opposite of every corner: half-edges are bucketed by their lower vertex and matched inside.
pub(super) fn pair_edges(
    vertex_count: usize,
    faces: &[[VertexId; 3]],
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Vec<u32>, End> {
    let corner_vertex = faces.as_flattened();
    // Every corner k faces the edge between the other two: from its next to its previous.
    let edges = |&[a, b, c]: &[VertexId; 3]| [(b, c), (c, a), (a, b)];

    // The end of every bucket; while they are filled, where its next half-edge goes.
    let mut bucket_end = vec![0_u32; vertex_count + 1];
    for (from, to) in faces.iter().flat_map(edges) {
        bucket_end[from.min(to).index() + 1] += 1;
    }
    for v in 0..vertex_count {
        bucket_end[v + 1] += bucket_end[v];
    }
    checkpoint()?;
    let mut half_edges = vec![0_u64; corner_vertex.len()];
    for (corner, (from, to)) in faces.iter().flat_map(edges).enumerate() {
        let slot = &mut bucket_end[from.min(to).index()];
        half_edges[*slot as usize] = half_edge(from.max(to), corner);
        *slot += 1;
    }

    let mut opposite = vec![NONE; corner_vertex.len()];
    let mut crowded: Option<(VertexId, VertexId, usize)> = None;
    let mut crowded_count = 0;
    let mut against: Vec<(CornerId, CornerId)> = Vec::new();
    let mut start = 0;
    for (v, &end) in bucket_end[..vertex_count].iter().enumerate() {
        at_block(v, checkpoint)?;
        let v = VertexId::new(v);
        let runs_upwards = |corner: CornerId| corner_vertex[corner.next().index()] == v;
        let bucket = &mut half_edges[start..end as usize];
        start = end as usize;
        bucket.sort_unstable();
        for edge in bucket.chunk_by(|a, b| a >> u32::BITS == b >> u32::BITS) {
            match *edge {
                [_] => {}
                // The lower half is the corner.
                [a, b] => {
                    let [c, d] = [a as u32, b as u32];
                    let [first, second] = [c, d].map(|corner| CornerId::new(corner as usize));
                    if runs_upwards(first) == runs_upwards(second) {
                        against.push((first, second));
                    }
                    opposite[c as usize] = d;
                    opposite[d as usize] = c;
                }
                _ => {
                    crowded_count += 1;
                    crowded.get_or_insert((v, VertexId::new((edge[0] >> u32::BITS) as usize), edge.len()));
                }
            }
        }
    }
    if let Some((a, b, faces)) = crowded {
        return Err(TopologyError::NonManifoldEdge { a, b, faces, count: crowded_count }.into());
    }
    if let Some(&(c, d)) = against.first() {
        return Err(orientation_error(corner_vertex, &opposite, (c, d), against.len()).into());
    }
    Ok(opposite)
}

/// Tells a surface that only needs some faces turned around from one with a single side.
fn orientation_error(
    corner_vertex: &[VertexId],
    opposite: &[u32],
    (c, d): (CornerId, CornerId),
    count: usize,
) -> TopologyError {
    let face_count = corner_vertex.len() / 3;
    // 0: not reached; 1: as it is; 2: turned around.
    let mut state = vec![0_u8; face_count];
    let mut queue = Vec::new();
    for seed in 0..face_count {
        if state[seed] != 0 {
            continue;
        }
        state[seed] = 1;
        queue.push(seed);
        while let Some(f) = queue.pop() {
            for corner in FaceId::new(f).corners() {
                let other = opposite[corner.index()];
                if other == NONE {
                    continue;
                }
                let other = CornerId::new(other as usize);
                let same_way = corner_vertex[corner.next().index()] == corner_vertex[other.next().index()];
                let wanted = if same_way { 3 - state[f] } else { state[f] };
                let g = other.face().index();
                if state[g] == 0 {
                    state[g] = wanted;
                    queue.push(g);
                } else if state[g] != wanted {
                    return TopologyError::NonOrientable { first: corner.face(), second: other.face() };
                }
            }
        }
    }
    let (a, b) = (corner_vertex[c.next().index()], corner_vertex[c.prev().index()]);
    TopologyError::InconsistentOrientation { first: c.face(), second: d.face(), a: a.min(b), b: a.max(b), count }
}

/// The start of every vertex's fan and whether the fan closes.
pub(super) fn find_fans(
    vertex_count: usize,
    faces: &[[VertexId; 3]],
    opposite: &[u32],
) -> Result<(Vec<u32>, Vec<bool>), TopologyError> {
    let is_first = |c: CornerId| opposite[c.prev().index()] == NONE;
    let mut start = vec![NONE; vertex_count];
    let mut incident = vec![0_u32; vertex_count];
    let mut interior = vec![false; vertex_count];
    let mut reach = |corner: u32, v: VertexId, is_first: bool| {
        let v = v.index();
        incident[v] += 1;
        if start[v] == NONE {
            start[v] = corner;
            interior[v] = true;
        }
        if is_first && interior[v] {
            start[v] = corner;
            interior[v] = false;
        }
    };
    let neighbours = opposite.as_chunks::<3>().0;
    for (corner, (&[a, b, c], &[across_a, across_b, across_c])) in (0..).step_by(3).zip(faces.iter().zip(neighbours)) {
        reach(corner, a, across_c == NONE);
        reach(corner + 1, b, across_a == NONE);
        reach(corner + 2, c, across_b == NONE);
    }
    let ccw = |c: CornerId| match opposite[c.next().index()] {
        NONE => None,
        o => Some(CornerId::new(o as usize).next()),
    };
    let fan_length = |first: CornerId| std::iter::successors(Some(first), |&c| ccw(c).filter(|&n| n != first)).count();
    let pinched = |v: usize| start[v] != NONE && fan_length(CornerId::new(start[v] as usize)) != incident[v] as usize;
    let bad: Vec<usize> =
        (0..vertex_count).into_par_iter().with_min_len(VERTICES_PER_TASK).filter(|&v| pinched(v)).collect();
    if let Some(&v) = bad.first() {
        let fans = count_fans(v, faces.as_flattened(), fan_length, is_first, ccw);
        return Err(TopologyError::NonManifoldVertex { vertex: VertexId::new(v), fans, count: bad.len() });
    }
    Ok((start, interior))
}

/// How many fans meet at a vertex: open ones by their first corner, closed ones by walking them.
fn count_fans(
    v: usize,
    corner_vertex: &[VertexId],
    fan_length: impl Fn(CornerId) -> usize,
    is_first: impl Fn(CornerId) -> bool,
    ccw: impl Fn(CornerId) -> Option<CornerId>,
) -> usize {
    let here: Vec<CornerId> =
        (0..corner_vertex.len()).map(CornerId::new).filter(|c| corner_vertex[c.index()].index() == v).collect();
    let mut reached: Vec<CornerId> = Vec::with_capacity(here.len());
    let mut fans = 0;
    // Open fans first, so that no walk starts in their middle.
    let (open, rest): (Vec<CornerId>, Vec<CornerId>) = here.iter().partition(|&&c| is_first(c));
    for c in open.into_iter().chain(rest) {
        if !reached.contains(&c) {
            fans += 1;
            reached.extend(std::iter::successors(Some(c), |&d| ccw(d)).take(fan_length(c)));
        }
    }
    fans
}
