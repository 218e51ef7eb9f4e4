//! Products with the constraints: `J x`, `Jᵀ λ` and `M λ = J Λ⁻¹ Jᵀ λ`, without ever forming `M`.
//!
//! VMV04 §7 solves for all multipliers at once with `M = J Λ⁻¹ Jᵀ`, `(nt + 2 ni)²`. `J` has about 9
//! entries per triangle besides its ones in the triangle rows, so two products with it and one with
//! a diagonal cost less than one with `M`.

use crate::{KktSystem, ReducedSystem};
use abf_constraints::{ConstraintRows, Jacobian};
use abf_linalg::LinOp;
use abf_mesh::{CornerId, Topology};
use abf_parallel::prelude::*;
use sprs::{CsMatI, CsMatViewI};
use std::cell::RefCell;

/// Products with fewer rows than this stay on one thread: starting others costs more than it saves.
const PARALLEL_ROWS: usize = 1 << 14;

/// How many rows one task multiplies.
const ROWS_PER_TASK: usize = 1 << 12;

/// `B x` and `Bᵀ λ`, `B` being some or all rows of the Jacobian in any order.
///
/// Both `J` and `Bᵀ` are kept by rows, so that each entry of a product is one sum in a fixed order:
/// rows are shared out among threads, and the bits do not depend on how.
#[derive(Clone, Debug)]
pub struct ConstraintProducts {
    jacobian: Jacobian,
    /// Row `i` of `B` is this row of `J`.
    kept: Vec<u32>,
    /// `Bᵀ`, `3 nt` rows.
    transposed: CsMatI<f64, u32>,
    /// For each entry of `Bᵀ` the entry of `J` that it repeats.
    source: Vec<u32>,
}

impl ConstraintProducts {
    /// `B = J`: all constraints, in their order.
    #[must_use]
    pub fn whole(topology: &Topology, rows: &ConstraintRows) -> Self {
        Self::of_rows(topology, rows, (0..rows.len() as u32).collect())
    }

    /// `B = R`: the vertex and wheel rows in the order of the unknowns of `S`.
    #[must_use]
    pub fn reduced(topology: &Topology, rows: &ConstraintRows, system: &ReducedSystem) -> Self {
        Self::of_rows(topology, rows, system.constraint_of_unknown(rows))
    }

    fn of_rows(topology: &Topology, rows: &ConstraintRows, kept: Vec<u32>) -> Self {
        let jacobian = Jacobian::new(topology, rows);
        let (transposed, source) = transpose(&jacobian.view(), &kept);
        Self { jacobian, kept, transposed, source }
    }

    /// Writes the wheel derivative of a system into both copies.
    pub fn update(&mut self, kkt: &KktSystem<'_>) {
        self.jacobian.update(kkt.topology, kkt.rows, kkt.wheel);
        let jacobian = self.jacobian.view();
        for (value, &source) in self.transposed.data_mut().iter_mut().zip(&self.source) {
            *value = jacobian.data()[source as usize];
        }
    }

    /// The rows of `J` that are the rows of `B`.
    #[must_use]
    pub fn kept_rows(&self) -> &[u32] {
        &self.kept
    }

    /// `3 nt`, the length of `x`.
    #[must_use]
    pub fn corner_count(&self) -> usize {
        self.transposed.rows()
    }

    /// `out = B x`.
    ///
    /// # Panics
    /// If a vector has another length than `B` asks for.
    pub fn multiply(&self, x: &[f64], out: &mut [f64]) {
        assert!(x.len() == self.corner_count() && out.len() == self.kept.len(), "vectors fit the constraints");
        let jacobian = self.jacobian.view();
        fill_rows(out, |i| row_product(&jacobian, self.kept[i] as usize, x));
    }

    /// `out = Bᵀ λ`.
    ///
    /// # Panics
    /// If a vector has another length than `Bᵀ` asks for.
    pub fn multiply_transposed(&self, multipliers: &[f64], out: &mut [f64]) {
        assert!(
            multipliers.len() == self.kept.len() && out.len() == self.corner_count(),
            "vectors fit the constraints"
        );
        let transposed = self.transposed.view();
        fill_rows(out, |c| row_product(&transposed, c, multipliers));
    }
}

/// The kept rows of a matrix, transposed; and where each of its entries came from.
fn transpose(matrix: &CsMatViewI<'_, f64, u32>, kept: &[u32]) -> (CsMatI<f64, u32>, Vec<u32>) {
    let entries_of = |row: u32| matrix.indptr().outer_inds_sz(row as usize);
    let mut start = vec![0_u32; matrix.cols() + 1];
    for &row in kept {
        matrix.indices()[entries_of(row)].iter().for_each(|&column| start[column as usize + 1] += 1);
    }
    for column in 0..matrix.cols() {
        start[column + 1] += start[column];
    }
    let count = start[matrix.cols()] as usize;
    let (mut indices, mut source) = (vec![0_u32; count], vec![0_u32; count]);
    let mut cursor = start.clone();
    for (i, &row) in kept.iter().enumerate() {
        for entry in entries_of(row) {
            let place = &mut cursor[matrix.indices()[entry] as usize];
            indices[*place as usize] = i as u32;
            source[*place as usize] = entry as u32;
            *place += 1;
        }
    }
    let values = source.iter().map(|&entry| matrix.data()[entry as usize]).collect();
    (CsMatI::new((matrix.cols(), kept.len()), start, indices, values), source)
}

#[inline]
fn row_product(matrix: &CsMatViewI<'_, f64, u32>, row: usize, x: &[f64]) -> f64 {
    let entries = matrix.indptr().outer_inds_sz(row);
    let columns = &matrix.indices()[entries.clone()];
    columns.iter().zip(&matrix.data()[entries]).map(|(&c, value)| value * x[c as usize]).sum()
}

/// `out[i] = row(i)`, on several threads where that pays.
fn fill_rows(out: &mut [f64], row: impl Fn(usize) -> f64 + Sync) {
    let fill = |(task, chunk): (usize, &mut [f64])| {
        for (k, value) in chunk.iter_mut().enumerate() {
            *value = row(task * ROWS_PER_TASK + k);
        }
    };
    if out.len() < PARALLEL_ROWS {
        out.chunks_mut(ROWS_PER_TASK).enumerate().for_each(fill);
    } else {
        out.par_chunks_mut(ROWS_PER_TASK).enumerate().for_each(fill);
    }
}

/// `M = J Λ⁻¹ Jᵀ` of VMV04 §7.1, `nt + 2 ni` unknowns in the order of [`ConstraintRows`]; as an
/// operator, and with what comes before and after solving
/// `M μ = h − J Λ⁻¹ g`,  `δ = −Λ⁻¹ (g + Jᵀ μ)`.
///
/// Positive definite where `Λ > 0`. Where `p` entries of `Λ` are negative and the step is towards a
/// minimum, `M` has exactly `p` negative eigenvalues (Sylvester's law on the whole system).
pub struct SchurComplement<'a> {
    products: &'a ConstraintProducts,
    kkt: &'a KktSystem<'a>,
    /// `Λ⁻¹ Jᵀ λ`, room for a product.
    corners: RefCell<Vec<f64>>,
}

impl<'a> SchurComplement<'a> {
    /// The operator of a system, whose wheel derivative `products` must hold.
    ///
    /// # Panics
    /// If `products` does not hold all rows.
    #[must_use]
    pub fn new(products: &'a ConstraintProducts, kkt: &'a KktSystem<'a>) -> Self {
        assert_eq!(products.kept_rows().len(), kkt.rows.len(), "products with all constraints");
        Self { products, kkt, corners: RefCell::new(vec![0.0; kkt.lambda.len()]) }
    }

    /// `h − J Λ⁻¹ g`.
    #[must_use]
    pub fn right_hand_side(&self) -> Vec<f64> {
        let unconstrained: Vec<f64> = self.kkt.gradient.iter().zip(self.kkt.lambda).map(|(g, l)| g / l).collect();
        let mut rhs = vec![0.0; self.size()];
        self.products.multiply(&unconstrained, &mut rhs);
        rhs.iter_mut().zip(self.kkt.residual).for_each(|(r, h)| *r = h - *r);
        rhs
    }

    /// `δ = −Λ⁻¹ (g + Jᵀ μ)`.
    pub fn back_substitute(&self, multipliers: &[f64], delta: &mut Vec<f64>) {
        delta.resize(self.kkt.lambda.len(), 0.0);
        self.products.multiply_transposed(multipliers, delta);
        for ((d, g), l) in delta.iter_mut().zip(self.kkt.gradient).zip(self.kkt.lambda) {
            *d = -(g + *d) / l;
        }
    }
}

impl LinOp for SchurComplement<'_> {
    fn size(&self) -> usize {
        self.kkt.rows.len()
    }

    fn apply(&self, x: &[f64], out: &mut [f64]) {
        let mut corners = self.corners.borrow_mut();
        self.products.multiply_transposed(x, &mut corners);
        corners.iter_mut().zip(self.kkt.lambda).for_each(|(p, l)| *p /= l);
        self.products.multiply(&corners, out);
    }
}

/// The diagonal of `M`: for a constraint with row `j` of `J`, `Σ j² / Λ`.
pub(crate) fn schur_diagonal(kkt: &KktSystem<'_>) -> Vec<f64> {
    let inverse = |c: CornerId| 1.0 / kkt.lambda[c.index()];
    let triangles = kkt.topology.faces().map(|f| f.corners().map(inverse).iter().sum::<f64>());
    let interior = kkt.rows.interior();
    let vertices = interior.iter().map(|&v| kkt.topology.fan(v).map(inverse).sum());
    let wheels = interior.iter().enumerate().map(|(i, &v)| {
        let term = |hub: CornerId| {
            let (next, prev) = kkt.wheel.coefficients(i, hub);
            next * next * inverse(hub.next()) + prev * prev * inverse(hub.prev())
        };
        kkt.topology.fan(v).map(term).sum()
    });
    triangles.chain(vertices).chain(wheels).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{Planted, apart, wave};
    use nalgebra::{DMatrix, DVector};

    fn product(matrix: &DMatrix<f64>, x: &[f64]) -> DVector<f64> {
        matrix * DVector::from_column_slice(x)
    }

    #[test]
    fn products_are_those_of_the_explicit_matrix() {
        let planted = Planted::new(200);
        let kkt = planted.kkt();
        let system = ReducedSystem::new(kkt.topology, kkt.rows).expect("fits");
        let dense = planted.jacobian();
        for mut products in [
            ConstraintProducts::whole(kkt.topology, kkt.rows),
            ConstraintProducts::reduced(kkt.topology, kkt.rows, &system),
        ] {
            products.update(&kkt);
            let kept: Vec<usize> = products.kept_rows().iter().map(|&row| row as usize).collect();
            let b = dense.select_rows(&kept);
            let (x, multipliers) = (wave(b.ncols()), wave(b.nrows()));
            let (mut down, mut up) = (vec![0.0; b.nrows()], vec![0.0; b.ncols()]);
            products.multiply(&x, &mut down);
            products.multiply_transposed(&multipliers, &mut up);
            assert!(apart(&down, &product(&b, &x)) < 1e-13);
            assert!(apart(&up, &product(&b.transpose(), &multipliers)) < 1e-13);
        }
    }

    #[test]
    fn the_schur_complement_and_its_diagonal_are_those_of_the_explicit_matrix() {
        let planted = Planted::new(200);
        let kkt = planted.kkt();
        let mut products = ConstraintProducts::whole(kkt.topology, kkt.rows);
        products.update(&kkt);
        let m = SchurComplement::new(&products, &kkt);
        let j = planted.jacobian();
        let inverse = DMatrix::from_diagonal(&DVector::from_iterator(j.ncols(), kkt.lambda.iter().map(|l| 1.0 / l)));
        let dense = &j * &inverse * j.transpose();
        let x = wave(m.size());
        let mut out = vec![0.0; m.size()];
        m.apply(&x, &mut out);
        assert!(apart(&out, &product(&dense, &x)) < 1e-12);
        assert!(apart(&schur_diagonal(&kkt), &dense.diagonal()) < 1e-12);
        let expected = DVector::from_column_slice(kkt.residual) - &j * product(&inverse, kkt.gradient);
        assert!(apart(&m.right_hand_side(), &expected) < 1e-12);
    }

    #[test]
    fn products_have_the_same_bits_for_any_number_of_threads() {
        let planted = Planted::new(12_000);
        let kkt = planted.kkt();
        let mut products = ConstraintProducts::whole(kkt.topology, kkt.rows);
        products.update(&kkt);
        let m = |threads: usize| {
            abf_parallel::with_threads(threads, || {
                let m = SchurComplement::new(&products, &kkt);
                let mut out = vec![0.0; m.size()];
                m.apply(&wave(m.size()), &mut out);
                out
            })
            .expect("threads")
        };
        let one = m(1);
        assert!(one.len() > PARALLEL_ROWS);
        assert!([2, 3].map(m).iter().all(|out| *out == one));
    }
}
