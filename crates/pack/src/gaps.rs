//! Where a piece comes near to itself: what packing cannot change.

use crate::geometry::{Point, cross, dot, minus, signed_area};
use crate::piece::Piece;
use std::collections::BTreeMap;

/// Parts of one loop are different ones from this many times the distance asked for on, along the loop. So a corner is
/// near to itself only if it is a notch of less than 29°.
const APART: f64 = 4.0;

/// A place where the outline of a piece comes near to itself across what is outside of it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Gap {
    /// The polygon of the piece.
    pub polygon: usize,
    /// The two edges that are nearest there: the loop, and the point of it that the edge begins at.
    pub edges: [[usize; 2]; 2],
    /// The two nearest points, one on each of these edges.
    pub points: [Point; 2],
    /// Between them, in units of the piece; 0 where the outline touches itself.
    pub distance: f64,
}

/// Every place where the outline of a polygon comes nearer to itself than `within`, in units of the piece, across what is
/// outside of it; the narrowest first. In each place the nearest points are found exactly.
///
/// Two points of one loop belong to different parts of it if they are at least `4 · within` apart along it; points of two
/// loops always do. Near pairs of edges whose edges are the same or follow one another are one place.
#[must_use]
pub fn gaps(piece: &Piece, within: f64) -> Vec<Gap> {
    let mut found = Vec::new();
    for (polygon, loops) in piece.polygons.iter().enumerate() {
        let outline = Outline::new(loops);
        found.extend(outline.places(&outline.near(within)).into_iter().map(|near| Gap {
            polygon,
            edges: near.edges.map(|edge| outline.name(edge)),
            points: near.points,
            distance: near.distance,
        }));
    }
    found.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.polygon.cmp(&b.polygon)).then(a.edges.cmp(&b.edges)));
    found
}

/// The edges of a polygon, loop after loop.
struct Outline {
    edges: Vec<Edge>,
    loops: Vec<Loop>,
}

#[derive(Clone, Copy)]
struct Edge {
    from: Point,
    along: Point,
    /// Along the loop up to `from`.
    start: f64,
    length: f64,
    of_loop: usize,
}

/// The edges of a loop that have a length.
struct Loop {
    first: usize,
    count: usize,
    length: f64,
    /// Whether the inside is on the left.
    has_inside_left: bool,
    /// For each of its edges the point that it begins at.
    points: Vec<usize>,
}

/// Two edges and their nearest points that count.
#[derive(Clone, Copy)]
struct Near {
    edges: [usize; 2],
    points: [Point; 2],
    distance: f64,
}

impl Outline {
    fn new(rings: &[Vec<Point>]) -> Self {
        let (mut edges, mut loops) = (Vec::new(), Vec::new());
        for (number, ring) in rings.iter().enumerate() {
            let (first, mut length, mut points) = (edges.len(), 0.0, Vec::new());
            for (i, &from) in ring.iter().enumerate() {
                let along = minus(ring[(i + 1) % ring.len()], from);
                let own = dot(along, along).sqrt();
                if own > 0.0 {
                    edges.push(Edge { from, along, start: length, length: own, of_loop: number });
                    points.push(i);
                    length += own;
                }
            }
            loops.push(Loop { first, count: edges.len() - first, length, has_inside_left: true, points });
        }
        let mut outline = Self { edges, loops };
        for (number, ring) in rings.iter().enumerate() {
            let is_hole = outline.is_within_others(number);
            outline.loops[number].has_inside_left = (signed_area(ring) > 0.0) != is_hole;
        }
        outline
    }

    /// Whether an odd number of other loops is around a loop.
    fn is_within_others(&self, number: usize) -> bool {
        let Loop { first, count, .. } = self.loops[number];
        if count == 0 {
            return false;
        }
        let Edge { from, along, .. } = self.edges[first];
        let p = [from[0] + 0.5 * along[0], from[1] + 0.5 * along[1]];
        let is_left = |edge: &&Edge| {
            let [a, b] = [edge.from[1], edge.from[1] + edge.along[1]];
            let crosses = (a <= p[1]) != (b <= p[1]);
            crosses && edge.from[0] + (p[1] - a) / (b - a) * edge.along[0] < p[0]
        };
        self.edges.iter().filter(|edge| edge.of_loop != number).filter(is_left).count() % 2 == 1
    }

    /// The loop of an edge, and the point of it that the edge begins at.
    fn name(&self, edge: usize) -> [usize; 2] {
        let of_loop = self.edges[edge].of_loop;
        let ring = &self.loops[of_loop];
        [of_loop, ring.points[edge - ring.first]]
    }

    /// All pairs of edges with points that count nearer than `within`.
    fn near(&self, within: f64) -> Vec<Near> {
        let low = |edge: &Edge, i: usize| edge.from[i].min(edge.from[i] + edge.along[i]);
        let high = |edge: &Edge, i: usize| edge.from[i].max(edge.from[i] + edge.along[i]);
        let mut order: Vec<usize> = (0..self.edges.len()).collect();
        order.sort_by(|&a, &b| low(&self.edges[a], 0).total_cmp(&low(&self.edges[b], 0)));
        let mut found = Vec::new();
        for (at, &i) in order.iter().enumerate() {
            let one = &self.edges[i];
            let (right, bottom, top) = (high(one, 0) + within, low(one, 1) - within, high(one, 1) + within);
            for &j in order[at + 1..].iter().take_while(|&&j| low(&self.edges[j], 0) <= right) {
                let other = &self.edges[j];
                if low(other, 1) <= top && high(other, 1) >= bottom {
                    found.extend(self.nearest([i.min(j), i.max(j)], within));
                }
            }
        }
        found
    }

    /// The nearest points of two edges that count, if they are nearer than `within`.
    fn nearest(&self, edges: [usize; 2], within: f64) -> Option<Near> {
        let [a, b] = edges.map(|edge| self.edges[edge]);
        // All pairs of places on the edges, as parts of their lengths.
        let mut pairs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        if a.of_loop == b.of_loop {
            let (between, apart) = (b.start - a.start, APART * within);
            let way = |[s, t]: Point| between + t * b.length - s * a.length;
            pairs = clipped(&pairs, |p| way(p) - apart);
            let around = self.loops[a.of_loop].length;
            pairs = clipped(&pairs, |p| around - way(p) - apart);
        }
        let [s, t] = least_distance(&pairs, minus(b.from, a.from), a.along, b.along)?;
        let at = |edge: Edge, t: f64| [edge.from[0] + t * edge.along[0], edge.from[1] + t * edge.along[1]];
        let points = [at(a, s), at(b, t)];
        let d = minus(points[1], points[0]);
        let distance = dot(d, d).sqrt();
        let is_outside = || self.leaves(edges[0], s, d) && self.leaves(edges[1], t, [-d[0], -d[1]]);
        (distance < within && (distance == 0.0 || is_outside())).then_some(Near { edges, points, distance })
    }

    /// Whether a direction leads out of the polygon from a place on an edge.
    fn leaves(&self, edge: usize, t: f64, direction: Point) -> bool {
        let Loop { first, count, has_inside_left, .. } = self.loops[self.edges[edge].of_loop];
        let neighbour = |step: usize| first + (edge - first + step) % count;
        let (before, after) = match t {
            t if t <= 0.0 => (neighbour(count - 1), edge),
            t if t >= 1.0 => (edge, neighbour(1)),
            _ => (edge, edge),
        };
        let side = if has_inside_left { 1.0 } else { -1.0 };
        let left_of = |a: Point, b: Point| side * cross(a, b) > 0.0;
        let (u, v) = (self.edges[before].along, self.edges[after].along);
        let (one, two) = (left_of(u, direction), left_of(v, direction));
        let is_inside = if left_of(u, v) { one && two } else { one || two };
        !is_inside
    }

    /// The nearest pair of every place.
    fn places(&self, near: &[Near]) -> Vec<Near> {
        let number: BTreeMap<[usize; 2], usize> = near.iter().enumerate().map(|(i, near)| (near.edges, i)).collect();
        let around = |edge: usize| {
            let Loop { first, count, .. } = self.loops[self.edges[edge].of_loop];
            [edge, first + (edge - first + 1) % count, first + (edge - first + count - 1) % count]
        };
        let mut is_seen = vec![false; near.len()];
        let mut places = Vec::new();
        for start in 0..near.len() {
            if is_seen[start] {
                continue;
            }
            is_seen[start] = true;
            let (mut place, mut waiting) = (near[start], vec![start]);
            while let Some(i) = waiting.pop() {
                if (near[i].distance, near[i].edges) < (place.distance, place.edges) {
                    place = near[i];
                }
                let [one, other] = near[i].edges.map(around);
                for pair in one.iter().flat_map(|&a| other.map(|b| [a.min(b), a.max(b)])) {
                    if let Some(&next) = number.get(&pair).filter(|&&next| !is_seen[next]) {
                        is_seen[next] = true;
                        waiting.push(next);
                    }
                }
            }
            places.push(place);
        }
        places
    }
}

/// The part of a convex polygon where `value`, which is linear, is not negative.
fn clipped(polygon: &[Point], value: impl Fn(Point) -> f64) -> Vec<Point> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (&p, &q) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (at_p, at_q) = (value(p), value(q));
        if at_p >= 0.0 {
            kept.push(p);
        }
        if (at_p >= 0.0) != (at_q >= 0.0) {
            let t = at_p / (at_p - at_q);
            kept.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
        }
    }
    kept
}

/// The `(s, t)` of a convex polygon with the least `|offset + t·v − s·u|`: where that is 0, or on the border.
fn least_distance(polygon: &[Point], offset: Point, u: Point, v: Point) -> Option<Point> {
    let between = |[s, t]: Point| [offset[0] + t * v[0] - s * u[0], offset[1] + t * v[1] - s * u[1]];
    let det = cross(u, v);
    if det != 0.0 {
        let crossing = [cross(offset, v) / det, cross(offset, u) / det];
        let is_right = |(&p, &q): (&Point, &Point)| cross(minus(q, p), minus(crossing, p)) < 0.0;
        if polygon.len() > 2 && !polygon.iter().zip(polygon.iter().cycle().skip(1)).any(is_right) {
            return Some(crossing);
        }
    }
    let mut best: Option<(f64, Point)> = None;
    for (&p, &q) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (from, change) = (between(p), minus(between(q), between(p)));
        let squared = dot(change, change);
        let part = if squared > 0.0 { (-dot(from, change) / squared).clamp(0.0, 1.0) } else { 0.0 };
        let at = [p[0] + part * (q[0] - p[0]), p[1] + part * (q[1] - p[1])];
        let d = between(at);
        let value = dot(d, d);
        if best.is_none_or(|(least, _)| value < least) {
            best = Some((value, at));
        }
    }
    best.map(|(_, at)| at)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of ten by ten with a slit of some width from the right.
    fn slit(width: f64) -> Vec<Point> {
        let (low, high) = (5.0 - 0.5 * width, 5.0 + 0.5 * width);
        vec![[0.0, 0.0], [10.0, 0.0], [10.0, low], [4.0, low], [4.0, high], [10.0, high], [10.0, 10.0], [0.0, 10.0]]
    }

    #[test]
    fn a_slit_is_one_gap_and_its_width_is_exact() {
        let piece = Piece::new(vec![slit(0.25)]);
        let found = gaps(&piece, 0.5);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].distance.to_bits(), 0.25_f64.to_bits());
        assert_eq!(found[0].points.map(|p| p[1]), [4.875, 5.125]);
        assert_eq!(gaps(&piece, 0.25), []);
        // Clockwise it is the same.
        let turned = Piece::new(vec![slit(0.25).into_iter().rev().collect()]);
        assert_eq!(gaps(&turned, 0.5)[0].distance.to_bits(), 0.25_f64.to_bits());
    }

    #[test]
    fn what_is_thin_inside_is_no_gap() {
        let bar = Piece::new(vec![vec![[0.0, 0.0], [10.0, 0.0], [10.0, 0.1], [0.0, 0.1]]]);
        assert_eq!(gaps(&bar, 1.0), []);
        let sliver = Piece::new(vec![vec![[0.0, 0.0], [10.0, 0.01], [10.0, 0.02]]]);
        assert_eq!(gaps(&sliver, 1.0), []);
    }

    #[test]
    fn holes_near_each_other_are_a_gap_only_across_what_is_outside() {
        let square = |low: f64, high: f64| vec![[low, low], [high, low], [high, high], [low, high]];
        // A narrow bridge between a hole and the border is solid; a narrow hole is not.
        assert_eq!(gaps(&Piece::new(vec![square(0.0, 10.0), square(0.1, 5.0)]), 0.5), []);
        let hole = vec![[1.0, 5.0], [9.0, 5.0], [9.0, 5.2], [1.0, 5.2]];
        for ring in [hole.clone(), hole.into_iter().rev().collect()] {
            let found = gaps(&Piece::new(vec![square(0.0, 10.0), ring]), 0.5);
            assert_eq!(found.len(), 1, "{found:?}");
            assert!((found[0].distance - 0.2).abs() < 1e-12, "{found:?}");
        }
    }

    #[test]
    fn a_sharp_notch_is_a_gap_and_a_blunt_one_is_not() {
        let notch = |half: f64| {
            vec![[0.0, 0.0], [10.0, 0.0], [10.0, 5.0 - half], [5.0, 5.0], [10.0, 5.0 + half], [10.0, 10.0], [0.0, 10.0]]
        };
        assert_eq!(gaps(&Piece::new(vec![notch(5.0)]), 0.5), []);
        let found = gaps(&Piece::new(vec![notch(0.5)]), 0.5);
        assert_eq!(found.len(), 1, "{found:?}");
        // The way from one point along both sides of the notch to the other is the least that counts.
        let way = found[0].points.map(|p| (p[0] - 5.0).hypot(p[1] - 5.0)).iter().sum::<f64>();
        assert!((way - 2.0).abs() < 1e-9, "{way}");
    }

    #[test]
    fn the_least_distance_is_the_one_that_sampling_finds() {
        let gear: Vec<Point> = (0..40)
            .map(|i| (f64::from(i) * std::f64::consts::TAU / 40.0, if i % 2 == 0 { 1.0 } else { 0.2 }))
            .map(|(angle, r)| [r * angle.cos(), r * angle.sin()])
            .collect();
        let within = 0.05;
        let found = gaps(&Piece::new(vec![gear.clone()]), within);
        assert_eq!(found.len(), 20, "one for every notch");
        let steps = 200;
        let mut least = f64::INFINITY;
        let length = |a: Point, b: Point| (a[0] - b[0]).hypot(a[1] - b[1]);
        let side = length(gear[0], gear[1]);
        for i in 0..=steps {
            for k in 0..=steps {
                let [s, t] = [i, k].map(|x| f64::from(x) / f64::from(steps));
                let at = |end: Point, t: f64| [0, 1].map(|c| gear[1][c] + t * (end[c] - gear[1][c]));
                let (p, q) = (at(gear[0], s), at(gear[2], t));
                if (s + t) * side >= APART * within {
                    least = least.min(length(p, q));
                }
            }
        }
        assert!(found[0].distance <= least && found[0].distance > 0.97 * least, "{} {least}", found[0].distance);
    }
}
