//! The number of every chart, where there is most room for it.

use super::outline::Edges;
use abf_mesh::{CornerId, Point2, UvMap};
use std::collections::{BTreeMap, BinaryHeap};

/// How exactly the middle of a chart is found, as a part of the longer side of its box.
const PRECISION: f64 = 0.01;
/// The longer side of a box has at most so many cells to begin with.
const CELLS: f64 = 64.0;
/// How wide a digit is, as a part of its height, with room to spare.
const DIGIT: f64 = 0.7;
/// The part of the free circle that a number takes.
const FILL: f64 = 0.8;

/// The number of a chart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Label {
    /// Counted from 1.
    pub(crate) number: u32,
    /// Its middle, in UVs.
    pub(crate) at: Point2<f64>,
    /// How high it is, in units of the UVs.
    pub(crate) height: f64,
}

/// The numbers of all charts, none higher than `highest`. Charts without an inside have none. `charts` has that of every
/// face, counted from 0.
pub(crate) fn labels(uv: &UvMap, edges: &Edges, charts: &[u32], highest: f64) -> Vec<Label> {
    let mut of_chart: BTreeMap<u32, Vec<[Point2<f64>; 2]>> = BTreeMap::new();
    for &c in &edges.open {
        of_chart.entry(charts[c.face().index()]).or_default().push([c, c.next()].map(|c: CornerId| uv.corner(c)));
    }
    let label = |(chart, outline): (u32, Vec<[Point2<f64>; 2]>)| {
        let (at, radius) = middle(&outline)?;
        let number = chart + 1;
        let width = DIGIT * number.to_string().len() as f64;
        let height = highest.min(FILL * 2.0 * radius / (1.0 + width * width).sqrt());
        Some(Label { number, at, height })
    };
    of_chart.into_iter().filter_map(label).collect()
}

/// A square that is searched.
struct Cell {
    middle: Point2<f64>,
    half: f64,
    /// From its middle to the outline, negative outside.
    distance: f64,
}

impl Cell {
    fn new(outline: &[[Point2<f64>; 2]], middle: Point2<f64>, half: f64) -> Self {
        Self { middle, half, distance: depth(outline, middle) }
    }

    /// No point of it is deeper inside.
    fn most(&self) -> f64 {
        self.distance + self.half * std::f64::consts::SQRT_2
    }
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Cell {}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cell {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let place = |cell: &Self| [cell.middle.x, cell.middle.y];
        let [[x, y], [u, v]] = [place(self), place(other)];
        self.most().total_cmp(&other.most()).then(x.total_cmp(&u)).then(y.total_cmp(&v))
    }
}

/// The point inside of an outline that is farthest from it, and how far that is: squares are halved, the most promising
/// first.
fn middle(outline: &[[Point2<f64>; 2]]) -> Option<(Point2<f64>, f64)> {
    let (low, high) = crate::panel::bounds(outline.iter().flatten().copied());
    let size = high - low;
    let half = 0.5 * size.min().max(size.max() / CELLS);
    if !(half > 0.0) {
        return None;
    }
    let [columns, rows] = [size.x, size.y].map(|side| (side / (2.0 * half)).ceil().max(1.0) as usize);
    let places = (0..columns).flat_map(|i| (0..rows).map(move |k| [i, k].map(|n| (2 * n + 1) as f64 * half)));
    let mut waiting: BinaryHeap<Cell> =
        places.map(|[x, y]| Cell::new(outline, Point2::new(low.x + x, low.y + y), half)).collect();
    let mut best: Option<(Point2<f64>, f64)> = None;
    while let Some(cell) = waiting.pop() {
        let so_far = best.map_or(0.0, |(_, distance)| distance);
        if cell.distance > so_far {
            best = Some((cell.middle, cell.distance));
        }
        if cell.most() - cell.distance.max(so_far) <= PRECISION * size.max() {
            break;
        }
        let quarter = 0.5 * cell.half;
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            let middle = Point2::new(cell.middle.x + x * quarter, cell.middle.y + y * quarter);
            waiting.push(Cell::new(outline, middle, quarter));
        }
    }
    best
}

/// How far a point is from an outline, negative outside.
fn depth(outline: &[[Point2<f64>; 2]], p: Point2<f64>) -> f64 {
    let (mut is_inside, mut nearest) = (false, f64::INFINITY);
    for [a, b] in outline {
        if (a.y <= p.y) != (b.y <= p.y) && a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) < p.x {
            is_inside = !is_inside;
        }
        let along = b - a;
        let squared = along.norm_squared();
        let part = if squared > 0.0 { ((p - a).dot(&along) / squared).clamp(0.0, 1.0) } else { 0.0 };
        nearest = nearest.min((a + along * part - p).norm_squared());
    }
    if is_inside { nearest.sqrt() } else { -nearest.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outline(points: &[[f64; 2]]) -> Vec<[Point2<f64>; 2]> {
        let next = points.iter().cycle().skip(1);
        points.iter().zip(next).map(|(a, b)| [Point2::from(*a), Point2::from(*b)]).collect()
    }

    #[test]
    fn the_middle_of_a_u_is_in_its_broadest_part() {
        let u = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [8.0, 9.0], [8.0, 1.0], [3.0, 1.0], [3.0, 9.0], [0.0, 9.0]];
        let (at, radius) = middle(&outline(&u)).expect("an inside");
        assert!(at.x > 1.3 && at.x < 1.7 && (1.4..1.7).contains(&radius), "{at} {radius}");
    }

    #[test]
    fn the_middle_of_a_frame_is_not_in_its_hole() {
        let square = |low: f64, high: f64| [[low, low], [high, low], [high, high], [low, high]];
        let frame = [outline(&square(0.0, 10.0)), outline(&square(2.0, 8.0))].concat();
        let (at, radius) = middle(&frame).expect("an inside");
        assert!(depth(&frame, at) > 0.9 && radius > 0.9, "{at} {radius}");
        assert_eq!(middle(&outline(&[[1.0, 1.0], [1.0, 1.0]])), None);
    }
}
