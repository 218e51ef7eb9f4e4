//! A chart in two.

use super::super::judge::Parts;
use super::corners::{corners, length};
use super::cut::{Cut, Sheet};
use crate::unwrap::{Unwrapped, UnwrappedChart};
use abf_mesh::{DisjointSets, FaceId, TriMesh, UvMap, VertexId};
use abf_metrics::{MetricsError, Precision, certify, measure_certified};
use std::collections::{HashMap, HashSet};

/// Parts charts and measures their parts.
pub(super) struct Splitter<'a> {
    mesh: &'a TriMesh,
    /// Of all faces, where their charts came out.
    parts: Parts<'a>,
    forbidden: Option<&'a [bool]>,
    precision: Precision,
    max_stretch: f64,
}

impl<'a> Splitter<'a> {
    /// `uv` has every chart where it came out.
    pub(super) fn new(
        mesh: &'a TriMesh,
        turned: &[FaceId],
        uv: &'a UvMap,
        (forbidden, precision, max_stretch): (Option<&'a [bool]>, Precision, f64),
    ) -> Self {
        Self { mesh, parts: Parts::new(mesh, turned, uv), forbidden, precision, max_stretch }
    }

    /// The edges of a chart; `None` for one that cannot be parted.
    pub(super) fn sheet(&self, chart: &UnwrappedChart) -> Option<Sheet> {
        chart.metrics.injective().then(|| Sheet::new(self.mesh, chart, self.forbidden)).flatten()
    }

    /// The seams of all charts, or, where there are none, the half of their boundaries.
    pub(super) fn seam_length(&self, unwrapped: &Unwrapped) -> f64 {
        if unwrapped.seam_length > 0.0 {
            return unwrapped.seam_length;
        }
        let borders = unwrapped.charts.iter().flat_map(|chart| border(self.mesh, chart));
        0.5 * borders.map(|edge| length(self.mesh, edge)).sum::<f64>()
    }

    /// Everything with one chart in two. `None` where the cut does not make two of it, or a part stretches too much.
    pub(super) fn parted(
        &self,
        unwrapped: &Unwrapped,
        chart: usize,
        cut: &Cut,
    ) -> Result<Option<Unwrapped>, MetricsError> {
        let whole = &unwrapped.charts[chart];
        let Some(is_other) = self.sides(whole, cut) else { return Ok(None) };
        let most = self.max_stretch.max(whole.metrics.stretch_l2);
        let mut seams = unwrapped.seams.clone();
        seams.extend(self.edges(whole, cut));
        seams.sort_unstable();
        seams.dedup();
        let mut parts = Vec::with_capacity(2);
        for side in [false, true] {
            let mut part = part_of(whole, |i| is_other[i] == side);
            let (mesh, uv, _) = self.parts.of(&part.faces);
            let certificate = certify(&mesh, &uv, self.precision)?;
            part.metrics = measure_certified(&mesh, &uv, certificate)?;
            if !(part.metrics.injective() && part.metrics.stretch_l2 <= most) {
                return Ok(None);
            }
            let mut edges = border(self.mesh, &part);
            edges.sort_unstable();
            edges.dedup();
            let of_seam = edges.into_iter().filter(|edge| seams.binary_search(edge).is_ok());
            part.seam_length = of_seam.map(|edge| length(self.mesh, edge)).sum();
            parts.push(part);
        }
        let mut parted = unwrapped.clone();
        parted.charts.splice(chart..=chart, parts);
        parted.seams = seams;
        parted.seam_length += cut.length;
        Ok(Some(parted))
    }

    /// The edges of a cut, the lower vertex first.
    fn edges(&self, chart: &UnwrappedChart, cut: &Cut) -> Vec<[VertexId; 2]> {
        let vertex_of: HashMap<usize, VertexId> =
            corners(self.mesh, chart).flat_map(|(three, vertices)| three.into_iter().zip(vertices)).collect();
        let ends = cut.path.windows(2).map(|ends| [vertex_of[&ends[0]], vertex_of[&ends[1]]]);
        ends.map(|[a, b]| [a.min(b), a.max(b)]).collect()
    }

    /// For every face of a chart on which side of a cut it is, if there are two sides.
    fn sides(&self, chart: &UnwrappedChart, cut: &Cut) -> Option<Vec<bool>> {
        let key = |a: usize, b: usize| [a.min(b), a.max(b)];
        let of_cut: HashSet<[usize; 2]> = cut.path.windows(2).map(|ends| key(ends[0], ends[1])).collect();
        let mut sets = DisjointSets::new(chart.faces.len());
        let mut first: HashMap<[usize; 2], usize> = HashMap::new();
        for (face, ([a, b, c], _)) in corners(self.mesh, chart).enumerate() {
            for edge in [key(a, b), key(b, c), key(c, a)].into_iter().filter(|edge| !of_cut.contains(edge)) {
                let other = *first.entry(edge).or_insert(face);
                sets.unite(face, other);
            }
        }
        let roots: Vec<usize> = (0..chart.faces.len()).map(|face| sets.find(face)).collect();
        let other = roots.iter().copied().find(|&root| root != roots[0])?;
        let are_two = roots.iter().all(|&root| root == roots[0] || root == other);
        are_two.then(|| roots.into_iter().map(|root| root == other).collect())
    }
}

/// Some faces of a chart, with their UVs.
fn part_of(chart: &UnwrappedChart, is_in: impl Fn(usize) -> bool) -> UnwrappedChart {
    let inside = || (0..chart.faces.len()).filter(|&i| is_in(i));
    let faces = inside().map(|i| chart.faces[i]).collect();
    let uv = chart.uv.submap(inside().map(|i| FaceId::new(i).corners()));
    UnwrappedChart { faces, uv, ..chart.clone() }
}

/// The ends of every edge that one face of a chart has, the lower one first.
fn border(mesh: &TriMesh, chart: &UnwrappedChart) -> Vec<[VertexId; 2]> {
    let mut edges: Vec<([usize; 2], [VertexId; 2])> = Vec::new();
    for (three, vertices) in corners(mesh, chart) {
        for (k, next) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (vertices[k], vertices[next]);
            edges.push(([three[k].min(three[next]), three[k].max(three[next])], [a.min(b), a.max(b)]));
        }
    }
    edges.sort_unstable();
    edges.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1).map(|same| same[0].1).collect()
}
