//! Which triangle is seen at every sample: scan conversion and the z-buffer.
//!
//! Nothing is coloured here. A triangle leaves its number and its depth at the samples it covers
//! where nothing nearer lies; colouring then happens once per sample, however many triangles lie
//! on top of each other (a *visibility buffer*).
//!
//! Samples come in square tiles. Each tile knows a depth behind which all of it is hidden, so that a triangle that lies
//! behind others costs a question per tile, and not one per sample. To draw from front to back saves most.

use std::ops::Range;

use abf_mesh::{Point2, Point3, Vector2};

/// What no triangle covers.
const NOTHING: u32 = u32::MAX;

/// The nearest thing at every sample of a grid; sample `(i, j)` sits at `(i + ½, j + ½)`, y up.
///
/// Depth is the third coordinate: the larger is nearer. Of two things at one depth the one with the lower number is
/// seen. What is drawn first makes no difference.
#[derive(Clone, Debug)]
pub(crate) struct Visibility {
    columns: usize,
    rows: usize,
    depth: Vec<f32>,
    item: Vec<u32>,
    tiles: Vec<Tile>,
}

/// The side of a tile, samples.
const TILE: usize = 16;

/// What is known of a tile.
#[derive(Clone, Copy, Debug)]
struct Tile {
    /// No sample of it is farther away than this.
    farthest: f32,
    /// How often samples have come nearer since that was found.
    changes: usize,
}

impl Visibility {
    /// A grid on which nothing lies yet.
    pub(crate) fn new(columns: usize, rows: usize) -> Self {
        let samples = columns * rows;
        let tile = Tile { farthest: f32::NEG_INFINITY, changes: 0 };
        let tiles = vec![tile; columns.div_ceil(TILE) * rows.div_ceil(TILE)];
        Self { columns, rows, depth: vec![f32::NEG_INFINITY; samples], item: vec![NOTHING; samples], tiles }
    }

    /// The number of the nearest thing at a sample; `None` where there is nothing.
    #[inline]
    pub(crate) fn at(&self, column: usize, row: usize) -> Option<u32> {
        let item = self.item[row * self.columns + column];
        (item != NOTHING).then_some(item)
    }

    /// Draws a triangle, of whichever orientation, edges included. One without area leaves nothing.
    pub(crate) fn triangle(&mut self, corners: &[Point3<f64>; 3], item: u32) {
        let [a, b, c] = *corners;
        let Some(inside) = Barycentric::new(&corners.map(|p| p.xy())) else { return };
        // Seen almost from the side, the plane is so steep that rounding in x would overshoot.
        let (farthest, nearest) = (a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
        let low = a.y.min(b.y).min(c.y);
        let high = a.y.max(b.y).max(c.y);
        let depth_at = |column: usize, row: usize| {
            let [wa, wb, wc] = inside.weights(Point2::new(column as f64 + 0.5, row as f64 + 0.5));
            (wa * a.z + wb * b.z + wc * c.z).clamp(farthest, nearest) as f32
        };
        let rows = centres(low, high, self.rows);
        for band in (rows.start / TILE..rows.end.div_ceil(TILE)).take_while(|_| !rows.is_empty()) {
            let rows = rows.start.max(band * TILE)..rows.end.min((band + 1) * TILE);
            self.draw_in_band(corners, &rows, depth_at, item);
        }
    }

    /// Draws the rows of a triangle that lie in one band of tiles.
    fn draw_in_band(
        &mut self,
        corners: &[Point3<f64>; 3],
        rows: &Range<usize>,
        depth_at: impl Fn(usize, usize) -> f32,
        item: u32,
    ) {
        let mut spans = [(0, 0); TILE];
        let (mut first, mut end) = (usize::MAX, 0);
        for (span_of_row, row) in spans.iter_mut().zip(rows.clone()) {
            let (left, right) = span(corners, row as f64 + 0.5);
            let columns = centres(left, right, self.columns);
            if !columns.is_empty() {
                (first, end) = (first.min(columns.start), end.max(columns.end));
                *span_of_row = (columns.start, columns.end);
            }
        }
        for tile in (first / TILE..end.div_ceil(TILE)).take_while(|_| first < end) {
            let columns = first.max(tile * TILE)..end.min((tile + 1) * TILE);
            if self.is_hidden(rows, &columns, &depth_at) {
                continue;
            }
            for (&(first, end), row) in spans.iter().zip(rows.clone()) {
                for column in first.max(columns.start)..end.min(columns.end) {
                    self.offer(column, row, depth_at(column, row), item);
                }
            }
            self.look_behind(self.tile_of(columns.start, rows.start));
        }
    }

    /// Whether a plane lies behind all that is seen in a part of a tile. Its depth is largest in a corner of it.
    fn is_hidden(&self, rows: &Range<usize>, columns: &Range<usize>, depth_at: &impl Fn(usize, usize) -> f32) -> bool {
        /// What rounding may add to a depth between the corners, as a part of it.
        const ROUNDING: f32 = 4.0 * f32::EPSILON;
        let Tile { farthest, .. } = self.tiles[self.tile_of(columns.start, rows.start)];
        if farthest == f32::NEG_INFINITY {
            return false;
        }
        let corners = [columns.start, columns.end - 1].map(|x| [rows.start, rows.end - 1].map(|y| depth_at(x, y)));
        let nearest = corners.into_iter().flatten().fold(f32::NEG_INFINITY, f32::max);
        nearest + ROUNDING * nearest.abs() < farthest
    }

    /// Finds how far one can see in a tile, once there have been as many changes as it has samples.
    fn look_behind(&mut self, tile: usize) {
        if self.tiles[tile].changes < TILE * TILE {
            return;
        }
        let across = self.columns.div_ceil(TILE);
        let (band, column) = (tile / across, tile % across);
        let (first, end) = (column * TILE, ((column + 1) * TILE).min(self.columns));
        let rows = band * TILE..((band + 1) * TILE).min(self.rows);
        let of_row = |row: usize| &self.depth[row * self.columns + first..row * self.columns + end];
        let farthest = rows.flat_map(of_row).copied().fold(f32::INFINITY, f32::min);
        self.tiles[tile] = Tile { farthest, changes: 0 };
    }

    /// The tile that a sample is in.
    #[inline]
    fn tile_of(&self, column: usize, row: usize) -> usize {
        row / TILE * self.columns.div_ceil(TILE) + column / TILE
    }

    /// Draws a line of the given half width with square ends.
    pub(crate) fn line(&mut self, from: Point3<f64>, to: Point3<f64>, half_width: f64, item: u32) {
        let Some(along) = (to.xy() - from.xy()).try_normalize(f64::MIN_POSITIVE) else { return };
        let along = half_width * along;
        let corner = |end: Point3<f64>, x: f64, y: f64| {
            let offset = x * along + y * Vector2::new(-along.y, along.x);
            Point3::new(end.x + offset.x, end.y + offset.y, end.z)
        };
        let (a, b) = (corner(from, -1.0, -1.0), corner(to, 1.0, -1.0));
        let (c, d) = (corner(to, 1.0, 1.0), corner(from, -1.0, 1.0));
        self.triangle(&[a, b, c], item);
        self.triangle(&[a, c, d], item);
    }

    /// Draws a disk that faces the viewer.
    pub(crate) fn dot(&mut self, centre: Point3<f64>, radius: f64, item: u32) {
        for row in centres(centre.y - radius, centre.y + radius, self.rows) {
            let dy = row as f64 + 0.5 - centre.y;
            let half = (radius * radius - dy * dy).max(0.0).sqrt();
            for column in centres(centre.x - half, centre.x + half, self.columns) {
                self.offer(column, row, centre.z as f32, item);
            }
        }
    }

    /// Keeps `item` at a sample if it is nearer than what is there.
    #[inline]
    fn offer(&mut self, column: usize, row: usize, depth: f32, item: u32) {
        let at = row * self.columns + column;
        let (old, seen) = (self.depth[at], self.item[at]);
        if depth > old || (depth == old && item < seen) {
            self.depth[at] = depth;
            self.item[at] = item;
            let tile = self.tile_of(column, row);
            self.tiles[tile].changes += 1;
        }
    }
}

/// The cells `0..count` whose centres `i + ½` lie in `[low, high]`.
fn centres(low: f64, high: f64, count: usize) -> Range<usize> {
    // Casts from floats saturate: what lies left of the grid becomes 0.
    let first = (low - 0.5).ceil() as usize;
    let end = (high + 0.5).floor() as usize;
    first..end.min(count)
}

/// Where the horizontal line at `y` enters and leaves a triangle.
///
/// Edges are walked from their lower end, so two triangles at one edge find the same `x` and
/// leave no crack between them.
fn span(corners: &[Point3<f64>; 3], y: f64) -> (f64, f64) {
    let [a, b, c] = corners;
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for (p, q) in [(a, b), (b, c), (c, a)] {
        let (p, q) = if (p.y, p.x) <= (q.y, q.x) { (p, q) } else { (q, p) };
        if y < p.y || q.y < y {
            continue;
        }
        // A horizontal edge spans from end to end; any other is met in one point.
        let (t, u) = if p.y < q.y { ((y - p.y) / (q.y - p.y), (y - p.y) / (q.y - p.y)) } else { (0.0, 1.0) };
        left = left.min(p.x + t * (q.x - p.x));
        right = right.max(p.x + u * (q.x - p.x));
    }
    (left, right)
}

/// Barycentric coordinates in the plane, as affine functions of the point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Barycentric {
    first: Point2<f64>,
    second: Vector2<f64>,
    third: Vector2<f64>,
}

impl Barycentric {
    /// The coordinates of a triangle; `None` if it has no area.
    pub(crate) fn new(&[a, b, c]: &[Point2<f64>; 3]) -> Option<Self> {
        let (ab, ac) = (b - a, c - a);
        let twice_area = ab.perp(&ac);
        let second = Vector2::new(ac.y, -ac.x) / twice_area;
        let third = Vector2::new(-ab.y, ab.x) / twice_area;
        let finite = second.iter().chain(&third).all(|x| x.is_finite());
        finite.then_some(Self { first: a, second, third })
    }

    /// The weights of the three corners at a point; they sum to one.
    #[inline]
    pub(crate) fn weights(&self, at: Point2<f64>) -> [f64; 3] {
        let from_first = at - self.first;
        let (second, third) = (self.second.dot(&from_first), self.third.dot(&from_first));
        [1.0 - second - third, second, third]
    }

    /// How far `values`, given at the corners, change over one sample: `|∂f/∂x| + |∂f/∂y|`.
    pub(crate) fn change(&self, [a, b, c]: [f64; 3]) -> f64 {
        ((b - a) * self.second + (c - a) * self.third).lp_norm(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle over the lower left half of a grid of the given side, at one depth.
    fn half(side: f64, depth: f64) -> [Point3<f64>; 3] {
        [Point3::new(0.0, 0.0, depth), Point3::new(side, 0.0, depth), Point3::new(0.0, side, depth)]
    }

    #[test]
    fn the_nearer_of_two_stacked_triangles_wins_in_either_order() {
        let (near, far) = (half(8.0, 2.0), half(8.0, 1.0));
        for order in [[(near, 7), (far, 5)], [(far, 5), (near, 7)]] {
            let mut seen = Visibility::new(8, 8);
            order.iter().for_each(|(corners, item)| seen.triangle(corners, *item));
            assert_eq!(seen.at(1, 1), Some(7));
            assert_eq!(seen.at(7, 7), None);
        }
    }

    #[test]
    fn neither_the_order_of_drawing_nor_what_lies_behind_makes_a_difference() {
        // Layers that tilt this way and that, each of them twice, over several tiles.
        const LAYERS: u32 = 77;
        let layer = |k: u32| {
            let (tilt, z) = (f64::from(k % 7) - 3.0, f64::from(k % 11));
            [Point3::new(-3.0, -5.0, z - tilt), Point3::new(90.0, 1.5, z + tilt), Point3::new(7.5, 95.0, z)]
        };
        let draw = |order: &mut dyn Iterator<Item = u32>| {
            let mut seen = Visibility::new(50, 37);
            order.for_each(|k| seen.triangle(&layer(k), k));
            seen.item
        };
        let forward = draw(&mut (0..2 * LAYERS));
        assert_eq!(draw(&mut (0..2 * LAYERS).rev()), forward);
        assert_eq!(draw(&mut (0..2 * LAYERS).map(|k| 51 * k % (2 * LAYERS))), forward);
        // Sample by sample, without tiles.
        for (at, &item) in forward.iter().enumerate() {
            let place = Point2::new((at % 50) as f64 + 0.5, (at / 50) as f64 + 0.5);
            let depth = |k: u32| {
                let corners = layer(k);
                let [a, b, c] = Barycentric::new(&corners.map(|p| p.xy())).expect("an area").weights(place);
                ([a, b, c].iter().all(|&w| w > 0.0))
                    .then(|| (a * corners[0].z + b * corners[1].z + c * corners[2].z) as f32)
            };
            let seen = (0..LAYERS).filter_map(|k| Some((depth(k)?, k)));
            let nearest = seen.reduce(|a, b| if b.0 > a.0 { b } else { a }).map(|(_, k)| k);
            assert_eq!((item != NOTHING).then_some(item), nearest, "sample {at}");
        }
    }

    #[test]
    fn what_lies_behind_costs_a_question_per_tile() {
        let mut seen = Visibility::new(64, 64);
        seen.triangle(&half(200.0, 2.0), 0);
        seen.triangle(&half(200.0, 1.0), 1);
        assert!(seen.tiles.iter().all(|tile| tile.farthest == 2.0 && tile.changes == 0), "{:?}", seen.tiles);
        assert!(seen.is_hidden(&(16..32), &(16..32), &|_, _| 1.0));
        assert!(!seen.is_hidden(&(16..32), &(16..32), &|_, _| 2.0), "of two at one depth the number decides");
    }

    #[test]
    fn triangles_that_pierce_each_other_are_seen_up_to_the_line_where_they_meet() {
        let slope = |left: f64, right: f64| {
            [Point3::new(0.0, 0.0, left), Point3::new(16.0, 0.0, right), Point3::new(8.0, 16.0, 0.5 * (left + right))]
        };
        let mut seen = Visibility::new(16, 16);
        seen.triangle(&slope(0.0, 1.0), 1);
        seen.triangle(&slope(1.0, 0.0), 2);
        assert_eq!((seen.at(7, 2), seen.at(8, 2)), (Some(2), Some(1)));
    }

    #[test]
    fn triangles_around_a_point_leave_no_crack() {
        const SPOKES: usize = 29;
        let rim = |k: usize| {
            let angle = k as f64 / SPOKES as f64 * std::f64::consts::TAU;
            Point3::new(20.3 + 40.0 * angle.cos(), 19.7 + 40.0 * angle.sin(), 0.0)
        };
        let mut seen = Visibility::new(40, 40);
        for k in 0..SPOKES {
            seen.triangle(&[Point3::new(20.3, 19.7, 0.0), rim(k), rim((k + 1) % SPOKES)], k as u32);
        }
        assert!((0..40).all(|row| (0..40).all(|column| seen.at(column, row).is_some())));
    }

    #[test]
    fn what_lies_outside_the_grid_is_clipped() {
        let mut seen = Visibility::new(4, 4);
        seen.triangle(&half(1e12, 0.0).map(|p| Point3::new(p.x - 1e11, p.y - 1e11, 0.0)), 3);
        assert_eq!(seen.at(3, 3), Some(3));
        seen.triangle(&half(2.0, 1.0).map(|p| Point3::new(p.x - 9.0, p.y + 9.0, 1.0)), 4);
        seen.dot(Point3::new(-5.0, 2.0, 1.0), 2.0, 5);
        assert!((0..4).all(|k| seen.at(k, k) == Some(3)));
    }

    #[test]
    fn a_triangle_without_area_leaves_nothing() {
        let mut seen = Visibility::new(4, 4);
        seen.triangle(&[Point3::new(0.0, 0.5, 0.0), Point3::new(2.0, 0.5, 0.0), Point3::new(4.0, 0.5, 0.0)], 0);
        assert!((0..4).all(|k| seen.at(k, 0).is_none()));
    }

    #[test]
    fn lines_and_dots_are_as_wide_as_asked() {
        let mut seen = Visibility::new(20, 20);
        seen.line(Point3::new(5.0, 10.0, 0.0), Point3::new(15.0, 10.0, 0.0), 2.0, 1);
        assert_eq!((0..20).filter(|&row| seen.at(10, row).is_some()).count(), 4);
        seen.dot(Point3::new(10.0, 10.0, 1.0), 3.0, 2);
        assert_eq!((0..20).filter(|&row| seen.at(10, row) == Some(2)).count(), 6);
    }

    #[test]
    fn weights_are_one_at_their_own_corner_and_zero_at_the_others() {
        let corners = [Point2::new(1.0, 2.0), Point2::new(4.0, 3.0), Point2::new(2.0, 7.0)];
        let inside = Barycentric::new(&corners).expect("it has an area");
        for (k, &corner) in corners.iter().enumerate() {
            for (j, weight) in inside.weights(corner).into_iter().enumerate() {
                assert!((weight - f64::from(u8::from(j == k))).abs() < 1e-15);
            }
        }
        assert!((inside.change(corners.map(|p| 3.0 * p.x - 2.0 * p.y)) - 5.0).abs() < 1e-12);
    }
}
