//! A piece in the numbers of the packer.

use crate::geometry::{Hull, Point, dot, minus, signed_area};

/// A piece around its own middle, in units of the longest piece.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    points: Vec<Point>,
    /// The end of every loop in `points`.
    loops: Vec<usize>,
    /// The end of every outline in `loops`.
    outlines: Vec<usize>,
    /// Of all outlines together; what lies in several counts once.
    pub(crate) area: f64,
    pub(crate) hull: Hull,
}

impl Shape {
    pub(crate) fn new(outlines: &[Vec<Vec<Point>>], middle: Point, unit: f64) -> Self {
        let mut points = Vec::new();
        let (mut loops, mut ends) = (Vec::new(), Vec::new());
        let mut area = 0.0;
        for outline in outlines {
            let mut areas = Vec::with_capacity(outline.len());
            for ring in outline {
                let start = points.len();
                points.extend(ring.iter().map(|p| [(p[0] - middle[0]) / unit, (p[1] - middle[1]) / unit]));
                loops.push(points.len());
                areas.push(signed_area(&points[start..]).abs());
            }
            // The outer loop has the largest area, whichever comes first.
            let outer = areas.iter().copied().fold(0.0, f64::max);
            area += (2.0 * outer - areas.iter().sum::<f64>()).max(0.0);
            ends.push(loops.len());
        }
        let hull = Hull::of(&points);
        let mut shape = Self { points, loops, outlines: ends, area, hull };
        if outlines.len() > 1 {
            shape.area = shape.area_of_union();
        }
        shape
    }

    /// The area of several outlines, measured along lines across them.
    fn area_of_union(&self) -> f64 {
        /// Lines: a smooth outline comes out within a thousandth.
        const LINES: usize = 1024;
        let (low, high) = self
            .points
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[1]), high.max(p[1])));
        let step = (high - low) / LINES as f64;
        if !(step > 0.0) {
            return 0.0;
        }
        let mut crossings: Vec<Vec<(usize, f64)>> = vec![Vec::new(); LINES];
        for (outline, loops) in self.outlines().enumerate() {
            for ring in loops {
                for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                    let (a, b) = if a[1] <= b[1] { (a, b) } else { (b, a) };
                    // Line k is in the middle of its strip; an edge has its lower end, not its upper one.
                    let line = |y: f64| (((y - low) / step + 0.5) as usize).min(LINES);
                    for (k, on_line) in crossings.iter_mut().enumerate().take(line(b[1])).skip(line(a[1])) {
                        let y = low + (k as f64 + 0.5) * step;
                        let t = ((y - a[1]) / (b[1] - a[1])).clamp(0.0, 1.0);
                        on_line.push((outline, a[0] + t * (b[0] - a[0])));
                    }
                }
            }
        }
        step * crossings.iter_mut().map(|line| covered(line)).sum::<f64>()
    }

    /// The same outlines with fewer points: none that is left out is farther than `within` from the edge in its place.
    ///
    /// So the piece lies within that of the new edges where it differs from what they are around.
    pub(crate) fn simplified(&self, within: f64) -> Self {
        let (mut points, mut loops, mut start) = (Vec::new(), Vec::with_capacity(self.loops.len()), 0);
        for &end in &self.loops {
            simplify(&self.points[start..end], within, &mut points);
            loops.push(points.len());
            start = end;
        }
        Self { points, loops, outlines: self.outlines.clone(), area: self.area, hull: self.hull.clone() }
    }

    pub(crate) fn points(&self) -> &[Point] {
        &self.points
    }

    /// The loops of every outline.
    pub(crate) fn outlines(&self) -> impl Iterator<Item = impl Iterator<Item = &[Point]>> {
        let start_of = |ends: &[usize], i: usize| if i == 0 { 0 } else { ends[i - 1] };
        (0..self.outlines.len()).map(move |i| {
            let loops = start_of(&self.outlines, i)..self.outlines[i];
            loops.map(move |j| &self.points[start_of(&self.loops, j)..self.loops[j]])
        })
    }
}

/// Those points of a loop that [`Shape::simplified`] keeps: from each the farthest that an edge may lead to.
fn simplify(ring: &[Point], within: f64, kept: &mut Vec<Point>) {
    /// Edges that become one. All points between are looked at for each of them.
    const MOST: usize = 16;
    let at = |i: usize| ring[i % ring.len()];
    let may_be_one = |from: usize, to: usize| {
        let (a, along) = (at(from), minus(at(to), at(from)));
        let squared = dot(along, along);
        (from + 1..to).all(|i| {
            let way = minus(at(i), a);
            let part = if squared > 0.0 { (dot(way, along) / squared).clamp(0.0, 1.0) } else { 0.0 };
            let off = [way[0] - part * along[0], way[1] - part * along[1]];
            dot(off, off) <= within * within
        })
    };
    let mut from = 0;
    while from < ring.len() {
        kept.push(ring[from]);
        let mut to = from + 1;
        while to < ring.len() && to < from + MOST && may_be_one(from, to + 1) {
            to += 1;
        }
        from = to;
    }
}

/// How much of a line is inside an outline, from where outlines cross it.
fn covered(crossings: &mut [(usize, f64)]) -> f64 {
    crossings.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let of_one = crossings.chunk_by(|a, b| a.0 == b.0);
    let mut inside: Vec<[f64; 2]> =
        of_one.flat_map(|all| all.as_chunks::<2>().0.iter().map(|[from, to]| [from.1, to.1])).collect();
    inside.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut length, mut end) = (0.0, f64::NEG_INFINITY);
    for [from, to] in inside {
        length += (to - from.max(end)).max(0.0);
        end = end.max(to);
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_two_outlines_cover_counts_once_and_their_holes_do_not() {
        let square = |x: f64, side: f64| vec![[x, 0.0], [x + side, 0.0], [x + side, side], [x, side]];
        let of = |outlines: &[Vec<Vec<Point>>]| Shape::new(outlines, [0.0; 2], 1.0).area;
        let hole = vec![[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]];
        assert!((of(&[vec![square(0.0, 1.0)], vec![square(0.5, 1.0)]]) - 1.5).abs() < 2e-3);
        assert!((of(&[vec![square(0.0, 1.0), hole.clone()], vec![square(2.0, 1.0)]]) - 1.75).abs() < 2e-3);
        // The hole of the one is covered by the other.
        assert!((of(&[vec![square(0.0, 1.0), hole], vec![square(0.0, 1.0)]]) - 1.0).abs() < 2e-3);
    }

    #[test]
    fn points_that_are_left_out_are_near_the_edges_in_their_place() {
        let at = |i: u32, r: f64| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 400.0).sin_cos();
            [r * cos, r * sin]
        };
        let rings: Vec<Vec<Point>> = [1.0, 0.4].map(|r| (0..400).map(|i| at(i, r)).collect()).into();
        let whole = Shape::new(&[rings], [0.0; 2], 1.0);
        for within in [1e-3, 1e-2] {
            let few = whole.simplified(within);
            assert!(few.points().len() < whole.points().len() / 4, "{}", few.points().len());
            let loops: Vec<&[Point]> = few.outlines().flatten().collect();
            assert_eq!(loops.len(), 2);
            for p in whole.points() {
                let to_edge = |a: Point, b: Point| {
                    let (along, way) = (minus(b, a), minus(*p, a));
                    let part = (dot(way, along) / dot(along, along)).clamp(0.0, 1.0);
                    (way[0] - part * along[0]).hypot(way[1] - part * along[1])
                };
                let edges = loops.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
                let off = edges.map(|(&a, &b)| to_edge(a, b)).fold(f64::INFINITY, f64::min);
                assert!(off <= within * (1.0 + 1e-9), "{off} {within}");
            }
        }
        // Without room no corner goes.
        assert_eq!(whole.simplified(0.0).points(), whole.points());
    }
}
