//! Facets unfolded into the plane, joined edge by edge as long as nothing meets.

mod cells;
pub(super) mod rejoin;

use super::facets::{Facets, Fold};
use abf_mesh::{CornerId, FaceId, Point2, Topology, Vector2};
use cells::Cells;
use std::f64::consts::TAU;

/// Two sides of an edge are in one place when they differ by no more than this part of its length …
const SAME_OF_EDGE: f64 = 1e-3;
/// … and this part of the diagonal.
const SAME_OF_WHOLE: f64 = 1e-6;

/// Parts of a boundary keep this distance from each other, as a part of the diagonal.
const GAP: f64 = 1e-6;

/// Faces around a vertex on the boundary leave at least this angle free, rad.
const FREE_ANGLE: f64 = 0.01;

/// Nets with a shorter rim are looked at edge by edge.
const FEW: usize = 24;

/// Most cells along the diagonal.
const MOST_CELLS: f64 = 128.0;

/// All nets of a surface.
pub(super) struct Nets<'t> {
    topology: &'t Topology,
    diagonal: f64,
    /// The side of a cell.
    cell: f64,
    /// Where every corner lies, in the coordinates of its net.
    layout: Vec<Point2<f64>>,
    /// The net of every face.
    net_of: Vec<u32>,
    /// Whether the edge that a corner faces is inside a net.
    welded: Vec<bool>,
    /// Edges that cannot be joined: they never can while their nets only grow.
    dead: Vec<bool>,
    nets: Vec<Net>,
    /// The last search that reached every face, and how many there were.
    seen: Vec<u32>,
    searches: u32,
}

#[derive(Clone, Default)]
struct Net {
    faces: Vec<FaceId>,
    /// Corners that face an edge of the boundary; some of them inside by now.
    rim: Vec<CornerId>,
    /// The same by the cells that the edge touches, from when they are first asked for.
    cells: Option<Cells>,
}

/// A rigid motion: `rotation · p + shift`, rotation as a complex number.
#[derive(Clone, Copy)]
struct Motion {
    rotation: Vector2<f64>,
    shift: Vector2<f64>,
}

impl Motion {
    fn apply(&self, p: Point2<f64>) -> Point2<f64> {
        let (c, s) = (self.rotation.x, self.rotation.y);
        Point2::new(c * p.x - s * p.y + self.shift.x, s * p.x + c * p.y + self.shift.y)
    }
}

impl<'t> Nets<'t> {
    /// One net for each facet.
    pub(super) fn new(topology: &'t Topology, facets: &Facets, diagonal: f64) -> Self {
        let mut nets: Vec<Net> = Vec::new();
        nets.resize_with(facets.sizes.len(), Net::default);
        let cells = (topology.face_count() as f64).sqrt().clamp(2.0, MOST_CELLS);
        let mut this = Self {
            topology,
            diagonal,
            cell: diagonal / cells,
            layout: facets.layout.clone(),
            net_of: facets.of_face.clone(),
            welded: vec![false; topology.corner_count()],
            dead: vec![false; topology.corner_count()],
            nets,
            seen: vec![0; topology.face_count()],
            searches: 0,
        };
        for f in topology.faces() {
            let net = facets.of_face[f.index()];
            this.nets[net as usize].faces.push(f);
            for c in f.corners() {
                match topology.opposite(c) {
                    Some(o) if facets.of_face[o.face().index()] == net => this.welded[c.index()] = true,
                    _ => this.add_to_rim(net as usize, c),
                }
            }
        }
        this
    }

    pub(super) fn net_of(&self, f: FaceId) -> u32 {
        self.net_of[f.index()]
    }

    pub(super) fn is_welded(&self, c: CornerId) -> bool {
        self.welded[c.index()]
    }

    /// The ends of the edge that a corner faces, in the plane.
    fn segment(&self, c: CornerId) -> [Point2<f64>; 2] {
        [self.layout[c.next().index()], self.layout[c.prev().index()]]
    }

    fn add_to_rim(&mut self, net: usize, c: CornerId) {
        let cells = self.cells_of(self.segment(c), 0.0);
        let net = &mut self.nets[net];
        net.rim.push(c);
        if let Some(known) = &mut net.cells {
            cells.for_each(|cell| known.insert(cell, c));
        }
    }

    /// Sorts the rim of a net into cells, if that has not been done and is worth it.
    fn find_cells(&mut self, net: usize) {
        if self.nets[net].cells.is_some() || self.nets[net].rim.len() < FEW {
            return;
        }
        let mut cells = Cells::default();
        for &c in self.nets[net].rim.iter().filter(|c| !self.welded[c.index()]) {
            self.cells_of(self.segment(c), 0.0).for_each(|cell| cells.insert(cell, c));
        }
        self.nets[net].cells = Some(cells);
    }

    /// The cells that the box of a segment touches.
    fn cells_of(&self, [p, q]: [Point2<f64>; 2], margin: f64) -> impl Iterator<Item = [i32; 2]> + use<> {
        let size = self.cell;
        let low = |x: f64| ((x - margin) / size).floor() as i32;
        let high = |x: f64| ((x + margin) / size).floor() as i32;
        let (left, right) = (low(p.x.min(q.x)), high(p.x.max(q.x)));
        let (bottom, top) = (low(p.y.min(q.y)), high(p.y.max(q.y)));
        // Of a long slanted segment only the cells near its line, rounded outwards; of an upright one all of a column.
        let d = q - p;
        let of_column = move |x: i32| {
            let middle = (f64::from(x) + 0.5) * size - p.x;
            let near = [-1.0, 1.0].map(|side| {
                let aside = side * (size + margin) * d.norm();
                (p.y + (d.y * middle + aside) / d.x) / size - 0.5
            });
            let from = near[0].min(near[1]).floor().max(f64::from(bottom)) as i32;
            let to = near[0].max(near[1]).ceil().min(f64::from(top)) as i32;
            (from..=to).map(move |y| [x, y])
        };
        (left..=right).flat_map(of_column)
    }

    /// Joins the nets on the two sides of an edge if nothing meets in the plane; whether they are one now.
    pub(super) fn join(&mut self, fold: &Fold) -> bool {
        let (c, o) = (fold.corner, fold.opposite);
        let [a, b] = [c, o].map(|c| self.net_of[c.face().index()] as usize);
        if a == b || self.dead[c.index()] {
            return a == b;
        }
        // The smaller one is moved.
        let (stays, moves, c, o) =
            if self.nets[a].faces.len() >= self.nets[b].faces.len() { (a, b, c, o) } else { (b, a, o, c) };
        let Some(motion) = self.motion(c, o) else { return false };
        let welds = self.welds(stays, moves, motion);
        self.find_cells(stays);
        if !self.fits(stays, moves, motion, &welds) {
            for &(c, o) in &welds {
                self.dead[c.index()] = true;
                self.dead[o.index()] = true;
            }
            return false;
        }
        self.merge(stays, moves, motion, &welds);
        true
    }

    /// What brings the net of `o` beside that of `c`.
    fn motion(&self, c: CornerId, o: CornerId) -> Option<Motion> {
        let [p, q] = self.segment(c);
        let [s, r] = self.segment(o);
        let (to, from) = ((q - p).try_normalize(0.0)?, (s - r).try_normalize(0.0)?);
        let rotation = Vector2::new(to.dot(&from), from.x * to.y - from.y * to.x);
        let turned = Motion { rotation, shift: Vector2::zeros() }.apply(r);
        // From middle to middle, so that what rounding leaves is shared.
        let turned_end = Motion { rotation, shift: Vector2::zeros() }.apply(s);
        let shift = ((p - turned) + (q - turned_end)) * 0.5;
        Some(Motion { rotation, shift })
    }

    /// The edges between two nets whose sides come to lie on each other: the corners that face them, of the net that
    /// stays first.
    fn welds(&self, stays: usize, moves: usize, motion: Motion) -> Vec<(CornerId, CornerId)> {
        let mut welds = Vec::new();
        for &o in &self.nets[moves].rim {
            let Some(c) = self.topology.opposite(o) else { continue };
            if self.welded[o.index()] || self.net_of[c.face().index()] as usize != stays {
                continue;
            }
            let [p, q] = self.segment(c);
            let [s, r] = self.segment(o).map(|p| motion.apply(p));
            let same = SAME_OF_EDGE * (q - p).norm() + SAME_OF_WHOLE * self.diagonal;
            if (p - r).norm() <= same && (q - s).norm() <= same {
                welds.push((c, o));
            }
        }
        welds
    }

    fn fits(&self, stays: usize, moves: usize, motion: Motion, welds: &[(CornerId, CornerId)]) -> bool {
        if welds.is_empty() || !welds.iter().all(|&(c, _)| self.leaves_room(c, welds)) {
            return false;
        }
        // Where the two meet at an edge they are joined along, they may meet.
        let mut ends: Vec<Point2<f64>> = welds.iter().flat_map(|&(c, _)| self.segment(c)).collect();
        ends.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
        let same = (SAME_OF_EDGE * 1e-2 + SAME_OF_WHOLE) * self.diagonal;
        let is_end = |p: Point2<f64>| {
            let from = ends.partition_point(|e| e.x < p.x - same);
            ends[from..].iter().take_while(|e| e.x <= p.x + same).any(|e| (e - p).norm() <= same)
        };
        let gap = GAP * self.diagonal;
        let is_weld = |o: CornerId| welds.iter().any(|w| w.1 == o || w.0 == o);
        let still = &self.nets[stays];
        for &o in self.nets[moves].rim.iter().filter(|o| !self.welded[o.index()]) {
            if is_weld(o) {
                continue;
            }
            let moved = self.segment(o).map(|p| motion.apply(p));
            let bars = |c: CornerId| {
                let segment = self.segment(c);
                if self.welded[c.index()] || distance(moved, segment) >= gap || is_weld(c) {
                    return false;
                }
                let shared = moved.iter().find(|p| is_end(**p) && segment.iter().any(|q| (*p - q).norm() <= same));
                shared.is_none() || !opens(moved, segment, same)
            };
            let is_barred = match &still.cells {
                Some(cells) => self.cells_of(moved, gap).any(|cell| cells.at(cell).any(bars)),
                None => still.rim.iter().any(|&c| bars(c)),
            };
            if is_barred {
                return false;
            }
        }
        true
    }

    /// Whether the faces around both ends of a weld leave room, or close exactly.
    fn leaves_room(&self, c: CornerId, welds: &[(CornerId, CornerId)]) -> bool {
        let crosses = |edge: CornerId| self.welded[edge.index()] || welds.iter().any(|&(c, o)| c == edge || o == edge);
        [c.next(), c.prev()].into_iter().all(|end| {
            let (sum, is_closed) = self.angle_around(end, &crosses);
            is_closed || sum <= TAU - FREE_ANGLE
        })
    }

    /// The angle of all faces around the vertex of a corner that are reached across edges that `crosses` lets through, rad;
    /// and whether they close.
    fn angle_around(&self, start: CornerId, crosses: &dyn Fn(CornerId) -> bool) -> (f64, bool) {
        let mut sum = self.angle(start);
        let mut at = start;
        // Counter-clockwise across the edge that `next` faces.
        while crosses(at.next()) {
            let Some(other) = self.topology.rotate_ccw(at) else { break };
            if other == start {
                return (sum, true);
            }
            sum += self.angle(other);
            at = other;
        }
        let mut at = start;
        while crosses(at.prev()) {
            let Some(other) = self.topology.opposite(at.prev()).map(CornerId::prev) else { break };
            if other == start {
                return (sum, true);
            }
            sum += self.angle(other);
            at = other;
        }
        (sum, false)
    }

    fn angle(&self, c: CornerId) -> f64 {
        let here = self.layout[c.index()];
        let (u, v) = (self.layout[c.next().index()] - here, self.layout[c.prev().index()] - here);
        (u.x * v.y - u.y * v.x).abs().atan2(u.dot(&v))
    }

    fn merge(&mut self, stays: usize, moves: usize, motion: Motion, welds: &[(CornerId, CornerId)]) {
        for &(c, o) in welds {
            self.welded[c.index()] = true;
            self.welded[o.index()] = true;
        }
        let Net { faces, rim, .. } = std::mem::take(&mut self.nets[moves]);
        for f in &faces {
            self.net_of[f.index()] = stays as u32;
            for c in f.corners() {
                self.layout[c.index()] = motion.apply(self.layout[c.index()]);
            }
        }
        self.nets[stays].faces.extend(faces);
        for c in rim {
            if !self.welded[c.index()] {
                self.add_to_rim(stays, c);
            }
        }
    }
}

/// Whether two segments with an end in common go different ways from it.
fn opens([p, q]: [Point2<f64>; 2], [r, s]: [Point2<f64>; 2], same: f64) -> bool {
    /// Directions nearer than this, rad, are one.
    const ANGLE: f64 = 1e-3;
    let pairs = [(p, q, r, s), (p, q, s, r), (q, p, r, s), (q, p, s, r)];
    let touching = pairs.into_iter().filter(|(a, _, b, _)| (a - b).norm() <= same);
    touching.into_iter().all(|(a, along, b, other)| {
        let (u, v) = (along - a, other - b);
        (u.x * v.y - u.y * v.x).abs().atan2(u.dot(&v)) > ANGLE
    })
}

/// The distance of two segments.
fn distance(one: [Point2<f64>; 2], other: [Point2<f64>; 2]) -> f64 {
    let side = |[p, q]: [Point2<f64>; 2], r: Point2<f64>| {
        let (u, v) = (q - p, r - p);
        u.x * v.y - u.y * v.x
    };
    let crosses = side(one, other[0]) * side(one, other[1]) < 0.0 && side(other, one[0]) * side(other, one[1]) < 0.0;
    if crosses {
        return 0.0;
    }
    let to = |[p, q]: [Point2<f64>; 2], r: Point2<f64>| {
        let d = q - p;
        let length = d.norm_squared();
        let t = if length > 0.0 { ((r - p).dot(&d) / length).clamp(0.0, 1.0) } else { 0.0 };
        (r - (p + d * t)).norm()
    };
    to(one, other[0]).min(to(one, other[1])).min(to(other, one[0])).min(to(other, one[1]))
}
