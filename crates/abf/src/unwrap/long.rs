//! Long charts, parted, or laid out smaller where their faces are as long as they are: one that is far longer than a page is wide
//! would set the density of all others.

use super::finish::Finished;
use super::order::InOrder;
use super::overlap::part_of;
use super::{SurfaceHints, Unwrap, UnwrapError, UnwrappedChart};
use crate::FlattenError;
use crate::run::neighbours;
use abf_control::Checkpoint;
use abf_cut::Repaired;
use abf_mesh::{CornerId, DisjointSets, FaceId, Point2, UvMap, Vector2};
use std::collections::{BTreeMap, HashMap};

/// About the part of a page that charts cover.
const COVERED: f64 = 0.5;

/// A part of less than this share of the mean area of a slice goes with a neighbour.
const CRUMB: f64 = 0.25;

/// Parts are worth it when none is longer than this share of the chart.
const SHORTER: f64 = 0.6;

/// Parts have more L² stretch than their chart when it is more than so many times as large: the rest is rounding.
const SAME_STRETCH: f64 = 1.0 + 1e-6;

/// Charts are laid out smaller beside others that have at least this share of the area.
const LEAST_REST: f64 = 1e-3;

/// A page is made wider for charts that are laid out smaller as if they took no more than this share of what is covered.
const MOST_OF_PAGE: f64 = 0.5;

impl Unwrap {
    /// Parts the charts of all components that are longer than `limit` page widths, into slices of about one page width.
    /// A page is as wide as the square that all charts together cover half of. A chart stays whole where the parts would have
    /// more L² stretch than the chart, where one would have more than the chart and the aim, and where its faces are so long
    /// that parts are hardly shorter; so does a disk that is one chart and all there is. Gives back how many charts were
    /// parted.
    pub(super) fn part_long(
        &self,
        limit: f64,
        (repaired, hints): (&Repaired, &SurfaceHints<'_>),
        components: &[InOrder],
        charts: &mut [Vec<Finished>],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<usize, UnwrapError> {
        let may_not_cut = |part: &InOrder, c: CornerId| {
            let sides = [Some(c), part.chart.topology.opposite(c)];
            sides.into_iter().flatten().any(|c| hints.is_forbidden(repaired.input_corner(part.corner(c))))
        };
        let is_alone = charts.iter().map(Vec::len).sum::<usize>() == 1;
        if is_alone && components.iter().all(|part| part.chart.topology.require_disk().is_ok()) {
            return Ok(0);
        }
        let area: f64 = charts.iter().flatten().map(|chart| chart.metrics.surface_area).sum();
        let width = page_width(area);
        let mut parted = 0;
        for (component, charts) in components.iter().zip(charts) {
            let first = repaired.faces[component.lowest_face().index()];
            let mut out = Vec::with_capacity(charts.len());
            for chart in charts.drain(..) {
                let (length, axis) = longest(&chart.uv);
                let is_long = length > limit * width && chart.metrics.valid();
                let parts = if is_long {
                    slices(component, &chart, (length, axis), width, &may_not_cut, checkpoint)
                        .map_err(|source| UnwrapError::Chart { first, source })?
                } else {
                    Vec::new()
                };
                // The L2 stretch of a part may be above that of the whole.
                let worst = parts.iter().map(|part| part.metrics.stretch_l2).fold(0.0, f64::max);
                let left = parts.iter().map(|part| longest(&part.uv).0).fold(0.0, f64::max);
                let whole = chart.metrics.stretch_l2;
                let is_worth_it = parts.len() > 1 && left <= SHORTER * length;
                let is_no_worse = worst <= whole.max(self.max_stretch) && stretch_of(&parts) <= SAME_STRETCH * whole;
                if is_worth_it && is_no_worse {
                    parted += 1;
                    out.extend(parts);
                } else {
                    out.push(chart);
                }
            }
            out.sort_by_key(|chart| chart.faces[0]);
            *charts = out;
        }
        Ok(parted)
    }
}

/// Of charts that could not be parted, those longer than `limit` page widths are given a scale at which they are one page width
/// long; the page is that of all charts at their scales. Nothing is done where there are no others.
///
/// A chart of length l and area a at the scale s = w / l has the area a w² / l². With A the area of the others and c the part of
/// a page that is covered, c w² = A + Σ a w² / l².
pub(super) fn shrink_long(charts: &mut [UnwrappedChart], limit: f64) {
    let sizes: Vec<(f64, f64)> =
        charts.iter().map(|chart| (longest(&chart.uv).0, chart.uv.triangles().map(area_of).sum())).collect();
    let mut order: Vec<usize> = (0..charts.len()).filter(|&i| charts[i].metrics.valid()).collect();
    order.sort_by(|&i, &j| sizes[j].0.total_cmp(&sizes[i].0).then(i.cmp(&j)));
    let all: f64 = sizes.iter().map(|size| size.1).sum();
    let mut rest = all;
    let mut long = Vec::new();
    for i in order {
        let (length, area) = sizes[i];
        if length > limit * page_width(rest) && rest - area > LEAST_REST * all {
            long.push(i);
            rest -= area;
        } else {
            break;
        }
    }
    let thin: f64 = long.iter().map(|&i| sizes[i].1 / (COVERED * sizes[i].0.powi(2))).sum();
    let width = page_width(rest / (1.0 - thin.min(MOST_OF_PAGE)));
    for i in long {
        charts[i].scale = (width / sizes[i].0).min(1.0);
    }
}

/// The L² stretch of charts at one scale, where each has the area of its surface.
fn stretch_of(parts: &[Finished]) -> f64 {
    let weighed = |part: &Finished| part.metrics.surface_area * part.metrics.stretch_l2.powi(2);
    let area: f64 = parts.iter().map(|part| part.metrics.surface_area).sum();
    (parts.iter().map(weighed).sum::<f64>() / area).sqrt()
}

fn area_of([p, q, r]: [Point2<f64>; 3]) -> f64 {
    0.5 * (q - p).perp(&(r - p)).abs()
}

/// The side of the square that so much area covers [`COVERED`] of.
fn page_width(area: f64) -> f64 {
    (area / COVERED).sqrt()
}

/// About the largest distance of two points, and the direction between them.
fn longest(uv: &UvMap) -> (f64, Vector2<f64>) {
    let farthest = |from: Point2<f64>| {
        let further = |a: Point2<f64>, b: &Point2<f64>| if (b - from).norm() > (a - from).norm() { *b } else { a };
        uv.points().iter().fold(from, further)
    };
    let Some(&first) = uv.points().first() else { return (0.0, Vector2::zeros()) };
    let one = farthest(first);
    let way = farthest(one) - one;
    (way.norm(), way.try_normalize(0.0).unwrap_or_default())
}

/// The connected parts of a chart in slices of equal width across its length.
fn slices(
    component: &InOrder,
    chart: &Finished,
    (length, axis): (f64, Vector2<f64>),
    width: f64,
    may_not_cut: &dyn Fn(&InOrder, CornerId) -> bool,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Vec<Finished>, FlattenError> {
    let along = |p: &Point2<f64>| p.coords.dot(&axis);
    let low = chart.uv.points().iter().map(along).fold(f64::INFINITY, f64::min);
    let count = (length / width).ceil();
    let slice = |f: usize| {
        let middle = chart.uv.triangle(FaceId::new(f)).iter().map(along).sum::<f64>() / 3.0;
        ((middle - low) / length * count).clamp(0.0, count - 1.0) as u32
    };
    let faces = chart.faces.len();
    let neighbours = neighbours(&chart.uv);
    let is_kept = |f: usize, k: usize| may_not_cut(component, chart.faces[f].corner(k));
    // Triangles of a polygon go with the first of them.
    let mut polygons = DisjointSets::new(faces);
    for (f, around) in neighbours.iter().enumerate() {
        for (k, g) in around.iter().enumerate() {
            if let Some(g) = g.filter(|_| is_kept(f, k)) {
                polygons.unite(f, g);
            }
        }
    }
    let slice_of: Vec<u32> = (0..faces).map(|f| slice(polygons.find(f))).collect();
    let mut connected = DisjointSets::new(faces);
    for (f, around) in neighbours.iter().enumerate() {
        for &g in around.iter().flatten().filter(|&&g| slice_of[g] == slice_of[f]) {
            connected.unite(f, g);
        }
    }
    let area = |f: usize| area_of(chart.uv.triangle(FaceId::new(f)));
    let least = CRUMB * (0..faces).map(area).sum::<f64>() / count;
    while join_crumbs(&chart.uv, &neighbours, &mut connected, &area, least) {
        checkpoint()?;
    }
    // By the first face of each, the faces ascending.
    let mut places_of: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    (0..faces).for_each(|f| places_of.entry(connected.find(f)).or_default().push(f));
    let mut parts = Vec::new();
    for places in places_of.values() {
        // A part without area has no map of its own.
        match part_of(&component.chart.mesh, chart, &chart.faces, places, checkpoint) {
            Ok(part) => parts.push(part),
            Err(FlattenError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(_) => return Ok(Vec::new()),
        }
    }
    Ok(parts)
}

/// Joins every set of faces of less than the `least` area to the neighbour that it shares the longest border with. Whether there
/// was one; the sets may still be too small then.
fn join_crumbs(
    uv: &UvMap,
    neighbours: &[[Option<usize>; 3]],
    sets: &mut DisjointSets,
    area: &dyn Fn(usize) -> f64,
    least: f64,
) -> bool {
    let mut areas: BTreeMap<usize, f64> = BTreeMap::new();
    (0..neighbours.len()).for_each(|f| *areas.entry(sets.find(f)).or_default() += area(f));
    let mut borders: HashMap<[usize; 2], f64> = HashMap::new();
    for (f, around) in neighbours.iter().enumerate() {
        let corners = uv.triangle(FaceId::new(f));
        for (k, g) in around.iter().enumerate().filter_map(|(k, g)| g.map(|g| (k, g))) {
            let (one, other) = (sets.find(f), sets.find(g));
            if one != other {
                *borders.entry([one, other]).or_default() += (corners[(k + 1) % 3] - corners[(k + 2) % 3]).norm();
            }
        }
    }
    let mut beside: BTreeMap<usize, (f64, usize)> = BTreeMap::new();
    for (&[one, other], &length) in borders.iter().filter(|([one, _], _)| areas[one] < least) {
        let best = beside.entry(one).or_insert((length, other));
        if length > best.0 || (length == best.0 && other < best.1) {
            *best = (length, other);
        }
    }
    let mut is_any = false;
    for (one, (_, other)) in beside {
        is_any |= sets.unite(one, other);
    }
    is_any
}
