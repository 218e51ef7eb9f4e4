//! One layout at one scale: pieces one after another onto the cells of pages, each at the best place for it.

use crate::geometry::{Point, Turn};
use crate::page::{Criterion, Page};
use crate::raster::{Bits, Lie, Mask};
use crate::shape::Shape;
use std::sync::OnceLock;

/// A piece at one angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub(crate) turn: Turn,
    /// The lower left corner of its box after the turn, and the size of that.
    pub(crate) low: Point,
    pub(crate) size: Point,
}

/// Where a piece is: the page of its group, its pose, and the lower left corner of its box in texels inside the margin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot {
    pub(crate) page: usize,
    pub(crate) turn: Turn,
    pub(crate) corner: Point,
}

/// The cells of a page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Width and height inside the margins, in texels.
    pub(crate) inner: Point,
    /// In texels.
    pub(crate) margin: f64,
    /// How far the pieces may be from their outlines, in texels: those have fewer points.
    pub(crate) slack: f64,
    /// The side of a cell in texels.
    pub(crate) cell: f64,
}

/// The masks of all pieces in all their poses at one scale, made when they are asked for.
#[derive(Debug)]
pub(crate) struct Masks<'a> {
    grid: Grid,
    shapes: &'a [Shape],
    poses: &'a [Vec<Pose>],
    /// In texels per unit.
    scale: f64,
    made: Vec<Vec<OnceLock<Mask>>>,
}

impl Grid {
    /// How far from its outline a piece keeps others, in cells.
    fn reach(&self) -> f64 {
        (self.margin + self.slack) / self.cell
    }
}

impl<'a> Masks<'a> {
    pub(crate) fn new(grid: Grid, shapes: &'a [Shape], poses: &'a [Vec<Pose>], scale: f64) -> Self {
        let made = poses.iter().map(|poses| poses.iter().map(|_| OnceLock::new()).collect()).collect();
        Self { grid, shapes, poses, scale, made }
    }

    fn get(&self, piece: usize, pose: usize) -> &Mask {
        self.made[piece][pose].get_or_init(|| Mask::new(&self.shapes[piece], self.lie(piece, pose), self.grid.reach()))
    }

    /// The cells that a piece itself touches.
    fn thin(&self, piece: usize, pose: usize) -> Bits {
        Bits::within(&self.shapes[piece], self.lie(piece, pose), self.grid.slack / self.grid.cell)
    }

    fn lie(&self, piece: usize, pose: usize) -> Lie {
        let Pose { turn, low, size } = self.poses[piece][pose];
        Lie { turn, low, size, scale: self.scale / self.grid.cell }
    }

    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Puts pieces in this order onto at most `pages` pages. An error is the place in the order of the piece that does
    /// not fit.
    pub(crate) fn place(
        &self,
        order: &[usize],
        criterion: Criterion,
        pages: usize,
    ) -> Result<Vec<(usize, Slot)>, usize> {
        let Grid { inner, cell, .. } = self.grid;
        let mut taken: Vec<Page> = Vec::new();
        let mut slots = Vec::with_capacity(order.len());
        for (at, &piece) in order.iter().enumerate() {
            let slot = (0..pages).find_map(|number| {
                if number == taken.len() {
                    taken.push(Page::new(inner.map(|side| side / cell), self.grid.reach()));
                }
                let page = &mut taken[number];
                let mut best = None;
                for pose in 0..self.poses[piece].len() {
                    let limit = best.map(|(_, spot): (usize, crate::page::Spot)| spot.cost);
                    if let Some(spot) = page.best(self.get(piece, pose), criterion, limit) {
                        best = Some((pose, spot));
                    }
                }
                let (pose, spot) = best?;
                page.take(&self.thin(piece, pose), spot.x, spot.y);
                let corner = [f64::from(spot.x) * cell, f64::from(spot.y) * cell];
                Some(Slot { page: number, turn: self.poses[piece][pose].turn, corner })
            });
            let slot = slot.ok_or(at)?;
            slots.push((piece, slot));
        }
        Ok(slots)
    }
}
