//! Charts: the connected pieces of a UV map.

use abf_mesh::{UvId, UvMap};

/// Which chart every face is in.
pub(crate) struct Charts {
    /// The chart of every face, numbered by first appearance.
    pub(crate) of_face: Vec<usize>,
    /// How many there are.
    pub(crate) count: usize,
}

impl Charts {
    /// The connected components of the UV points, where the three points of a face are connected.
    pub(crate) fn find(uv: &UvMap) -> Self {
        const UNNUMBERED: usize = usize::MAX;
        let mut sets = DisjointSets::new(uv.points().len());
        for face in uv.corners().chunks_exact(3) {
            sets.join(face[0].index(), face[1].index());
            sets.join(face[1].index(), face[2].index());
        }
        let mut number = vec![UNNUMBERED; uv.points().len()];
        let mut count = 0;
        let chart_of = |face: &[UvId]| {
            let root = sets.root(face[0].index());
            if number[root] == UNNUMBERED {
                number[root] = count;
                count += 1;
            }
            number[root]
        };
        let of_face = uv.corners().chunks_exact(3).map(chart_of).collect();
        Self { of_face, count }
    }
}

/// Union–find with path halving. The lower index becomes the root, so the result does not depend
/// on anything but the sets.
struct DisjointSets {
    parent: Vec<usize>,
}

impl DisjointSets {
    fn new(len: usize) -> Self {
        Self { parent: (0..len).collect() }
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.root(i), self.root(j));
        self.parent[i.max(j)] = i.min(j);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::Point2;

    #[test]
    fn charts_are_numbered_by_first_appearance_and_unused_points_are_none() {
        let corners = [5, 6, 7, 0, 1, 2, 7, 8, 5, 2, 1, 3].map(UvId::new).to_vec();
        let charts = Charts::find(&UvMap::new(vec![Point2::origin(); 10], corners));
        assert_eq!(charts.of_face, [0, 1, 0, 1]);
        assert_eq!(charts.count, 2);
    }
}
