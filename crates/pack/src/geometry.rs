//! Convex hulls, and the boxes around them at an angle.

/// A point of the plane.
pub(crate) type Point = [f64; 2];

/// The cosine and the sine of an angle.
pub(crate) type Turn = [f64; 2];

/// No turn at all.
pub(crate) const UNTURNED: Turn = [1.0, 0.0];

/// `p` after a turn around the origin.
pub(crate) fn turned([x, y]: Point, [cos, sin]: Turn) -> Point {
    [cos * x - sin * y, sin * x + cos * y]
}

/// One turn after another.
pub(crate) fn compose(first: Turn, second: Turn) -> Turn {
    turned(first, second)
}

/// The turns by `k · 360° / count` for `k` in `0..count`, `count` a power of two. They come from square roots alone,
/// so that they are the same numbers on every machine.
pub(crate) fn wheel(count: usize) -> Vec<Turn> {
    let mut turns = vec![UNTURNED];
    // The turn by half a circle, then by halves of it.
    let mut step = [-1.0, 0.0];
    while turns.len() < count {
        let mut next = Vec::with_capacity(2 * turns.len());
        for &turn in &turns {
            next.extend([turn, compose(turn, step)]);
        }
        turns = next;
        let cos = f64::midpoint(1.0, step[0]).sqrt();
        step = if step[0] <= -1.0 { [0.0, 1.0] } else { [cos, (0.5 * (1.0 - step[0])).sqrt()] };
    }
    turns
}

/// The lowest coordinates of turned points, and their extent.
pub(crate) fn extent(points: &[Point], turn: Turn) -> (Point, Point) {
    let mut all = points.iter().map(|&p| turned(p, turn));
    let first = all.next().unwrap_or([0.0; 2]);
    let (low, high) = all
        .fold((first, first), |(low, high), [x, y]| ([low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]));
    (low, [high[0] - low[0], high[1] - low[1]])
}

/// The signed area of a closed loop.
pub(crate) fn signed_area(points: &[Point]) -> f64 {
    let Some(&origin) = points.first() else { return 0.0 };
    let from_origin = |p: &Point| [p[0] - origin[0], p[1] - origin[1]];
    let pairs = points.iter().zip(points.iter().cycle().skip(1));
    0.5 * pairs.map(|(a, b)| cross(from_origin(a), from_origin(b))).sum::<f64>()
}

/// A convex hull, counter-clockwise.
#[derive(Clone, Debug)]
pub(crate) struct Hull {
    points: Vec<Point>,
    /// The directions of the edges as numbers that grow with the angle, from the first edge on.
    angles: Vec<f64>,
}

impl Hull {
    /// The hull of some points (Andrew 1979). Rounding may leave out a corner that hardly is one.
    pub(crate) fn of(points: &[Point]) -> Self {
        let mut sorted = points.to_vec();
        sorted.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        sorted.dedup();
        if sorted.len() < 3 {
            return Self { points: sorted, angles: Vec::new() };
        }
        let mut points = chain(sorted.iter().copied());
        points.extend(chain(sorted.iter().rev().copied()));
        let mut angles = Vec::with_capacity(points.len());
        for i in 0..points.len() {
            let angle = pseudo_angle(minus(points[(i + 1) % points.len()], points[i]));
            // The hull starts at its lowest x: its edges start below the x-axis, between -90° and 90°.
            angles.push(rebased(angle));
        }
        Self { points, angles }
    }

    /// The turn after which the box around the hull has the least area, lying on its longer side
    /// (an edge of the hull lies on a side of that box: Freeman, Shapira 1975).
    pub(crate) fn tightest_box(&self) -> Turn {
        let area = |size: Point| size[0] * size[1];
        let candidates = std::iter::once(UNTURNED).chain(self.edge_directions().into_iter().map(turn_of));
        let best = self.least(candidates, area);
        let [w, h] = self.size(best);
        if w >= h { best } else { [-best[1], best[0]] }
    }

    /// The least distance of two parallel lines that hold the hull between them: one of them goes along an edge.
    pub(crate) fn width(&self) -> f64 {
        let across = |direction: Point| self.size(turn_of(direction))[1];
        self.edge_directions().into_iter().map(across).min_by(f64::total_cmp).unwrap_or(0.0)
    }

    /// The turn after which the hull fits into a rectangle of this shape at the largest scale, and that scale.
    ///
    /// The extents are `a · d` with `a` the direction of an axis and `d` between two opposite corners, constant between
    /// two directions of edges. Each is concave there, so `max(w / W, h / H)` is least where an edge lies along an axis,
    /// or where both are equal: at `a ⟂ d_w / W − d_h' / H` with `d_h'` the other `d` after a quarter turn.
    pub(crate) fn largest_in(&self, [width, height]: Point) -> (Turn, f64) {
        let mut directions: Vec<Point> = Vec::new();
        for [x, y] in self.edge_directions() {
            directions.extend([upper([x, y]), upper([-y, x])]);
        }
        directions.sort_unstable_by(|a, b| pseudo_angle(*a).total_cmp(&pseudo_angle(*b)));
        let mut candidates = vec![UNTURNED];
        candidates.extend(directions.iter().map(|&d| turn_of(d)));
        for (i, &a) in directions.iter().enumerate() {
            let b = directions.get(i + 1).copied().unwrap_or([-directions[0][0], -directions[0][1]]);
            let Some(middle) = normalized([a[0] + b[0], a[1] + b[1]]) else { continue };
            let across = self.across(middle);
            let up = self.across([-middle[1], middle[0]]);
            let q = [across[0] / width - up[1] / height, across[1] / width + up[0] / height];
            candidates.extend(normalized([-q[1], q[0]]).map(turn_of));
        }
        let filled = |[w, h]: Point| (w / width).max(h / height);
        let best = self.least(candidates.into_iter(), filled);
        (best, 1.0 / filled(self.size(best)))
    }

    /// Width and height after a turn.
    fn size(&self, turn: Turn) -> Point {
        let along = [turn[0], -turn[1]];
        let up = [turn[1], turn[0]];
        [dot(self.across(along), along), dot(self.across(up), up)]
    }

    /// From the corner furthest back along a direction to the one furthest ahead.
    fn across(&self, direction: Point) -> Point {
        minus(self.furthest(direction), self.furthest([-direction[0], -direction[1]]))
    }

    fn furthest(&self, direction: Point) -> Point {
        const FEW: usize = 12;
        if self.points.len() < FEW {
            let ahead = |best: Point, &p: &Point| if dot(p, direction) > dot(best, direction) { p } else { best };
            return self.points.iter().fold(self.points.first().copied().unwrap_or([0.0; 2]), ahead);
        }
        // Edges before this corner still gain along the direction, those after it lose.
        let normal = rebased(pseudo_angle([-direction[1], direction[0]]));
        let place = self.angles.partition_point(|&angle| angle < normal);
        self.points[place % self.points.len()]
    }

    fn edge_directions(&self) -> Vec<Point> {
        let pairs = self.points.iter().zip(self.points.iter().cycle().skip(1));
        pairs.filter_map(|(&a, &b)| normalized(minus(b, a))).collect()
    }

    fn least(&self, turns: impl Iterator<Item = Turn>, value: impl Fn(Point) -> f64) -> Turn {
        let mut best = (UNTURNED, f64::INFINITY);
        for turn in turns {
            let found = value(self.size(turn));
            if found < best.1 {
                best = (turn, found);
            }
        }
        best.0
    }
}

/// One side of a hull, without its last point, which begins the other side.
fn chain(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut chain: Vec<Point> = Vec::new();
    for p in points {
        while let [.., a, b] = chain[..]
            && cross(minus(b, a), minus(p, a)) <= 0.0
        {
            chain.pop();
        }
        chain.push(p);
    }
    chain.pop();
    chain
}

/// The turn that brings a direction to the x-axis.
fn turn_of([x, y]: Point) -> Turn {
    [x, -y]
}

/// Of a direction and its opposite the one with an angle in [0°, 180°).
fn upper([x, y]: Point) -> Point {
    if y > 0.0 || (y == 0.0 && x > 0.0) { [x, y] } else { [-x, -y] }
}

/// A number in [0, 4) that grows with the angle in [0°, 360°).
fn pseudo_angle([x, y]: Point) -> f64 {
    let along = x / (x.abs() + y.abs());
    if y >= 0.0 { 1.0 - along } else { 3.0 + along }
}

/// The same from -90° on.
fn rebased(pseudo_angle: f64) -> f64 {
    if pseudo_angle < 3.0 { pseudo_angle + 4.0 } else { pseudo_angle }
}

fn normalized([x, y]: Point) -> Option<Point> {
    let length = (x * x + y * y).sqrt();
    (length > 0.0 && length.is_finite()).then(|| [x / length, y / length])
}

pub(crate) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(crate) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ellipse(count: usize) -> Vec<Point> {
        let angle = |i: usize| i as f64 * std::f64::consts::TAU / count as f64;
        (0..count).map(|i| turned([3.0 * angle(i).cos() + 5.0, angle(i).sin()], [0.6, 0.8])).collect()
    }

    #[test]
    fn a_turned_rectangle_lies_down_in_a_box_of_its_size() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 3.0], [0.0, 3.0], [0.5, 1.0]];
        let points = corners.map(|[x, y]| turned([x + 7.0, y - 2.0], [0.6, 0.8]));
        let turn = Hull::of(&points).tightest_box();
        let (_, size) = extent(&points, turn);
        assert!((size[0] - 3.0).abs() < 1e-12 && (size[1] - 1.0).abs() < 1e-12, "{size:?}");
        assert!((turn[0].hypot(turn[1]) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_smallest_square_around_a_bar_stands_on_its_corner() {
        let bar = [[0.0, 0.0], [10.0, 0.0], [10.0, 1.0], [0.0, 1.0]];
        let (_, scale) = Hull::of(&bar).largest_in([1.0, 1.0]);
        assert!((scale - 2.0_f64.sqrt() / 11.0).abs() < 1e-12, "{scale}");
    }

    #[test]
    fn no_angle_of_many_beats_the_closed_form() {
        for points in [ellipse(7), ellipse(100), vec![[0.0, 0.0], [4.0, 1.0], [1.0, 2.5]]] {
            for page in [[1.0, 1.0], [2.0, 1.0]] {
                let (turn, scale) = Hull::of(&points).largest_in(page);
                let at = |turn| {
                    let (_, [w, h]) = extent(&points, turn);
                    (page[0] / w).min(page[1] / h)
                };
                assert!((at(turn) / scale - 1.0).abs() < 1e-12);
                let sampled = wheel(4096).into_iter().map(at).fold(0.0, f64::max);
                assert!(scale >= sampled * (1.0 - 1e-12) && scale < sampled * 1.002, "{scale} {sampled}");
            }
        }
    }

    #[test]
    fn a_wheel_has_all_its_turns_once() {
        let mut angles: Vec<f64> =
            wheel(16).into_iter().map(|[c, s]| s.atan2(c).to_degrees().rem_euclid(360.0)).collect();
        angles.sort_by(f64::total_cmp);
        angles.iter().enumerate().for_each(|(k, a)| assert!((a - 22.5 * k as f64).abs() < 1e-9, "{k} {a}"));
    }

    #[test]
    fn points_on_a_line_and_single_points_have_boxes_too() {
        let line: Vec<Point> = (0..5).map(|i| [f64::from(i), f64::from(i)]).collect();
        let (_, size) = extent(&line, Hull::of(&line).tightest_box());
        assert!((size[0] - 32.0_f64.sqrt()).abs() < 1e-12 && size[1] < 1e-12, "{size:?}");
        let (_, scale) = Hull::of(&line).largest_in([1.0, 1.0]);
        assert!((scale - 0.25).abs() < 1e-12, "{scale}");
        assert_eq!(Hull::of(&[[2.0, 3.0]]).largest_in([1.0, 1.0]).1, f64::INFINITY);
    }
}
