//! The cells of a page that are taken, and where a mask fits between them.

use crate::raster::{Bits, CellRun, Mask};

/// Words that are looked at together.
const BLOCK: usize = 4;

/// A page of cells.
///
/// `tables[k]` has a bit for every cell: whether it or one of the `2^k − 1` cells right of it is taken. A run of cells is
/// free at every place of a row that two of these bits leave free, so one step tells of 64 places.
#[derive(Clone, Debug)]
pub(crate) struct Page {
    /// Width and height in cells and parts of cells.
    size: [f64; 2],
    rows: i32,
    /// Columns left of the page, all free: runs begin there when a mask with its margin reaches over the border.
    pad: i32,
    stride: usize,
    tables: Vec<Vec<u64>>,
}

/// What is small for the best place. Each compares two numbers of a place, the first before the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Criterion {
    /// The top of the piece, then x.
    Top,
    /// Its bottom, then x.
    Bottom,
    /// The side of the square from the corner of the page that holds it, then `x + y`.
    Square,
    /// The half-perimeter of the rectangle from the corner of the page that holds it, then x.
    Corner,
    /// The height of its middle, then x.
    Middle,
}

/// A place on a page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    pub(crate) x: i32,
    pub(crate) y: i32,
    pub(crate) cost: [f64; 2],
}

impl Criterion {
    fn cost(self, [w, h]: [f64; 2], x: i32, y: i32) -> [f64; 2] {
        let (x, y) = (f64::from(x), f64::from(y));
        match self {
            Self::Top => [y + h, x],
            Self::Bottom => [y, x],
            Self::Square => [(x + w).max(y + h), x + y],
            Self::Corner => [x + y + w + h, x],
            Self::Middle => [y + 0.5 * h, x],
        }
    }

    /// The largest x that can cost `limit` or less in row `y`.
    fn last_x(self, [w, h]: [f64; 2], y: i32, limit: f64) -> f64 {
        match self {
            Self::Top | Self::Bottom | Self::Middle => f64::INFINITY,
            Self::Square => limit - w,
            Self::Corner => limit - f64::from(y) - w - h,
        }
    }
}

impl Page {
    /// An empty page. `margin` is the largest one of the masks to come, in cells.
    pub(crate) fn new(size: [f64; 2], margin: f64) -> Self {
        let pad = (margin.ceil() as i32 + 2).div_euclid(64) * 64 + 64;
        let [columns, rows] = size.map(|length| length.ceil() as i32 + 1);
        let stride = (2 * pad + columns) as usize / 64 + 2;
        let levels = (columns + 2 * pad).ilog2() as usize + 1;
        // The last row is followed by what a block may read beyond it.
        let tables = vec![vec![0; stride * rows as usize + 2 * BLOCK]; levels];
        Self { size, rows, pad, stride, tables }
    }

    /// The best place of `mask` that costs less than `limit`.
    pub(crate) fn best(&self, mask: &Mask, criterion: Criterion, limit: Option<[f64; 2]>) -> Option<Spot> {
        let [last_x, last_y] = [0, 1].map(|i| (self.size[i] - mask.size[i]).floor());
        if !(last_x >= 0.0 && last_y >= 0.0) {
            return None;
        }
        let mut best: Option<Spot> = None;
        let mut limit = limit.unwrap_or([f64::INFINITY; 2]);
        for y in 0..=last_y as i32 {
            let least = criterion.cost(mask.size, 0, y);
            if least[0] > limit[0] {
                break;
            }
            let last_x = last_x.min(criterion.last_x(mask.size, y, limit[0]));
            if last_x < 0.0 {
                continue;
            }
            let Some(x) = self.first_free(mask, y, last_x as i32) else { continue };
            let cost = criterion.cost(mask.size, x, y);
            if cost < limit {
                limit = cost;
                best = Some(Spot { x, y, cost });
            }
        }
        best
    }

    /// The first x up to `last` where the mask fits at height `y`.
    fn first_free(&self, mask: &Mask, y: i32, last: i32) -> Option<i32> {
        let last = last as usize;
        for block in 0..=last / (64 * BLOCK) {
            let start = block * BLOCK;
            let mut free = [0; BLOCK];
            for (i, word) in free.iter_mut().enumerate().take_while(|(i, _)| start + i <= last / 64) {
                *word = if start + i == last / 64 { u64::MAX >> (63 - last % 64) } else { u64::MAX };
            }
            if self.strike_all(mask, y, start, &mut free) {
                let first = free.iter().position(|&word| word != 0)?;
                return Some(64 * (start + first) as i32 + free[first].trailing_zeros() as i32);
            }
        }
        None
    }

    /// Strikes out the places of a block of a row where the mask meets a taken cell, and says whether any are left.
    fn strike_all(&self, mask: &Mask, y: i32, start: usize, free: &mut [u64; BLOCK]) -> bool {
        /// Runs after which it is seen whether any place is left.
        const RUNS: usize = 1;
        mask.wide.chunks(RUNS).all(|runs| {
            runs.iter().for_each(|run| self.strike(run, y, start, free));
            free.iter().fold(0, |all, word| all | word) != 0
        })
    }

    fn strike(&self, run: &CellRun, y: i32, start: usize, free: &mut [u64; BLOCK]) {
        let row = y + run.row;
        if row < 0 || row >= self.rows {
            return;
        }
        let level = run.length.ilog2() as usize;
        let table = &self.tables[level][row as usize * self.stride + start..];
        let first = (run.first + self.pad) as usize;
        strike_at(table, first, free);
        let rest = run.length as usize - (1 << level);
        if rest > 0 {
            strike_at(table, first + rest, free);
        }
    }

    /// Takes the cells that the piece touches.
    pub(crate) fn take(&mut self, cells: &Bits, x: i32, y: i32) {
        for (row, words) in cells.rows() {
            let row = y + row;
            if row < 0 || row >= self.rows || words.iter().all(|&word| word == 0) {
                continue;
            }
            let start = row as usize * self.stride;
            let shift = (x + cells.low[0] + self.pad) as usize;
            let target = &mut self.tables[0][start..start + self.stride];
            for (i, &word) in words.iter().enumerate().filter(|(_, word)| **word != 0) {
                let (at, bit) = (i + shift / 64, shift % 64);
                target[at] |= word << bit;
                if bit > 0 && word >> (64 - bit) != 0 {
                    target[at + 1] |= word >> (64 - bit);
                }
            }
            self.rebuild(start);
        }
    }

    fn rebuild(&mut self, start: usize) {
        for level in 1..self.tables.len() {
            let (below, from) = self.tables.split_at_mut(level);
            let source = &below[level - 1][start..start + self.stride];
            let target = &mut from[0][start..start + self.stride];
            let (words, bit) = ((1 << (level - 1)) / 64, (1 << (level - 1)) % 64);
            for i in 0..target.len() {
                let word = |j: usize| source.get(j).copied().unwrap_or(0);
                let ahead = word(i + words) >> bit;
                let carried = if bit > 0 { word(i + words + 1) << (64 - bit) } else { 0 };
                target[i] = source[i] | ahead | carried;
            }
        }
    }
}

fn strike_at(table: &[u64], shift: usize, free: &mut [u64; BLOCK]) {
    let (words, bit) = (shift / 64, shift % 64);
    let ahead = &table[words..words + BLOCK + 1];
    for (i, free) in free.iter_mut().enumerate() {
        // The upper word comes in two steps: a shift by 64 is none.
        *free &= !(ahead[i] >> bit | ahead[i + 1] << 1 << (63 - bit));
    }
}
