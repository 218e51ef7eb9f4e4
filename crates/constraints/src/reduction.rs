//! The elimination that every method shares.
//!
//! One quadratic step solves
//!
//! ```text
//! [ Λ  Jᵀ ] [ δ ]     [ g ]
//! [ J  0  ] [ μ ] = − [ h ]        Λ diagonal.
//! ```
//!
//! Two triangle rows share no corner, so in `J Λ⁻¹ Jᵀ` their block is diagonal and can be
//! eliminated triangle by triangle. With `1 = (1, 1, 1)`, `R` the 6 × 3 block of the vertex and
//! wheel rows of a triangle's three vertices, and
//!
//! ```text
//! P = Λ⁻¹ − Λ⁻¹ 1 1ᵀ Λ⁻¹ / (1ᵀ Λ⁻¹ 1),        s = Λ⁻¹ 1 / (1ᵀ Λ⁻¹ 1),
//! ```
//!
//! what is left is a system `S μ_R = r` in the vertex and wheel multipliers only (2 ni of them):
//!
//! ```text
//! S = Σ_t R P Rᵀ,        r = h_R − Σ_t R (P g + s h_t),
//! δ_t = −P (g + Rᵀ μ_R) − s h_t,        μ_t = (h_t − 1ᵀ Λ⁻¹ (g + Rᵀ μ_R)) / (1ᵀ Λ⁻¹ 1).
//! ```
//!
//! ABF++ (Sheffer et al. 2005) does the same elimination on assembled matrices; VMV04 keeps the
//! whole `M = J Λ⁻¹ Jᵀ`.

use crate::{ConstraintRows, WheelDerivative};
use abf_mesh::{CornerId, FaceId, Topology};

/// `P` and `s` of one triangle.
#[derive(Clone, Copy, Debug)]
pub struct TriangleReduction {
    inverse: [f64; 3],
    inverse_sum: f64,
}

impl TriangleReduction {
    /// The reduction for the three diagonal entries of `Λ`, of any sign.
    #[inline]
    #[must_use]
    pub fn new(lambda: [f64; 3]) -> Self {
        let inverse = lambda.map(f64::recip);
        Self { inverse, inverse_sum: inverse[0] + inverse[1] + inverse[2] }
    }

    /// Whether `1ᵀ Λ⁻¹ 1` cancels to rounding, which entries of mixed sign can make it do; the
    /// reduction is then useless and the triangle needs another `Λ`.
    #[inline]
    #[must_use]
    pub fn is_singular(&self) -> bool {
        const ROUNDING: f64 = 1e-12;
        let size = self.inverse.iter().map(|x| x.abs()).sum::<f64>();
        !(self.inverse_sum.abs() > ROUNDING * size)
    }

    /// `P q`.
    #[inline]
    #[must_use]
    pub fn project(&self, q: [f64; 3]) -> [f64; 3] {
        let mean = self.weighted_sum(q) / self.inverse_sum;
        [0, 1, 2].map(|k| self.inverse[k] * (q[k] - mean))
    }

    /// `s h`: the smallest change, in the metric `Λ`, that adds `h` to the sum of the angles.
    #[inline]
    #[must_use]
    pub fn shift(&self, h: f64) -> [f64; 3] {
        self.inverse.map(|d| d * h / self.inverse_sum)
    }

    /// `P q + s h`, which for `q = g + Rᵀ μ_R` is `−δ_t`.
    #[inline]
    #[must_use]
    pub fn opposite_change(&self, q: [f64; 3], h: f64) -> [f64; 3] {
        let (projected, shift) = (self.project(q), self.shift(h));
        [0, 1, 2].map(|k| projected[k] + shift[k])
    }

    /// The multiplier of the triangle's own row, `q = g + Rᵀ μ_R`.
    #[inline]
    #[must_use]
    pub fn multiplier(&self, h: f64, q: [f64; 3]) -> f64 {
        (h - self.weighted_sum(q)) / self.inverse_sum
    }

    /// `1ᵀ Λ⁻¹ q`.
    #[inline]
    fn weighted_sum(&self, q: [f64; 3]) -> f64 {
        self.inverse[0] * q[0] + self.inverse[1] * q[1] + self.inverse[2] * q[2]
    }
}

/// `R` of one triangle: row `k` is the vertex condition and row `3 + k` the wheel condition of its
/// `k`-th vertex; rows of boundary vertices are zero.
#[derive(Clone, Copy, Debug)]
pub struct TriangleRows {
    /// The interior vertices, by their number in [`ConstraintRows`].
    pub interior: [Option<usize>; 3],
    /// For each vertex the coefficients of its `next` and `prev` corner in its wheel row.
    wheel: [(f64, f64); 3],
}

impl TriangleRows {
    /// The rows of one face.
    #[inline]
    #[must_use]
    pub fn new(topology: &Topology, rows: &ConstraintRows, wheel: &WheelDerivative, face: FaceId) -> Self {
        let corners = face.corners();
        let interior = corners.map(|c| rows.interior_index(topology.vertex(c)));
        let coefficients = |k: usize, c: CornerId| interior[k].map_or((0.0, 0.0), |i| wheel.coefficients(i, c));
        Self {
            interior,
            wheel: [coefficients(0, corners[0]), coefficients(1, corners[1]), coefficients(2, corners[2])],
        }
    }

    /// `R q`: the vertex entries and the wheel entries.
    #[inline]
    #[must_use]
    pub fn apply(&self, q: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let wheel = [0, 1, 2].map(|k| {
            let (next, prev) = self.wheel[k];
            next * q[(k + 1) % 3] + prev * q[(k + 2) % 3]
        });
        (q, wheel)
    }

    /// `Rᵀ μ` for the vertex and wheel multipliers of the three vertices; those of boundary
    /// vertices must be zero.
    #[inline]
    #[must_use]
    pub fn apply_transposed(&self, vertex: [f64; 3], wheel: [f64; 3]) -> [f64; 3] {
        // Corner k is next of corner k − 1 and prev of corner k + 1.
        [0, 1, 2].map(|k| {
            let (before, after) = ((k + 2) % 3, (k + 1) % 3);
            vertex[k] + self.wheel[before].0 * wheel[before] + self.wheel[after].1 * wheel[after]
        })
    }

    /// `R P Rᵀ`, symmetric 6 × 6.
    #[must_use]
    pub fn schur_block(&self, reduction: &TriangleReduction) -> [[f64; 6]; 6] {
        let mut block = [[0.0; 6]; 6];
        for (column, entries) in self.unit_columns().into_iter().enumerate() {
            let (vertex, wheel) = self.apply(reduction.project(entries));
            for k in 0..3 {
                block[k][column] = vertex[k];
                block[3 + k][column] = wheel[k];
            }
        }
        block
    }

    /// The six columns of `Rᵀ`.
    fn unit_columns(&self) -> [[f64; 3]; 6] {
        let unit = |k: usize| [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 });
        let zero = [0.0; 3];
        [0, 1, 2, 3, 4, 5].map(|j| {
            if j < 3 { self.apply_transposed(unit(j), zero) } else { self.apply_transposed(zero, unit(j - 3)) }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Jacobian, WheelForm};
    use abf_shapes::Shape;
    use nalgebra::{DMatrix, DVector};

    /// The whole system solved densely, and the reduced one, must agree: in δ and in every multiplier.
    #[test]
    fn the_reduced_system_solves_the_whole_one() {
        let mesh = Shape::BumpySheet.mesh(60);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let rows = ConstraintRows::new(&topology);
        let angles = mesh.corner_angles();
        for form in [WheelForm::Log, WheelForm::Product] {
            // Λ with a few negative entries, as the exact Hessian has.
            let lambda: Vec<f64> =
                (0..angles.len()).map(|c| if c % 17 == 3 { -0.7 } else { 1.0 + 0.3 * (c as f64).sin() }).collect();
            let g: Vec<f64> = (0..angles.len()).map(|c| (0.9 * c as f64).cos()).collect();
            let h: Vec<f64> = (0..rows.len()).map(|r| (1.3 * r as f64).sin()).collect();
            let wheel = WheelDerivative::new(form, &topology, &rows, &angles);
            let (delta, multipliers) = solve_whole(&topology, &rows, &wheel, &lambda, &g, &h);
            let (reduced_delta, reduced_multipliers) = solve_reduced(&topology, &rows, &wheel, &lambda, &g, &h);
            assert!((delta - reduced_delta).amax() < 1e-9);
            assert!((multipliers - reduced_multipliers).amax() < 1e-8);
        }
    }

    fn solve_whole(
        topology: &Topology,
        rows: &ConstraintRows,
        wheel: &WheelDerivative,
        lambda: &[f64],
        g: &[f64],
        h: &[f64],
    ) -> (DVector<f64>, DVector<f64>) {
        let (n, m) = (lambda.len(), h.len());
        let mut jacobian = Jacobian::new(topology, rows);
        jacobian.update(topology, rows, wheel);
        let mut kkt = DMatrix::zeros(n + m, n + m);
        for (c, l) in lambda.iter().enumerate() {
            kkt[(c, c)] = *l;
        }
        for (value, (row, column)) in &jacobian.view() {
            kkt[(n + row as usize, column as usize)] = *value;
            kkt[(column as usize, n + row as usize)] = *value;
        }
        let rhs = DVector::from_iterator(n + m, g.iter().chain(h).map(|x| -x));
        let solution = kkt.lu().solve(&rhs).expect("regular");
        (solution.rows(0, n).into_owned(), solution.rows(n, m).into_owned())
    }

    fn solve_reduced(
        topology: &Topology,
        rows: &ConstraintRows,
        wheel: &WheelDerivative,
        lambda: &[f64],
        g: &[f64],
        h: &[f64],
    ) -> (DVector<f64>, DVector<f64>) {
        let ni = rows.interior_count();
        let mut s = DMatrix::zeros(2 * ni, 2 * ni);
        let mut r = DVector::from_column_slice(&h[rows.triangle_count()..]);
        let of_face = |f: FaceId| {
            let c = f.corners().map(CornerId::index);
            let reduction = TriangleReduction::new(c.map(|c| lambda[c]));
            assert!(!reduction.is_singular());
            (c, reduction, TriangleRows::new(topology, rows, wheel, f))
        };
        let index = |t: &TriangleRows, k: usize| t.interior[k % 3].map(|i| if k < 3 { i } else { ni + i });
        for f in topology.faces() {
            let (c, reduction, t) = of_face(f);
            let block = t.schur_block(&reduction);
            let (shift, projected) = (reduction.shift(h[f.index()]), reduction.project(c.map(|c| g[c])));
            let (vertex, wheel) = t.apply([0, 1, 2].map(|k| projected[k] + shift[k]));
            for a in 0..6 {
                let Some(row) = index(&t, a) else { continue };
                r[row] -= if a < 3 { vertex[a] } else { wheel[a - 3] };
                for (b, entry) in block[a].iter().enumerate() {
                    if let Some(column) = index(&t, b) {
                        s[(row, column)] += entry;
                    }
                }
            }
        }
        let mu = s.lu().solve(&r).expect("regular");
        let mut delta = DVector::zeros(lambda.len());
        let mut multipliers = DVector::zeros(h.len());
        multipliers.rows_mut(rows.triangle_count(), 2 * ni).copy_from(&mu);
        for f in topology.faces() {
            let (c, reduction, t) = of_face(f);
            let of = |offset: usize| [0, 1, 2].map(|k| t.interior[k].map_or(0.0, |i| mu[offset + i]));
            let back = t.apply_transposed(of(0), of(ni));
            let q = [0, 1, 2].map(|k| g[c[k]] + back[k]);
            let (projected, shift) = (reduction.project(q), reduction.shift(h[f.index()]));
            for k in 0..3 {
                delta[c[k]] = -projected[k] - shift[k];
            }
            multipliers[f.index()] = reduction.multiplier(h[f.index()], q);
        }
        (delta, multipliers)
    }

    #[test]
    fn a_sum_that_cancels_is_found() {
        assert!(TriangleReduction::new([1.0, 1.0, -0.5]).is_singular());
        assert!(!TriangleReduction::new([1.0, 1.0, -0.6]).is_singular());
    }
}
