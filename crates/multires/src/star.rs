//! The angles of the triangles around one vertex, as that vertex moves.

use abf_mesh::predicates::orient2d;
use abf_mesh::{Point2, Point3, Vector2};
use std::f64::consts::PI;

/// Targets below this, rad, weigh no more than it.
const LEAST_TARGET: f64 = 1e-3;

/// How often a step is halved.
const MOST_HALVED: usize = 6;

/// A triangle at the vertex: its other two corners, counter-clockwise, and the target angles at the three, rad.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spoke {
    pub(crate) ends: [Point2<f64>; 2],
    pub(crate) target: [f64; 3],
}

impl Spoke {
    /// Whether the triangle is counter-clockwise with the vertex here.
    pub(crate) fn is_positive(&self, vertex: Point2<f64>) -> bool {
        orient2d(self.ends[0], self.ends[1], vertex) > 0.0
    }

    fn weights(&self) -> [f64; 3] {
        self.target.map(|a| 1.0 / (a * a).max(LEAST_TARGET * LEAST_TARGET))
    }

    /// What the angles are off by, rad.
    fn off(&self, to: [Vector2<f64>; 2]) -> [f64; 3] {
        let between = to[1] - to[0];
        let double_area = to[0].perp(&to[1]);
        let at_vertex = double_area.atan2(to[0].dot(&to[1]));
        let at_first = double_area.atan2(-between.dot(&to[0]));
        [at_vertex - self.target[0], at_first - self.target[1], PI - at_vertex - at_first - self.target[2]]
    }

    fn to_ends(self, vertex: Point2<f64>) -> [Vector2<f64>; 2] {
        self.ends.map(|end| end - vertex)
    }
}

/// `Σ ((x − a) / a)²` over the triangles; `None` where one of them is not counter-clockwise.
fn energy(vertex: Point2<f64>, spokes: impl Iterator<Item = Spoke>) -> Option<f64> {
    let mut sum = 0.0;
    for spoke in spokes {
        if !spoke.is_positive(vertex) {
            return None;
        }
        let off = spoke.off(spoke.to_ends(vertex));
        let weights = spoke.weights();
        sum += (0..3).map(|k| weights[k] * off[k] * off[k]).sum::<f64>();
    }
    Some(sum)
}

/// The vertex one Gauss–Newton step of `Σ ((x − a) / a)²` further, its only unknowns its own coordinates. The step is
/// halved until it lowers the sum with all triangles counter-clockwise; the vertex stays where no share of it does.
///
/// They are counter-clockwise all the way: areas are linear in the place of one vertex.
pub(crate) fn improved(vertex: Point2<f64>, spokes: &(impl Iterator<Item = Spoke> + Clone)) -> Point2<f64> {
    let step = Step::new(vertex, spokes.clone());
    let whole = vertex + step.by;
    if step.is_sure() && spokes.clone().all(|spoke| spoke.is_positive(whole)) {
        return whole;
    }
    let mut share = 1.0;
    for _ in 0..MOST_HALVED {
        let moved = vertex + step.by * share;
        if energy(moved, spokes.clone()).is_some_and(|after| after < step.before) {
            return moved;
        }
        share *= 0.5;
    }
    vertex
}

/// A step to the least of the energy's linearisation.
struct Step {
    by: Vector2<f64>,
    /// The energy before it.
    before: f64,
    /// What the linearisation promises to take off.
    promised: f64,
    /// `Σ w b²`: an angle of weight `w` is linearised up to `b |d|²` for any step `d` of at most `reach`.
    bend: f64,
    /// Half the distance to the nearest neighbour.
    reach: f64,
}

impl Step {
    fn new(vertex: Point2<f64>, spokes: impl Iterator<Item = Spoke>) -> Self {
        let (mut before, mut pull) = (0.0, Vector2::zeros());
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        let (mut bend, mut nearest) = (0.0, f64::INFINITY);
        for spoke in spokes {
            let to = spoke.to_ends(vertex);
            let curved = to.map(|z| 1.0 / z.norm_squared());
            nearest = to.iter().fold(nearest, |nearest, z| nearest.min(z.norm_squared()));
            // The gradient of `arg z` is `iz / |z|²`.
            let [first, second] = [0, 1].map(|k| Vector2::new(-to[k].y, to[k].x) * curved[k]);
            let slopes = [first - second, -first, second];
            // Without its linear part, `arg (z − d) = arg z + arg (1 − d/z)` changes by less than `|d/z|²` for `|d/z| ≤ ½`.
            let bends = [curved[0] + curved[1], curved[0], curved[1]];
            let (off, weights) = (spoke.off(to), spoke.weights());
            for k in 0..3 {
                before += weights[k] * off[k] * off[k];
                pull -= slopes[k] * (weights[k] * off[k]);
                xx += weights[k] * slopes[k].x * slopes[k].x;
                xy += weights[k] * slopes[k].x * slopes[k].y;
                yy += weights[k] * slopes[k].y * slopes[k].y;
                bend += weights[k] * bends[k] * bends[k];
            }
        }
        let determinant = xx * yy - xy * xy;
        let by = Vector2::new(yy * pull.x - xy * pull.y, xx * pull.y - xy * pull.x) / determinant;
        let by = if by.x.is_finite() && by.y.is_finite() { by } else { Vector2::zeros() };
        Self { by, before, promised: pull.dot(&by), bend, reach: 0.5 * nearest.sqrt() }
    }

    /// Whether the whole step lowers the energy, whatever the linearisation leaves out. By the triangle inequality the
    /// root of the energy after it is at most that of the linearisation plus `√(Σ w b²) |d|²`.
    fn is_sure(&self) -> bool {
        let square = self.by.norm_squared();
        let after = (self.before - self.promised).max(0.0).sqrt() + self.bend.sqrt() * square;
        square <= self.reach * self.reach && after < self.before.sqrt()
    }
}

/// The angles of a triangle in space, rad, and twice its area.
pub(crate) fn angles_in_space([a, b, c]: [Point3<f64>; 3]) -> ([f64; 3], f64) {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let double_area = ab.cross(&ca).norm();
    let [at_a, at_b] = [-ab.dot(&ca), -bc.dot(&ab)].map(|dot| double_area.atan2(dot));
    // An arctangent less: below the least target its digits do not matter.
    ([at_a, at_b, PI - at_a - at_b], double_area)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wheel whose targets are its angles with the hub at the origin.
    fn wheel() -> Vec<Spoke> {
        let rim: Vec<Point2<f64>> = (0..6)
            .map(|i| {
                let (sin, cos) = f64::from(i).sin_cos();
                Point2::new(1.5 * cos, sin)
            })
            .collect();
        let spoke = |i: usize| {
            let ends = [rim[i], rim[(i + 1) % 6]];
            let space = [Point2::origin(), ends[0], ends[1]].map(|p| Point3::new(p.x, p.y, 0.0));
            Spoke { ends, target: angles_in_space(space).0 }
        };
        (0..6).map(spoke).collect()
    }

    #[test]
    fn a_step_points_down_the_slope_of_the_energy() {
        let (spokes, at) = (wheel(), Point2::new(0.2, -0.1));
        let energy_at = |p: Point2<f64>| energy(p, spokes.iter().copied()).expect("inside");
        let Step { by, before, promised, .. } = Step::new(at, spokes.iter().copied());
        assert!((before - energy_at(at)).abs() < 1e-12);
        let h = 1e-6;
        let slope = (energy_at(at + by * h) - energy_at(at - by * h)) / (2.0 * h);
        assert!(slope < -before, "a step that solves a least squares problem almost: {slope} {before}");
        assert!((slope + 2.0 * promised).abs() < 1e-6 * promised, "{slope} is not twice {promised}");
    }

    /// For steps of all lengths from places all over the wheel, and for targets that no place has.
    #[test]
    fn a_step_that_is_sure_lowers_the_energy_and_short_ones_are_sure() {
        let (mut sure, mut steps) = (0, 0);
        for scale in [1.0, 0.8, 0.5] {
            let mut spokes = wheel();
            spokes.iter_mut().for_each(|spoke| spoke.target[1] *= scale);
            let energy_at = |p: Point2<f64>| energy(p, spokes.iter().copied());
            for i in 0..40 {
                let radius = 0.02 * f64::from(i);
                let at = Point2::new(radius * f64::from(i).cos(), radius * f64::from(i).sin());
                let step = Step::new(at, spokes.iter().copied());
                steps += 1;
                if step.is_sure() {
                    sure += 1;
                    let after = energy_at(at + step.by).expect("all triangles are counter-clockwise");
                    assert!(after < step.before, "{after} after {} at {at}", step.before);
                }
            }
        }
        assert!(sure > steps / 4 && sure < steps, "{sure} of {steps}");
    }

    #[test]
    fn steps_lead_to_the_place_that_has_the_targets() {
        let spokes = wheel();
        let mut at = Point2::new(0.3, 0.2);
        for _ in 0..8 {
            at = improved(at, &spokes.iter().copied());
        }
        assert!(at.coords.norm() < 1e-9, "{at}");
    }

    #[test]
    fn a_vertex_never_leaves_the_place_where_its_triangles_are_counter_clockwise() {
        let mut spokes = wheel();
        // No place has these.
        spokes.iter_mut().for_each(|spoke| spoke.target = [3.0, 0.07, 0.07]);
        let mut at = Point2::new(0.3, 0.2);
        for _ in 0..8 {
            at = improved(at, &spokes.iter().copied());
            assert!(spokes.iter().all(|spoke| spoke.is_positive(at)));
        }
    }
}
