//! The filter: what a trial must be better than, in violation or in objective.

/// Pairs `(θ, φ)` of places that were left; a trial dominated by one of them is refused (Fletcher, Leyffer 2002;
/// Wächter, Biegler 2006, §2.3).
#[derive(Clone, Debug)]
pub(crate) struct Filter {
    largest_violation: f64,
    entries: Vec<(f64, f64)>,
}

impl Filter {
    /// A filter that refuses violations above this and nothing else.
    pub(crate) fn new(largest_violation: f64) -> Self {
        Self { largest_violation, entries: Vec::new() }
    }

    /// Whether `(θ, φ)` is better than every entry in one of the two. NaN never is.
    pub(crate) fn accepts(&self, (violation, objective): (f64, f64)) -> bool {
        violation <= self.largest_violation && self.entries.iter().all(|&(v, o)| violation < v || objective < o)
    }

    /// Refuses from now on what is not better than this.
    pub(crate) fn add(&mut self, entry: (f64, f64)) {
        self.entries.retain(|&(v, o)| v < entry.0 || o < entry.1);
        self.entries.push(entry);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_refuses_what_one_entry_dominates() {
        let mut filter = Filter::new(10.0);
        assert!(filter.accepts((9.0, 1e9)) && !filter.accepts((11.0, -1e9)));
        filter.add((1.0, 5.0));
        filter.add((2.0, 3.0));
        assert!(filter.accepts((0.5, 100.0)) && filter.accepts((3.0, 2.9)) && filter.accepts((1.5, 4.0)));
        assert!(!filter.accepts((1.0, 5.0)) && !filter.accepts((2.5, 3.5)));
        assert!(!filter.accepts((f64::NAN, 0.0)) && !filter.accepts((3.0, f64::NAN)));
        filter.add((0.1, 1.0));
        assert_eq!(filter.entries.len(), 1, "dominated entries go");
    }
}
