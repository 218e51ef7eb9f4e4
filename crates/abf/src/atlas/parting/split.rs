//! A chart in two.

use super::super::judge::Parts;
use super::corners::{corners, length};
use super::cut::{Cut, Sheet};
use crate::unwrap::{Unwrapped, UnwrappedChart};
use abf_cut::first_at_place;
use abf_mesh::{DisjointSets, FaceId, TriMesh, UvMap, VertexId};
use abf_metrics::{MetricsError, Precision, certify, measure_certified};
use std::collections::{HashMap, HashSet};

/// Parts charts and measures their parts.
pub(super) struct Splitter<'a> {
    mesh: &'a TriMesh,
    /// The lowest vertex in the place of every vertex: faces that meet along a seam may have vertices of their own.
    first_at: Vec<VertexId>,
    /// Of all faces, where their charts came out.
    parts: Parts<'a>,
    forbidden: Option<&'a [bool]>,
    precision: Precision,
    max_stretch: f64,
}

/// A chart in two.
pub(super) struct Halves {
    chart: usize,
    parts: [UnwrappedChart; 2],
    /// The edges of the cut.
    edges: Vec<[VertexId; 2]>,
    length: f64,
}

impl Halves {
    /// Puts them in the place of their chart.
    pub(super) fn put_into(self, unwrapped: &mut Unwrapped) {
        unwrapped.charts.splice(self.chart..=self.chart, self.parts);
        unwrapped.seams.extend(self.edges);
        unwrapped.seams.sort_unstable();
        unwrapped.seams.dedup();
        unwrapped.seam_length += self.length;
    }
}

impl<'a> Splitter<'a> {
    /// `uv` has every chart where it came out.
    pub(super) fn new(
        mesh: &'a TriMesh,
        turned: &[FaceId],
        uv: &'a UvMap,
        (forbidden, precision, max_stretch): (Option<&'a [bool]>, Precision, f64),
    ) -> Self {
        let (first_at, parts) = (first_at_place(mesh), Parts::new(mesh, turned, uv));
        Self { mesh, first_at, parts, forbidden, precision, max_stretch }
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

    /// One chart in two. `None` where the cut does not make two of it, or a part stretches too much.
    pub(super) fn halves(
        &self,
        unwrapped: &Unwrapped,
        chart: usize,
        cut: &Cut,
    ) -> Result<Option<Halves>, MetricsError> {
        let whole = &unwrapped.charts[chart];
        let Some(is_other) = self.sides(whole, cut) else { return Ok(None) };
        let most = self.max_stretch.max(whole.metrics.stretch_l2);
        let edges = self.edges(whole, cut);
        let mut seams: Vec<_> = unwrapped.seams.iter().chain(&edges).map(|&edge| self.in_place(edge)).collect();
        seams.sort_unstable();
        let half = |side: bool| -> Result<Option<UnwrappedChart>, MetricsError> {
            let mut part = part_of(whole, |i| is_other[i] == side);
            let (mesh, uv, _) = self.parts.of(&part.faces);
            let certificate = certify(&mesh, &uv, self.precision)?;
            part.metrics = measure_certified(&mesh, &uv, certificate)?;
            part.seam_length = self.length_within(&part, &seams);
            let is_kept = part.metrics.injective() && part.metrics.stretch_l2 <= most;
            Ok(is_kept.then_some(part))
        };
        let Some(one) = half(false)? else { return Ok(None) };
        let Some(other) = half(true)? else { return Ok(None) };
        Ok(Some(Halves { chart, parts: [one, other], edges, length: cut.length }))
    }

    /// The length of the edges of a chart that are among the seams; one with the chart on both sides counts once.
    fn length_within(&self, chart: &UnwrappedChart, seams: &[[VertexId; 2]]) -> f64 {
        let mut edges: Vec<_> = border(self.mesh, chart).into_iter().map(|edge| self.in_place(edge)).collect();
        edges.sort_unstable();
        edges.dedup();
        let of_seam = edges.into_iter().filter(|edge| seams.binary_search(edge).is_ok());
        of_seam.map(|edge| length(self.mesh, edge)).sum()
    }

    /// An edge by the lowest vertices in the places of its ends.
    fn in_place(&self, ends: [VertexId; 2]) -> [VertexId; 2] {
        let [a, b] = ends.map(|v| self.first_at[v.index()]);
        [a.min(b), a.max(b)]
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
