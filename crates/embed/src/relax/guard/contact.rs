//! A boundary vertex near an edge of the boundary: how near, what that costs, when they meet.

use abf_mesh::{Point2, Vector2, VertexId};

/// A boundary vertex and a boundary edge that does not end there, by their numbers in the guard.
pub(crate) type Pair = (u32, u32);

/// How near a vertex is to an edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearness {
    pub(crate) distance: f64,
    /// From the edge to the vertex; a unit vector.
    normal: Vector2<f64>,
    /// Where on the edge the nearest point is, from 0 to 1.
    share: f64,
}

impl Nearness {
    pub(crate) fn of([p, a, b]: [Point2<f64>; 3]) -> Self {
        let along = b - a;
        let share = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        let share = if share.is_nan() { 0.0 } else { share };
        let away = p - (a + along * share);
        let distance = away.norm();
        let normal = if distance > 0.0 { away / distance } else { Vector2::zeros() };
        Self { distance, normal, share }
    }
}

/// A pair within reach of the barrier, and what that costs: `κ b(x)`, `x = (d − gap) / reach`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub(crate) pair: Pair,
    /// The vertex, and the ends of the edge.
    pub(crate) vertices: [VertexId; 3],
    pub(crate) nearness: Nearness,
    /// A distance that is not to be reached.
    pub(crate) gap: f64,
    /// How far beyond that the barrier acts.
    pub(crate) reach: f64,
    /// κ.
    pub(crate) weight: f64,
}

impl Contact {
    /// `x`.
    pub(crate) fn share_of_reach(&self) -> f64 {
        (self.nearness.distance - self.gap) / self.reach
    }

    /// `−κ (x − 1)² log x`; infinite where the gap is reached, 0 out of reach.
    pub(crate) fn value(&self) -> f64 {
        let x = self.share_of_reach();
        if x <= 0.0 {
            return f64::INFINITY;
        }
        if x >= 1.0 { 0.0 } else { -self.weight * (x - 1.0) * (x - 1.0) * x.ln() }
    }

    /// The derivatives by the three points.
    pub(crate) fn slopes(&self) -> [Vector2<f64>; 3] {
        let x = self.share_of_reach();
        let slope = -2.0 * (x - 1.0) * x.ln() - (x - 1.0) * (x - 1.0) / x;
        self.change().map(|q| q * (self.weight * slope / self.reach))
    }

    /// The positive part of the second derivatives: that by the distance.
    pub(crate) fn hessian(&self) -> [[f64; 6]; 6] {
        let x = self.share_of_reach();
        let (off, inverse) = (1.0 - x, x.recip());
        let bent = -2.0 * x.ln() + 4.0 * off * inverse + off * off * inverse * inverse;
        let bent = self.weight * bent / (self.reach * self.reach);
        let q = self.change();
        let at = |i: usize| q[i / 2][i % 2];
        std::array::from_fn(|i| std::array::from_fn(|j| bent * at(i) * at(j)))
    }

    /// The derivative of the distance by the three points.
    fn change(&self) -> [Vector2<f64>; 3] {
        let Nearness { normal, share, .. } = self.nearness;
        [normal, normal * (share - 1.0), normal * -share]
    }
}

/// The first share of a motion, up to `limit`, at which a vertex is on the line of an edge and between its ends; infinite if
/// there is none.
pub(crate) fn first_contact([p, a, b]: [Point2<f64>; 3], [dp, da, db]: [Vector2<f64>; 3], limit: f64) -> f64 {
    /// How far beyond an end still counts.
    const BEYOND: f64 = 1e-9;
    let (e, f, de, df) = (b - a, p - a, db - da, dp - da);
    let between = |s: f64| {
        let (e, f) = (e + de * s, f + df * s);
        let share = f.dot(&e) / e.norm_squared();
        s > 0.0 && s <= limit && (-BEYOND..=1.0 + BEYOND).contains(&share)
    };
    roots(e.perp(&f), e.perp(&df) + de.perp(&f), de.perp(&df))
        .into_iter()
        .filter(|&s| between(s))
        .fold(f64::INFINITY, f64::min)
}

/// The roots of `a + b s + c s²`, in the form that does not cancel; infinite or NaN where there are fewer than two.
fn roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    let discriminant = b * b - 4.0 * a * c;
    if !(discriminant >= 0.0) {
        return [f64::INFINITY; 2];
    }
    let half = -0.5 * (b + discriminant.sqrt().copysign(b));
    [half / c, a / half]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(points: [[f64; 2]; 3]) -> Contact {
        Contact {
            pair: (0, 0),
            vertices: [0, 1, 2].map(VertexId::new),
            nearness: Nearness::of(points.map(Point2::from)),
            gap: 0.1,
            reach: 0.5,
            weight: 3.0,
        }
    }

    #[test]
    fn the_barrier_has_the_slopes_of_its_differences() {
        // Beside the edge, and beyond its end.
        for points in [[[0.3, 0.4], [0.0, 0.0], [1.0, 0.1]], [[1.2, 0.3], [0.0, 0.0], [1.0, 0.1]]] {
            let here = contact(points);
            assert!(here.value() > 0.0 && here.value().is_finite());
            let slopes = here.slopes();
            for i in 0..6 {
                let moved = |by: f64| {
                    let mut moved = points;
                    moved[i / 2][i % 2] += by;
                    contact(moved)
                };
                let h = 1e-6;
                let slope = (moved(h).value() - moved(-h).value()) / (2.0 * h);
                assert!((slope - slopes[i / 2][i % 2]).abs() < 1e-6 * (1.0 + slope.abs()), "{i} {slope}");
            }
        }
    }

    #[test]
    fn the_barrier_bends_along_the_distance_as_its_slopes_do() {
        let at = |y: f64| contact([[0.3, y], [0.0, 0.0], [1.0, 0.0]]);
        let h = 1e-6;
        let bent = (at(0.4 + h).slopes()[0].y - at(0.4 - h).slopes()[0].y) / (2.0 * h);
        assert!((bent - at(0.4).hessian()[1][1]).abs() < 1e-5 * bent, "{bent}");
        assert_eq!(at(0.1).value(), f64::INFINITY);
        assert_eq!(at(0.6).value(), 0.0);
    }

    #[test]
    fn a_vertex_meets_an_edge_where_it_is_between_its_ends() {
        let points = [[0.5, 1.0], [0.0, 0.0], [1.0, 0.0]].map(Point2::from);
        let still = Vector2::zeros();
        let down = |x: f64| first_contact(points, [Vector2::new(x, -2.0), still, still], 1.0);
        assert!((down(0.0) - 0.5).abs() < 1e-15 && (down(0.9) - 0.5).abs() < 1e-15);
        assert_eq!(down(2.0), f64::INFINITY);
        let shy = first_contact(points, [Vector2::new(0.0, -0.9), still, still], 1.0);
        assert_eq!(shy, f64::INFINITY);
        // The edge comes up and turns.
        let turned = first_contact(points, [still, Vector2::new(0.0, 1.5), Vector2::new(0.0, 2.5)], 1.0);
        assert!((turned - 0.5).abs() < 1e-15);
    }
}
