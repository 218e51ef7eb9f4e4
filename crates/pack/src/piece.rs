//! What is packed, and where it is put.

use crate::geometry::{Hull, turned};

/// What stays together: one polygon with holes, or several that may overlap.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Piece {
    /// The polygons. Each is a list of closed loops, the outer one and those of its holes, in any order and direction; a
    /// point is inside if it is inside an odd number of them. The piece is everything inside any of its polygons.
    pub polygons: Vec<Vec<Vec<[f64; 2]>>>,
    /// Pieces of different groups share no page.
    pub group: usize,
    /// Whether it must be put as it is, without a turn.
    pub keeps_its_angle: bool,
}

impl Piece {
    /// One polygon: an outer loop, and those of its holes.
    #[must_use]
    pub fn new(loops: Vec<Vec<[f64; 2]>>) -> Self {
        Self { polygons: vec![loops], ..Self::default() }
    }

    /// The width of the narrowest strip that it fits into.
    #[must_use]
    pub fn width(&self) -> f64 {
        Hull::of(&self.points().collect::<Vec<_>>()).width()
    }

    pub(crate) fn points(&self) -> impl Iterator<Item = [f64; 2]> {
        self.polygons.iter().flatten().flatten().copied()
    }
}

/// Where a piece is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Its page, counted from 0 over all groups.
    pub page: usize,
    /// The cosine and the sine of the angle that it is turned by.
    pub turn: [f64; 2],
    /// The lower left corner of its box after that, in units of the input.
    pub low: [f64; 2],
    /// Where this corner is put, in texels.
    pub corner: [f64; 2],
}

impl Placement {
    /// Where a point of the piece is put, in texels of the page.
    #[must_use]
    pub fn texel(&self, p: [f64; 2], texels_per_unit: f64) -> [f64; 2] {
        let [x, y] = turned(p, self.turn);
        [(x - self.low[0]) * texels_per_unit + self.corner[0], (y - self.low[1]) * texels_per_unit + self.corner[1]]
    }
}

/// Pieces on pages.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Packing {
    /// The scale, the same for all pieces.
    pub texels_per_unit: f64,
    /// One for every piece, in their order.
    pub placements: Vec<Placement>,
    /// How many pages there are.
    pub pages: usize,
    /// The part of the pages that pieces cover, by the areas of their loops. Of a piece of several polygons, what lies in
    /// several counts once, within a thousandth.
    pub coverage: f64,
}

impl Packing {
    /// Where a point of a piece is put, in texels of its page.
    ///
    /// # Panics
    /// Without such a piece.
    #[must_use]
    pub fn texel(&self, piece: usize, p: [f64; 2]) -> [f64; 2] {
        self.placements[piece].texel(p, self.texels_per_unit)
    }
}
