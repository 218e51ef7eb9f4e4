//! What an iterative method sees of a system: a product and a preconditioner.

use crate::LinearError;

/// A square real operator that is known by its products.
pub trait LinOp {
    /// The number of unknowns.
    fn size(&self) -> usize;
    /// `out = A x`. What `out` held before does not matter.
    fn apply(&self, x: &[f64], out: &mut [f64]);
}

/// The inverse of a symmetric positive definite `C` that resembles the operator.
pub trait Preconditioner {
    /// `out = C⁻¹ r`. What `out` held before does not matter.
    fn apply(&self, r: &[f64], out: &mut [f64]);
}

/// No preconditioning: `C = I`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity;

impl Preconditioner for Identity {
    fn apply(&self, r: &[f64], out: &mut [f64]) {
        out.copy_from_slice(r);
    }
}

/// The diagonal as a preconditioner (Jacobi).
#[derive(Clone, Debug, PartialEq)]
pub struct Jacobi {
    inverse: Vec<f64>,
}

impl Jacobi {
    /// `C = diag(diagonal)`.
    ///
    /// # Errors
    /// [`LinearError::NotPositiveDefinite`] unless every entry is positive and finite.
    pub fn new(diagonal: &[f64]) -> Result<Self, LinearError> {
        match diagonal.iter().position(|&d| !(d > 0.0 && d.is_finite())) {
            Some(pivot) => Err(LinearError::NotPositiveDefinite { pivot, size: diagonal.len() }),
            None => Ok(Self { inverse: diagonal.iter().map(|d| 1.0 / d).collect() }),
        }
    }
}

impl Preconditioner for Jacobi {
    fn apply(&self, r: &[f64], out: &mut [f64]) {
        assert!(r.len() == self.inverse.len() && out.len() == r.len(), "vectors fit the diagonal");
        for ((out, r), inverse) in out.iter_mut().zip(r).zip(&self.inverse) {
            *out = r * inverse;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::symmetric;

    #[test]
    fn a_symmetric_matrix_multiplies_with_both_triangles() {
        let a = symmetric(3, &[(0, 0, 2.0), (1, 0, -1.0), (2, 0, 4.0), (2, 1, 3.0)]);
        // A = [2 −1 4; −1 0 3; 4 3 0]
        let mut out = [f64::NAN; 3];
        LinOp::apply(&a, &[1.0, 2.0, 3.0], &mut out);
        assert_eq!(out, [12.0, 8.0, 10.0]);
        assert_eq!(LinOp::size(&a), 3);
    }

    #[test]
    fn jacobi_divides_by_the_diagonal() {
        let mut out = [0.0; 2];
        Jacobi::new(&[2.0, 4.0]).expect("positive").apply(&[1.0, 1.0], &mut out);
        assert_eq!(out, [0.5, 0.25]);
    }

    #[test]
    fn jacobi_refuses_a_diagonal_that_is_not_positive_and_finite() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Jacobi::new(&[1.0, bad]), Err(LinearError::NotPositiveDefinite { pivot: 1, size: 2 }));
        }
    }
}
