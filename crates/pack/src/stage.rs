//! How layouts are tried: on which cells, at which angles, how many, in which order.

use crate::page::Criterion;
use crate::settings::Effort;

/// One round of attempts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stage {
    /// Cells along the longer side of a page.
    pub(crate) cells: u32,
    /// Angles of a large piece, and of the others.
    pub(crate) angles: [usize; 2],
    /// How many attempts there are.
    pub(crate) attempts: usize,
    /// [`Attempt::repairs`].
    pub(crate) repairs: usize,
    /// The step of the scale that is not worth another layout.
    pub(crate) tolerance: f64,
    /// How far a piece may be from its outline, in cells: the more, the fewer points that has.
    pub(crate) slack: f64,
    /// The layouts that may be made, where there is a limit.
    pub(crate) limit: Option<Limit>,
}

/// How few layouts do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    pub(crate) layouts: usize,
    /// Bisections of the scale at which boxes fit that are put off until no layout was found.
    pub(crate) put_off: usize,
}

/// What comes first, and where it is put.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    pub(crate) order: Order,
    pub(crate) criterion: Criterion,
    /// How often a piece that found no place comes earlier in the order, half as late as it was.
    pub(crate) repairs: usize,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Order {
    HalfPerimeter,
    Area,
    LongestSide,
}

impl Stage {
    pub(crate) fn of(effort: Effort, pieces: usize) -> Vec<Self> {
        // What a layout costs grows with the pieces: fewer are made of many.
        let (angles, attempts, repairs) = match pieces {
            0..12 => ([32, 16], 15, 6),
            12..30 => ([32, 16], 15, 3),
            30..120 => ([16, 8], 15, 3),
            120..400 => ([16, 8], 15, 0),
            400..2_000 => ([16, 8], 5, 1),
            2_000..8_000 => ([8, 2], 2, 0),
            _ => ([2, 1], 1, 0),
        };
        let [large, small] = angles;
        // Milliseconds: where there are many pieces, the angle of each matters less.
        let (cells, most) = match pieces {
            0..12 => (256, 4),
            12..400 => (192, 2),
            _ => (256, 1),
        };
        let limit = match pieces {
            0..12 => None,
            12..400 => Some(Limit { layouts: 3, put_off: 0 }),
            _ => Some(Limit { layouts: 1, put_off: 10 }),
        };
        let angles_of_few = angles.map(|n| n.min(most));
        let fast = Self { cells, angles: angles_of_few, attempts: 1, repairs: 0, tolerance: 0.02, slack: 0.05, limit };
        let good = Self { cells: 512, angles, attempts, repairs, tolerance: 0.004, slack: 0.0, limit: None };
        let fine = Self { angles: [large.max(64), small.max(16)], ..good };
        match effort {
            Effort::Fast => vec![fast],
            Effort::Good => vec![good],
            Effort::Best => vec![good, fine, Self { cells: 1024, ..fine }],
        }
    }
}

impl Attempt {
    /// All of them: those that are best most often first.
    pub(crate) fn all(repairs: usize) -> Vec<Self> {
        let criteria = [Criterion::Top, Criterion::Bottom, Criterion::Square, Criterion::Corner, Criterion::Middle];
        let orders = [Order::HalfPerimeter, Order::Area, Order::LongestSide];
        let of = |criterion| orders.map(|order| Self { order, criterion, repairs });
        criteria.into_iter().flat_map(of).collect()
    }

    pub(crate) fn is(&self, other: &Self) -> bool {
        self.criterion == other.criterion && std::mem::discriminant(&self.order) == std::mem::discriminant(&other.order)
    }
}
