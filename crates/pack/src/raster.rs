//! The cells that a polygon touches, and those within the margin of it.

use crate::geometry::{Point, Turn, turned};
use crate::shape::Shape;

/// What every cell is widened by, in cells: more than rounding can move a point.
const HAIR: f64 = 1e-7;

/// A piece at one angle and scale, in cells of the grid.
#[derive(Debug)]
pub(crate) struct Mask {
    /// Width and height of the piece, in cells and parts of cells.
    pub(crate) size: Point,
    /// Every cell that a point nearer than the margin touches, as runs. Rows are in bit-reversed order: the next row
    /// looked at is far from those before it, so that a place that is taken is found out soon.
    pub(crate) wide: Vec<CellRun>,
}

/// Cells in a row, side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellRun {
    pub(crate) row: i32,
    pub(crate) first: i32,
    pub(crate) length: u32,
}

/// One bit for each cell of a rectangle of cells.
#[derive(Clone, Debug)]
pub(crate) struct Bits {
    /// The column of the first bit and the row of the first word.
    pub(crate) low: [i32; 2],
    /// Words to a row.
    pub(crate) stride: usize,
    pub(crate) words: Vec<u64>,
}

impl Bits {
    fn new(low: [i32; 2], width: usize, height: usize) -> Self {
        let stride = width.div_ceil(64);
        Self { low, stride, words: vec![0; stride * height] }
    }

    pub(crate) fn rows(&self) -> impl Iterator<Item = (i32, &[u64])> {
        (self.low[1]..).zip(self.words.chunks_exact(self.stride))
    }

    fn row_count(&self) -> i32 {
        (self.words.len() / self.stride) as i32
    }

    /// Takes the cells of a row that an interval touches. Both are counted from the first bit, not from the corner of the
    /// piece: nothing is negative, and to cut off the digits is to round down.
    fn paint(&mut self, row: usize, from: f64, to: f64) {
        let last = 64 * self.stride - 1;
        let (first, last) = (((from - HAIR) as usize).min(last), ((to + HAIR) as usize).min(last));
        let start = row * self.stride;
        let Some(words) = self.words.get_mut(start..start + self.stride) else { return };
        let (head, tail) = (u64::MAX << (first % 64), u64::MAX >> (63 - last % 64));
        let (first, last) = (first / 64, last / 64);
        if first == last {
            words[first] |= head & tail;
            return;
        }
        words[first] |= head;
        words[first + 1..last].iter_mut().for_each(|word| *word = u64::MAX);
        words[last] |= tail;
    }

    /// Makes of one bit at every crossing of a row the bits with an odd number of crossings up to them.
    fn fill_between(&mut self) {
        for row in self.words.chunks_exact_mut(self.stride) {
            let mut inside = 0;
            for word in row {
                for shift in [1, 2, 4, 8, 16, 32] {
                    *word ^= *word << shift;
                }
                *word ^= inside;
                inside = if *word >> 63 == 1 { u64::MAX } else { 0 };
            }
        }
    }

    fn runs(&self, row: i32, out: &mut Vec<CellRun>) {
        let start = row as usize * self.stride;
        let words = &self.words[start..start + self.stride];
        let end = 64 * self.stride;
        // The first bit from `at` on that is set, or the first that is not.
        let next = |mut at: usize, set: bool| {
            while at < end {
                let word = if set { words[at / 64] } else { !words[at / 64] } >> (at % 64);
                if word != 0 {
                    return at + word.trailing_zeros() as usize;
                }
                at = (at / 64 + 1) * 64;
            }
            end
        };
        let mut at = next(0, true);
        while at < end {
            let stop = next(at, false);
            let first = self.low[0] + at as i32;
            out.push(CellRun { row: self.low[1] + row, first, length: (stop - at) as u32 });
            at = next(stop, true);
        }
    }
}

/// How a piece lies on the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lie {
    pub(crate) turn: Turn,
    /// The lower left corner after the turn, in units.
    pub(crate) low: Point,
    /// Width and height after the turn, in units.
    pub(crate) size: Point,
    /// Cells per unit.
    pub(crate) scale: f64,
}

impl Mask {
    /// The cells nearer than `margin` cells to the piece.
    pub(crate) fn new(shape: &Shape, lie: Lie, margin: f64) -> Self {
        let wide = Bits::within(shape, lie, margin);
        let mut runs = Vec::new();
        bit_reversed(wide.row_count(), |row| wide.runs(row, &mut runs));
        Self { size: lie.size.map(|length| length * lie.scale), wide: runs }
    }
}

impl Bits {
    /// Every cell that a point within `radius` cells of the piece touches.
    ///
    /// A cell that no edge touches is inside with its centre, and an odd number of edges crosses the row left of it. All
    /// others are those of the edges.
    pub(crate) fn within(shape: &Shape, lie: Lie, radius: f64) -> Self {
        let Lie { turn, low, size, scale } = lie;
        let around = radius.ceil() as i32 + 1;
        let cells = |length: f64| (length * scale).ceil() as usize + 1 + 2 * around as usize;
        let mut found = Self::new([-around; 2], cells(size[0]), cells(size[1]));
        let place = |p: Point| {
            let [x, y] = turned(p, turn);
            [(x - low[0]) * scale + f64::from(around), (y - low[1]) * scale + f64::from(around)]
        };
        let mut inside = found.clone();
        for outline in shape.outlines() {
            inside.words.fill(0);
            for ring in outline {
                let Some(&last) = ring.last() else { continue };
                let mut from = place(last);
                for to in ring.iter().map(|&p| place(p)) {
                    mark_crossings(&mut inside, from, to);
                    paint_capsule(&mut found, from, to, radius);
                    from = to;
                }
            }
            inside.fill_between();
            found.words.iter_mut().zip(&inside.words).for_each(|(word, more)| *word |= more);
        }
        found
    }
}

/// Turns over the bit of every cell where an edge crosses the centre line of a row.
fn mark_crossings(bits: &mut Bits, a: Point, b: Point) {
    let (low, high) = if a[1] <= b[1] { (a, b) } else { (b, a) };
    // The centre of row `r` is at `r + 1/2`. An edge has its lower end, not its upper one.
    let (first, end) = ((low[1] + 0.5) as usize, (high[1] + 0.5) as usize);
    // Rounding to the nearest takes a centre that lies on an end to the row above.
    let (first, end) = (row_from(low[1], first), row_from(high[1], end));
    if first == end {
        return;
    }
    let slope = (high[0] - low[0]) / (high[1] - low[1]);
    let (least, most) = (low[0].min(high[0]), low[0].max(high[0]));
    for row in first..end {
        let x = (low[0] + (row as f64 + 0.5 - low[1]) * slope).clamp(least, most) as usize;
        bits.words[row * bits.stride + x / 64] ^= 1 << (x % 64);
    }
}

/// The first row with its centre at `y` or above, near `row`.
fn row_from(y: f64, row: usize) -> usize {
    if row > 0 && row as f64 - 0.5 >= y { row - 1 } else { row }
}

/// Takes the cells that points within `radius` of the segment touch.
fn paint_capsule(bits: &mut Bits, a: Point, b: Point, radius: f64) {
    let low = (a[1].min(b[1]) - radius - HAIR) as usize;
    let high = (a[1].max(b[1]) + radius + HAIR) as usize;
    let mirrored = |[x, y]: Point| [-x, y];
    for row in low..=high {
        let strip = [row as f64, row as f64 + 1.0];
        let right = right_end(a, b, radius, strip);
        let left = -right_end(mirrored(a), mirrored(b), radius, strip);
        bits.paint(row, left.min(right), right.max(left));
    }
}

/// The largest x of the points of a strip of heights within `radius` of a segment.
///
/// The right end of what is at height `y` is concave in `y`. So it is largest at the height in the strip that is nearest
/// to the rightmost end point.
fn right_end(a: Point, b: Point, radius: f64, [bottom, top]: [f64; 2]) -> f64 {
    // Of an upright segment every height is one of a rightmost point.
    let (end_low, end_high, x) = if a[0] > b[0] {
        (a[1], a[1], a[0])
    } else if b[0] > a[0] {
        (b[1], b[1], b[0])
    } else {
        (a[1].min(b[1]), a[1].max(b[1]), a[0])
    };
    let y = if end_high < bottom {
        bottom
    } else if end_low > top {
        top
    } else {
        return x + radius;
    };
    let disc = |[x, at]: Point| {
        let half = radius * radius - (y - at) * (y - at);
        (half >= 0.0).then(|| x + half.sqrt())
    };
    let rise = b[1] - a[1];
    let side = || {
        if rise == 0.0 {
            return None;
        }
        let [dx, dy] = [b[0] - a[0], rise];
        let length = (dx * dx + dy * dy).sqrt();
        // The normal that points to the right.
        let turn = if dy > 0.0 { radius / length } else { -radius / length };
        let offset = [dy * turn, -dx * turn];
        let t = (y - a[1] - offset[1]) / rise;
        (-HAIR..=1.0 + HAIR).contains(&t).then(|| a[0] + offset[0] + t.clamp(0.0, 1.0) * dx)
    };
    let found = [disc(a), disc(b), side()].into_iter().flatten().fold(f64::NEG_INFINITY, f64::max);
    // Only rounding brings a segment to a strip that it does not reach: its nearer end is there, then.
    let nearer = if (a[1] - y).abs() <= (b[1] - y).abs() { a[0] } else { b[0] };
    if found.is_finite() { found } else { nearer }
}

/// Calls `visit` with every number below `count`, in the order of their bits read backwards.
fn bit_reversed(count: i32, mut visit: impl FnMut(i32)) {
    let bits = (count.max(1) as u32).next_power_of_two().trailing_zeros();
    for i in 0..1_u32 << bits {
        let row = if bits == 0 { 0 } else { i.reverse_bits() >> (32 - bits) };
        if (row as i32) < count {
            visit(row as i32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{UNTURNED, extent};

    fn cells(bits: &Bits) -> Vec<[i32; 2]> {
        let mut found = Vec::new();
        for (row, words) in bits.rows() {
            for column in 0..64 * bits.stride {
                if words[column / 64] >> (column % 64) & 1 == 1 {
                    found.push([bits.low[0] + column as i32, row]);
                }
            }
        }
        found
    }

    fn bits(loops: Vec<Vec<Point>>, radius: f64) -> Bits {
        let shape = Shape::new(&[loops], [0.0; 2], 1.0);
        let (low, size) = extent(shape.points(), UNTURNED);
        Bits::within(&shape, Lie { turn: UNTURNED, low, size, scale: 1.0 }, radius)
    }

    #[test]
    fn a_square_with_a_hole_takes_its_cells_and_not_those_of_the_hole() {
        let square = |low: f64, high: f64| vec![[low, low], [high, low], [high, high], [low, high]];
        let taken = cells(&bits(vec![square(0.0, 8.5), square(1.5, 6.5)], 0.0));
        assert!(taken.contains(&[0, 0]) && taken.contains(&[8, 8]) && taken.contains(&[1, 4]), "{taken:?}");
        assert!(!taken.contains(&[2, 2]) && !taken.contains(&[5, 5]) && taken.contains(&[6, 6]), "{taken:?}");
    }

    #[test]
    fn a_sliver_between_centres_of_cells_is_taken_all_along() {
        let found = bits(vec![vec![[0.1, 0.1], [20.1, 0.2], [20.1, 0.2001]]], 0.0);
        assert!(cells(&found).len() >= 20);
    }

    #[test]
    fn cells_within_the_margin_are_those_that_sampling_finds() {
        let triangle = vec![[0.0, 0.0], [7.3, 2.1], [1.4, 5.9]];
        let margin = 1.7;
        let found = bits(vec![triangle.clone()], margin);
        let wide = cells(&found);
        let mut runs = Vec::new();
        (0..found.row_count()).for_each(|row| found.runs(row, &mut runs));
        let of_runs: Vec<[i32; 2]> =
            runs.iter().flat_map(|run| (0..run.length).map(|i| [run.first + i as i32, run.row])).collect();
        assert_eq!(wide, of_runs);
        let distance = |p: Point| {
            let edges = [[0, 1], [1, 2], [2, 0]].map(|[i, j]| [triangle[i], triangle[j]]);
            let inside =
                edges.iter().all(|[a, b]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) >= 0.0);
            let to = |[a, b]: [Point; 2]| {
                let d = [b[0] - a[0], b[1] - a[1]];
                let t = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
                let t = t.clamp(0.0, 1.0);
                (p[0] - a[0] - t * d[0]).hypot(p[1] - a[1] - t * d[1])
            };
            if inside { 0.0 } else { edges.into_iter().map(to).fold(f64::INFINITY, f64::min) }
        };
        for x in -3..11 {
            for y in -3..10 {
                let samples = (0..=40).flat_map(|i| (0..=40).map(move |j| [f64::from(i) / 40.0, f64::from(j) / 40.0]));
                let nearest = samples.map(|[u, v]| distance([f64::from(x) + u, f64::from(y) + v]));
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                let is_wide = wide.contains(&[x, y]);
                assert!(is_wide || nearest >= margin, "cell {x} {y} at {nearest} is missing");
                assert!(!is_wide || nearest <= margin + 0.05, "cell {x} {y} at {nearest} is too much");
            }
        }
    }

    #[test]
    fn rows_come_in_bit_reversed_order_and_each_once() {
        let mut order = Vec::new();
        bit_reversed(6, |row| order.push(row));
        assert_eq!(order, [0, 4, 2, 1, 5, 3]);
    }
}
