//! Charts in two, where that lets an atlas cover more, or keeps the margin inside of a chart.

mod corners;
mod cut;
mod split;

use super::{Atlas, AtlasError, Packed, Stored, outline_of};
use crate::unwrap::{Unwrapped, UnwrappedChart};
use abf_control::SettingError;
use abf_mesh::TriMesh;
use abf_pack::{Effort, PackSettings, Piece, pack};
use abf_parallel::prelude::*;
use cut::{Cut, Sheet};
use split::Splitter;

/// Why charts are parted when they are packed, and what that may cost.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Parting {
    /// The part of the pages that charts are to cover, in (0, 1]. Without it no chart is parted for that.
    pub coverage: Option<f64>,
    /// By which part the seams may grow for coverage, at least 0. Without a seam, the half of the boundary counts as one.
    pub seam_budget: f64,
    /// Whether charts are parted where they come nearer to themselves than the margin.
    pub keeps_inner_margin: bool,
    /// A chart stays whole where a part would have more L² stretch than the chart and this.
    pub max_stretch: f64,
}

impl Default for Parting {
    fn default() -> Self {
        Self { coverage: None, seam_budget: 0.25, keeps_inner_margin: false, max_stretch: f64::INFINITY }
    }
}

/// Charts that were parted, and their atlas.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Parted {
    /// The charts, parts in the place of those that were parted. Parts keep their UVs.
    pub unwrapped: Unwrapped,
    /// Where they are.
    pub packed: Packed,
    /// Cuts that were made for coverage.
    pub for_coverage: usize,
    /// Cuts that were made for the margin inside of charts.
    pub for_margin: usize,
    /// Whether it was ended before there was nothing more to cut.
    pub is_unfinished: bool,
}

/// Cuts of one chart that are tried in full, the most promising first.
const TRIES: usize = 12;
/// The longest cuts, as parts of the budget, one after another: several short ones may do more than a long one.
const LONGEST: [f64; 2] = [1.0, 0.5];
/// By how much a cut must let the atlas cover more.
const GAIN: f64 = 1.01;
/// Quick packings that may be made to rate the cuts of a chart, times the charts in each; one packing of many charts
/// takes as long as many of few.
const RATINGS: usize = 12_000;
/// The same for the packings as good as the one that was asked for, which rate the most promising cuts once more.
const GOOD_RATINGS: usize = 96;
/// The fewest of these packings, and the most.
const GOOD_RATED: [usize; 2] = [3, 12];
/// The most promising cuts, beside whose ends others are looked for.
const BESIDE: usize = 12;

impl Atlas {
    /// Packs charts as [`Self::pack`] does, and parts charts along edges.
    ///
    /// For coverage the largest chart is parted as long as that lets the atlas cover more, until it covers what is aimed
    /// at or the budget is spent. Cuts go between points of the outer boundary of a chart, along shortest paths. Each is
    /// rated by a quick packing of the outlines, the best of them by a good one, and the best of these is made. Where that
    /// misses the aim, several cuts of half the budget at most are tried in their place.
    ///
    /// For the margin a chart is parted where a cut separates the two sides of a place that is too narrow. Narrow holes
    /// stay as they are.
    ///
    /// `materials` are those of [`Self::pack`]. `forbidden` says for every corner of the mesh whether the edge that it
    /// faces may not be a seam.
    ///
    /// # Errors
    /// [`AtlasError`].
    pub fn pack_parting(
        &self,
        mesh: &TriMesh,
        unwrapped: Unwrapped,
        (materials, forbidden): (Option<&[u32]>, Option<&[bool]>),
        stored: Stored,
        parting: &Parting,
    ) -> Result<Parted, AtlasError> {
        self.pack_parting_while(mesh, unwrapped, (materials, forbidden), stored, (parting, &mut || true))
    }

    /// The same as long as `may_go_on` answers that it may: it is asked before every cut is tried. What is parted by then is
    /// kept.
    ///
    /// # Errors
    /// [`AtlasError`].
    pub fn pack_parting_while(
        &self,
        mesh: &TriMesh,
        unwrapped: Unwrapped,
        (materials, forbidden): (Option<&[u32]>, Option<&[bool]>),
        stored: Stored,
        (parting, may_go_on): (&Parting, &mut dyn FnMut() -> bool),
    ) -> Result<Parted, AtlasError> {
        parting.check()?;
        let uv = unwrapped.uv();
        let turned = unwrapped.turned.clone();
        let splitter = Splitter::new(mesh, &turned, &uv, (forbidden, stored.precision(), parting.max_stretch));
        let packed = self.pack(mesh, &unwrapped, materials, stored)?;
        let mut parted = Parted { unwrapped, packed, for_coverage: 0, for_margin: 0, is_unfinished: false };
        let again = |unwrapped: &Unwrapped| self.pack(mesh, unwrapped, materials, stored);
        if let Some(aim) = parting.coverage {
            let budget = parting.seam_budget * splitter.seam_length(&parted.unwrapped);
            self.cover(&splitter, &mut parted, (aim, budget), (&again, may_go_on))?;
        }
        if parting.keeps_inner_margin {
            self.keep_margin(&splitter, &mut parted, (&again, may_go_on))?;
        }
        Ok(parted)
    }

    /// Parts the largest chart until the atlas covers so much, first by cuts of any length within the budget, then, from the
    /// start, by shorter ones. The better atlas is kept.
    fn cover(
        &self,
        splitter: &Splitter<'_>,
        parted: &mut Parted,
        (aim, budget): (f64, f64),
        (again, may_go_on): (&Again<'_>, &mut dyn FnMut() -> bool),
    ) -> Result<(), AtlasError> {
        let whole = parted.clone();
        for share in LONGEST {
            if parted.packed.coverage >= aim || parted.is_unfinished {
                break;
            }
            let mut tried = whole.clone();
            self.cover_by(splitter, &mut tried, (aim, budget, share * budget), (again, may_go_on))?;
            let is_unfinished = tried.is_unfinished;
            if tried.packed.coverage > parted.packed.coverage {
                *parted = tried;
            }
            parted.is_unfinished = is_unfinished;
        }
        Ok(())
    }

    /// Parts the largest chart by cuts that are no longer than `longest` until the atlas covers so much, or no cut within the
    /// budget is worth it.
    fn cover_by(
        &self,
        splitter: &Splitter<'_>,
        parted: &mut Parted,
        (aim, mut budget, longest): (f64, f64, f64),
        (again, may_go_on): (&Again<'_>, &mut dyn FnMut() -> bool),
    ) -> Result<(), AtlasError> {
        while parted.packed.coverage < aim {
            let Some((chart, cuts)) = self.cuts(splitter, &parted.unwrapped, budget.min(longest)) else { break };
            let mut gained = None;
            for cut in cuts.iter().take(TRIES) {
                if !may_go_on() {
                    parted.is_unfinished = true;
                    return Ok(());
                }
                let Some(halves) = splitter.halves(&parted.unwrapped, chart, cut)? else { continue };
                let mut unwrapped = parted.unwrapped.clone();
                halves.put_into(&mut unwrapped);
                let Some(packed) = fitting(again(&unwrapped))? else { continue };
                if packed.coverage > GAIN * parted.packed.coverage {
                    gained = Some((unwrapped, packed, cut.length));
                    break;
                }
            }
            let Some((unwrapped, packed, length)) = gained else { break };
            budget -= length;
            *parted = Parted { unwrapped, packed, for_coverage: parted.for_coverage + 1, ..*parted };
        }
        Ok(())
    }

    /// Parts charts that are too narrow somewhere until none is, no cut helps, or the parts do not fit the pages.
    fn keep_margin(
        &self,
        splitter: &Splitter<'_>,
        parted: &mut Parted,
        (again, may_go_on): (&Again<'_>, &mut dyn FnMut() -> bool),
    ) -> Result<(), AtlasError> {
        loop {
            let mut unwrapped = parted.unwrapped.clone();
            let cuts = self.part_narrow(splitter, (&mut unwrapped, &parted.packed), may_go_on)?;
            if cuts > 0 {
                let Some(packed) = fitting(again(&unwrapped))? else { return Ok(()) };
                (parted.unwrapped, parted.packed) = (unwrapped, packed);
                parted.for_margin += cuts;
            }
            if !may_go_on() {
                parted.is_unfinished |= !parted.packed.narrow.is_empty();
                return Ok(());
            }
            if cuts == 0 {
                return Ok(());
            }
        }
    }

    /// The largest chart, and the cuts of it that are no longer than `most`, the most promising first.
    fn cuts(&self, splitter: &Splitter<'_>, unwrapped: &Unwrapped, most: f64) -> Option<(usize, Vec<Cut>)> {
        let area = |chart: &UnwrappedChart| chart.metrics.uv_area;
        let all = unwrapped.charts.iter().enumerate();
        let (largest, chart) = all.max_by(|a, b| area(a.1).total_cmp(&area(b.1)).then(b.0.cmp(&a.0)))?;
        let sheet = splitter.sheet(chart)?;
        let others = unwrapped.charts.iter().enumerate().filter(|&(i, _)| i != largest);
        let others: Vec<Piece> =
            others.map(|(_, chart)| Piece { polygons: outline_of(chart), ..Piece::default() }).collect();
        let count = unwrapped.charts.len();
        let mut cuts = sheet.across(most);
        cuts.truncate((RATINGS / count).max(TRIES));
        let rated = self.rated(&sheet, &others, cuts, Effort::Fast);
        // What is not so far from the best may have a better one beside it.
        let mut cuts = sheet.beside(&rated[..rated.len().min(BESIDE)], most);
        cuts.truncate((RATINGS / count).max(TRIES));
        let mut cuts = self.rated(&sheet, &others, cuts, Effort::Fast);
        if self.effort != Effort::Fast {
            let [fewest, most] = GOOD_RATED;
            cuts.truncate((GOOD_RATINGS / count).clamp(fewest, most));
            cuts = self.rated(&sheet, &others, cuts, Effort::Good);
        }
        Some((largest, cuts))
    }

    /// Cuts of a chart by the scale at which its parts and the other charts fit, the largest scale first.
    fn rated(&self, sheet: &Sheet, others: &[Piece], cuts: Vec<Cut>, effort: Effort) -> Vec<Cut> {
        let settings = PackSettings {
            page: self.page,
            margin: f64::from(self.margin),
            effort,
            pages: self.max_pages,
            ..PackSettings::default()
        };
        let scale = |cut: Cut| {
            let mut pieces = others.to_vec();
            pieces.extend(sheet.sides(&cut).map(|ring| Piece::new(vec![ring])));
            (pack(&pieces, &settings).map_or(0.0, |packing| packing.texels_per_unit), cut)
        };
        let mut rated: Vec<(f64, Cut)> = cuts.into_par_iter().map(scale).collect();
        // Of cuts that are as good the shorter one comes first.
        rated.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.length.total_cmp(&b.1.length)));
        rated.into_iter().map(|(_, cut)| cut).collect()
    }

    /// Parts the charts that are too narrow somewhere, as often as that leaves fewer such places at the scale of the atlas.
    /// How many cuts that were.
    fn part_narrow(
        &self,
        splitter: &Splitter<'_>,
        (unwrapped, packed): (&mut Unwrapped, &Packed),
        may_go_on: &mut dyn FnMut() -> bool,
    ) -> Result<usize, AtlasError> {
        let within = f64::from(self.margin) / packed.texels_per_unit;
        let mut narrow: Vec<usize> = packed.narrow.iter().map(|place| place.chart).collect();
        narrow.sort_unstable();
        narrow.dedup();
        let mut made = 0;
        // From the last one on, so that parts do not change the numbers of those that wait.
        while let Some(chart) = narrow.pop().filter(|_| may_go_on()) {
            let Some(sheet) = splitter.sheet(&unwrapped.charts[chart]) else { continue };
            for cut in sheet.between_narrow_sides(within) {
                if let Some(halves) = splitter.halves(unwrapped, chart, &cut)? {
                    halves.put_into(unwrapped);
                    made += 1;
                    narrow.extend([chart, chart + 1]);
                    break;
                }
            }
        }
        Ok(made)
    }
}

/// Packs charts that were parted.
type Again<'a> = dyn Fn(&Unwrapped) -> Result<Packed, AtlasError> + 'a;

/// What was packed; `None` where the parts do not fit the pages.
fn fitting(packed: Result<Packed, AtlasError>) -> Result<Option<Packed>, AtlasError> {
    match packed {
        Ok(packed) => Ok(Some(packed)),
        Err(AtlasError::Pack(_)) => Ok(None),
        Err(error) => Err(error),
    }
}

impl Parting {
    /// Checks every number.
    ///
    /// # Errors
    /// [`AtlasError::Setting`].
    pub fn check(&self) -> Result<(), AtlasError> {
        if let Some(coverage) = self.coverage.filter(|c| !(*c > 0.0 && *c <= 1.0)) {
            return Err(SettingError::new("coverage", "in (0, 1]", coverage).into());
        }
        if !(self.seam_budget >= 0.0 && self.seam_budget.is_finite()) {
            return Err(SettingError::new("seam budget", "a finite number, at least 0", self.seam_budget).into());
        }
        if !(self.max_stretch >= 1.0) {
            return Err(SettingError::new("max stretch", "at least 1", self.max_stretch).into());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
