//! Union–find.

/// A partition of `0..len`, in which sets are united and never taken apart.
///
/// The lowest member stands for its set, so that the result depends on the sets alone and not on the order in which they
/// were united (Tarjan 1975, paths halved). Finding takes `O(log n)` amortised; sets of ids that are numbered along a mesh
/// are found in two or three steps.
///
/// ```
/// let mut sets = abf_mesh::DisjointSets::new(4);
/// assert!(sets.unite(3, 1));
/// assert!(!sets.unite(1, 3));
/// assert_eq!([0, 1, 2, 3].map(|i| sets.find(i)), [0, 1, 2, 1]);
/// ```
#[derive(Clone, Debug)]
pub struct DisjointSets {
    /// Ids are made of 32 bits.
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Every element in a set of its own.
    ///
    /// # Panics
    /// If 32 bits cannot number the elements.
    #[must_use]
    pub fn new(len: usize) -> Self {
        let len = u32::try_from(len).expect("ids of 32 bits");
        Self { parent: (0..len).collect() }
    }

    /// The lowest member of the set that `element` is in.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn find(&mut self, mut element: usize) -> usize {
        loop {
            let parent = self.parent[element] as usize;
            if parent == element {
                return element;
            }
            let grandparent = self.parent[parent];
            self.parent[element] = grandparent;
            element = grandparent as usize;
        }
    }

    /// Makes one set of the two that `a` and `b` are in; `false` if they were one before.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn unite(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b)] = a.min(b) as u32;
        a != b
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_lowest_member_stands_for_its_set_in_whatever_order_they_are_united(
            pairs in prop::collection::vec((0..40_usize, 0..40_usize), 0..60),
        ) {
            let mut labels: Vec<usize> = (0..40).collect();
            let (mut forwards, mut backwards) = (DisjointSets::new(40), DisjointSets::new(40));
            for &(a, b) in &pairs {
                let (low, high) = (labels[a].min(labels[b]), labels[a].max(labels[b]));
                prop_assert_eq!(forwards.unite(a, b), low != high);
                labels.iter_mut().filter(|label| **label == high).for_each(|label| *label = low);
            }
            pairs.iter().rev().for_each(|&(a, b)| { backwards.unite(b, a); });
            for (i, &label) in labels.iter().enumerate() {
                prop_assert_eq!([forwards.find(i), backwards.find(i)], [label; 2]);
            }
        }
    }
}
