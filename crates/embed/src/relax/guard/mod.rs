//! What keeps the boundary of a drawing clear of itself.
//!
//! A boundary vertex and a boundary edge that does not end there are kept apart by a barrier of their distance (Li and
//! others 2020, incremental potential contact). How far that reaches, and how much it weighs, follows the drawing and its
//! energy. A step goes at most a part of the way to the first contact of such a pair. What is accepted is decided by an exact
//! test of the whole boundary, not by the barrier.

mod contact;
mod gap;

use crate::plane::{of_face, orientation};
use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{Point2, Topology, Vector2, VertexId};
use abf_overlap::{BoundaryTest, BoxTree, Extent};
pub(crate) use contact::Pair;
use contact::{Contact, Nearness, first_contact};

/// The reach of the barrier, as a part of the mean boundary edge.
const REACH: f64 = 0.05;
/// The same as a part of the gap that is asked for, where that is more.
const REACH_OF_GAP: f64 = 0.25;
/// Pairs within so many times their reach get entries in the matrix.
const ROOM: f64 = 2.0;
/// The weight of a pair, as a part of the energy, over the number of boundary vertices.
const WEIGHT: f64 = 1e-2;
/// The barrier is for pairs that are nearer to each other than this part of their way along the boundary, and so is a gap: a slit
/// has an end.
const NEAR_BESIDE_WAY: f64 = 0.25;
/// How much more or less is nearly the same.
const NEARLY_THE_SAME: f64 = 2.0;
/// Pairs this near, as a part of the reach, slide along each other in short steps only: the barrier gets stiffer by a factor then,
/// up to a limit.
const TIGHT: f64 = 1e-2;
const STIFFER: f64 = 4.0;
const STIFFEST: f64 = 1e8;
/// A gap that is not there yet: so much of the distance is not given up again.
const KEPT: f64 = 0.9;
/// The gap where none is asked for, as a part of the reach. Parts that come nearer give up a tenth of their distance in a step
/// at most. Without it they meet before the energy is least, and slide along each other: strips that wind ended with 2 to 15
/// times the energy, after all steps that there are.
const OWN_GAP: f64 = 0.5;

/// The boundary of a mesh, and how it is kept clear of itself.
pub(crate) struct Guard<'t> {
    topology: &'t Topology,
    test: BoundaryTest<'t>,
    /// Loop after loop. Edge `k` runs from vertex `k` to `next[k]`.
    vertices: Vec<VertexId>,
    next: Vec<u32>,
    previous: Vec<u32>,
    loop_of: Vec<u32>,
    /// The smallest distance of parts of the boundary that are not near along it, in a drawing as large as the surface.
    pub(crate) gap: f64,
    /// Twice the area of the surface.
    double_area: f64,
    /// By what the weight of the barrier is multiplied.
    pub(crate) stiffness: f64,
    /// How far the barrier reaches without a gap.
    reach: f64,
    /// The energy that its weight is a part of.
    energy: f64,
}

/// A barrier that stands still.
pub(crate) struct Barrier<'g> {
    guard: &'g Guard<'g>,
    /// The places of the boundary vertices where it was set up.
    points: Vec<Point2<f64>>,
    walk: Walk,
    gap: f64,
    weight: f64,
}

/// Ways along the boundary.
struct Walk {
    /// Of every boundary vertex, from the first of its loop.
    at: Vec<f64>,
    /// Of every loop.
    total: Vec<f64>,
}

impl<'t> Guard<'t> {
    /// The guard of a mesh whose drawings are as large as the surface in the end.
    pub(crate) fn new(topology: &'t Topology, area: f64, gap: f64) -> Self {
        let (mut vertices, mut next, mut previous, mut loop_of) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (which, boundary) in topology.boundary_loops().iter().enumerate() {
            let (begin, count) = (vertices.len(), boundary.vertices.len());
            vertices.extend(&boundary.vertices);
            next.extend((0..count).map(|k| (begin + (k + 1) % count) as u32));
            previous.extend((0..count).map(|k| (begin + (k + count - 1) % count) as u32));
            loop_of.extend(std::iter::repeat_n(which as u32, count));
        }
        let test = BoundaryTest::new(topology);
        let double_area = 2.0 * area;
        Self {
            topology,
            test,
            vertices,
            next,
            previous,
            loop_of,
            gap,
            double_area,
            stiffness: 1.0,
            reach: 0.0,
            energy: 0.0,
        }
    }

    /// Whether the boundary of a drawing neither meets itself nor encloses a point twice; exact.
    pub(crate) fn is_clear(&self, uv: &[Point2<f64>], checkpoint: &mut Checkpoint<'_>) -> Result<bool, Cancelled> {
        self.test.is_clear(uv, checkpoint)
    }

    /// Has the barrier follow a drawing, and the size of its energy. It stays as it is while they are nearly the same, so that a
    /// descent can end.
    pub(crate) fn follow(&mut self, uv: &[Point2<f64>], energy: f64) {
        let length =
            |k: usize| (uv[self.vertices[self.next[k] as usize].index()] - uv[self.vertices[k].index()]).norm();
        let count = self.vertices.len();
        let reach = REACH * (0..count).map(length).sum::<f64>() / count as f64;
        let is_same = |old: f64, new: f64| old <= NEARLY_THE_SAME * new && new <= NEARLY_THE_SAME * old;
        if !is_same(self.reach, reach) || !is_same(self.energy, energy) {
            (self.reach, self.energy) = (reach, energy);
        }
        let tightest = self.barrier(uv).contacts(uv).iter().map(Contact::share_of_reach).fold(1.0, f64::min);
        if tightest < TIGHT {
            self.stiffness = (self.stiffness * STIFFER).min(STIFFEST);
        }
    }

    /// The barrier for a step from here.
    pub(crate) fn barrier(&self, uv: &[Point2<f64>]) -> Barrier<'_> {
        let points: Vec<Point2<f64>> = self.vertices.iter().map(|v| uv[v.index()]).collect();
        let weight = self.stiffness * WEIGHT * self.energy / points.len() as f64;
        let walk = self.walk(&points);
        let gap = (self.gap * self.scale(uv)).max(OWN_GAP * self.reach);
        Barrier { guard: self, points, walk, gap, weight }
    }

    /// The size of a drawing; that of one as large as the surface is 1.
    pub(crate) fn scale(&self, uv: &[Point2<f64>]) -> f64 {
        let area: f64 = self.topology.faces().map(|face| orientation(&of_face(self.topology, uv, face))).sum();
        (area / self.double_area).sqrt()
    }

    /// Whether an edge does not end at a vertex.
    fn is_pair(&self, vertex: u32, edge: u32) -> bool {
        edge != vertex && edge != self.previous[vertex as usize]
    }

    fn walk(&self, points: &[Point2<f64>]) -> Walk {
        let (mut at, mut total): (Vec<f64>, Vec<f64>) = (vec![0.0; points.len()], Vec::new());
        for k in 0..points.len() {
            let to = self.next[k] as usize;
            let end = at[k] + (points[to] - points[k]).norm();
            if to > k {
                at[to] = end;
            } else {
                total.push(end);
            }
        }
        Walk { at, total }
    }

    /// The way along the boundary from a vertex to the nearer end of an edge; infinite between loops.
    fn way(&self, walk: &Walk, vertex: u32, edge: u32) -> f64 {
        let own = self.loop_of[vertex as usize];
        if own != self.loop_of[edge as usize] {
            return f64::INFINITY;
        }
        let to = |end: u32| {
            let one_way = (walk.at[end as usize] - walk.at[vertex as usize]).abs();
            one_way.min(walk.total[own as usize] - one_way)
        };
        to(edge).min(to(self.next[edge as usize]))
    }
}

impl Barrier<'_> {
    /// What it costs; infinite where a gap is reached.
    pub(crate) fn value(&self, uv: &[Point2<f64>]) -> f64 {
        self.contacts(uv).iter().map(Contact::value).sum()
    }

    /// The pairs in reach.
    pub(crate) fn contacts(&self, uv: &[Point2<f64>]) -> Vec<Contact> {
        self.within(uv, 1.0)
    }

    /// The pairs that are in reach, or may soon be; in order.
    pub(crate) fn near(&self, uv: &[Point2<f64>]) -> Vec<Pair> {
        let mut pairs: Vec<Pair> = self.within(uv, ROOM).into_iter().map(|contact| contact.pair).collect();
        pairs.sort_unstable();
        pairs
    }

    /// The vertices of a pair that share entries.
    pub(crate) fn vertices(&self, pair: Pair) -> [(VertexId, VertexId); 2] {
        let [p, a, b] = self.guard_vertices(pair);
        [(p, a), (p, b)]
    }

    /// The first share of a motion, up to `limit`, at which a vertex is on an edge.
    pub(crate) fn first_contact(&self, uv: &[Point2<f64>], motion: &[Vector2<f64>], limit: f64) -> f64 {
        let swept = |k: u32| {
            let [here, there] =
                [self.guard.vertices[k as usize], self.guard.vertices[self.guard.next[k as usize] as usize]]
                    .map(|v| (uv[v.index()], uv[v.index()] + motion[v.index()] * limit));
            Extent::around(here.0, here.1).with(Extent::around(there.0, there.1))
        };
        let count = self.points.len() as u32;
        let tree = BoxTree::new((0..count).collect(), swept);
        let mut first = f64::INFINITY;
        for (k, v) in (0..count).zip(&self.guard.vertices) {
            let own = Extent::around(uv[v.index()], uv[v.index()] + motion[v.index()] * limit);
            tree.visit(
                |extent| extent.meets(&own),
                |e| {
                    if self.guard.is_pair(k, e) {
                        let vertices = self.guard_vertices((k, e));
                        let points = vertices.map(|v| uv[v.index()]);
                        first = first_contact(points, vertices.map(|v| motion[v.index()]), limit).min(first);
                    }
                },
            );
        }
        first
    }

    fn guard_vertices(&self, (vertex, edge): Pair) -> [VertexId; 3] {
        [vertex, edge, self.guard.next[edge as usize]].map(|k| self.guard.vertices[k as usize])
    }

    /// The pairs within so many times their reach.
    fn within(&self, uv: &[Point2<f64>], times: f64) -> Vec<Contact> {
        let guard = self.guard;
        let place = |k: u32| uv[guard.vertices[k as usize].index()];
        let count = self.points.len() as u32;
        let tree = BoxTree::new((0..count).collect(), |k| Extent::around(place(k), place(guard.next[k as usize])));
        let mut contacts = Vec::new();
        for k in 0..count {
            let farthest = self.gap + times * guard.reach.max(REACH_OF_GAP * self.gap);
            let near = around(place(k), farthest);
            tree.visit(
                |extent| extent.meets(&near),
                |e| {
                    if !guard.is_pair(k, e) {
                        return;
                    }
                    let nearness = Nearness::of([place(k), place(e), place(guard.next[e as usize])]);
                    if nearness.distance >= farthest {
                        return;
                    }
                    let most = NEAR_BESIDE_WAY * guard.way(&self.walk, k, e);
                    let gap = self.gap_of((k, e), most);
                    let reach = guard.reach.min(most).max(REACH_OF_GAP * gap);
                    if nearness.distance < gap + times * reach {
                        let vertices = self.guard_vertices((k, e));
                        contacts.push(Contact { pair: (k, e), vertices, nearness, gap, reach, weight: self.weight });
                    }
                },
            );
        }
        contacts
    }

    /// The gap of a pair: what is asked for, less where the two are near along the boundary, or are nearer than that already.
    fn gap_of(&self, (vertex, edge): Pair, most: f64) -> f64 {
        if self.gap == 0.0 {
            return 0.0;
        }
        let ends = [vertex, edge, self.guard.next[edge as usize]].map(|k| self.points[k as usize]);
        self.gap.min(most).min(KEPT * Nearness::of(ends).distance)
    }
}

/// The box around a point to this distance.
fn around(p: Point2<f64>, distance: f64) -> Extent {
    Extent { low: p.map(|x| x - distance), high: p.map(|x| x + distance) }
}
