//! What became of a mesh that was cut into charts.

use super::figure::{self, known};
use super::run::Solved;
use super::settings::written;
use super::times::Stages;
use abf::{NarrowPlace, Pipeline, Placement, Unwrap, UnwrappedChart};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Deref;

/// Rounding is no reason to miss an aim.
const WITHIN: f64 = 1.0 + 1e-9;

/// The charts of a mesh and their atlas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Atlas {
    /// What was asked of seams, holes and the packing.
    pub(crate) settings: ChartSettings,
    /// Each chart.
    pub(crate) charts: Vec<Charted>,
    /// How many unit squares they are in.
    pub(crate) pages: usize,
    /// Texels of a page along x and y; nothing on a sheet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) page: Option<[u32; 2]>,
    /// Texels between charts; nothing on a sheet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) margin: Option<u32>,
    /// Texels per unit of the mesh, the same in all charts but those with a scale; nothing on a sheet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) texels_per_unit: Option<f64>,
    /// Width and height of the sheet, in units of the mesh, if charts lie on one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) sheet: Option<[f64; 2]>,
    /// The part of the pages that charts cover.
    #[serde(with = "figure")]
    pub(crate) coverage: f64,
    /// Where charts come nearer to themselves than the margin.
    #[serde(default)]
    pub(crate) narrow: Narrow,
    /// How many charts are less than a texel wide.
    #[serde(default)]
    pub(crate) under_a_texel: usize,
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
    /// Whether charts may lie over themselves.
    #[serde(rename = "overlap_allowed", default)]
    pub(crate) may_overlap: bool,
    /// What was repaired, in words.
    pub(crate) repairs: Vec<String>,
}

/// The settings of charts, in the forms in which they write and read themselves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ChartSettings {
    /// Those of [`Unwrap`]; its pipeline is the run's.
    pub(crate) unwrap: Map<String, Value>,
    /// Those of [`abf::Atlas`].
    pub(crate) packing: Map<String, Value>,
}

impl ChartSettings {
    /// What was asked.
    pub(crate) fn new(unwrap: &Unwrap, packing: &abf::Atlas) -> Self {
        let mut unwrap = written(unwrap);
        unwrap.remove("pipeline");
        Self { unwrap, packing: written(packing) }
    }

    /// Whether disks were cut like all else.
    pub(crate) fn cuts_disks(&self) -> bool {
        self.unwrap.get("cut_disks") == Some(&Value::Bool(true))
    }
}

/// Places where charts come nearer to themselves than the margin.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Narrow {
    /// How many.
    pub(crate) places: usize,
    /// In how many charts.
    pub(crate) charts: usize,
    /// How wide the narrowest is, in texels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) least: Option<f64>,
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
    /// What the solver and the layout did.
    #[serde(flatten)]
    pub(crate) solved: Solved,
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
    /// Its size on the page as a part of that of the others.
    #[serde(default = "whole")]
    pub(crate) scale: f64,
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
    /// Where the time of its piece went, every time that was flattened; absent in older documents.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) timings_s: Option<Stages>,
}

/// The scale in older documents.
fn whole() -> f64 {
    1.0
}

impl Deref for Charted {
    type Target = Solved;

    fn deref(&self) -> &Solved {
        &self.solved
    }
}

impl Narrow {
    pub(crate) fn new(places: &[NarrowPlace]) -> Self {
        let charts: BTreeSet<usize> = places.iter().map(|place| place.chart).collect();
        let least = places.iter().map(|place| place.texels).min_by(f64::total_cmp);
        Self { places: places.len(), charts: charts.len(), least }
    }
}

impl Charted {
    pub(crate) fn new(
        pipeline: &Pipeline,
        chart: &UnwrappedChart,
        (placement, scale): (&Placement, f64),
        took: Stages,
    ) -> Self {
        Self {
            component: chart.component,
            page: placement.page,
            triangles: chart.faces.len(),
            solved: Solved::of_chart(pipeline, chart),
            valid: chart.metrics.valid(),
            injective: chart.metrics.injective(),
            f: known(chart.metrics.f),
            stretch_l2: known(chart.metrics.stretch_l2),
            scale,
            unfinished: chart.unfinished,
            seam_length: chart.seam_length,
            rounds: chart.rounds,
            holes_filled: chart.holes_filled,
            layout_error: chart.layout_error.filter(|error| error.is_finite()),
            timings_s: Some(took),
        }
    }
}

impl Atlas {
    /// Whether every chart is finished, lies nowhere over itself unless that is allowed, and is within the aim, where seams
    /// may be as long as that takes.
    pub(crate) fn is_as_asked(&self) -> bool {
        let is_within = |chart: &Charted| !self.is_bound || !(chart.stretch_l2 > self.max_stretch * WITHIN);
        let is_apart = |chart: &Charted| chart.injective || self.may_overlap;
        self.charts.iter().all(|chart| is_apart(chart) && !chart.unfinished && is_within(chart))
    }

    /// How many holes were closed: parts of a component have the same.
    pub(crate) fn holes_filled(&self) -> usize {
        let by_component: BTreeMap<usize, usize> =
            self.charts.iter().map(|chart| (chart.component, chart.holes_filled)).collect();
        by_component.values().sum()
    }
}
