//! Edges in the plane by the cells of a grid.

use abf_mesh::CornerId;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Ends the edges of a cell.
const NONE: u32 = u32::MAX;

/// Edges by the cells that they touch.
#[derive(Clone, Default)]
pub(super) struct Cells {
    /// The last edge of every cell.
    last: HashMap<[i32; 2], u32, BuildHasherDefault<Mixed>>,
    /// Edges, each with the one before it in its cell.
    edges: Vec<(CornerId, u32)>,
}

impl Cells {
    pub(super) fn insert(&mut self, cell: [i32; 2], edge: CornerId) {
        let here = self.edges.len() as u32;
        let before = self.last.insert(cell, here).unwrap_or(NONE);
        self.edges.push((edge, before));
    }

    /// The edges of a cell.
    pub(super) fn at(&self, cell: [i32; 2]) -> impl Iterator<Item = CornerId> + '_ {
        let mut next = self.last.get(&cell).copied().unwrap_or(NONE);
        std::iter::from_fn(move || {
            let &(edge, before) = self.edges.get(next as usize)?;
            next = before;
            Some(edge)
        })
    }
}

/// A hash of a few integers that nobody chooses to collide: multiplied by the golden ratio, high bits folded down.
#[derive(Default)]
pub(super) struct Mixed(u64);

impl Hasher for Mixed {
    fn write(&mut self, bytes: &[u8]) {
        for part in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..part.len()].copy_from_slice(part);
            self.0 = (self.0 ^ u64::from_le_bytes(word)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            self.0 ^= self.0 >> 32;
        }
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_has_its_edges_and_no_others() {
        let mut cells = Cells::default();
        let place = |i: usize| [(i % 7) as i32 - 3, (i / 7 % 5) as i32 - 2];
        (0..200).for_each(|i| cells.insert(place(i), CornerId::new(i)));
        for x in -4..=4 {
            for y in -3..=3 {
                let mut found: Vec<usize> = cells.at([x, y]).map(CornerId::index).collect();
                found.reverse();
                let expected: Vec<usize> = (0..200).filter(|&i| place(i) == [x, y]).collect();
                assert_eq!(found, expected, "{x} {y}");
            }
        }
    }
}
