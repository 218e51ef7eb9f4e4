//! Many layouts, and the largest scale among them.

use crate::boxes::{self, Rectangle};
use crate::geometry::{Point, UNTURNED, compose, extent, wheel};
use crate::grid::{Grid, Masks, Pose, Slot};
use crate::settings::Effort;
use crate::shape::Shape;
use crate::stage::{Attempt, Order, Stage};
use abf_parallel::prelude::*;
use std::borrow::Cow;
use std::cmp::Reverse;

/// What is packed onto what.
#[derive(Debug)]
pub(crate) struct Job {
    pub(crate) shapes: Vec<Shape>,
    /// Whether a piece keeps its angle.
    pub(crate) fixed: Vec<bool>,
    /// The pieces of every group.
    pub(crate) groups: Vec<Vec<usize>>,
    /// How many pages a group may have.
    pub(crate) pages: usize,
    /// Width and height inside the margins, in texels.
    pub(crate) inner: Point,
    /// In texels.
    pub(crate) margin: f64,
    /// In its tightest box, lying on the longer side.
    pub(crate) boxes: Vec<Pose>,
    /// At the angle at which it fits at the largest scale, and that scale; or in its box, where that is far larger than its
    /// group can be.
    pub(crate) largest: Vec<(Pose, f64)>,
}

/// All pieces at one scale, in the order of the pieces.
pub(crate) type Layout = Vec<Slot>;

/// A piece that could be this many times as large alone does not decide by itself.
pub(crate) const DECIDES: f64 = 1.6;
/// Pieces that count as large: those of the largest area.
const LARGE: usize = 64;
/// Bisections between a scale at which boxes fit and twice that: to four digits.
pub(crate) const BISECTIONS: usize = 13;
/// By how much an attempt must beat the best one before it.
const GAIN: f64 = 1.002;
/// A bound this many times the best scale is tried at once where few layouts may be made.
const NEAR: f64 = 1.1;
/// Where few layouts may be made, each is tried so far from the best scale to the one that is too large, as logarithms: the
/// first nearly always fits.
const STEP: f64 = 0.25;
/// Attempts that are made side by side, on as many threads as there are. It decides what is tried, so it is not the number
/// of threads.
const SIDE_BY_SIDE: usize = 4;

impl Job {
    /// No scale above it fits: by the area of each group, and by each piece alone.
    pub(crate) fn bound(&self) -> f64 {
        let room = self.inner[0] * self.inner[1] * self.pages as f64;
        let area = |group: &Vec<usize>| group.iter().map(|&i| self.shapes[i].area).sum::<f64>();
        let by_area = self.groups.iter().map(|group| (room / area(group)).sqrt()).fold(f64::INFINITY, f64::min);
        let bound = self.largest.iter().map(|&(_, scale)| scale).fold(by_area, f64::min);
        // Points and segments of no length fit at any scale.
        if bound.is_finite() { bound } else { 1.0 }
    }

    /// The largest scale that is found, and its layout. `None`: not even points fit.
    pub(crate) fn largest_scale(&self, effort: Effort) -> Option<(f64, Layout)> {
        let bound = self.bound();
        let stages = Stage::of(effort, self.shapes.len());
        let put_off = stages[0].limit.map_or(0, |limit| limit.put_off);
        let (mut best, too_large) = self.largest_boxes(bound, BISECTIONS - put_off)?;
        for stage in stages {
            if best.0 * GAIN < bound {
                self.improve(stage, bound, &mut best);
            }
            if best.0 < too_large {
                self.bisect_boxes(put_off, &mut best, too_large);
            }
            if best.0 < bound && best.0 * GAIN >= bound {
                // So little is left that the bound itself is tried.
                best = self.by_any_attempt(stage, bound).map_or(best, |layout| (bound, layout));
            }
        }
        Some(best)
    }

    /// A layout at this scale, if one is found.
    pub(crate) fn at_scale(&self, scale: f64, effort: Effort) -> Option<Layout> {
        if scale > self.bound() {
            return None;
        }
        if let Some(layout) = self.boxes_at(scale) {
            return Some(layout);
        }
        Stage::of(effort, self.shapes.len()).into_iter().find_map(|stage| self.by_any_attempt(stage, scale))
    }

    /// A layout at this scale by the first attempt of a stage that finds one.
    fn by_any_attempt(&self, stage: Stage, scale: f64) -> Option<Layout> {
        let (poses, shapes) = (self.poses(stage, scale), self.outlines(stage, scale));
        let masks = Masks::new(self.grid(stage), &shapes, &poses, scale);
        let attempts = &Attempt::all(stage.repairs)[..stage.attempts];
        attempts.chunks(SIDE_BY_SIDE).find_map(|some| {
            let found: Vec<_> = some.par_iter().map(|&attempt| self.cells_at(&masks, attempt)).collect();
            found.into_iter().flatten().next()
        })
    }

    /// By boxes, and a scale at which they do not fit, or the bound.
    pub(crate) fn largest_boxes(&self, bound: f64, bisections: usize) -> Option<((f64, Layout), f64)> {
        /// Halvings after which what does not fit never will: all pieces are points by then.
        const HALVINGS: i32 = 60;
        if let Some(layout) = self.boxes_at(bound) {
            return Some(((bound, layout), bound));
        }
        let scales = (1..=HALVINGS).map(|k| bound * 0.5_f64.powi(k));
        let mut best = scales.into_iter().find_map(|scale| Some((scale, self.boxes_at(scale)?)))?;
        let too_large = 2.0 * best.0;
        let too_large = self.bisect_boxes(bisections, &mut best, too_large);
        Some((best, too_large))
    }

    /// Larger boxes below a scale at which they do not fit, and the least scale found at which they do not.
    fn bisect_boxes(&self, bisections: usize, best: &mut (f64, Layout), mut too_large: f64) -> f64 {
        for _ in 0..bisections {
            let scale = f64::midpoint(best.0, too_large);
            match self.boxes_at(scale) {
                Some(layout) => *best = (scale, layout),
                None => too_large = scale,
            }
        }
        too_large
    }

    fn boxes_at(&self, scale: f64) -> Option<Layout> {
        let mut slots = vec![Slot { page: 0, turn: UNTURNED, corner: [0.0; 2] }; self.shapes.len()];
        for group in &self.groups {
            if self.put_single(group, scale, &mut slots)? {
                continue;
            }
            let size = |i: usize| self.boxes[i].size.map(|length| length * scale + self.margin);
            let sizes: Vec<Rectangle> =
                group.iter().map(|&i| Rectangle { size: size(i), turns: !self.fixed[i] }).collect();
            let spots = boxes::place(&sizes, self.inner.map(|side| side + self.margin), self.pages)?;
            for (&i, spot) in group.iter().zip(spots) {
                let turn = self.boxes[i].turn;
                let turn = if spot.on_its_side { compose(turn, [0.0, 1.0]) } else { turn };
                slots[i] = Slot { page: spot.page, turn, corner: spot.corner };
            }
        }
        Some(slots)
    }

    /// Puts the piece of a group of one at the angle that lets it be largest. `None`: it does not fit. False: there are more.
    fn put_single(&self, group: &[usize], scale: f64, slots: &mut [Slot]) -> Option<bool> {
        let &[i] = group else { return Some(false) };
        let (pose, largest) = self.largest[i];
        (scale <= largest).then(|| slots[i] = Slot { page: 0, turn: pose.turn, corner: [0.0; 2] })?;
        Some(true)
    }

    fn improve(&self, stage: Stage, bound: f64, best: &mut (f64, Layout)) {
        let (poses, shapes) = (self.poses(stage, bound), self.outlines(stage, bound));
        let masks = |scale: f64| Masks::new(self.grid(stage), &shapes, &poses, scale);
        let attempts = &Attempt::all(stage.repairs)[..stage.attempts];
        // The first attempt finds out how large pieces can be.
        let mut too_large = bound * (1.0 + stage.tolerance);
        let mut layouts = 0;
        while too_large > best.0 * (1.0 + stage.tolerance) && stage.limit.is_none_or(|limit| layouts < limit.layouts) {
            let scale = match stage.limit {
                // Where the bound is near it is likely to be reached.
                Some(_) if layouts == 0 && bound < NEAR * best.0 => bound,
                Some(_) => (best.0 * (too_large / best.0).powf(STEP)).min(bound),
                None => (best.0 * too_large).sqrt().min(bound),
            };
            layouts += 1;
            match self.cells_at(&masks(scale), attempts[0]) {
                Some(layout) => *best = (scale, layout),
                None => too_large = scale,
            }
        }
        // The others each have to beat it. One that does goes on as far as it can.
        let mut waiting: Vec<Attempt> = attempts[1..].to_vec();
        while !waiting.is_empty() && best.0 * GAIN <= bound {
            let scale = best.0 * GAIN;
            let shared = masks(scale);
            let mut gained = false;
            while !waiting.is_empty() && !gained {
                let some = waiting.len().min(SIDE_BY_SIDE);
                let mut tried: Vec<(Attempt, Option<Layout>)> =
                    waiting[..some].par_iter().map(|&attempt| (attempt, self.cells_at(&shared, attempt))).collect();
                let winner = tried.iter().position(|(_, layout)| layout.is_some());
                if let Some(winner) = winner {
                    let (attempt, layout) = tried.swap_remove(winner);
                    *best = (scale, layout.unwrap_or_default());
                    self.climb(attempt, stage, &masks, bound, best);
                    gained = true;
                }
                // What did not fit is done with; what did has to beat the new best.
                let again: Vec<Attempt> = waiting[..some]
                    .iter()
                    .enumerate()
                    .filter(|&(i, _)| Some(i) != winner)
                    .filter(|(_, attempt)| tried.iter().any(|(a, layout)| a.is(attempt) && layout.is_some()))
                    .map(|(_, &attempt)| attempt)
                    .collect();
                waiting.splice(..some, again);
            }
        }
    }

    /// Larger and larger steps while the pieces fit, then smaller ones.
    fn climb<'a>(
        &'a self,
        attempt: Attempt,
        stage: Stage,
        masks: &impl Fn(f64) -> Masks<'a>,
        bound: f64,
        best: &mut (f64, Layout),
    ) {
        let mut step = stage.tolerance;
        let mut grows = true;
        while step >= stage.tolerance {
            let scale = best.0 * (1.0 + step);
            let found = if scale <= bound { self.cells_at(&masks(scale), attempt) } else { None };
            match found {
                Some(layout) => *best = (scale, layout),
                None => grows = false,
            }
            step *= if grows { 2.0 } else { 0.5 };
        }
    }

    fn cells_at(&self, masks: &Masks<'_>, attempt: Attempt) -> Option<Layout> {
        let mut slots = vec![Slot { page: 0, turn: UNTURNED, corner: [0.0; 2] }; self.shapes.len()];
        for group in &self.groups {
            if self.put_single(group, masks.scale(), &mut slots)? {
                continue;
            }
            let mut order = self.sorted(group, attempt.order);
            let mut repairs = 0;
            let found = loop {
                match masks.place(&order, attempt.criterion, self.pages) {
                    Ok(found) => break found,
                    Err(at) if repairs < attempt.repairs && at > 0 => order[at / 2..=at].rotate_right(1),
                    Err(_) => return None,
                }
                repairs += 1;
            };
            for (i, slot) in found {
                slots[i] = slot;
            }
        }
        Some(slots)
    }

    fn sorted(&self, group: &[usize], order: Order) -> Vec<usize> {
        let value = |&i: &usize| {
            let [w, h] = self.boxes[i].size;
            match order {
                Order::HalfPerimeter => w + h,
                Order::Area => self.shapes[i].area,
                Order::LongestSide => w.max(h),
            }
        };
        let mut sorted = group.to_vec();
        // None is negative or NaN, so that their bits are in their order.
        sorted.sort_by_cached_key(|i| (Reverse(value(i).to_bits()), *i));
        sorted
    }

    fn grid(&self, stage: Stage) -> Grid {
        let cell = self.inner[0].max(self.inner[1]) / f64::from(stage.cells);
        Grid { inner: self.inner, margin: self.margin, slack: stage.slack * cell, cell }
    }

    /// The pieces with outlines that are as near to them as the stage asks, up to this scale.
    fn outlines(&self, stage: Stage, scale: f64) -> Cow<'_, [Shape]> {
        let within = self.grid(stage).slack / scale;
        if within > 0.0 {
            Cow::Owned(self.shapes.par_iter().map(|shape| shape.simplified(within)).collect())
        } else {
            Cow::Borrowed(&self.shapes)
        }
    }

    /// The angles that are tried of every piece: from its tightest box on, and, for one that takes much of the page, from the
    /// angle at which it can be largest.
    fn poses(&self, stage: Stage, bound: f64) -> Vec<Vec<Pose>> {
        let mut by_area: Vec<usize> = (0..self.shapes.len()).collect();
        by_area.sort_by_cached_key(|&i| (Reverse(self.shapes[i].area.to_bits()), i));
        let mut is_large = vec![false; self.shapes.len()];
        by_area.iter().take(LARGE).for_each(|&i| is_large[i] = true);
        let wheels = stage.angles.map(wheel);
        let of = |i: usize| {
            let base = self.boxes[i];
            if self.fixed[i] {
                return vec![base];
            }
            let wheel = &wheels[usize::from(!is_large[i])];
            let mut turns: Vec<_> = wheel.iter().map(|&turn| compose(base.turn, turn)).collect();
            let (pose, scale) = self.largest[i];
            if is_large[i] && scale < DECIDES * bound {
                turns.extend(super::geometry::wheel(4).into_iter().map(|turn| compose(pose.turn, turn)));
            }
            turns.into_iter().map(|turn| Pose::new(&self.shapes[i], turn)).collect()
        };
        (0..self.shapes.len()).into_par_iter().map(of).collect()
    }
}

impl Pose {
    pub(crate) fn new(shape: &Shape, turn: [f64; 2]) -> Self {
        let (low, size) = extent(shape.points(), turn);
        Self { turn, low, size }
    }
}
