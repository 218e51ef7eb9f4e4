//! Long charts, parted: one that is far longer than a page is wide would set the density of all others.

use super::finish::Finished;
use super::overlap::{neighbours, part_of};
use super::{SurfaceHints, Unwrap, UnwrapError};
use crate::FlattenError;
use abf_control::Checkpoint;
use abf_cut::{Chart, Repaired};
use abf_mesh::{CornerId, DisjointSets, FaceId, Point2, UvMap, Vector2};
use std::collections::BTreeMap;

/// About the part of a page that charts cover.
const COVERED: f64 = 0.5;

impl Unwrap {
    /// Parts the charts of all components that are longer than `limit` page widths, into parts of at most one page width.
    /// A page is as wide as the square that all charts together cover half of. A chart stays whole where a part would have
    /// more L2 stretch than the chart and the aim. Gives back how many charts were parted.
    pub(super) fn part_long(
        &self,
        limit: f64,
        (repaired, hints): (&Repaired, &SurfaceHints<'_>),
        components: &[Chart],
        charts: &mut [Vec<Finished>],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<usize, UnwrapError> {
        let may_not_cut = |part: &Chart, c: CornerId| {
            let of_component = |c: CornerId| part.faces[c.face().index()].corner(c.place());
            let sides = [Some(c), part.topology.opposite(c)];
            sides.into_iter().flatten().any(|c| hints.is_forbidden(repaired.input_corner(of_component(c))))
        };
        let area: f64 = charts.iter().flatten().map(|chart| chart.metrics.surface_area).sum();
        let width = (area / COVERED).sqrt();
        let mut parted = 0;
        for (component, charts) in components.iter().zip(charts) {
            let first = repaired.faces[component.faces[0].index()];
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
                if parts.len() > 1 && worst <= chart.metrics.stretch_l2.max(self.max_stretch) {
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
    component: &Chart,
    chart: &Finished,
    (length, axis): (f64, Vector2<f64>),
    width: f64,
    may_not_cut: &dyn Fn(&Chart, CornerId) -> bool,
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
    // By the first face of each, the faces ascending.
    let mut places_of: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    (0..faces).for_each(|f| places_of.entry(connected.find(f)).or_default().push(f));
    let mut parts = Vec::new();
    for places in places_of.values() {
        // A part without area has no map of its own.
        match part_of(&component.mesh, chart, &chart.faces, places, checkpoint) {
            Ok(part) => parts.push(part),
            Err(FlattenError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(_) => return Ok(Vec::new()),
        }
    }
    Ok(parts)
}
