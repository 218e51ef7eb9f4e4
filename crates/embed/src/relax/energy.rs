//! Energies of a map from a surface to the plane, triangle by triangle.
//!
//! The map of a triangle is linear, with the Jacobian `J = U diag(s₁, s₂) Vᵀ`. An isometric energy is the integral of a
//! density `Ψ(s₁, s₂)` over the surface. Its second derivative by `J` has four eigenmodes that are known beforehand (Smith,
//! de Goes, Kim 2019): two that scale, `u₁v₁ᵀ` and `u₂v₂ᵀ`, with the block `[Ψ₁₁ Ψ₁₂; Ψ₁₂ Ψ₂₂]`; the twist
//! `(u₂v₁ᵀ − u₁v₂ᵀ)/√2` with `(Ψ₁ + Ψ₂)/(s₁ + s₂)`; the flip `(u₁v₂ᵀ + u₂v₁ᵀ)/√2` with `(Ψ₁ − Ψ₂)/(s₁ − s₂)`. The
//! positive part keeps those that are not negative.

use super::linear::Singular;
use super::rest::RestShape;
use crate::objective::Objective;
use crate::plane::{add_edge_damping, angle_derivatives, angles, of_face, orientation};
use abf_mesh::{FaceId, Point2, Topology, Vector2};
use std::f64::consts::PI;
use std::sync::Arc;

/// The weight of `Σ |δe|²/|e|²` beside an isometric energy of the same triangle: it holds what costs nothing, such as a
/// turn of the whole, and bends no optimum.
const EDGE_DAMPING: f64 = 1e-9;

/// The same beside the energy of ABF, which costs nothing where a part is scaled.
const ANGLE_EDGE_DAMPING: f64 = 1e-6;

/// The energy of a drawing, the sum of one term for every triangle.
pub(crate) trait TriangleEnergy: Sync {
    /// The term of a face with these points; infinite when they are not counter-clockwise, by the exact predicate.
    fn value(&self, face: FaceId, points: &[Point2<f64>; 3]) -> f64;

    /// The first derivatives of that term and the positive part of the second.
    fn derivatives(&self, face: FaceId, points: &[Point2<f64>; 3]) -> Derivatives;

    /// The same term without its barrier, where it has one.
    fn without_barrier(&self, face: FaceId, points: &[Point2<f64>; 3]) -> f64 {
        self.value(face, points)
    }

    /// The size of an energy of a whole drawing that is hardly anything.
    fn hardly_anything(&self) -> f64;

    /// The size of the barrier of a face, whose value may have any sign; 0 where there is none.
    fn barrier_size(&self) -> f64 {
        0.0
    }
}

/// Derivatives by the coordinates `(x₀, y₀, x₁, y₁, x₂, y₂)` of a triangle.
#[derive(Clone, Copy)]
pub(crate) struct Derivatives {
    pub(crate) gradient: [f64; 6],
    pub(crate) hessian: [[f64; 6]; 6],
}

/// A density `Ψ(s₁, s₂)` that is infinite where a triangle collapses.
pub(crate) trait Density: Send + Sync {
    /// `Ψ` from `(s₁ − s₂)²` and `s₁s₂ > 0`, without cancellation near its least value, 0.
    fn value(&self, difference_squared: f64, product: f64) -> f64;

    /// The derivatives at `s₁ ≥ s₂ > 0`.
    fn slopes(&self, s: [f64; 2]) -> Slopes;

    /// What of `Ψ` grows as `c²` when the map is scaled by `c`, and what as `c⁻²`.
    fn by_scale(&self, s: [f64; 2]) -> [f64; 2];
}

/// The derivatives of a density, and its eigenmodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slopes {
    /// `Ψ₁`, `Ψ₂`.
    pub(crate) first: [f64; 2],
    /// `Ψ₁₁`, `Ψ₁₂`, `Ψ₂₂`.
    pub(crate) second: [f64; 3],
    /// `(Ψ₁ + Ψ₂)/(s₁ + s₂)`.
    pub(crate) twist: f64,
    /// `(Ψ₁ − Ψ₂)/(s₁ − s₂)`, or its limit.
    pub(crate) flip: f64,
}

/// The symmetric Dirichlet energy `s₁² + s₂² + s₁⁻² + s₂⁻² − 4`: 0 where lengths are kept.
pub(crate) struct SymmetricDirichlet;

impl Density for SymmetricDirichlet {
    fn value(&self, difference_squared: f64, product: f64) -> f64 {
        let off = 1.0 - product;
        difference_squared * (1.0 + (product * product).recip()) + 2.0 * off * off / product
    }

    fn slopes(&self, [a, b]: [f64; 2]) -> Slopes {
        let (d, squares) = (a * b, a * a + b * b);
        let cubed = d * d * d;
        Slopes {
            first: [a, b].map(|s| 2.0 * (s - (s * s * s).recip())),
            second: [2.0 + 6.0 / (a * a * a * a), 0.0, 2.0 + 6.0 / (b * b * b * b)],
            twist: 2.0 - 2.0 * (squares - d) / cubed,
            flip: 2.0 + 2.0 * (squares + d) / cubed,
        }
    }

    fn by_scale(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        [a * a + b * b, (a * a).recip() + (b * b).recip()]
    }
}

/// Between conformal and area-true: `s₁/s₂ + s₂/s₁ − 2 + θ (s₁s₂ + 1/(s₁s₂) − 2)`.
pub(crate) struct Slider {
    /// θ, the weight of areas.
    pub(crate) theta: f64,
}

impl Density for Slider {
    fn value(&self, difference_squared: f64, product: f64) -> f64 {
        let off = 1.0 - product;
        (difference_squared + self.theta * off * off) / product
    }

    fn slopes(&self, [a, b]: [f64; 2]) -> Slopes {
        let (theta, d, squares) = (self.theta, a * b, a * a + b * b);
        let inverse = d.recip();
        let own = |s: f64, other: f64| {
            let area = theta * (other - inverse / s);
            other.recip() - other / (s * s) + area
        };
        let curved = |s: f64, other: f64| 2.0 * (other * other + theta) / (s * s * d);
        let mixed = theta * (1.0 + inverse * inverse) - squares * inverse * inverse;
        Slopes {
            first: [own(a, b), own(b, a)],
            second: [curved(a, b), mixed, curved(b, a)],
            twist: inverse + theta - (squares - d + theta) * inverse * inverse,
            flip: inverse - theta + (squares + d + theta) * inverse * inverse,
        }
    }

    fn by_scale(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        [a * b, (a * b).recip()]
    }
}

/// The integral of a density over a surface of area 1.
pub(crate) struct Isometric {
    pub(crate) density: Arc<dyn Density>,
    /// One for every face.
    pub(crate) rest: Vec<RestShape>,
}

impl Isometric {
    /// The factor `c` of the whole drawing at which the energy is least.
    pub(crate) fn best_scale(&self, topology: &Topology, uv: &[Point2<f64>]) -> f64 {
        let mut sums = [0.0; 2];
        for face in topology.faces() {
            let rest = &self.rest[face.index()];
            let by_scale = self.density.by_scale(rest.linear(&of_face(topology, uv, face)).singular().values);
            (0..2).for_each(|k| sums[k] += rest.weight * by_scale[k]);
        }
        (sums[1] / sums[0]).sqrt().sqrt()
    }
}

/// What is hardly anything per unit of area, or per triangle.
const HARDLY_ANYTHING: f64 = 0.01;

impl TriangleEnergy for Isometric {
    fn hardly_anything(&self) -> f64 {
        HARDLY_ANYTHING
    }

    fn value(&self, face: FaceId, points: &[Point2<f64>; 3]) -> f64 {
        let double_area = orientation(points);
        if !(double_area > 0.0) {
            return f64::INFINITY;
        }
        let rest = &self.rest[face.index()];
        let linear = rest.linear(points);
        rest.weight * self.density.value(linear.difference_squared(), double_area * rest.inverse_double_area)
    }

    fn derivatives(&self, face: FaceId, points: &[Point2<f64>; 3]) -> Derivatives {
        let rest = &self.rest[face.index()];
        let Singular { values, u, v } = rest.linear(points).singular();
        let slopes = self.density.slopes(values);
        let along = |axis: &Vector2<f64>| rest.dual.map(|b| axis.dot(&b));
        let (p, q) = (along(&v[0]), along(&v[1]));
        let modes = Modes::positive(&slopes);
        let mut gradient = [0.0; 6];
        let mut hessian = [[0.0; 6]; 6];
        for i in 0..3 {
            let slope = u[0] * (slopes.first[0] * p[i]) + u[1] * (slopes.first[1] * q[i]);
            (gradient[2 * i], gradient[2 * i + 1]) = (rest.weight * slope.x, rest.weight * slope.y);
            for j in 0..3 {
                let own = modes.block([p[i], q[i]], [p[j], q[j]]);
                let turned = turned_by(&u, &own);
                for (a, row) in turned.into_iter().enumerate() {
                    for (b, value) in row.into_iter().enumerate() {
                        hessian[2 * i + a][2 * j + b] = rest.weight * value;
                    }
                }
            }
        }
        add_edge_damping(&mut hessian, points, EDGE_DAMPING * rest.weight);
        Derivatives { gradient, hessian }
    }
}

/// The eigenmodes as they are used: none negative.
struct Modes {
    scaling: [f64; 3],
    /// Half the sum of twist and flip.
    same: f64,
    /// Half the flip less half the twist.
    across: f64,
}

impl Modes {
    fn positive(slopes: &Slopes) -> Self {
        let (twist, flip) = (slopes.twist.max(0.0), slopes.flip.max(0.0));
        Self { scaling: positive_part(slopes.second), same: 0.5 * (twist + flip), across: 0.5 * (flip - twist) }
    }

    /// The block of two vertices in the frame of `U`; `i` and `j` are their dual vectors in the frame of `V`.
    fn block(&self, i: [f64; 2], j: [f64; 2]) -> [[f64; 2]; 2] {
        let [a, b, c] = self.scaling;
        [
            [a * i[0] * j[0] + self.same * i[1] * j[1], b * i[0] * j[1] + self.across * i[1] * j[0]],
            [b * i[1] * j[0] + self.across * i[0] * j[1], c * i[1] * j[1] + self.same * i[0] * j[0]],
        ]
    }
}

/// `U B Uᵀ` with the columns `u` of `U`.
fn turned_by(u: &[Vector2<f64>; 2], block: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let row = |k: usize, axis: usize| block[k][0] * u[0][axis] + block[k][1] * u[1][axis];
    let entry = |a: usize, b: usize| u[0][a] * row(0, b) + u[1][a] * row(1, b);
    [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
}

/// `[a b; b c]` without its negative eigenvalue, if it has one.
fn positive_part([a, b, c]: [f64; 3]) -> [f64; 3] {
    if a >= 0.0 && c >= 0.0 && a * c >= b * b {
        return [a, b, c];
    }
    let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
    let radius = half.hypot(b);
    let largest = mean + radius;
    if !(largest > 0.0) {
        return [0.0; 3];
    }
    if radius == 0.0 {
        return [a, b, c];
    }
    // The smaller eigenvalue is negative: what is left is the larger one with its eigenvector.
    let (cosine, sine) = (half / radius, b / radius);
    [0.5 * largest * (1.0 + cosine), 0.5 * largest * sine, 0.5 * largest * (1.0 - cosine)]
}

/// The energy of ABF with its barrier, over the positions: Gauss–Newton in the angles, as in the descent.
pub(crate) struct AngleEnergy<'p, 'a> {
    pub(crate) objective: Objective<'p, 'a>,
}

impl TriangleEnergy for AngleEnergy<'_, '_> {
    fn value(&self, face: FaceId, points: &[Point2<f64>; 3]) -> f64 {
        if !(orientation(points) > 0.0) {
            return f64::INFINITY;
        }
        let of_corner = |(corner, x): (abf_mesh::CornerId, f64)| {
            let energy = self.objective.corner_energy(corner.index(), x);
            energy - self.objective.barrier * (x * (PI - x)).ln()
        };
        let value: f64 = face.corners().into_iter().zip(angles(points)).map(of_corner).sum();
        if value.is_nan() { f64::INFINITY } else { value }
    }

    fn without_barrier(&self, face: FaceId, points: &[Point2<f64>; 3]) -> f64 {
        face.corners().into_iter().zip(angles(points)).map(|(c, x)| self.objective.corner_energy(c.index(), x)).sum()
    }

    fn hardly_anything(&self) -> f64 {
        HARDLY_ANYTHING * self.objective.problem.topology().face_count() as f64
    }

    fn barrier_size(&self) -> f64 {
        3.0 * self.objective.barrier
    }

    fn derivatives(&self, face: FaceId, points: &[Point2<f64>; 3]) -> Derivatives {
        let mut gradient = [0.0; 6];
        let mut hessian = [[0.0; 6]; 6];
        let rows = angle_derivatives(points).into_iter().zip(angles(points));
        for (corner, (row, x)) in face.corners().into_iter().zip(rows) {
            let (slope, curvature) = self.objective.derivatives(corner.index(), x);
            for i in 0..6 {
                gradient[i] += slope * row[i];
                (0..6).for_each(|j| hessian[i][j] += curvature * row[i] * row[j]);
            }
        }
        add_edge_damping(&mut hessian, points, ANGLE_EDGE_DAMPING);
        Derivatives { gradient, hessian }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: [[f64; 2]; 3] = [[0.0, 0.0], [1.1, 0.0], [0.3, 0.8]];
    const DRAWN: [[f64; 2]; 3] = [[0.1, 0.2], [1.9, -0.4], [0.7, 0.6]];

    fn densities() -> Vec<Arc<dyn Density>> {
        let sliders = [0.0, 0.01, 0.3, 1.0].map(|theta| Arc::new(Slider { theta }) as Arc<dyn Density>);
        sliders.into_iter().chain([Arc::new(SymmetricDirichlet) as Arc<dyn Density>]).collect()
    }

    fn points(of: [[f64; 2]; 3]) -> [Point2<f64>; 3] {
        of.map(Point2::from)
    }

    #[test]
    fn slopes_of_densities_are_their_differences() {
        let of = |density: &dyn Density, s: [f64; 2]| density.value((s[0] - s[1]).powi(2), s[0] * s[1]);
        for density in densities() {
            for s in [[1.3, 0.7], [2.0, 1.9], [0.6, 0.2]] {
                let slopes = density.slopes(s);
                let h = 1e-5;
                for k in 0..2 {
                    let at = |shift: f64| {
                        let mut moved = s;
                        moved[k] += shift;
                        moved
                    };
                    let slope = (of(&*density, at(h)) - of(&*density, at(-h))) / (2.0 * h);
                    assert!((slope - slopes.first[k]).abs() < 1e-5 * (1.0 + slope.abs()), "{s:?} {k}");
                    let bent = [0, 1].map(|j| {
                        let [up, down] = [h, -h].map(|shift| density.slopes(at(shift)).first[j]);
                        (up - down) / (2.0 * h)
                    });
                    for (j, bent) in bent.into_iter().enumerate() {
                        assert!((bent - slopes.second[j + k]).abs() < 1e-5 * (1.0 + bent.abs()), "{s:?} {k} {j}");
                    }
                }
                let twist = (slopes.first[0] + slopes.first[1]) / (s[0] + s[1]);
                let flip = (slopes.first[0] - slopes.first[1]) / (s[0] - s[1]);
                assert!((twist - slopes.twist).abs() < 1e-10 * (1.0 + twist.abs()), "{twist} {}", slopes.twist);
                assert!((flip - slopes.flip).abs() < 1e-10 * (1.0 + flip.abs()), "{flip} {}", slopes.flip);
            }
        }
    }

    #[test]
    fn derivatives_of_a_triangle_are_its_differences_where_every_mode_is_positive() {
        for density in densities().iter().rev().take(3) {
            let rest = vec![RestShape::of_plane(&points(REST), 0.7)];
            let energy = Isometric { density: Arc::clone(density), rest };
            // Near the optimum no mode is negative.
            let near = [[0.0, 0.0], [1.12, 0.01], [0.31, 0.81]];
            for (drawn, is_convex) in [(near, true), (DRAWN, false)] {
                let at = energy.derivatives(FaceId::new(0), &points(drawn));
                let moved = |column: usize, by: f64| {
                    let mut moved = points(drawn);
                    moved[column / 2][column % 2] += by;
                    moved
                };
                let h = 1e-6;
                for column in 0..6 {
                    let [up, down] = [h, -h].map(|by| energy.value(FaceId::new(0), &moved(column, by)));
                    let slope = (up - down) / (2.0 * h);
                    assert!((slope - at.gradient[column]).abs() < 1e-6 * (1.0 + slope.abs()), "{column}");
                    let [up, down] = [h, -h].map(|by| energy.derivatives(FaceId::new(0), &moved(column, by)).gradient);
                    for row in (0..6).filter(|_| is_convex) {
                        let bent = (up[row] - down[row]) / (2.0 * h);
                        assert!((bent - at.hessian[row][column]).abs() < 1e-5 * (1.0 + bent.abs()), "{row} {column}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_positive_part_has_no_negative_eigenvalue_and_is_the_matrix_itself_where_it_had_none() {
        assert_eq!(positive_part([2.0, 1.0, 3.0]), [2.0, 1.0, 3.0]);
        assert_eq!(positive_part([-1.0, 0.0, -2.0]), [0.0; 3]);
        let [a, b, c] = positive_part([1.0, 2.0, -0.5]);
        assert!((a * c - b * b).abs() < 1e-14 && a > 0.0 && c > 0.0);
        assert_eq!(positive_part([-1.0, 0.0, 2.0]), [0.0, 0.0, 2.0]);
    }

    #[test]
    fn a_triangle_turned_over_costs_infinitely_much() {
        let rest = vec![RestShape::of_plane(&points(REST), 1.0)];
        let energy = Isometric { density: Arc::new(SymmetricDirichlet), rest };
        let [a, b, c] = points(DRAWN);
        assert_eq!(energy.value(FaceId::new(0), &[a, c, b]), f64::INFINITY);
        assert_eq!(energy.value(FaceId::new(0), &[a, a, b]), f64::INFINITY);
        assert!(energy.value(FaceId::new(0), &points(REST)) < 1e-28);
    }
}
