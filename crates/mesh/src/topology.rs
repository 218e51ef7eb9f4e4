//! The corner table: who is opposite whom, without coordinates.

use abf_parallel::prelude::*;

use crate::{CornerId, FaceId, VertexId};

/// Marks "no corner" in the packed tables.
const NONE: u32 = u32::MAX;

/// Fewer vertices are not worth a thread.
const VERTICES_PER_TASK: usize = 1 << 13;

/// The connectivity of an oriented manifold with or without boundary, in any number of components.
///
/// Corner `3f + k` sits at the `k`-th vertex of face `f`. The edge facing a corner runs from
/// `next` to `prev`; the corner that faces the same edge from the other side is its *opposite*,
/// and a boundary edge has none.
#[derive(Clone, Debug, PartialEq)]
pub struct Topology {
    corner_vertex: Vec<VertexId>,
    opposite: Vec<u32>,
    /// For every vertex the corner its fan starts with: on the boundary the first counter-clockwise,
    /// in the interior the one of lowest index. `NONE` where no face uses the vertex.
    fan_start: Vec<u32>,
    interior: Vec<bool>,
    interior_count: usize,
    boundary_edge_count: usize,
}

/// Why faces do not form an oriented manifold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// There is no face at all.
    #[error("the mesh has no faces")]
    Empty,
    /// More corners than 32-bit indices can name.
    #[error("the mesh has {faces} faces, more than 32-bit corner indices can name")]
    TooLarge {
        /// How many faces there are.
        faces: usize,
    },
    /// A face that uses one vertex twice.
    #[error("face {face} uses vertex {vertex} twice ({count} in all)")]
    RepeatedVertex {
        /// The first such face.
        face: FaceId,
        /// The vertex it repeats.
        vertex: VertexId,
        /// How many such faces there are.
        count: usize,
    },
    /// An edge of three or more faces.
    #[error("the edge between vertices {a} and {b} has {faces} faces ({count} in all)")]
    NonManifoldEdge {
        /// One end of the first such edge.
        a: VertexId,
        /// Its other end.
        b: VertexId,
        /// How many faces share it.
        faces: usize,
        /// How many such edges there are.
        count: usize,
    },
    /// Two faces that run along their common edge the same way; turning some faces around mends it.
    #[error(
        "faces {first} and {second} are oriented against each other along the edge between vertices {a} and {b} ({count} in all)"
    )]
    InconsistentOrientation {
        /// One face at the first such edge.
        first: FaceId,
        /// The other.
        second: FaceId,
        /// One end of the edge.
        a: VertexId,
        /// Its other end.
        b: VertexId,
        /// How many such edges there are.
        count: usize,
    },
    /// No choice of orientations fits together (a Möbius band, a Klein bottle).
    #[error("the surface has one side only: faces {first} and {second} cannot both be oriented")]
    NonOrientable {
        /// One face where the two sides meet.
        first: FaceId,
        /// The other.
        second: FaceId,
    },
    /// A vertex where several fans of faces touch in a point.
    #[error("the faces at vertex {vertex} form {fans} separate fans ({count} in all)")]
    NonManifoldVertex {
        /// The first such vertex.
        vertex: VertexId,
        /// How many fans meet there.
        fans: usize,
        /// How many such vertices there are.
        count: usize,
    },
}

/// A law of the corner table that does not hold; see [`Topology::check`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("corner table broken at corner {corner}: {law}")]
pub struct BrokenLaw {
    /// Where.
    pub corner: CornerId,
    /// Which law.
    pub law: &'static str,
}

impl Topology {
    /// Builds the corner table in time linear in the number of faces (edges are sorted per vertex).
    ///
    /// # Errors
    /// One [`TopologyError`] naming the first offending element and how many there are.
    ///
    /// # Panics
    /// If a face names a vertex `>= vertex_count`; a [`crate::TriMesh`] cannot hold such a face.
    pub fn build(vertex_count: usize, faces: &[[VertexId; 3]]) -> Result<Self, TopologyError> {
        if faces.is_empty() {
            return Err(TopologyError::Empty);
        }
        if faces.len() > (NONE as usize - 1) / 3 {
            return Err(TopologyError::TooLarge { faces: faces.len() });
        }
        reject_repeated_vertices(faces)?;
        let opposite = pair_edges(vertex_count, faces)?;
        let corner_vertex = faces.as_flattened().to_vec();
        let (fan_start, interior) = find_fans(vertex_count, faces, &opposite)?;
        let interior_count = interior.iter().filter(|&&i| i).count();
        let boundary_edge_count = opposite.iter().filter(|&&o| o == NONE).count();
        Ok(Self { corner_vertex, opposite, fan_start, interior, interior_count, boundary_edge_count })
    }

    /// How many vertices the mesh has, used or not.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.fan_start.len()
    }

    /// How many faces there are: `nt`.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.corner_vertex.len() / 3
    }

    /// How many corners there are: `3 nt`.
    #[must_use]
    pub fn corner_count(&self) -> usize {
        self.corner_vertex.len()
    }

    /// How many vertices have faces all around: `ni`.
    #[must_use]
    pub fn interior_vertex_count(&self) -> usize {
        self.interior_count
    }

    /// How many edges have a face on one side only.
    #[must_use]
    pub fn boundary_edge_count(&self) -> usize {
        self.boundary_edge_count
    }

    /// How many edges there are.
    #[must_use]
    pub fn edge_count(&self) -> usize {
        (self.corner_count() + self.boundary_edge_count) / 2
    }

    /// How many vertices some face uses.
    #[must_use]
    pub fn used_vertex_count(&self) -> usize {
        self.fan_start.iter().filter(|&&c| c != NONE).count()
    }

    /// Every face.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceId> + use<> {
        (0..self.face_count()).map(FaceId::new)
    }

    /// Every corner.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = CornerId> + use<> {
        (0..self.corner_count()).map(CornerId::new)
    }

    /// Every vertex, used or not.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = VertexId> + use<> {
        (0..self.vertex_count()).map(VertexId::new)
    }

    /// The vertex a corner sits at.
    #[inline]
    #[must_use]
    pub fn vertex(&self, corner: CornerId) -> VertexId {
        self.corner_vertex[corner.index()]
    }

    /// The three vertices of a face, counter-clockwise.
    #[inline]
    #[must_use]
    pub fn face_vertices(&self, face: FaceId) -> [VertexId; 3] {
        face.corners().map(|c| self.vertex(c))
    }

    /// The corner that faces the same edge from the other side; `None` on the boundary.
    #[inline]
    #[must_use]
    pub fn opposite(&self, corner: CornerId) -> Option<CornerId> {
        match self.opposite[corner.index()] {
            NONE => None,
            other => Some(CornerId::new(other as usize)),
        }
    }

    /// The opposite of every corner, `u32::MAX` where there is none.
    #[must_use]
    pub fn packed_opposites(&self) -> &[u32] {
        &self.opposite
    }

    /// The next corner counter-clockwise around the same vertex; `None` past the last of a
    /// boundary fan.
    #[inline]
    #[must_use]
    pub fn rotate_ccw(&self, corner: CornerId) -> Option<CornerId> {
        self.opposite(corner.next()).map(CornerId::next)
    }

    /// The next corner clockwise around the same vertex; `None` past the first of a boundary fan.
    #[inline]
    #[must_use]
    pub fn rotate_cw(&self, corner: CornerId) -> Option<CornerId> {
        self.opposite(corner.prev()).map(CornerId::prev)
    }

    /// Whether the vertex has faces all around.
    #[inline]
    #[must_use]
    pub fn is_interior(&self, vertex: VertexId) -> bool {
        self.interior[vertex.index()]
    }

    /// Whether the vertex lies on the boundary (a vertex without faces does not).
    #[must_use]
    pub fn is_boundary(&self, vertex: VertexId) -> bool {
        !self.is_interior(vertex) && self.fan_start(vertex).is_some()
    }

    /// The corner the fan of a vertex starts with: on the boundary the first counter-clockwise.
    /// `None` where no face uses the vertex.
    #[must_use]
    pub fn fan_start(&self, vertex: VertexId) -> Option<CornerId> {
        match self.fan_start[vertex.index()] {
            NONE => None,
            corner => Some(CornerId::new(corner as usize)),
        }
    }

    /// The corners at a vertex, counter-clockwise, each once.
    pub fn fan(&self, vertex: VertexId) -> impl Iterator<Item = CornerId> + '_ {
        let start = self.fan_start(vertex);
        std::iter::successors(start, move |&c| self.rotate_ccw(c).filter(|&next| Some(next) != start))
    }

    /// Asserts every law of the corner table. Tests call it after every change.
    ///
    /// # Errors
    /// The first law that does not hold.
    pub fn check(&self) -> Result<(), BrokenLaw> {
        let mut seen = vec![false; self.corner_count()];
        for c in self.corners() {
            let broken = |law| Err(BrokenLaw { corner: c, law });
            if let Some(o) = self.opposite(c) {
                if self.opposite(o) != Some(c) {
                    return broken("the opposite of the opposite is the corner itself");
                }
                if self.vertex(o.next()) != self.vertex(c.prev()) || self.vertex(o.prev()) != self.vertex(c.next()) {
                    return broken("opposite corners face the same edge in opposite directions");
                }
                if o.face() == c.face() {
                    return broken("a face is not its own neighbour");
                }
            } else if self.is_interior(self.vertex(c.next())) || self.is_interior(self.vertex(c.prev())) {
                return broken("both ends of a boundary edge lie on the boundary");
            }
        }
        for v in self.vertices() {
            for c in self.fan(v) {
                let broken = |law| Err(BrokenLaw { corner: c, law });
                if self.vertex(c) != v {
                    return broken("a fan stays at its vertex");
                }
                if std::mem::replace(&mut seen[c.index()], true) {
                    return broken("a fan visits each corner once");
                }
            }
            let closed = self.fan_start(v).is_some_and(|start| self.rotate_cw(start).is_some());
            if closed != self.is_interior(v) {
                let corner = self.fan_start(v).unwrap_or(CornerId::new(0));
                return Err(BrokenLaw { corner, law: "a vertex is interior exactly when its fan closes" });
            }
        }
        match seen.iter().position(|&s| !s) {
            Some(c) => Err(BrokenLaw { corner: CornerId::new(c), law: "every corner is in the fan of its vertex" }),
            None => Ok(()),
        }
    }
}

fn reject_repeated_vertices(faces: &[[VertexId; 3]]) -> Result<(), TopologyError> {
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
fn pair_edges(vertex_count: usize, faces: &[[VertexId; 3]]) -> Result<Vec<u32>, TopologyError> {
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
        return Err(TopologyError::NonManifoldEdge { a, b, faces, count: crowded_count });
    }
    if let Some(&(c, d)) = against.first() {
        return Err(orientation_error(corner_vertex, &opposite, (c, d), against.len()));
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
fn find_fans(
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

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(faces: &[[usize; 3]]) -> Vec<[VertexId; 3]> {
        faces.iter().map(|f| f.map(VertexId::new)).collect()
    }

    fn build(n: usize, faces: &[[usize; 3]]) -> Result<Topology, TopologyError> {
        let topology = Topology::build(n, &ids(faces))?;
        topology.check().expect("every law holds");
        Ok(topology)
    }

    #[test]
    fn a_fan_is_walked_counter_clockwise_from_the_boundary() {
        let t = build(5, &[[0, 3, 4], [0, 1, 2], [0, 2, 3]]).expect("a fan");
        let around: Vec<usize> = t.fan(VertexId::new(0)).map(|c| t.vertex(c.next()).index()).collect();
        assert_eq!(around, [1, 2, 3]);
        assert_eq!(t.boundary_edge_count(), 5);
        assert_eq!(t.edge_count(), 7);
        assert_eq!(t.interior_vertex_count(), 0);
    }

    #[test]
    fn a_closed_fan_has_an_interior_vertex() {
        let t = build(5, &[[0, 1, 2], [0, 2, 3], [0, 3, 1]]).expect("a pyramid without its base");
        assert!(t.is_interior(VertexId::new(0)));
        assert_eq!(t.fan(VertexId::new(0)).count(), 3);
        assert!(!t.is_boundary(VertexId::new(4)) && t.fan_start(VertexId::new(4)).is_none());
        assert_eq!(t.used_vertex_count(), 4);
    }

    #[test]
    fn rejects_an_edge_of_three_faces() {
        let e = build(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]).unwrap_err();
        let (a, b) = (VertexId::new(0), VertexId::new(1));
        assert_eq!(e, TopologyError::NonManifoldEdge { a, b, faces: 3, count: 1 });
    }

    #[test]
    fn rejects_faces_oriented_against_each_other() {
        let e = build(4, &[[0, 1, 2], [0, 1, 3]]).unwrap_err();
        assert!(matches!(e, TopologyError::InconsistentOrientation { count: 1, .. }), "{e}");
    }

    #[test]
    fn tells_a_one_sided_surface_from_a_badly_oriented_one() {
        // The five-vertex Möbius band.
        let e = build(5, &[[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]]).unwrap_err();
        assert!(matches!(e, TopologyError::NonOrientable { .. }), "{e}");
    }

    #[test]
    fn rejects_two_fans_that_touch_in_a_vertex() {
        let e = build(5, &[[0, 1, 2], [0, 3, 4]]).unwrap_err();
        assert_eq!(e, TopologyError::NonManifoldVertex { vertex: VertexId::new(0), fans: 2, count: 1 });
        let closed_and_open = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [0, 4, 5]];
        let e = build(6, &closed_and_open).unwrap_err();
        assert_eq!(e, TopologyError::NonManifoldVertex { vertex: VertexId::new(0), fans: 2, count: 1 });
    }

    #[test]
    fn rejects_a_face_that_repeats_a_vertex() {
        let e = build(3, &[[0, 1, 2], [2, 1, 2]]).unwrap_err();
        let (face, vertex) = (FaceId::new(1), VertexId::new(2));
        assert_eq!(e, TopologyError::RepeatedVertex { face, vertex, count: 1 });
    }

    #[test]
    fn rejects_no_faces() {
        assert_eq!(build(3, &[]).unwrap_err(), TopologyError::Empty);
    }

    #[test]
    fn two_triangles_glued_along_two_edges_are_a_manifold() {
        // The vertex they both surround has degree two.
        let t = build(3, &[[0, 1, 2], [0, 2, 1]]).expect("a two-sided triangle");
        assert_eq!(t.boundary_edge_count(), 0);
        assert!(t.is_interior(VertexId::new(0)));
    }
}
