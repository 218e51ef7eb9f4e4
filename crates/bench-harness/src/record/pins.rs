//! What became of pins.

use super::figure::{self, known};
use super::text;
use abf::embed::PinResidual;
use abf::{Energy, PinReport};
use serde::{Deserialize, Serialize};

/// What became of pins: see [`abf::PinReport`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pinned {
    /// Which energy moved the other vertices.
    #[serde(with = "text")]
    pub(crate) energy: Energy,
    /// What it is at the end.
    #[serde(with = "figure")]
    pub(crate) after: f64,
    /// How many steps it took.
    pub(crate) steps: usize,
    /// How many hard pins are not in their places.
    pub(crate) missed: usize,
    /// Of every pin how far it is from its place, UV units.
    pub(crate) residuals: Vec<PinDistance>,
}

/// How far a pin is from its place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PinDistance {
    /// Which vertex.
    pub(crate) vertex: u32,
    /// Whether it was to be met exactly.
    pub(crate) hard: bool,
    /// In units of the UVs.
    #[serde(with = "figure")]
    pub(crate) distance: f64,
}

impl Pinned {
    pub(super) fn new(report: &PinReport) -> Self {
        let distance =
            |pin: &PinResidual| PinDistance { vertex: pin.vertex, hard: pin.is_hard, distance: known(pin.distance) };
        Self {
            energy: report.energy,
            after: known(report.after),
            steps: report.steps,
            missed: report.residuals.iter().filter(|pin| pin.is_missed()).count(),
            residuals: report.residuals.iter().map(distance).collect(),
        }
    }
}
