//! What became of the islands that a file has.

use super::atlas::Narrow;
use super::figure;
use abf::{Atlas, Repacked as Packed};
use serde::{Deserialize, Serialize};

/// UV islands that were laid out anew.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Repacked {
    /// How many islands there are.
    pub(crate) islands: usize,
    /// How many of them lie over others, and stay together with them.
    pub(crate) overlapping: usize,
    /// How many were laid upon one of their shape.
    pub(crate) stacked: usize,
    /// How many pieces were packed.
    pub(crate) pieces: usize,
    /// How many unit squares they are in.
    pub(crate) pages: usize,
    /// Texels of a page along x and y.
    pub(crate) page: [u32; 2],
    /// Texels between islands.
    pub(crate) margin: u32,
    /// Texels per unit of the UVs as they were.
    #[serde(with = "figure")]
    pub(crate) texels_per_unit: f64,
    /// The part of the pages that islands cover.
    #[serde(with = "figure")]
    pub(crate) coverage: f64,
    /// Where islands come nearer to themselves than the margin.
    pub(crate) narrow: Narrow,
    /// The page of every island, in the order of their first faces.
    pub(crate) page_of_island: Vec<usize>,
}

impl Repacked {
    pub(crate) fn new(packed: &Packed, atlas: &Atlas) -> Self {
        Self {
            islands: packed.islands,
            overlapping: packed.overlapping,
            stacked: packed.stacked_on.iter().flatten().count(),
            pieces: packed.pieces,
            pages: packed.pages,
            page: atlas.page,
            margin: atlas.margin,
            texels_per_unit: packed.texels_per_unit,
            coverage: packed.coverage,
            narrow: Narrow::new(&packed.narrow),
            page_of_island: packed.placements.iter().map(|placed| placed.page).collect(),
        }
    }
}
