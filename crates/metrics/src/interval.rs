//! Ranges of numbers.

/// The least and the greatest of some numbers.
pub(crate) struct Interval {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Default for Interval {
    fn default() -> Self {
        Self { low: f64::INFINITY, high: f64::NEG_INFINITY }
    }
}

impl Interval {
    /// One more number.
    pub(crate) fn take(&mut self, x: f64) {
        self.low = self.low.min(x);
        self.high = self.high.max(x);
    }

    /// The numbers of another interval, too.
    pub(crate) fn join(&mut self, other: &Self) {
        self.take(other.low);
        self.take(other.high);
    }
}
