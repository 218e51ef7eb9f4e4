//! The smallest box around a chart.

use abf_mesh::{Point2, Vector2};

/// A box around some points, lying on its longer side after the turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TightBox {
    /// The cosine and the sine of the angle that the points are turned by.
    pub(super) turn: [f64; 2],
    /// The lower left corner after that.
    pub(super) low: Point2<f64>,
    /// Width and height.
    pub(super) size: Vector2<f64>,
}

/// A point after a turn around the origin.
pub(super) fn turned(p: Point2<f64>, [cos, sin]: [f64; 2]) -> Point2<f64> {
    Point2::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y)
}

impl TightBox {
    /// The box of least area: it has an edge of the convex hull on one of its sides (Freeman, Shapira 1975).
    pub(super) fn around(points: &[Point2<f64>]) -> Self {
        let hull = convex_hull(points);
        let edges = hull.iter().zip(hull.iter().cycle().skip(1)).map(|(a, b)| b - a);
        let turns = edges.filter(|edge| edge.norm() > 0.0).map(|edge| [edge.x / edge.norm(), -edge.y / edge.norm()]);
        let boxes = turns.map(|turn| Self::at(turn, &hull));
        let flat = Self::unturned(&hull);
        // In units of its longer side areas are numbers, whatever the size of the chart.
        let area = |b: &Self| (b.size.x / flat.size.amax()) * (b.size.y / flat.size.amax());
        let tightest = boxes.fold(flat, |best, other| if area(&other) < area(&best) { other } else { best });
        if tightest.size.x >= tightest.size.y {
            return tightest;
        }
        let [cos, sin] = tightest.turn;
        Self::at([-sin, cos], &hull)
    }

    /// The box with sides along the axes.
    pub(super) fn unturned(points: &[Point2<f64>]) -> Self {
        Self::at([1.0, 0.0], points)
    }

    pub(super) fn is_turned(&self) -> bool {
        self.turn != [1.0, 0.0]
    }

    fn at(turn: [f64; 2], points: &[Point2<f64>]) -> Self {
        let mut all = points.iter().map(|&p| turned(p, turn));
        let first = all.next().unwrap_or_else(Point2::origin);
        let (low, high) = all.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)));
        Self { turn, low, size: high - low }
    }
}

/// The corners of the convex hull, counter-clockwise (Andrew 1979). Rounding may leave out a corner that hardly is one; the
/// box is taken around what is left, so the caller's margin has to hold for it.
fn convex_hull(points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let mut sorted = points.to_vec();
    sorted.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let chain = |points: &mut dyn Iterator<Item = Point2<f64>>| {
        let mut chain: Vec<Point2<f64>> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp(&(p - a)) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        // The last begins the other chain.
        chain.pop();
        chain
    };
    let mut hull = chain(&mut sorted.iter().copied());
    hull.extend(chain(&mut sorted.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_rectangle_lies_down_in_a_box_of_its_size() {
        let [cos, sin] = [0.6, 0.8];
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 3.0], [0.0, 3.0], [0.5, 1.0]];
        let points = corners.map(|[x, y]| turned(Point2::new(x + 7.0, y - 2.0), [cos, sin]));
        let found = TightBox::around(&points);
        assert!((found.size - Vector2::new(3.0, 1.0)).norm() < 1e-12, "{found:?}");
        let [cos, sin] = found.turn;
        assert!((cos.hypot(sin) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn points_on_a_line_and_no_points_have_boxes_too() {
        let line: Vec<Point2<f64>> = (0..5).map(|i| Point2::new(f64::from(i), f64::from(i))).collect();
        let found = TightBox::around(&line);
        assert!((found.size.x - 32.0_f64.sqrt()).abs() < 1e-12 && found.size.y < 1e-12, "{found:?}");
        assert_eq!(TightBox::around(&[]).size, Vector2::zeros());
    }
}
