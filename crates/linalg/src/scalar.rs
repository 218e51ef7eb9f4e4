//! The numbers a matrix may hold.

use num_complex::Complex64;
use std::ops::{Add, AddAssign, Mul, Sub, SubAssign};

/// The numbers a matrix may hold: `f64` or [`Complex64`]. Sealed by its bound.
pub trait Scalar:
    faer::traits::ComplexField
    + Copy
    + AddAssign
    + SubAssign
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Send
    + Sync
    + std::fmt::Debug
{
    /// The number zero.
    const ZERO: Self;
    /// The complex conjugate; a real number itself.
    #[must_use]
    fn conjugate(self) -> Self;
    /// The squared absolute value.
    fn norm_squared(self) -> f64;
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;

    #[inline]
    fn conjugate(self) -> Self {
        self
    }

    #[inline]
    fn norm_squared(self) -> f64 {
        self * self
    }
}

impl Scalar for Complex64 {
    const ZERO: Self = Self::new(0.0, 0.0);

    #[inline]
    fn conjugate(self) -> Self {
        self.conj()
    }

    #[inline]
    fn norm_squared(self) -> f64 {
        self.norm_sqr()
    }
}
