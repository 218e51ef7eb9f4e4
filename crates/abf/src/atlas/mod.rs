//! From charts to an atlas: turned into their tightest boxes, scaled alike, and packed with a margin.

mod boxes;
mod judge;
mod packing;

use crate::unwrap::Unwrapped;
use abf_control::SettingError;
use abf_mesh::{Point2, TriMesh, UvMap};
use abf_metrics::{Metrics, MetricsError, Precision};
use boxes::TightBox;
use std::collections::HashMap;
use std::fmt;
use std::str::FromStr;

/// How charts are laid out in the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Atlas {
    /// Which charts share a page.
    pub pages: AtlasPages,
    /// Texels along a side of a page; what a margin is measured in.
    pub resolution: u32,
    /// Texels that stay free between two charts, and between a chart and the border.
    pub margin: u32,
}

impl Default for Atlas {
    fn default() -> Self {
        Self { pages: AtlasPages::One, resolution: 1024, margin: 2 }
    }
}

/// Which charts share a page: a unit square of their own, for a texture of their own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AtlasPages {
    /// All of them.
    #[default]
    One,
    /// Those of one connected component.
    PerComponent,
    /// Those of one material: of the one most of their faces have.
    PerMaterial,
}

/// Why charts cannot be packed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AtlasError {
    /// A setting outside its range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// Pages per material without materials.
    #[error("pages per material need a material for each of the {faces} faces, and there are {given}")]
    Labels {
        /// How many faces there are.
        faces: usize,
        /// How many labels were given.
        given: usize,
    },
    /// Even at one texel each the charts do not fit.
    #[error("{charts} charts with {margin} texels between them do not fit into {resolution} × {resolution} texels")]
    TooManyCharts {
        /// How many on the fullest page.
        charts: usize,
        /// The margin asked for.
        margin: u32,
        /// The resolution asked for.
        resolution: u32,
    },
    /// The packed UVs cannot be judged.
    #[error(transparent)]
    Metrics(#[from] MetricsError),
}

/// Charts in the unit squares of their pages.
#[derive(Clone, Debug)]
pub struct Packed {
    /// One UV for every corner of the input, each chart within `[0, 1]²` of its page, as it will be stored.
    pub uv: UvMap,
    /// Where every chart is, in the order of [`Unwrapped::charts`].
    pub placements: Vec<Placement>,
    /// How many pages there are.
    pub pages: usize,
    /// How many texels a unit of the mesh gets, the same in all charts.
    pub texels_per_unit: f64,
    /// The part of the pages that charts cover.
    pub coverage: f64,
    /// Distortion of all charts together, and what is proved of them as stored: no overlap means that no two charts of a
    /// page overlap, either. Faces that repair dropped are not judged.
    pub metrics: Metrics,
}

/// Where a chart is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Its page, counted from 0.
    pub page: usize,
    /// The cosine and the sine of the angle that it is turned by.
    pub turn: [f64; 2],
    /// The lower left corner of its box after that, in units of the mesh.
    pub low: Point2<f64>,
    /// The texel that this corner is put at.
    pub texel: [u32; 2],
}

impl Placement {
    fn place(&self, p: Point2<f64>, texels_per_unit: f64, resolution: u32) -> Point2<f64> {
        let q = boxes::turned(p, self.turn);
        let along = |x: f64, low: f64, texel: u32| {
            // The last bits may point out of the page.
            (((x - low) * texels_per_unit + f64::from(texel)) / f64::from(resolution)).clamp(0.0, 1.0)
        };
        Point2::new(along(q.x, self.low.x, self.texel[0]), along(q.y, self.low.y, self.texel[1]))
    }
}

/// How a format stores a point.
pub type Stored = fn(Point2<f64>) -> Point2<f64>;

impl Atlas {
    /// The most texels along a side.
    pub const MAX_RESOLUTION: u32 = 1 << 16;

    /// Packs the charts of `mesh`. `materials` has a label for each of its faces, and is needed for
    /// [`AtlasPages::PerMaterial`] only. `stored` says what the format that the UVs are for makes of a point, in the
    /// precision that they are certified in.
    ///
    /// A chart that is valid before, and would not be after turning and rounding, is not turned.
    ///
    /// # Errors
    /// [`AtlasError`].
    pub fn pack(
        &self,
        mesh: &TriMesh,
        unwrapped: &Unwrapped,
        materials: Option<&[u32]>,
        (stored, precision): (Stored, Precision),
    ) -> Result<Packed, AtlasError> {
        self.check()?;
        let page_of = self.pages_of(mesh, unwrapped, materials)?;
        let mut pages: Vec<Vec<usize>> = vec![Vec::new(); page_of.iter().max().map_or(0, |last| last + 1)];
        page_of.iter().enumerate().for_each(|(chart, &page)| pages[page].push(chart));
        let mut boxes: Vec<TightBox> =
            unwrapped.charts.iter().map(|chart| TightBox::around(chart.uv.points())).collect();
        loop {
            let (texels_per_unit, texels) = packing::pack(&boxes, &pages, self.resolution, self.margin)?;
            let placement = |i: usize| Placement {
                page: page_of[i],
                turn: boxes[i].turn,
                low: boxes[i].low,
                texel: texels[i].map(|t| t + self.margin),
            };
            let placements: Vec<Placement> = (0..boxes.len()).map(placement).collect();
            let uv = unwrapped.assemble(|i, p| stored(placements[i].place(p, texels_per_unit, self.resolution)));
            let judged = judge::judge(mesh, unwrapped, &pages, &uv, precision)?;
            let spoilt: Vec<usize> = judged
                .invalid_charts
                .iter()
                .copied()
                .filter(|&i| boxes[i].is_turned() && unwrapped.charts[i].metrics.valid())
                .collect();
            if spoilt.is_empty() {
                let coverage = judged.metrics.uv_area / pages.len() as f64;
                let (pages, metrics) = (pages.len(), judged.metrics);
                return Ok(Packed { uv, placements, pages, texels_per_unit, coverage, metrics });
            }
            spoilt.iter().for_each(|&i| boxes[i] = TightBox::unturned(unwrapped.charts[i].uv.points()));
        }
    }

    fn check(&self) -> Result<(), AtlasError> {
        let wrong = |name, allowed, value| Err(SettingError::new(name, allowed, value).into());
        if !(1..=Self::MAX_RESOLUTION).contains(&self.resolution) {
            return wrong("resolution", "in 1..=65536 texels", self.resolution);
        }
        if self.margin > self.resolution / 4 {
            return wrong("margin", "at most a quarter of the resolution", self.margin);
        }
        Ok(())
    }

    /// The page of every chart, numbered by first appearance.
    fn pages_of(
        &self,
        mesh: &TriMesh,
        unwrapped: &Unwrapped,
        materials: Option<&[u32]>,
    ) -> Result<Vec<usize>, AtlasError> {
        let keys: Vec<usize> = match self.pages {
            AtlasPages::One => vec![0; unwrapped.charts.len()],
            AtlasPages::PerComponent => unwrapped.charts.iter().map(|chart| chart.component).collect(),
            AtlasPages::PerMaterial => {
                let faces = mesh.face_count();
                let labels = materials.filter(|labels| labels.len() == faces);
                let labels = labels.ok_or(AtlasError::Labels { faces, given: materials.map_or(0, <[u32]>::len) })?;
                let material = |f: &abf_mesh::FaceId| labels[f.index()] as usize;
                unwrapped.charts.iter().map(|chart| most_frequent(chart.faces.iter().map(material))).collect()
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
    pub const fn name(self) -> &'static str {
        match self {
            Self::One => "one",
            Self::PerComponent => "per-component",
            Self::PerMaterial => "per-material",
        }
    }
}

impl fmt::Display for AtlasPages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for AtlasPages {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let known = || Self::ALL.into_iter();
        known().find(|pages| pages.name() == s).ok_or_else(|| {
            let names: Vec<&str> = known().map(Self::name).collect();
            format!("'{s}' is no way to share pages; there are: {}", names.join(", "))
        })
    }
}
