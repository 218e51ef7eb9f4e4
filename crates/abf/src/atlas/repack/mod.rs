//! From the UVs that a mesh has to an atlas, without flattening.

mod congruent;
mod islands;
mod overlapping;
mod stacked;

use super::judge::{Judge, Selected};
use super::{Atlas, AtlasError, NarrowPlace, Placement, Stored};
use abf_cut::Weld;
use abf_mesh::{FaceId, Point2, TriMesh, UvMap};
use abf_metrics::{Metrics, MetricsError, charts};
use abf_pack::{PackError, PackSettings, Packing, Piece};
use islands::Islands;
use std::borrow::Cow;
use std::ops::RangeInclusive;

/// Lays out anew the UV islands that a mesh has: packed by their shape, all scaled alike, none of them changed otherwise.
///
/// ```
/// use abf::mesh::{Point2, Point3, TriMesh, UvId, UvMap};
/// use abf::{Repack, Stored};
///
/// // Two triangles, far apart in the plane.
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = TriMesh::new(points.map(Point3::from).to_vec(), &[[0, 1, 2], [0, 2, 3]])?;
/// let places = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [50.0, 0.0], [51.0, 1.0], [50.0, 1.0]];
/// let uv = UvMap::new(places.map(Point2::from).to_vec(), (0..6).map(UvId::new).collect());
///
/// let packed = Repack::default().run(&mesh, &uv, None, Stored::default())?;
/// assert_eq!(packed.islands, 2);
/// assert!(packed.coverage > 0.4 && packed.metrics.injective());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Islands that lie over each other stay together, as one piece. A unit of [`Atlas::texels_per_unit`] is one of the UVs as
/// they are: with the side of the page that they were made for, islands keep their size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Repack {
    /// The pages.
    pub atlas: Atlas,
    /// Whether islands of the same shape are laid upon each other, turned but not mirrored. Their points agree within a
    /// hundred-thousandth of the extent of all UVs, and a thousandth of their own; those laid upon others take their places
    /// to the bit.
    pub stack: bool,
}

/// UV islands in the unit squares of their pages.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Repacked {
    /// The map, with the corners of the one given, each island within `[0, 1]²` of its page, as it will be stored. Points
    /// that no corner uses are at the origin.
    pub uv: UvMap,
    /// How many islands there are: faces that share UV points, or have points of one vertex in one place, are in one.
    pub islands: usize,
    /// The island of every face, numbered by first appearance.
    pub island_of_face: Vec<usize>,
    /// Where every island is. One that is laid upon another is where that is.
    pub placements: Vec<Placement>,
    /// How many faces repair turned around: they are judged so.
    pub turned: usize,
    /// How many faces have the vertices and the UVs of an earlier one, as the two sides of a leaf. They are no overlap, and are
    /// not judged.
    pub shared: usize,
    /// How many islands lie over others, and stay together with them.
    pub overlapping: usize,
    /// For every island the one that it is laid upon.
    pub stacked_on: Vec<Option<usize>>,
    /// What was packed: islands that lie over each other are one piece, and so are those laid upon each other.
    pub pieces: usize,
    /// How many pages there are.
    pub pages: usize,
    /// How many texels a unit of the UVs as they were gets.
    pub texels_per_unit: f64,
    /// The part of the pages that islands cover; where they lie over each other it counts once.
    pub coverage: f64,
    /// Where islands come nearer to themselves than the margin: [`NarrowPlace::chart`] is the island.
    pub narrow: Vec<NarrowPlace>,
    /// The distortion of all faces that are judged, and what is proved of them as stored, but for islands that are laid upon others: an
    /// overlap is one that the map had before.
    pub metrics: Metrics,
}

impl Repack {
    /// Packs the islands of `uv`. The other arguments are those of [`Atlas::pack`]; a component is a set of faces that are
    /// connected by vertices.
    ///
    /// An island that is valid or injective before, and would not be after turning and rounding, is not turned. One of lines
    /// only, which no texel is in, is put into one point.
    ///
    /// # Errors
    /// [`AtlasError`]; [`AtlasError::Metrics`] for UVs that are NaN or infinite.
    pub fn run(
        &self,
        mesh: &TriMesh,
        uv: &UvMap,
        materials: Option<&[u32]>,
        stored: Stored,
    ) -> Result<Repacked, AtlasError> {
        self.run_within(mesh, uv, (materials, None), stored)
    }

    /// The same for a mesh of several objects, of which the vertices are not joined with each other before it is judged; both
    /// lists have a label for each face.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_within(
        &self,
        mesh: &TriMesh,
        uv: &UvMap,
        (materials, objects): (Option<&[u32]>, Option<&[u32]>),
        stored: Stored,
    ) -> Result<Repacked, AtlasError> {
        let (atlas, precision) = (&self.atlas, stored.precision());
        atlas.check()?;
        let of_face = charts(mesh, uv)?;
        check_finite(uv)?;
        let (uv, factor) = &in_range(uv);
        // Where repair leaves nothing, all is judged as it is.
        let objects = objects.filter(|objects| objects.len() == mesh.face_count());
        let selected = Selected::of(mesh, uv, Weld::Auto, objects).unwrap_or_else(|_| Selected::all(mesh.face_count()));
        let islands = Islands::find(mesh, (uv, of_face), selected, precision)?;
        let group =
            atlas.groups(mesh, islands.faces.iter().map(Vec::as_slice), || islands.components(mesh), materials)?;
        let stacked_on = if self.stack { congruent::stacks(&islands, &group) } else { vec![None; islands.len()] };
        let bundles = islands.bundles(&stacked_on);
        let mut pieces: Vec<Piece> = bundles
            .iter()
            .map(|bundle| Piece {
                polygons: bundle.iter().flat_map(|&i| islands.polygons(i)).collect(),
                group: group[bundle[0]],
                keeps_its_angle: false,
            })
            .collect();
        let texels_per_unit = atlas.texels_per_unit.map(|texels| texels / factor);
        let settings = PackSettings { texels_per_unit, ..atlas.packer(precision) };
        loop {
            let Packing { texels_per_unit, placements, pages, coverage, .. } =
                abf_pack::pack(&pieces, &settings).map_err(|error| atlas.refused(in_units(error, *factor)))?;
            let mut of_island = vec![Placement::from(placements[0]); islands.len()];
            for (bundle, &placed) in bundles.iter().zip(&placements) {
                bundle.iter().for_each(|&i| of_island[i] = placed.into());
            }
            for (i, leader) in stacked_on.iter().enumerate() {
                leader.iter().for_each(|leader: &stacked::Stacked| of_island[i] = of_island[leader.on]);
            }
            let place = |i: usize, p| stored.point(of_island[i].place(p, texels_per_unit, atlas.page));
            let packed = islands.moved(&stacked_on, place);
            let judge = Judge::new(mesh, &islands.turned, &packed, precision);
            let mut faces_of: Vec<Vec<FaceId>> = vec![Vec::new(); pages];
            for &i in bundles.iter().flatten() {
                faces_of[of_island[i].page].extend_from_slice(&islands.judged[i]);
            }
            let certificate = judge.certificate(&faces_of)?;
            let turnable: Vec<(usize, usize)> = bundles
                .iter()
                .enumerate()
                .filter(|&(number, _)| !pieces[number].keeps_its_angle)
                .flat_map(|(number, bundle)| bundle.iter().map(move |&i| (number, i)))
                .filter(|&(_, i)| !islands.judged[i].is_empty())
                .collect();
            let before = turnable.iter().map(|&(_, i)| (islands.judged[i].as_slice(), islands.proved[i]));
            let spoilt = judge.spoilt(before, &certificate)?;
            if spoilt.is_empty() {
                let metrics = judge.metrics(&islands.judged.concat(), certificate, atlas.page)?;
                let mut narrow = atlas.narrow_places(&pieces, &vec![1.0; pieces.len()], texels_per_unit);
                for place in &mut narrow {
                    place.chart = bundles[place.chart][0];
                    place.ends = place.ends.map(|end| end / *factor);
                }
                of_island.iter_mut().for_each(|placed| placed.low /= *factor);
                return Ok(Repacked {
                    islands: islands.len(),
                    turned: islands.turned.len(),
                    shared: islands.shared,
                    overlapping: bundles.iter().filter(|bundle| bundle.len() > 1).map(Vec::len).sum(),
                    placements: of_island,
                    stacked_on: stacked_on.into_iter().map(|leader| leader.map(|leader| leader.on)).collect(),
                    pieces: bundles.len(),
                    island_of_face: islands.of_face,
                    uv: packed,
                    pages,
                    texels_per_unit: (texels_per_unit * factor).min(f64::MAX),
                    coverage,
                    narrow,
                    metrics,
                });
            }
            spoilt.into_iter().for_each(|at| pieces[turnable[at].0].keeps_its_angle = true);
        }
    }
}

/// Every UV has to be a number.
fn check_finite(uv: &UvMap) -> Result<(), MetricsError> {
    let is_bad = |f: &FaceId| uv.triangle(*f).iter().any(|p| !(p.x.is_finite() && p.y.is_finite()));
    let mut bad = (0..uv.corners().len() / 3).map(FaceId::new).filter(is_bad);
    match bad.next() {
        Some(first) => Err(MetricsError::UvNotFinite { first, count: 1 + bad.count() }),
        None => Ok(()),
    }
}

/// UVs that can be squared and added without leaving the range of numbers, and the power of two they were multiplied by.
fn in_range(uv: &UvMap) -> (Cow<'_, UvMap>, f64) {
    const SAFE: RangeInclusive<f64> = 1e-100..=1e100;
    let largest = uv.triangles().flatten().map(|p| p.coords.amax()).fold(0.0, f64::max);
    if largest == 0.0 || SAFE.contains(&largest) {
        return (Cow::Borrowed(uv), 1.0);
    }
    let factor = (-largest.log2().floor()).clamp(-1000.0, 1000.0).exp2();
    (Cow::Owned(uv.clone().mapped(|p| p * factor)), factor)
}

/// A refusal of the packer in the units of UVs that were multiplied by a factor.
fn in_units(error: PackError, factor: f64) -> PackError {
    match error {
        PackError::PieceTooLarge { piece, width, height, texels_per_unit, largest } => {
            let [texels_per_unit, largest] = [texels_per_unit, largest].map(|texels| texels * factor);
            PackError::PieceTooLarge { piece, width, height, texels_per_unit, largest }
        }
        PackError::TooManyPages { pieces, pages, texels_per_unit } => {
            PackError::TooManyPages { pieces, pages, texels_per_unit: texels_per_unit * factor }
        }
        error => error,
    }
}

/// The coordinates of a point.
fn xy(p: Point2<f64>) -> [f64; 2] {
    [p.x, p.y]
}

#[cfg(test)]
mod tests;
