//! A result, and what its owner sees of it.

use abf::mesh::{Point2, TriMesh, UvMap, VertexId};
use abf::{Flattening, Metrics, PinReport, RelaxReport, RelaxedMap, Termination, UnwrappedArrays, UnwrappedChart};
use std::ffi::{CString, c_char};
use std::mem::offset_of;
use std::ptr;

/// How the solver ended. Of an atlas: the first end that was not as asked, if there is one.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AbfTermination {
    /// The stopping criteria are met.
    Converged = 0,
    /// The one pass, or the one linear solve, that was asked for is done.
    OnePass = 1,
    /// The largest number of iterations is done.
    MaxIterations = 2,
    /// The time is up.
    TimeLimit = 3,
    /// The residual stopped falling.
    Stalled = 4,
    /// The callback stopped it.
    Cancelled = 5,
}

/// What a result holds. Pointers are valid as long as the result.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AbfView {
    /// `sizeof(AbfView)`, set by the caller. Later versions append fields, and fill as much as the caller has.
    pub size: usize,
    /// Vertices of the result. `abf_flatten`, and `abf_relax` without `uv_indices`: those of the input.
    pub vertex_count: usize,
    /// `abf_flatten`, `abf_relax`: two numbers per vertex, u and v; else null.
    pub uv64: *const f64,
    /// `abf_unwrap`: two numbers per vertex, u and v, in the unit square of its page; else null.
    pub uv32: *const f32,
    /// `abf_unwrap`, and `abf_relax` with `uv_indices`: for each vertex the vertex of the input it is a copy of; else null.
    pub remap: *const u32,
    /// Triangles, in the order of the input.
    pub triangle_count: usize,
    /// The same: three vertices of the result per triangle; else null: they are those of the input.
    pub indices: *const u32,
    /// `abf_unwrap`, `abf_relax`: the chart of each triangle, `UINT32_MAX` where it is in none; else null.
    pub triangle_charts: *const u32,
    /// Charts.
    pub chart_count: usize,
    /// `abf_unwrap`: the page of each chart; else null.
    pub chart_pages: *const u32,
    /// `abf_unwrap`: pages; else 0.
    pub page_count: usize,
    /// `abf_unwrap`: texels of a page along x; else 0.
    pub width: u32,
    /// `abf_unwrap`: texels of a page along y; else 0.
    pub height: u32,
    /// `abf_unwrap`: texels per unit of the mesh; else 0.
    pub texels_per_unit: f64,
    /// `abf_unwrap`: the part of the pages that charts cover; else 0.
    pub coverage: f64,
    /// Valid, and every solver ended as asked. Of an atlas: every chart is finished, and nothing lies over anything else, unless
    /// `overlap` allows that.
    pub certified: bool,
    /// No triangle is flipped or collapsed, no interior vertex wound around twice. Proved with exact signs.
    pub valid: bool,
    /// Valid, and nothing lies over anything else.
    pub injective: bool,
    /// How the solver ended.
    pub termination: AbfTermination,
    /// Triangles that are turned over.
    pub flips: usize,
    /// Triangles whose corners lie on one line.
    pub collapsed: usize,
    /// Interior vertices that are wound around more than once.
    pub wound: usize,
    /// Places where the map lies over itself.
    pub overlaps: usize,
    /// `abf_unwrap`: charts that there was no time to finish; `abf_relax`: charts that could not be relaxed.
    pub unfinished: usize,
    /// F / 3nt, the mean squared angle error, rad².
    pub angle_error: f64,
    /// L² stretch, 1 for an isometry.
    pub stretch_l2: f64,
    /// L∞ stretch.
    pub stretch_linf: f64,
    /// Quasi-conformal distortion, the mean, 1 for a conformal map.
    pub qc_mean: f64,
    /// The largest.
    pub qc_max: f64,
    /// Area distortion, 0 where areas keep their proportions.
    pub area_l2: f64,
    /// Area of the surface, in units of the mesh squared.
    pub surface_area: f64,
    /// Area of the map, in UV units squared.
    pub uv_area: f64,
    /// Whose result it is; "several" where charts differ; `abf_relax`: empty.
    pub solver: *const c_char,
    /// `abf_unwrap`: what was repaired, sentences separated by ", "; empty where nothing was.
    pub repairs: *const c_char,
    /// `abf_unwrap`: how many cuts were made for `coverage`.
    pub parted_for_coverage: usize,
    /// `abf_unwrap`: how many cuts were made for `inner_margin`.
    pub parted_for_margin: usize,
    /// How many steps `energy` took, all charts together; 0: none was asked for, or there was no map or no time.
    pub relax_steps: usize,
    /// The energy before, for a surface of area 1; of several charts the mean by area. 0 without steps.
    pub energy_before: f64,
    /// The same at the end.
    pub energy_after: f64,
    /// Pins.
    pub pin_count: usize,
    /// How far each pinned vertex is from its place, in units of the UVs, in the order of the options; else null.
    pub pin_distances: *const f64,
    /// How many pins must be met and are not, of those that were tried: without any, `pin_count` is 0.
    pub pins_missed: usize,
}

impl AbfView {
    /// The sizes of the struct in all versions of the header. What is appended begins where the one before ended.
    pub(crate) const SIZES: [usize; 2] = [offset_of!(Self, parted_for_coverage), size_of::<Self>()];
}

/// A result.
#[derive(Debug)]
pub struct AbfResult {
    uv64: Vec<[f64; 2]>,
    uv32: Vec<[f32; 2]>,
    remap: Vec<u32>,
    indices: Vec<u32>,
    triangle_charts: Vec<u32>,
    chart_pages: Vec<u32>,
    charts: usize,
    unfinished: usize,
    page: [u32; 2],
    pages: usize,
    texels_per_unit: f64,
    coverage: f64,
    certified: bool,
    termination: AbfTermination,
    metrics: Metrics,
    solver: CString,
    repairs: CString,
    parted: [usize; 2],
    energy: Energies,
    pins: Vec<f64>,
    missed: usize,
}

/// What relaxing came to, all charts together.
#[derive(Clone, Copy, Debug, Default)]
struct Energies {
    steps: usize,
    before: f64,
    after: f64,
}

impl Energies {
    /// Of charts with their areas.
    fn of<'r>(charts: impl Iterator<Item = (&'r RelaxReport, f64)>) -> Self {
        let (mut all, mut area) = (Self::default(), 0.0);
        for (report, own) in charts {
            all.steps += report.steps;
            all.before += own * report.before;
            all.after += own * report.after;
            area += own;
        }
        if area > 0.0 { Self { before: all.before / area, after: all.after / area, ..all } } else { Self::default() }
    }
}

/// How far pins are from their places, and how many of those that must be met are not.
fn pins(report: Option<&PinReport>) -> (Vec<f64>, usize) {
    let residuals = report.map_or(&[][..], |report| &report.residuals);
    let missed = residuals.iter().filter(|pin| pin.is_missed()).count();
    (residuals.iter().map(|pin| pin.distance).collect(), missed)
}

impl AbfResult {
    pub(crate) fn of_disk(mesh: &TriMesh, flat: &Flattening, metrics: Metrics) -> Self {
        let (pins, missed) = pins(flat.pinned.as_ref());
        let (uv64, remap, indices) = rows_of(mesh, &flat.uv, false);
        Self {
            energy: Energies::of(flat.relaxed.iter().map(|report| (report, 1.0))),
            pins,
            missed,
            uv64,
            uv32: Vec::new(),
            remap,
            indices,
            triangle_charts: Vec::new(),
            chart_pages: Vec::new(),
            charts: flat.injective.as_ref().map_or(1, |report| report.parts),
            unfinished: 0,
            page: [0; 2],
            pages: 0,
            texels_per_unit: 0.0,
            coverage: 0.0,
            certified: flat.is_certified(),
            termination: of_termination(flat.termination),
            metrics,
            solver: text(flat.solver.name()),
            repairs: CString::default(),
            parted: [0; 2],
        }
    }

    /// A map that was there, relaxed: with indices where UVs were those of corners.
    pub(crate) fn of_map(mesh: &TriMesh, map: &RelaxedMap, metrics: Metrics, is_per_corner: bool) -> Self {
        let (pins, missed) = pins(map.pinned.as_ref());
        let (uv64, remap, indices) = rows_of(mesh, &map.uv, is_per_corner);
        let mut areas = vec![0.0; map.charts.len()];
        let area = |face: &[VertexId; 3]| {
            let [a, b, c] = face.map(|v| mesh.positions()[v.index()]);
            (b - a).cross(&(c - a)).norm()
        };
        map.chart_of_face.iter().zip(mesh.faces()).for_each(|(&chart, face)| areas[chart] += area(face));
        let relaxed = map.charts.iter().zip(areas).filter_map(|(report, area)| Some((report.as_ref()?, area)));
        Self {
            uv64,
            uv32: Vec::new(),
            remap,
            indices,
            triangle_charts: map.chart_of_face.iter().map(|&chart| chart as u32).collect(),
            chart_pages: Vec::new(),
            charts: map.charts.len(),
            unfinished: map.refused.len(),
            page: [0; 2],
            pages: 0,
            texels_per_unit: 0.0,
            coverage: 0.0,
            certified: map.is_certified(),
            termination: of_termination(map.termination),
            metrics,
            solver: CString::default(),
            repairs: CString::default(),
            parted: [0; 2],
            energy: Energies::of(relaxed),
            pins,
            missed,
        }
    }

    pub(crate) fn of_atlas(arrays: UnwrappedArrays, page: [u32; 2], may_overlap: bool) -> Self {
        let certified = arrays.is_certified(may_overlap);
        let parted = [arrays.parted_for_coverage, arrays.parted_for_margin];
        let UnwrappedArrays { uvs, indices, remap, packed, unwrapped, .. } = arrays;
        let charts = &unwrapped.charts;
        let mut triangle_charts = vec![u32::MAX; indices.len() / 3];
        for (number, chart) in charts.iter().enumerate() {
            chart.faces.iter().for_each(|face| triangle_charts[face.index()] = number as u32);
        }
        let solver = charts.first().map_or("", |chart| chart.solver.name());
        let area = |chart: &UnwrappedChart| chart.metrics.surface_area;
        let energy = Energies::of(charts.iter().filter_map(|chart| Some((chart.relaxed.as_ref()?, area(chart)))));
        let is_one = charts.iter().all(|chart| chart.solver.name() == solver);
        let ends = || charts.iter().map(|chart| chart.termination);
        let termination = ends().find(|end| !end.is_as_asked()).or_else(|| ends().next());
        Self {
            uv64: Vec::new(),
            uv32: uvs,
            remap,
            indices,
            triangle_charts,
            chart_pages: packed.placements.iter().map(|placement| placement.page as u32).collect(),
            charts: charts.len(),
            unfinished: charts.iter().filter(|chart| chart.unfinished).count(),
            page,
            pages: packed.pages,
            texels_per_unit: packed.texels_per_unit,
            coverage: packed.coverage,
            certified,
            termination: termination.map_or(AbfTermination::Converged, of_termination),
            metrics: packed.metrics,
            solver: text(if is_one { solver } else { "several" }),
            repairs: text(&unwrapped.repairs.sentences().join(", ")),
            parted,
            energy,
            pins: Vec::new(),
            missed: 0,
        }
    }

    pub(crate) fn view(&self) -> AbfView {
        let (metrics, certificate) = (&self.metrics, &self.metrics.certificate);
        AbfView {
            size: size_of::<AbfView>(),
            vertex_count: self.uv64.len().max(self.uv32.len()),
            uv64: start(&self.uv64).cast(),
            uv32: start(&self.uv32).cast(),
            remap: start(&self.remap),
            triangle_count: metrics.triangles.max(self.indices.len() / 3),
            indices: start(&self.indices),
            triangle_charts: start(&self.triangle_charts),
            chart_count: self.charts,
            chart_pages: start(&self.chart_pages),
            page_count: self.pages,
            width: self.page[0],
            height: self.page[1],
            texels_per_unit: self.texels_per_unit,
            coverage: self.coverage,
            certified: self.certified,
            valid: certificate.valid(),
            injective: certificate.injective(),
            termination: self.termination,
            flips: certificate.flips,
            collapsed: certificate.collapsed,
            wound: certificate.wound,
            overlaps: certificate.overlaps(),
            unfinished: self.unfinished,
            angle_error: metrics.f,
            stretch_l2: metrics.stretch_l2,
            stretch_linf: metrics.stretch_linf,
            qc_mean: metrics.qc_mean,
            qc_max: metrics.qc_max,
            area_l2: metrics.area_l2,
            surface_area: metrics.surface_area,
            uv_area: metrics.uv_area,
            solver: self.solver.as_ptr(),
            repairs: self.repairs.as_ptr(),
            parted_for_coverage: self.parted[0],
            parted_for_margin: self.parted[1],
            relax_steps: self.energy.steps,
            energy_before: self.energy.before,
            energy_after: self.energy.after,
            pin_count: self.pins.len(),
            pin_distances: start(&self.pins),
            pins_missed: self.missed,
        }
    }
}

/// The rows of a map, of each the vertex, and the row of every corner. Of a map with one row per vertex the last two are empty; it
/// is one unless rows per corner are asked for, or a vertex has several.
fn rows_of(mesh: &TriMesh, uv: &UvMap, is_per_corner: bool) -> (Vec<[f64; 2]>, Vec<u32>, Vec<u32>) {
    let rows = |points: &[Point2<f64>]| points.iter().map(|p| [p.x, p.y]).collect();
    let per_vertex = if is_per_corner { None } else { uv.one_per_vertex(mesh) };
    if let Some(points) = per_vertex {
        return (rows(&points), Vec::new(), Vec::new());
    }
    let mut remap = vec![0; uv.points().len()];
    let corners = || uv.corners().iter().map(|id| id.index());
    corners().zip(mesh.faces().as_flattened()).for_each(|(row, vertex)| remap[row] = vertex.index() as u32);
    (rows(uv.points()), remap, corners().map(|row| row as u32).collect())
}

/// Where an array begins; null where there is none.
fn start<T>(array: &[T]) -> *const T {
    if array.is_empty() { ptr::null() } else { array.as_ptr() }
}

/// Text without a zero byte inside.
pub(crate) fn text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

fn of_termination(termination: Termination) -> AbfTermination {
    match termination {
        Termination::Converged => AbfTermination::Converged,
        Termination::OnePass => AbfTermination::OnePass,
        Termination::MaxIterations => AbfTermination::MaxIterations,
        Termination::TimeLimit => AbfTermination::TimeLimit,
        Termination::Cancelled => AbfTermination::Cancelled,
        _ => AbfTermination::Stalled,
    }
}
