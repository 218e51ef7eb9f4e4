//! How a file stores points.

use abf_mesh::Point2;
use abf_metrics::Precision;

/// How a file stores points, and what is proved of them there.
///
/// ```
/// use abf::{Precision, Stored, mesh::Point2};
///
/// assert_eq!(Stored::default().precision(), Precision::Double);
/// let single = Stored::in_precision(Precision::Single);
/// assert_eq!(single.point(Point2::new(0.1, 0.5)), Point2::new(f64::from(0.1_f32), 0.5));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Stored {
    how: How,
    precision: Precision,
}

#[derive(Clone, Copy, Debug)]
enum How {
    Rounded,
    Converted(fn(Point2<f64>) -> Point2<f64>),
}

impl Stored {
    /// Coordinates are rounded to a precision.
    #[must_use]
    pub const fn in_precision(precision: Precision) -> Self {
        Self { how: How::Rounded, precision }
    }

    /// Points become those of `convert`, as a reader will find them; they are certified in `precision`.
    #[must_use]
    pub const fn converted(convert: fn(Point2<f64>) -> Point2<f64>, precision: Precision) -> Self {
        Self { how: How::Converted(convert), precision }
    }

    /// A point as it is stored.
    #[must_use]
    pub fn point(&self, point: Point2<f64>) -> Point2<f64> {
        match self.how {
            How::Rounded => point.map(|x| self.precision.round(x)),
            How::Converted(convert) => convert(point),
        }
    }

    /// What is left of a coordinate.
    #[must_use]
    pub const fn precision(&self) -> Precision {
        self.precision
    }
}

/// In doubles.
impl Default for Stored {
    fn default() -> Self {
        Self::in_precision(Precision::Double)
    }
}
