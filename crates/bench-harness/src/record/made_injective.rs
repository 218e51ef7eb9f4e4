//! What was done about overlaps.

use super::text;
use crate::record::failure::chain;
use abf::{Energy, Injective, InjectiveReport};
use serde::{Deserialize, Serialize};

/// What was done about a map that lay over itself: see [`abf::InjectiveReport`]. Of several charts the largest energies, the
/// smallest gap, and all steps, parts and overlaps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MadeInjective {
    /// By which rule.
    #[serde(with = "text")]
    pub(crate) rule: Injective,
    /// How many overlaps there were.
    pub(crate) overlaps: usize,
    /// Which energy was least at the end.
    #[serde(with = "text::optional")]
    pub(crate) energy: Option<Energy>,
    /// What it was before.
    pub(crate) before: Option<f64>,
    /// What it is at the end.
    pub(crate) after: Option<f64>,
    /// How many steps it took.
    pub(crate) steps: usize,
    /// How many of these went for lengths first.
    pub(crate) first_steps: usize,
    /// The smallest distance of parts of the boundary, UV units.
    pub(crate) gap: Option<f64>,
    /// In how many parts the map is.
    pub(crate) parts: usize,
    /// Why the map is as it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<String>,
}

impl MadeInjective {
    pub(super) fn new(report: &InjectiveReport) -> Self {
        Self {
            rule: report.rule,
            overlaps: report.overlaps,
            energy: report.energy,
            before: report.before,
            after: report.after,
            steps: report.steps,
            first_steps: report.first_steps,
            gap: report.gap,
            parts: report.parts,
            error: report.error.as_ref().map(|error| chain(error)),
        }
    }

    pub(super) fn and(self, other: Self) -> Self {
        let both = |one: Option<f64>, other: Option<f64>, of: fn(f64, f64) -> f64| match (one, other) {
            (Some(one), Some(other)) => Some(of(one, other)),
            (one, other) => one.or(other),
        };
        Self {
            rule: self.rule,
            overlaps: self.overlaps + other.overlaps,
            energy: self.energy.or(other.energy),
            before: both(self.before, other.before, f64::max),
            after: both(self.after, other.after, f64::max),
            steps: self.steps + other.steps,
            first_steps: self.first_steps + other.first_steps,
            gap: both(self.gap, other.gap, f64::min),
            parts: self.parts + other.parts,
            error: self.error.or(other.error),
        }
    }
}
