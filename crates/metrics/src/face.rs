//! The distortion of every triangle by itself.

use abf_mesh::{DisjointSets, FaceId, Point2, Point3, TriMesh, UvId, UvMap, VertexId};
use abf_parallel::prelude::*;

use crate::MetricsError;
use crate::charts::Charts;
use crate::triangle::{
    angles, is_within_rounding, largest_singular_value, power_of_two_scale, signed_uv_area, surface_area,
};

/// How a UV triangle lies in the plane, compared with its chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Orientation {
    /// Turned the way of the area-weighted majority of its chart.
    Kept,
    /// Turned the other way.
    Flipped,
    /// Its three UVs lie on one line.
    Collapsed,
}

impl Orientation {
    /// `+1` for kept, `−1` for flipped, `0` for collapsed.
    #[must_use]
    pub const fn sign(self) -> i8 {
        match self {
            Self::Kept => 1,
            Self::Flipped => -1,
            Self::Collapsed => 0,
        }
    }
}

/// What became of one triangle.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FaceDistortion {
    /// How it lies, by the exact sign of its area.
    pub orientation: Orientation,
    /// Whether its UV area is no more than the rounding of its coordinates can make:
    /// `A₂ ≤ 4 ε · max |coordinate| · (|e₁| + |e₂|)`. Always so for a collapsed triangle. Its
    /// stretch and its quasi-conformal distortion count as infinite.
    pub within_rounding: bool,
    /// Whether it has no area in 3-D to compare with: `A₃ ≤ 1e-14 ΣA₃` over its component. The distortions and angles
    /// of such a triangle mean nothing and enter no sum.
    pub degenerate_3d: bool,
    /// Its part of the whole surface, `A₃ / ΣA₃`.
    pub surface_share: f64,
    /// Area distortion `(A₂ / A₃) / (ΣA₂ / ΣA₃)`: 1 where the map keeps areas up to its overall
    /// scale, below 1 where it shrinks.
    pub area_ratio: f64,
    /// L² stretch `√((s₁² + s₂²) / 2) · √(ΣA₂ / ΣA₃)` (Sander et al. 2001): 1 for an isometry.
    pub stretch_l2: f64,
    /// L∞ stretch `s₁ · √(ΣA₂ / ΣA₃)` (Sander et al. 2001): 1 for an isometry.
    pub stretch_linf: f64,
    /// Quasi-conformal distortion `s₁ / s₂`: 1 for a similarity, never less.
    pub quasi_conformal: f64,
    /// The angles α° in 3-D at the three corners, in radians.
    pub mesh_angles: [f64; 3],
    /// The angles x in the plane at the three corners, in radians, without sign.
    pub uv_angles: [f64; 3],
}

impl FaceDistortion {
    /// The angle errors `x − α°` at the three corners, in radians.
    #[must_use]
    pub fn angle_errors(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.uv_angles[k] - self.mesh_angles[k])
    }
}

/// Measures every triangle of a mesh against its UV triangle, in the order of the faces.
///
/// # Errors
/// [`MetricsError`] when there is nothing to compare.
pub fn per_face(mesh: &TriMesh, uv: &UvMap) -> Result<Vec<FaceDistortion>, MetricsError> {
    let survey = Survey::new(mesh, uv)?;
    let faces = (0..mesh.face_count()).into_par_iter().with_min_len(FACES_PER_TASK);
    Ok(faces.map(|f| survey.face(FaceId::new(f))).collect())
}

/// The share of the surface below which a triangle has no shape to compare with.
const NO_SURFACE: f64 = 1e-14;

/// How many faces a thread takes at a time.
const FACES_PER_TASK: usize = 1 << 12;

/// A mesh and its UVs, each scaled to coordinates around 1, with everything that has to be known
/// about the whole before one face can be judged.
pub(crate) struct Survey<'a> {
    mesh: &'a TriMesh,
    uv: &'a UvMap,
    surface_scale: f64,
    uv_scale: f64,
    charts: Charts,
    /// For every chart the sign of its net area.
    majority: Vec<f64>,
    /// For every face its area in 3-D and its signed area in the plane, both in scaled units.
    areas: Vec<(f64, f64)>,
    total_surface: f64,
    total_uv: f64,
    /// For every face the surface of its component, where some face is next to nothing of the whole.
    component_surface: Option<Vec<f64>>,
}

impl<'a> Survey<'a> {
    /// Checks the input, finds the charts and takes the totals.
    pub(crate) fn new(mesh: &'a TriMesh, uv: &'a UvMap) -> Result<Self, MetricsError> {
        Self::with_charts(mesh, uv, || Charts::find(mesh, uv))
    }

    /// The same for a map that is known to be one chart.
    pub(crate) fn of_one_chart(mesh: &'a TriMesh, uv: &'a UvMap) -> Result<Self, MetricsError> {
        Self::with_charts(mesh, uv, || Charts::ONE)
    }

    fn with_charts(mesh: &'a TriMesh, uv: &'a UvMap, charts: impl FnOnce() -> Charts) -> Result<Self, MetricsError> {
        check(mesh, uv)?;
        let corners_of = |face: &[VertexId; 3]| face.map(|v| mesh.positions()[v.index()]);
        let flat_of = |face: &[UvId; 3]| face.map(|t| uv.points()[t.index()]);
        let surfaces = mesh.faces().par_iter().with_min_len(FACES_PER_TASK);
        let flats = uv.corners().as_chunks::<3>().0.par_iter().with_min_len(FACES_PER_TASK);
        let surface_scale =
            power_of_two_scale(largest(surfaces.clone().map(|f| corners_of(f).map(|p| p.coords.amax()))));
        let uv_scale = power_of_two_scale(largest(flats.clone().map(|f| flat_of(f).map(|p| p.coords.amax()))));
        let area_in_space = |face| surface_area(&corners_of(face).map(|p| p * surface_scale));
        let area_in_plane = |face| signed_uv_area(&flat_of(face).map(|p| p * uv_scale));
        let areas: Vec<(f64, f64)> = surfaces.zip(flats).map(|(s, f)| (area_in_space(s), area_in_plane(f))).collect();
        let total_surface = areas.iter().map(|&(surface, _)| surface).sum();
        if total_surface == 0.0 {
            return Err(MetricsError::NoArea { faces: mesh.face_count() });
        }
        let total_uv = areas.iter().map(|&(_, flat)| flat.abs()).sum();
        let charts = charts();
        let majority = majority_signs(&charts, &areas);
        let tiny = areas.iter().any(|&(surface, _)| surface <= NO_SURFACE * total_surface);
        let component_surface = tiny.then(|| component_surfaces(mesh, &areas));
        Ok(Self {
            mesh,
            uv,
            surface_scale,
            uv_scale,
            charts,
            majority,
            areas,
            total_surface,
            total_uv,
            component_surface,
        })
    }

    /// How many charts the map has.
    pub(crate) fn chart_count(&self) -> usize {
        self.charts.count
    }

    /// The total area in 3-D, in the units of the mesh.
    pub(crate) fn surface_area(&self) -> f64 {
        // Divided twice, because the square of the scale may overflow.
        self.total_surface / self.surface_scale / self.surface_scale
    }

    /// The total area in the plane, without sign, in the units of the UVs.
    pub(crate) fn uv_area(&self) -> f64 {
        self.total_uv / self.uv_scale / self.uv_scale
    }

    /// What `add` makes of every block of faces, in their order. Blocks are always the same, so that sums
    /// over them are too, whatever the number of threads.
    pub(crate) fn by_block<T: Default + Send>(&self, add: impl Fn(&mut T, FaceId) + Sync) -> Vec<T> {
        let count = self.areas.len();
        let block = |b: usize| {
            let mut all = T::default();
            let faces = b * FACES_PER_TASK..count.min((b + 1) * FACES_PER_TASK);
            faces.map(FaceId::new).for_each(|f| add(&mut all, f));
            all
        };
        (0..count.div_ceil(FACES_PER_TASK)).into_par_iter().map(block).collect()
    }

    /// The chart of a face.
    pub(crate) fn chart_of(&self, face: FaceId) -> usize {
        self.charts.of(face)
    }

    /// For every chart its largest coordinate without sign, scaled.
    pub(crate) fn largest_coordinates(&self) -> Vec<f64> {
        let mut largest = vec![0.0_f64; self.charts.count];
        for face in (0..self.areas.len()).map(FaceId::new) {
            let here = self.uv.triangle(face).map(|p| p.coords.amax()).into_iter().fold(0.0, f64::max);
            let of_chart = &mut largest[self.charts.of(face)];
            *of_chart = of_chart.max(here * self.uv_scale);
        }
        largest
    }

    /// The mesh.
    pub(crate) fn mesh(&self) -> &'a TriMesh {
        self.mesh
    }

    /// Its UVs, as given.
    pub(crate) fn uv(&self) -> &'a UvMap {
        self.uv
    }

    /// The power of two that brings the UVs around 1.
    pub(crate) fn uv_scale(&self) -> f64 {
        self.uv_scale
    }

    /// Whether the chart of a face is mirrored as a whole.
    pub(crate) fn is_mirrored(&self, face: FaceId) -> bool {
        self.majority[self.charts.of(face)] < 0.0
    }

    /// How a face lies.
    pub(crate) fn lies(&self, face: FaceId) -> Orientation {
        self.orientation(face, self.areas[face.index()].1)
    }

    /// The UV triangle of a face, scaled, with its area without sign.
    pub(crate) fn flat_triangle(&self, face: FaceId) -> ([Point2<f64>; 3], f64) {
        (self.uv.triangle(face).map(|p| p * self.uv_scale), self.areas[face.index()].1.abs())
    }

    /// `A₂ / A₃` of a face, up to a factor that is the same for all; `None` where there is no shape to compare with.
    pub(crate) fn area_ratio(&self, face: FaceId) -> Option<f64> {
        let (surface, flat) = self.areas[face.index()];
        (!self.has_no_surface(face, surface)).then_some(flat.abs() / surface)
    }

    /// Whether a face of this area is next to nothing of its component, or of the whole and on one line to rounding.
    fn has_no_surface(&self, face: FaceId, surface: f64) -> bool {
        if surface > NO_SURFACE * self.total_surface {
            return false;
        }
        let component = self.component_surface.as_ref().map_or(self.total_surface, |of_face| of_face[face.index()]);
        let [a, b, c] = self.mesh.triangle(face).map(|p| p * self.surface_scale);
        let longest = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
        surface <= NO_SURFACE * component || surface <= 2.0 * f64::EPSILON * longest
    }

    /// What became of a face.
    pub(crate) fn face(&self, face: FaceId) -> FaceDistortion {
        let surface = self.mesh.triangle(face).map(|p| p * self.surface_scale);
        let flat = self.uv.triangle(face).map(|p| p * self.uv_scale);
        let (area_3d, signed) = self.areas[face.index()];
        let area_uv = signed.abs();
        let within_rounding = is_within_rounding(&flat, area_uv, f64::EPSILON);
        let [stretch_l2, stretch_linf, quasi_conformal] =
            if within_rounding { [f64::INFINITY; 3] } else { self.stretch(&surface, &flat, area_3d, area_uv) };
        let surface_share = area_3d / self.total_surface;
        // A map without any area has shrunk every triangle to nothing, not to 0/0.
        let uv_share = if area_uv > 0.0 { area_uv / self.total_uv } else { 0.0 };
        FaceDistortion {
            orientation: self.orientation(face, signed),
            within_rounding,
            degenerate_3d: self.has_no_surface(face, area_3d),
            surface_share,
            area_ratio: uv_share / surface_share,
            stretch_l2,
            stretch_linf,
            quasi_conformal,
            mesh_angles: angles(&surface, area_3d),
            uv_angles: angles(&flat, area_uv),
        }
    }

    /// L² stretch, L∞ stretch and quasi-conformal distortion of a triangle with area in the plane.
    fn stretch(&self, surface: &[Point3<f64>; 3], flat: &[Point2<f64>; 3], area_3d: f64, area_uv: f64) -> [f64; 3] {
        let to_isometry = (self.total_uv / self.total_surface).sqrt();
        let s1 = largest_singular_value(surface, flat, area_uv);
        let s2 = area_3d / area_uv / s1;
        [(0.5 * (s1 * s1 + s2 * s2)).sqrt() * to_isometry, s1 * to_isometry, s1 / s2]
    }

    fn orientation(&self, face: FaceId, signed_area: f64) -> Orientation {
        let along_majority = signed_area * self.majority[self.charts.of(face)];
        if along_majority > 0.0 {
            Orientation::Kept
        } else if along_majority < 0.0 {
            Orientation::Flipped
        } else {
            Orientation::Collapsed
        }
    }
}

/// For every face the area of the component it is in; faces that share a vertex are in one.
fn component_surfaces(mesh: &TriMesh, areas: &[(f64, f64)]) -> Vec<f64> {
    let mut sets = DisjointSets::new(mesh.vertex_count());
    for [a, b, c] in mesh.faces() {
        sets.unite(a.index(), b.index());
        sets.unite(b.index(), c.index());
    }
    let roots: Vec<usize> = mesh.faces().iter().map(|face| sets.find(face[0].index())).collect();
    let mut totals = vec![0.0; mesh.vertex_count()];
    roots.iter().zip(areas).for_each(|(&root, &(surface, _))| totals[root] += surface);
    roots.iter().map(|&root| totals[root]).collect()
}

/// For every chart `+1` or `−1`, the sign of the sum of its signed areas; `+1` for a sum of zero.
fn majority_signs(charts: &Charts, areas: &[(f64, f64)]) -> Vec<f64> {
    let mut net = vec![0.0; charts.count];
    for (face, &(_, signed)) in areas.iter().enumerate() {
        net[charts.of(FaceId::new(face))] += signed;
    }
    net.iter().map(|&sum| if sum < 0.0 { -1.0 } else { 1.0 }).collect()
}

/// The largest of numbers that are not negative.
fn largest(numbers: impl ParallelIterator<Item = [f64; 3]>) -> f64 {
    numbers.map(|three| three.into_iter().fold(0.0, f64::max)).reduce(|| 0.0, f64::max)
}

fn check(mesh: &TriMesh, uv: &UvMap) -> Result<(), MetricsError> {
    let (faces, corners) = (mesh.face_count(), uv.corners().len());
    if faces == 0 {
        return Err(MetricsError::NoFaces);
    }
    if corners != 3 * faces {
        return Err(MetricsError::CornerCount { corners, faces });
    }
    let finite = |p: &Point3<f64>| p.iter().all(|x| x.is_finite());
    // Points of no face may be anything; only where one is bad do faces have to be looked at.
    if !mesh.positions().par_iter().with_min_len(FACES_PER_TASK).all(finite)
        && let Some((first, count)) = first_and_count(mesh.triangles().map(|t| !t.iter().all(finite)))
    {
        return Err(MetricsError::PositionNotFinite { first, count });
    }
    let finite = |p: &Point2<f64>| p.iter().all(|x| x.is_finite());
    if !uv.points().par_iter().with_min_len(FACES_PER_TASK).all(finite)
        && let Some((first, count)) = first_and_count(uv.triangles().map(|t| !t.iter().all(finite)))
    {
        return Err(MetricsError::UvNotFinite { first, count });
    }
    Ok(())
}

/// The first face that is bad and how many are, if any is.
fn first_and_count(bad: impl Iterator<Item = bool>) -> Option<(FaceId, usize)> {
    let mut bad = bad.enumerate().filter(|&(_, bad)| bad);
    let (first, _) = bad.next()?;
    Some((FaceId::new(first), 1 + bad.count()))
}
