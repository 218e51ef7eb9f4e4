//! Where a map shrinks the surface most.

use crate::FlattenError;
use abf_cut::Chart;
use abf_mesh::{FaceId, Point3, TriMesh, UvMap, VertexId};
use abf_metrics::{FaceDistortion, per_face};

/// No face counts as shrunk to less than this part of its area.
const SMALLEST: f64 = 1e-60;

/// A face with no more than this part of the area of all has none.
const NO_AREA: f64 = 1e-14;

/// More peaks are not looked at.
const MOST_PEAKS: usize = 200;

/// An aim that is so many times as far above 1.
pub(super) fn scaled_aim(max_stretch: f64, times: f64) -> f64 {
    1.0 + times * (max_stretch - 1.0)
}

/// The stretch of a chart.
pub(super) struct Stretch {
    /// L² stretch over the real faces ([`Metrics::stretch_l2`](abf_metrics::Metrics::stretch_l2)).
    pub(super) l2: f64,
    /// For every vertex of the surface that the chart was cut from, the mean of `√(A₃ / A₂)` over the real faces around
    /// it, weighted by A₃, at equal total areas: above 1 where the map is too small. 0 where there are none.
    at_vertex: Vec<f64>,
    /// The surface area around every vertex, as a part of the whole, times what its squared stretch is above 1.
    excess: Vec<f64>,
}

/// Where the stretch is.
pub(super) struct Peaks {
    /// The one worth most first.
    pub(super) vertices: Vec<VertexId>,
    /// The part of all stretch that they are worth; NaN where there is none.
    pub(super) share: f64,
}

/// A real face that has an area.
struct Face {
    /// Its vertices on the surface that the chart was cut from.
    vertices: [VertexId; 3],
    surface_share: f64,
    area_ratio: f64,
    stretch_l2: f64,
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
        let face = |(f, face): (usize, &FaceDistortion)| Face {
            vertices: chart.topology.face_vertices(FaceId::new(f)).map(|v| chart.vertices[v.index()]),
            surface_share: face.surface_share,
            area_ratio: face.area_ratio,
            stretch_l2: face.stretch_l2,
        };
        let faces: Vec<Face> = all[..real].iter().enumerate().filter(|(_, f)| !f.degenerate_3d).map(face).collect();
        Ok(Self::of(&faces, surface_vertices))
    }

    /// What a conformal map that scales lengths by `e^u` does to the first `real` faces of a surface.
    pub(super) fn predicted(mesh: &TriMesh, real: usize, u: &[f64]) -> Self {
        let areas: Vec<f64> = mesh.triangles().take(real).map(|[a, b, c]| (b - a).cross(&(c - a)).norm()).collect();
        let total: f64 = areas.iter().sum();
        let face = |(&vertices, &area): (&[VertexId; 3], &f64)| {
            let scale = (vertices.iter().map(|v| u[v.index()]).sum::<f64>() / 3.0).exp();
            let (area_ratio, stretch_l2) = (scale * scale, scale.recip());
            Face { vertices, surface_share: area / total, area_ratio, stretch_l2 }
        };
        let faces: Vec<Face> =
            mesh.faces().iter().zip(&areas).filter(|(_, area)| **area > NO_AREA * total).map(face).collect();
        Self::of(&faces, mesh.vertex_count())
    }

    fn of(faces: &[Face], surface_vertices: usize) -> Self {
        let shares = |weigh: &dyn Fn(&Face) -> f64| -> f64 { faces.iter().map(|f| f.surface_share * weigh(f)).sum() };
        let total = shares(&|_| 1.0);
        // Per-face figures are at equal areas of all faces, virtual ones included.
        let ratio = shares(&|f| f.area_ratio) / total;
        let l2 = (shares(&|f| f.stretch_l2.powi(2)) / total * ratio).sqrt();
        let mut sums = vec![(0.0, 0.0); surface_vertices];
        for face in faces {
            let shrunk = (ratio / face.area_ratio.max(SMALLEST)).sqrt();
            for v in face.vertices {
                let (sum, weight) = &mut sums[v.index()];
                *sum += face.surface_share * shrunk;
                *weight += face.surface_share;
            }
        }
        let mean = |&(sum, weight): &(f64, f64)| if weight > 0.0 { sum / weight } else { 0.0 };
        let at_vertex: Vec<f64> = sums.iter().map(mean).collect();
        let above = |(s, &(_, weight)): (&f64, &(f64, f64))| weight * (s * s - 1.0).max(0.0);
        let excess = at_vertex.iter().zip(&sums).map(above).collect();
        Self { l2, at_vertex, excess }
    }

    /// The peaks of the stretch worth most: at most `count` vertices.
    ///
    /// Peaks are taken in the order of their stretch, `apart` from each other, among the vertices that `may_be` one. What
    /// a peak is worth is the excess of the vertices it keeps from being peaks: a spike of a few small faces is worth
    /// little, however high it is.
    pub(super) fn peaks(&self, mesh: &TriMesh, count: usize, apart: f64, may_be: impl Fn(VertexId) -> bool) -> Peaks {
        let mut order: Vec<usize> = (0..self.at_vertex.len()).filter(|&v| self.at_vertex[v] > 1.0).collect();
        order.sort_unstable_by(|&a, &b| self.at_vertex[b].total_cmp(&self.at_vertex[a]).then(a.cmp(&b)));
        let mut peaks: Vec<(Point3<f64>, VertexId, f64)> = Vec::new();
        for v in order.into_iter().map(VertexId::new) {
            let here = mesh.positions()[v.index()];
            let excess = self.excess[v.index()];
            match peaks.iter().position(|(peak, ..)| (peak - here).norm_squared() < apart * apart) {
                Some(near) => peaks[near].2 += excess,
                None if peaks.len() < MOST_PEAKS && may_be(v) => peaks.push((here, v, excess)),
                None => {}
            }
        }
        peaks.sort_by(|a, b| b.2.total_cmp(&a.2));
        peaks.truncate(count);
        let share = peaks.iter().map(|(_, _, worth)| worth).sum::<f64>() / self.excess.iter().sum::<f64>();
        Peaks { vertices: peaks.into_iter().map(|(_, v, _)| v).collect(), share }
    }
}
