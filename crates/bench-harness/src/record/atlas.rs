//! What became of a mesh that was cut into charts.

use super::figure::{self, known};
use super::text;
use abf::{Placement, Termination, UnwrappedChart};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Rounding is no reason to miss an aim.
const WITHIN: f64 = 1.0 + 1e-9;

/// The charts of a mesh and their atlas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Atlas {
    /// Each chart.
    pub(crate) charts: Vec<Charted>,
    /// How many unit squares they are in.
    pub(crate) pages: usize,
    /// Texels along a side of a page.
    pub(crate) resolution: u32,
    /// Texels between charts.
    pub(crate) margin: u32,
    /// Texels per unit of the mesh, the same in all charts.
    #[serde(with = "figure")]
    pub(crate) texels_per_unit: f64,
    /// The part of the pages that charts cover.
    #[serde(with = "figure")]
    pub(crate) coverage: f64,
    /// How many edges are seams.
    pub(crate) seam_edges: usize,
    /// Their length.
    #[serde(with = "figure")]
    pub(crate) seam_length: f64,
    /// The diagonal of the bounding box, to compare that with.
    #[serde(with = "figure")]
    pub(crate) diagonal: f64,
    /// The L² stretch aimed at.
    pub(crate) max_stretch: f64,
    /// Whether every chart has to be within it: not where the length of seams is limited.
    #[serde(rename = "max_stretch_binds")]
    pub(crate) is_bound: bool,
    /// What was repaired, in words.
    pub(crate) repairs: Vec<String>,
}

/// One chart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Charted {
    /// The component it is of, counted from 0.
    pub(crate) component: usize,
    /// Its page, counted from 0.
    pub(crate) page: usize,
    /// How many triangles it has.
    pub(crate) triangles: usize,
    /// Whose result it is.
    pub(crate) solved_by: String,
    /// How the solver ended.
    #[serde(with = "text::ending")]
    pub(crate) termination: Termination,
    /// No triangle flipped, none collapsed, no vertex wound around.
    pub(crate) valid: bool,
    /// Valid, and no overlap.
    pub(crate) injective: bool,
    /// `F / 3nt`.
    #[serde(with = "figure")]
    pub(crate) f: f64,
    /// L² stretch.
    #[serde(with = "figure")]
    pub(crate) stretch_l2: f64,
    /// Whether there was no time to finish it: its last valid map.
    pub(crate) unfinished: bool,
    /// The length of its seams.
    #[serde(with = "figure")]
    pub(crate) seam_length: f64,
    /// Flattenings it took to find its seams.
    pub(crate) rounds: usize,
    /// Holes that were closed while it was flattened.
    pub(crate) holes_filled: usize,
    /// The largest difference between an angle of the UVs and the one solved for, rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) layout_error: Option<f64>,
}

impl Charted {
    pub(crate) fn new(chart: &UnwrappedChart, placement: &Placement) -> Self {
        Self {
            component: chart.component,
            page: placement.page,
            triangles: chart.faces.len(),
            solved_by: chart.solver.to_string(),
            termination: chart.termination,
            valid: chart.metrics.valid(),
            injective: chart.metrics.injective(),
            f: known(chart.metrics.f),
            stretch_l2: known(chart.metrics.stretch_l2),
            unfinished: chart.unfinished,
            seam_length: chart.seam_length,
            rounds: chart.rounds,
            holes_filled: chart.holes_filled,
            layout_error: chart.layout_error.filter(|error| error.is_finite()),
        }
    }
}

impl Atlas {
    /// How the charts ended: as the first that did not end as asked, else as the first.
    pub(crate) fn termination(&self) -> Option<Termination> {
        let all = || self.charts.iter().map(|chart| chart.termination);
        all().find(|end| !end.is_as_asked()).or_else(|| all().next())
    }

    /// Whether every chart is finished, lies nowhere over itself and is within the aim, where seams may be as long as that
    /// takes.
    pub(crate) fn is_as_asked(&self) -> bool {
        let is_within = |chart: &Charted| !self.is_bound || !(chart.stretch_l2 > self.max_stretch * WITHIN);
        self.charts.iter().all(|chart| chart.injective && !chart.unfinished && is_within(chart))
    }

    /// How many holes were closed: parts of a component have the same.
    pub(crate) fn holes_filled(&self) -> usize {
        let by_component: BTreeMap<usize, usize> =
            self.charts.iter().map(|chart| (chart.component, chart.holes_filled)).collect();
        by_component.values().sum()
    }
}
