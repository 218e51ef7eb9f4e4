//! A UV map as oriented triangles that are joined where they share an edge in the plane.
//!
//! Faces of a mirrored chart are turned around, so that every triangle on the right side runs
//! counter-clockwise. Two faces are joined along an edge of the mesh when they run along it in opposite
//! directions and agree on the places of both its ends; an edge at which more than two faces agree joins
//! none of them. What is not joined is boundary, so any set of faces has a boundary, manifold or not.

use abf_mesh::{CornerId, FaceId, Point2, Topology, TriMesh, UvId, UvMap, VertexId};
use abf_parallel::prelude::*;
use std::borrow::Cow;

/// Marks "no corner", as in [`Topology::packed_opposites`].
const NONE: u32 = u32::MAX;

/// Fewer corners or points are not worth a thread.
pub(crate) const PER_TASK: usize = 1 << 13;

/// The joined triangles.
pub struct Sheet<'a> {
    /// The UV points, scaled around 1.
    places: Vec<Point2<f64>>,
    /// The UV point of every corner; in turned faces the last two are exchanged.
    corners: Cow<'a, [UvId]>,
    /// The vertex of every corner, in the same order.
    vertices: Cow<'a, [VertexId]>,
    /// The corner that faces the same edge from the other side.
    opposite: Cow<'a, [u32]>,
}

/// The UV points times a power of two.
fn scaled(uv: &UvMap, scale: f64) -> Vec<Point2<f64>> {
    // Adding zero makes −0 positive, so that equal places have equal bits.
    uv.points().par_iter().with_min_len(PER_TASK).map(|p| p.map(|x| x * scale + 0.0)).collect()
}

/// The corners around a vertex, joined one to the next counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fan {
    /// Its first corner clockwise; any one where it closes.
    pub first: CornerId,
    /// Its last corner.
    pub last: CornerId,
    /// Whether the last is joined to the first.
    pub is_closed: bool,
}

impl<'a> Sheet<'a> {
    /// Joins the faces of a map. `scale` is a power of two; `is_turned` says which faces belong to a
    /// mirrored chart.
    #[must_use]
    pub fn new(mesh: &TriMesh, uv: &UvMap, scale: f64, is_turned: impl Fn(usize) -> bool) -> Self {
        let mut corners = uv.corners().to_vec();
        let mut vertices: Vec<VertexId> = mesh.faces().iter().flatten().copied().collect();
        for f in (0..mesh.face_count()).filter(|&f| is_turned(f)) {
            corners.swap(3 * f + 1, 3 * f + 2);
            vertices.swap(3 * f + 1, 3 * f + 2);
        }
        let places = scaled(uv, scale);
        let mut sheet = Self { places, corners: corners.into(), vertices: vertices.into(), opposite: Cow::default() };
        sheet.opposite = sheet.join(mesh.vertex_count()).into();
        sheet
    }

    /// The same for a map with one point per vertex of a manifold, none of whose faces is turned: joined are the faces
    /// that its corner table joins.
    #[must_use]
    pub fn of_manifold(mesh: &'a TriMesh, topology: &'a Topology, uv: &'a UvMap, scale: f64) -> Self {
        Self {
            places: scaled(uv, scale),
            corners: uv.corners().into(),
            vertices: mesh.faces().as_flattened().into(),
            opposite: topology.packed_opposites().into(),
        }
    }

    /// The same for a drawing with one point per vertex, as it is.
    pub(crate) fn of_drawing(
        topology: &'a Topology,
        corners: &'a [UvId],
        vertices: &'a [VertexId],
        uv: &[Point2<f64>],
    ) -> Self {
        let places = uv.iter().map(|p| p.map(|x| x + 0.0)).collect();
        let opposite = topology.packed_opposites().into();
        Self { places, corners: corners.into(), vertices: vertices.into(), opposite }
    }

    /// How many corners there are.
    #[must_use]
    pub fn corner_count(&self) -> usize {
        self.corners.len()
    }

    /// The UV point of a corner.
    #[must_use]
    pub fn point(&self, corner: CornerId) -> UvId {
        self.corners[corner.index()]
    }

    /// The place of a UV point.
    #[must_use]
    pub fn place_of(&self, point: UvId) -> Point2<f64> {
        self.places[point.index()]
    }

    /// How many UV points there are.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.places.len()
    }

    /// The place of a corner.
    #[must_use]
    pub fn place(&self, corner: CornerId) -> Point2<f64> {
        self.place_of(self.point(corner))
    }

    /// The vertex of a corner.
    #[must_use]
    pub fn vertex(&self, corner: CornerId) -> VertexId {
        self.vertices[corner.index()]
    }

    /// The places of a face, counter-clockwise if it lies on the right side.
    #[must_use]
    pub fn triangle(&self, face: FaceId) -> [Point2<f64>; 3] {
        face.corners().map(|c| self.place(c))
    }

    /// The edges with a face on one side only, each named by the corner facing it: it runs from the
    /// next corner to the previous one, its face on the left.
    pub fn boundary(&self) -> impl Iterator<Item = CornerId> + '_ {
        let is_free = |&c: &usize| self.opposite[c] == NONE;
        (0..self.corner_count()).filter(is_free).map(CornerId::new)
    }

    /// The next corner counter-clockwise around the same vertex.
    #[must_use]
    pub fn rotate_ccw(&self, corner: CornerId) -> Option<CornerId> {
        match self.opposite[corner.next().index()] {
            NONE => None,
            other => Some(CornerId::new(other as usize).next()),
        }
    }

    /// The fan of a vertex that stands in one place, from its first corner.
    #[must_use]
    pub fn fan_from(&self, first: CornerId) -> Fan {
        let mut last = first;
        while let Some(next) = self.rotate_ccw(last) {
            if next == first {
                return Fan { first, last, is_closed: true };
            }
            last = next;
        }
        Fan { first, last, is_closed: false }
    }

    /// Every fan once: those on the boundary, then those that close.
    pub fn fans(&self) -> impl Iterator<Item = Fan> + '_ {
        let mut seen = vec![false; self.corner_count()];
        let open = (0..self.corner_count()).map(|c| (CornerId::new(c), true));
        let closed = (0..self.corner_count()).map(|c| (CornerId::new(c), false));
        open.chain(closed).filter_map(move |(first, is_open)| {
            if seen[first.index()] || (is_open && self.opposite[first.prev().index()] != NONE) {
                return None;
            }
            let fan = self.fan_from(first);
            self.fan_corners(fan).for_each(|c| seen[c.index()] = true);
            Some(fan)
        })
    }

    /// The corners of a fan, counter-clockwise.
    pub fn fan_corners(&self, fan: Fan) -> impl Iterator<Item = CornerId> + '_ {
        std::iter::successors(Some(fan.first), move |&c| self.rotate_ccw(c).filter(|_| c != fan.last))
    }

    /// The opposite of every corner: edges are bucketed by their lower vertex and joined inside.
    fn join(&self, vertex_count: usize) -> Vec<u32> {
        let ends = |c: CornerId| (self.vertices[c.next().index()], self.vertices[c.prev().index()]);
        let corners = || (0..self.corner_count()).map(CornerId::new);
        let mut start = vec![0_u32; vertex_count + 1];
        for c in corners() {
            let (from, to) = ends(c);
            start[from.min(to).index() + 1] += 1;
        }
        for v in 0..vertex_count {
            start[v + 1] += start[v];
        }
        let mut cursor = start.clone();
        let mut edges = vec![(0_u32, 0_u32); self.corner_count()];
        for c in corners() {
            let (from, to) = ends(c);
            let slot = &mut cursor[from.min(to).index()];
            edges[*slot as usize] = (from.max(to).index() as u32, c.index() as u32);
            *slot += 1;
        }
        let mut opposite = vec![NONE; self.corner_count()];
        for v in 0..vertex_count {
            let bucket = &mut edges[start[v] as usize..start[v + 1] as usize];
            bucket.sort_unstable();
            for edge in bucket.chunk_by_mut(|a, b| a.0 == b.0) {
                match *edge {
                    [_] => {}
                    [(_, a), (_, b)] => self.join_pair(a, b, &mut opposite),
                    _ => self.join_crowd(edge, &mut opposite),
                }
            }
        }
        opposite
    }

    /// Joins two half-edges between the same vertices, if they fit.
    fn join_pair(&self, a: u32, b: u32, opposite: &mut [u32]) {
        let [c, d] = [a, b].map(|c| CornerId::new(c as usize));
        let agree = |c: CornerId, d: CornerId| {
            self.vertex(c) == self.vertex(d) && (self.point(c) == self.point(d) || self.place(c) == self.place(d))
        };
        // An edge from a vertex to itself has no direction.
        let has_direction = self.vertex(c.next()) != self.vertex(c.prev());
        if c.face() != d.face() && has_direction && agree(c.next(), d.prev()) && agree(c.prev(), d.next()) {
            opposite[c.index()] = b;
            opposite[d.index()] = a;
        }
    }

    /// Joins the half-edges of an edge with more than two faces, where exactly two agree on its places.
    fn join_crowd(&self, edge: &mut [(u32, u32)], opposite: &mut [u32]) {
        let key = |&(_, c): &(u32, u32)| {
            let c = CornerId::new(c as usize);
            let (from, to) = (c.next(), c.prev());
            let (low, high) = if self.vertex(from) <= self.vertex(to) { (from, to) } else { (to, from) };
            let bits = |c: CornerId| [self.place(c).x.to_bits(), self.place(c).y.to_bits()];
            [bits(low), bits(high)]
        };
        edge.sort_unstable_by_key(|half| (key(half), half.1));
        for same in edge.chunk_by(|a, b| key(a) == key(b)) {
            if let [(_, a), (_, b)] = *same {
                self.join_pair(a, b, opposite);
            }
        }
    }
}
