//! Where a map shrinks the surface most.

use crate::FlattenError;
use abf_cut::Chart;
use abf_mesh::{FaceId, Point3, TriMesh, UvMap, VertexId};
use abf_metrics::{FaceDistortion, per_face};

/// No face counts as shrunk to less than this part of its area.
const SMALLEST: f64 = 1e-60;

/// The stretch of a chart.
pub(super) struct Stretch {
    /// L² stretch over the real faces ([`Metrics::stretch_l2`](abf_metrics::Metrics::stretch_l2)).
    pub(super) l2: f64,
    /// For every vertex of the surface that the chart was cut from, the mean of `√(A₃ / A₂)` over the real faces around
    /// it, weighted by A₃, at equal total areas: above 1 where the map is too small. 0 where there are none.
    at_vertex: Vec<f64>,
}

impl Stretch {
    /// Measures the first `real` faces of a chart of a surface with so many vertices.
    pub(super) fn measure(
        chart: &Chart,
        uv: &UvMap,
        real: usize,
        surface_vertices: usize,
    ) -> Result<Self, FlattenError> {
        let all = per_face(&chart.mesh, uv)?;
        let faces = &all[..real];
        let shares = |weigh: &dyn Fn(&FaceDistortion) -> f64| -> f64 {
            faces.iter().filter(|f| !f.degenerate_3d).map(|f| f.surface_share * weigh(f)).sum()
        };
        let total = shares(&|_| 1.0);
        // Per-face figures are at equal areas of all faces, virtual ones included.
        let ratio = shares(&|f| f.area_ratio) / total;
        let l2 = (shares(&|f| f.stretch_l2.powi(2)) / total * ratio).sqrt();
        let mut sums = vec![(0.0, 0.0); surface_vertices];
        for (f, face) in faces.iter().enumerate().filter(|(_, face)| !face.degenerate_3d) {
            let shrunk = (ratio / face.area_ratio.max(SMALLEST)).sqrt();
            for v in chart.topology.face_vertices(FaceId::new(f)) {
                let (sum, weight) = &mut sums[chart.vertices[v.index()].index()];
                *sum += face.surface_share * shrunk;
                *weight += face.surface_share;
            }
        }
        let at_vertex = sums.into_iter().map(|(sum, weight)| if weight > 0.0 { sum / weight } else { 0.0 }).collect();
        Ok(Self { l2, at_vertex })
    }

    /// The vertices where the stretch is largest: at most `count`, at least `apart` from each other.
    pub(super) fn largest(&self, mesh: &TriMesh, count: usize, apart: f64) -> Vec<VertexId> {
        let mut order: Vec<usize> = (0..self.at_vertex.len()).filter(|&v| self.at_vertex[v] > 1.0).collect();
        order.sort_unstable_by(|&a, &b| self.at_vertex[b].total_cmp(&self.at_vertex[a]).then(a.cmp(&b)));
        let mut chosen: Vec<VertexId> = Vec::new();
        let at = |v: VertexId| mesh.positions()[v.index()];
        let is_far = |p: Point3<f64>, chosen: &[VertexId]| chosen.iter().all(|&c| (at(c) - p).norm() >= apart);
        for v in order.into_iter().map(VertexId::new) {
            if chosen.len() == count {
                break;
            }
            if is_far(at(v), &chosen) {
                chosen.push(v);
            }
        }
        chosen
    }
}
