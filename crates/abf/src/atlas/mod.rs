//! From charts to an atlas: packed by their shape, at one scale, with a margin.

mod error;
pub(crate) mod judge;
mod outline;
mod parting;
mod repack;
mod sizes;
mod stored;

use crate::unwrap::{Unwrapped, UnwrappedChart};
use abf_control::{SettingError, UnknownName};
use abf_mesh::{FaceId, Point2, TriMesh, UvId, UvMap};
use abf_metrics::{Metrics, Precision};
use abf_pack::{Effort, PackError, PackSettings, Packing, Piece};
use abf_parallel::prelude::*;
use judge::Judge;
pub(crate) use judge::{Parts, Proved, Selected, in_input};
use std::borrow::Cow;
use std::collections::HashMap;

/// How charts are laid out in the unit square.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Atlas {
    /// Which charts share a page.
    pub pages: AtlasPages,
    /// Texels of a page along x and y; what a margin is measured in.
    pub page: [u32; 2],
    /// Texels that stay free between two charts, and between a chart and the border.
    pub margin: u32,
    /// How hard the packer tries.
    pub effort: Effort,
    /// How many pages the charts that share pages may take.
    pub max_pages: usize,
    /// Texels per unit of the mesh. Without it the largest number with which the charts are found to fit.
    pub texels_per_unit: Option<f64>,
}

impl Default for Atlas {
    fn default() -> Self {
        Self {
            pages: AtlasPages::One,
            page: [1024; 2],
            margin: 2,
            effort: Effort::Fast,
            max_pages: 1,
            texels_per_unit: None,
        }
    }
}

/// Which charts share a page: a unit square of their own, for a texture of their own.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    Hash,
    strum::Display,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantNames,
)]
#[strum(serialize_all = "kebab-case", parse_err_ty = UnknownName, parse_err_fn = unknown)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum AtlasPages {
    /// All of them.
    #[default]
    One,
    /// Those of one connected component.
    PerComponent,
    /// Those of one material: of the one most of their faces have.
    PerMaterial,
}

/// Charts in the unit squares of their pages.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Packed {
    /// One UV for every corner of the input, each chart within `[0, 1]²` of its page, as it will be stored.
    pub uv: UvMap,
    /// Where every chart is, in the order of [`Unwrapped::charts`].
    pub placements: Vec<Placement>,
    /// How many pages there are.
    pub pages: usize,
    /// How many texels a unit of the mesh gets, the same in all charts but those with a [scale](Self::scales).
    pub texels_per_unit: f64,
    /// The part of the pages that charts cover.
    pub coverage: f64,
    /// Where charts come nearer to themselves than the margin, chart by chart, the narrowest place first. No packing can
    /// change that.
    pub narrow: Vec<NarrowPlace>,
    /// The charts that are less than a texel wide, ascending.
    pub under_a_texel: Vec<usize>,
    /// The size of every chart as a part of the size it has at `texels_per_unit`: its [`scale`](UnwrappedChart::scale), or more
    /// where it is so small that its triangles would collapse as they are stored.
    pub scales: Vec<f64>,
    /// Distortion of all charts together, and what is proved of them as stored: no overlap means that no two charts of a
    /// page overlap, either. Faces that repair dropped are not judged. Of a page that is no square, the distortion is that
    /// of texels, and `uv_area` counts its longer side as 1.
    pub metrics: Metrics,
}

/// A place where a chart comes nearer to itself than the margin, across what is outside of it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NarrowPlace {
    /// The chart, in the order of [`Unwrapped::charts`].
    pub chart: usize,
    /// The two nearest points of its boundary there, in the coordinates of [`UnwrappedChart::uv`].
    pub ends: [Point2<f64>; 2],
    /// How far they are apart, in texels.
    pub texels: f64,
}

/// Where a chart is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Placement {
    /// Its page, counted from 0.
    pub page: usize,
    /// The cosine and the sine of the angle that it is turned by, times its [scale](Packed::scales).
    pub turn: [f64; 2],
    /// The lower left corner of its box after that, in units of the mesh.
    pub low: Point2<f64>,
    /// Where this corner is put: in texels of its page, and in units of the mesh in a [`Pattern`](crate::Pattern).
    pub texel: [f64; 2],
}

impl Placement {
    fn place(&self, p: Point2<f64>, texels_per_unit: f64, sides: [u32; 2]) -> Point2<f64> {
        let at = self.scaled(p, texels_per_unit);
        // The last bits may point out of the page.
        Point2::new(at.x / f64::from(sides[0]), at.y / f64::from(sides[1])).map(|x| x.clamp(0.0, 1.0))
    }

    /// Where a point of the chart is put, in texels if a unit has so many.
    pub(crate) fn scaled(&self, p: Point2<f64>, texels_per_unit: f64) -> Point2<f64> {
        let Self { page, turn, low, texel: corner } = *self;
        let placed = abf_pack::Placement { page, turn, low: [low.x, low.y], corner };
        Point2::from(placed.texel([p.x, p.y], texels_per_unit))
    }
}

impl From<abf_pack::Placement> for Placement {
    fn from(placed: abf_pack::Placement) -> Self {
        Self { page: placed.page, turn: placed.turn, low: Point2::from(placed.low), texel: placed.corner }
    }
}

pub use error::AtlasError;
pub use parting::{Parted, Parting};
pub use repack::{Repack, Repacked};
pub use stored::Stored;

impl Atlas {
    /// The most texels along a side of a page.
    pub const MAX_SIDE: u32 = PackSettings::MAX_SIDE;

    /// The margin that keeps charts apart in the mip levels from 0 to `levels`: `2 · 2^levels` texels.
    ///
    /// A texel of level `k` is the mean of `2^k × 2^k` texels. Bilinear filtering reads one texel of the level beside a
    /// chart. With two texels of the level between two charts, each has one of its own. Saturates where no page is that
    /// large.
    #[must_use]
    pub const fn margin_for_mip_levels(levels: u32) -> u32 {
        match 2_u32.checked_shl(levels) {
            Some(margin) if margin > 0 => margin,
            _ => u32::MAX,
        }
    }

    /// UVs in the proportions of a page of so many texels along x and y: its longer side counts as 1.
    #[must_use]
    pub fn in_proportions(uv: &UvMap, page: [u32; 2]) -> Cow<'_, UvMap> {
        if page[0] == page[1] {
            return Cow::Borrowed(uv);
        }
        let [width, height] = page.map(|side| f64::from(side) / f64::from(page[0].max(page[1])));
        Cow::Owned(uv.clone().mapped(|p| Point2::new(p.x * width, p.y * height)))
    }

    /// Packs the charts of `mesh`. `materials` has a label for each of its faces, and is needed for
    /// [`AtlasPages::PerMaterial`] only. `stored` says what the format that the UVs are for makes of a point, in the
    /// precision that they are certified in.
    ///
    /// A chart that is valid or injective before, and would not be after turning and rounding, is not turned; if that does not
    /// help, and it is less than a texel wide, it is made larger.
    ///
    /// # Errors
    /// [`AtlasError`].
    pub fn pack(
        &self,
        mesh: &TriMesh,
        unwrapped: &Unwrapped,
        materials: Option<&[u32]>,
        stored: Stored,
    ) -> Result<Packed, AtlasError> {
        self.check()?;
        let components = || unwrapped.charts.iter().map(|chart| chart.component).collect();
        let faces = unwrapped.charts.iter().map(|chart| chart.faces.as_slice());
        let page_of = self.groups(mesh, faces, components, materials)?;
        let piece = |(chart, &group): (&UnwrappedChart, &usize)| {
            let mut piece = Piece { polygons: outline_of(chart), group, keeps_its_angle: false };
            sizes::resize(&mut piece, chart.scale);
            piece
        };
        let mut scales: Vec<f64> = unwrapped.charts.iter().map(|chart| chart.scale).collect();
        let mut pieces: Vec<Piece> = unwrapped.charts.par_iter().zip(&page_of).map(piece).collect();
        let mut times_enlarged = vec![0; pieces.len()];
        let longer_side = f64::from(self.page[0].max(self.page[1]));
        let settings = self.packer(stored.precision());
        loop {
            let Packing { texels_per_unit, placements, pages, .. } =
                abf_pack::pack(&pieces, &settings).map_err(|error| self.refused(error))?;
            let of_chart = |(placed, scale): (abf_pack::Placement, &f64)| {
                let turn = placed.turn.map(|x| x * scale);
                Placement { turn, ..Placement::from(placed) }
            };
            let placements: Vec<Placement> = placements.into_iter().zip(&scales).map(of_chart).collect();
            let uv = unwrapped.assemble(|i, p| stored.point(placements[i].place(p, texels_per_unit, self.page)));
            let judge = Judge::new(mesh, &unwrapped.turned, &uv, stored.precision());
            let mut faces_of = vec![Vec::new(); pages];
            for (chart, placement) in unwrapped.charts.iter().zip(&placements) {
                faces_of[placement.page].extend_from_slice(&chart.faces);
            }
            let certificate = judge.certificate(&faces_of)?;
            let mut is_changed = false;
            for i in judge.spoilt(proved(&unwrapped.charts), &certificate)? {
                let size = (&mut scales[i], &mut times_enlarged[i]);
                is_changed |= sizes::mend(&mut pieces[i], size, texels_per_unit, longer_side);
            }
            if !is_changed {
                let metrics = judge.metrics(&faces_of.concat(), certificate, self.page)?;
                let coverage = metrics.uv_area / (pages as f64 * self.aspect());
                let narrow = self.narrow_places(&pieces, &scales, texels_per_unit);
                let under_a_texel = sizes::under_a_texel(&pieces, texels_per_unit);
                return Ok(Packed {
                    uv,
                    placements,
                    pages,
                    texels_per_unit,
                    coverage,
                    narrow,
                    under_a_texel,
                    scales,
                    metrics,
                });
            }
        }
    }

    fn packer(&self, precision: Precision) -> PackSettings {
        // Half of the last digit of a number up to 1, twice for a format that counts v from the top; times the diagonal.
        let rounding = precision.epsilon();
        PackSettings {
            page: self.page,
            margin: f64::from(self.margin),
            rounding: rounding * f64::from(self.longer_side()),
            pages: self.max_pages,
            texels_per_unit: self.texels_per_unit,
            effort: self.effort,
        }
    }

    fn longer_side(&self) -> u32 {
        self.page[0].max(self.page[1])
    }

    /// The shorter side of a page as a part of the longer one.
    fn aspect(&self) -> f64 {
        f64::from(self.page[0].min(self.page[1])) / f64::from(self.longer_side())
    }

    fn narrow_places(&self, pieces: &[Piece], scales: &[f64], texels_per_unit: f64) -> Vec<NarrowPlace> {
        let within = f64::from(self.margin) / texels_per_unit;
        let of_chart = |(chart, piece): (usize, &Piece)| -> Vec<NarrowPlace> {
            let place = |gap: abf_pack::Gap| {
                let texels = gap.distance * texels_per_unit;
                NarrowPlace { chart, ends: gap.points.map(|p| Point2::from(p) / scales[chart]), texels }
            };
            abf_pack::gaps(piece, within).into_iter().map(place).collect()
        };
        pieces.par_iter().enumerate().map(of_chart).collect::<Vec<_>>().concat()
    }

    fn refused(&self, error: PackError) -> AtlasError {
        match error {
            PackError::TooManyPieces { pieces, .. } => {
                AtlasError::TooManyCharts { charts: pieces, margin: self.margin, page: self.page }
            }
            other => AtlasError::Pack(other),
        }
    }

    fn check(&self) -> Result<(), AtlasError> {
        let wrong = |name, allowed, value| Err(SettingError::new(name, allowed, value).into());
        let [width, height] = self.page;
        for (name, side) in [("page width", width), ("page height", height)] {
            if !(1..=Self::MAX_SIDE).contains(&side) {
                return wrong(name, "in 1..=65536 texels", side);
            }
        }
        if self.margin > width.min(height) / 4 {
            return wrong("margin", "at most a quarter of the shorter side of the page", self.margin);
        }
        Ok(())
    }

    /// For every chart the group that it shares pages with, numbered by first appearance.
    fn groups<'a>(
        &self,
        mesh: &TriMesh,
        charts: impl Iterator<Item = &'a [FaceId]>,
        components: impl FnOnce() -> Vec<usize>,
        materials: Option<&[u32]>,
    ) -> Result<Vec<usize>, AtlasError> {
        let keys: Vec<usize> = match self.pages {
            AtlasPages::One => charts.map(|_| 0).collect(),
            AtlasPages::PerComponent => components(),
            AtlasPages::PerMaterial => {
                let faces = mesh.face_count();
                let labels = materials.filter(|labels| labels.len() == faces);
                let labels = labels.ok_or(AtlasError::Labels { faces, given: materials.map_or(0, <[u32]>::len) })?;
                let material = |f: &FaceId| labels[f.index()] as usize;
                charts.map(|faces| most_frequent(faces.iter().map(material))).collect()
            }
        };
        let mut known: HashMap<usize, usize> = HashMap::new();
        let number = |key| {
            let next = known.len();
            *known.entry(key).or_insert(next)
        };
        Ok(keys.into_iter().map(number).collect())
    }
}

/// The faces of every chart, and what is proved of it.
pub(crate) fn proved(charts: &[UnwrappedChart]) -> impl Iterator<Item = (&[FaceId], Proved)> {
    charts.iter().map(|chart| (chart.faces.as_slice(), Proved::of(&chart.metrics.certificate)))
}

/// The polygons that a chart covers.
pub(crate) fn outline_of(chart: &UnwrappedChart) -> Vec<Vec<Vec<[f64; 2]>>> {
    let triangles = chart.uv.corners().as_chunks::<3>().0.iter().copied();
    let place = |id: UvId| {
        let p = chart.uv.points()[id.index()];
        [p.x, p.y]
    };
    outline::polygons(triangles, place, chart.metrics.injective())
}

/// The value that is there most often; the least of several.
fn most_frequent(values: impl Iterator<Item = usize>) -> usize {
    let mut counts = std::collections::BTreeMap::new();
    values.for_each(|value| *counts.entry(value).or_insert(0_usize) += 1);
    counts.into_iter().max_by_key(|&(value, count)| (count, std::cmp::Reverse(value))).map_or(0, |(value, _)| value)
}

impl AtlasPages {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 3] = [Self::One, Self::PerComponent, Self::PerMaterial];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<AtlasPages>("way to share pages", given)
}
