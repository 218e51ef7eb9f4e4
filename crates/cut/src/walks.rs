//! Walks from face to face, which take the triangles of a polygon together.

use abf_control::{Cancelled, Checkpoint, at_block};
use abf_mesh::DisjointSets;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The faces of a piece, how far it is from each to its neighbours, and which of them stay together.
///
/// Faces that stay together, as the triangles of a polygon, are in one place: a walk reaches all of them with the first.
/// So each goes to one side, where two sides part a piece, and equal ways do not cut it.
#[derive(Clone, Debug)]
pub struct FaceWalks {
    /// For every side of every face the face beyond it, and how far that is.
    beyond: Vec<[Option<(usize, f64)>; 3]>,
    /// The faces that stay together, in a circle.
    next: Vec<usize>,
}

impl FaceWalks {
    /// Of the face beyond every side, and how far that is, at least 0. `stays` says which sides, by face and number, have
    /// faces that stay together on both sides.
    #[must_use]
    pub fn new(beyond: Vec<[Option<(usize, f64)>; 3]>, stays: impl Fn(usize, usize) -> bool) -> Self {
        let mut together = DisjointSets::new(beyond.len());
        for (f, sides) in beyond.iter().enumerate() {
            for (k, side) in sides.iter().enumerate() {
                if let Some((g, _)) = side.filter(|_| stays(f, k)) {
                    together.unite(f, g);
                }
            }
        }
        let mut next: Vec<usize> = (0..beyond.len()).collect();
        for f in 0..beyond.len() {
            next.swap(f, together.find(f));
        }
        Self { beyond, next }
    }

    /// For every face whether it is nearer to the second of two faces than to the first. Both sides are connected.
    ///
    /// Where the two stay together themselves, nothing does.
    ///
    /// # Errors
    /// [`Cancelled`] when the checkpoint ends it.
    pub fn nearer_to_second(
        &self,
        first: usize,
        second: usize,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Vec<bool>, Cancelled> {
        if self.together(first).any(|f| f == second) {
            let alone = Self { beyond: self.beyond.clone(), next: (0..self.next.len()).collect() };
            return Ok(alone.from(&[first, second], checkpoint)?.1);
        }
        Ok(self.from(&[first, second], checkpoint)?.1)
    }

    /// The face farthest from one, and not that one, among those that are reached; of equals the last. The face itself where
    /// no other is.
    ///
    /// # Errors
    /// [`Cancelled`] when the checkpoint ends it.
    pub fn farthest_from(&self, from: usize, checkpoint: &mut Checkpoint<'_>) -> Result<usize, Cancelled> {
        let distance = self.from(&[from], checkpoint)?.0;
        let reached = (0..distance.len()).filter(|&f| distance[f].is_finite() && f != from);
        Ok(reached.max_by(|&f, &g| distance[f].total_cmp(&distance[g])).unwrap_or(from))
    }

    /// A face and those that stay with it.
    fn together(&self, face: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(face), move |&f| Some(self.next[f]).filter(|&next| next != face))
    }

    /// The distance of every face from the nearest source, and whether that is the last of them.
    fn from(&self, sources: &[usize], checkpoint: &mut Checkpoint<'_>) -> Result<(Vec<f64>, Vec<bool>), Cancelled> {
        let mut distance = vec![f64::INFINITY; self.beyond.len()];
        let mut is_last = vec![false; self.beyond.len()];
        let mut heap = BinaryHeap::new();
        for (i, &source) in sources.iter().enumerate() {
            for f in self.together(source) {
                (distance[f], is_last[f]) = (0.0, i > 0);
                heap.push(Reverse((0_u64, f)));
            }
        }
        let mut steps = 0;
        while let Some(Reverse((key, f))) = heap.pop() {
            at_block(steps, checkpoint)?;
            steps += 1;
            // The order of the bits of doubles that are not negative is that of the doubles.
            let here = f64::from_bits(key);
            if here > distance[f] {
                continue;
            }
            for (g, length) in self.beyond[f].into_iter().flatten() {
                let there = here + length;
                if there < distance[g] {
                    for face in self.together(g) {
                        (distance[face], is_last[face]) = (there, is_last[f]);
                        heap.push(Reverse((there.to_bits(), face)));
                    }
                }
            }
        }
        Ok((distance, is_last))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six faces in a row, one apart.
    fn row(stays: impl Fn(usize, usize) -> bool) -> FaceWalks {
        let beyond =
            (0..6_usize).map(|f| [f.checked_sub(1).map(|g| (g, 1.0)), Some((f + 1, 1.0)).filter(|_| f < 5), None]);
        FaceWalks::new(beyond.collect(), stays)
    }

    fn sides(walks: &FaceWalks, first: usize, second: usize) -> Vec<bool> {
        walks.nearer_to_second(first, second, &mut || Ok(())).expect("nobody aborts")
    }

    #[test]
    fn what_stays_together_goes_to_one_side_though_both_are_equally_near() {
        assert_eq!(sides(&row(|_, _| false), 0, 5), [false, false, false, true, true, true]);
        let kept = sides(&row(|f, k| (f, k) == (2, 1)), 0, 5);
        assert!(kept == [false, false, false, false, true, true] || kept == [false, false, true, true, true, true]);
        assert_eq!(sides(&row(|f, k| (f, k) == (4, 0)), 1, 4), [false, false, false, true, true, true]);
    }

    #[test]
    fn two_faces_that_stay_together_are_parted_when_asked_for() {
        assert_eq!(sides(&row(|_, _| true), 1, 4), [false, false, false, true, true, true]);
    }

    #[test]
    fn the_farthest_face_is_another_one() {
        let walks = row(|f, k| f < 3 && k == 1);
        assert_eq!(walks.farthest_from(3, &mut || Ok(())), Ok(5));
        assert_eq!(walks.farthest_from(5, &mut || Ok(())), Ok(3), "the first four are in one place");
        let alone = FaceWalks::new(vec![[None; 3]], |_, _| true);
        assert_eq!(alone.farthest_from(0, &mut || Ok(())), Ok(0));
        assert_eq!(row(|_, _| false).farthest_from(0, &mut || Err(Cancelled)), Err(Cancelled));
    }
}
