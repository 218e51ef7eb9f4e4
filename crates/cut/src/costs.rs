//! What it costs to cut along an edge.

use crate::seams::{edge_length, edges_at, ends, interior_edges};
use abf_mesh::{CornerId, Topology, TriMesh, Vector3, VertexId};
use abf_parallel::prelude::*;

/// What a seam prefers.
///
/// The cost of an edge is its length · (1 − crease · t) · (1 − hidden · k). Both settings are in [0, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct CostSettings {
    /// How much creases are preferred. t = min(1, θ/60°)², with θ the angle between the normals of the two faces.
    pub crease: f64,
    /// How much hidden places are preferred. k in [0, 1] says how deep the edge lies in a valley, on the scale of ten
    /// edges: smoothed over as many rings, how far the vertices around stand above the tangent plane.
    pub hidden: f64,
}

impl Default for CostSettings {
    fn default() -> Self {
        Self { crease: 0.5, hidden: 0.5 }
    }
}

impl CostSettings {
    /// Nothing but length.
    pub const LENGTH: Self = Self { crease: 0.0, hidden: 0.0 };
}

/// The cost of cutting along every edge; infinite where that is forbidden.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeCosts {
    /// By corner: that of the edge it faces.
    cost: Vec<f64>,
}

/// The angle between normals from which an edge is as good a crease as any, rad.
const FULL_CREASE: f64 = std::f64::consts::PI / 3.0;

impl EdgeCosts {
    /// The costs of all edges; `is_forbidden` is asked once for each, with the lower corner that faces it. Edges of the
    /// boundary cost nothing: they are cut already.
    #[must_use]
    pub fn new(
        mesh: &TriMesh,
        topology: &Topology,
        settings: &CostSettings,
        is_forbidden: impl Fn(CornerId) -> bool,
    ) -> Self {
        let normals: Vec<Vector3<f64>> = mesh.triangles().map(|[a, b, c]| (b - a).cross(&(c - a))).collect();
        let depth = if settings.hidden > 0.0 { valleys(mesh, topology, &normals) } else { Vec::new() };
        let mut cost = vec![0.0; topology.corner_count()];
        for (corner, opposite) in interior_edges(topology) {
            let one = if is_forbidden(corner) {
                f64::INFINITY
            } else {
                let [n, m] = [corner, opposite].map(|c| normals[c.face().index()]);
                let turn = n.cross(&m).norm().atan2(n.dot(&m));
                let crease = (turn / FULL_CREASE).min(1.0).powi(2);
                let [a, b] = ends(topology, corner).map(|v| depth.get(v.index()).copied().unwrap_or(0.0));
                let preference = (1.0 - settings.crease * crease) * (1.0 - settings.hidden * 0.5 * (a + b));
                edge_length(mesh, topology, corner) * preference
            };
            cost[corner.index()] = one;
            cost[opposite.index()] = one;
        }
        Self { cost }
    }

    /// The cost of the edge that a corner faces.
    #[inline]
    #[must_use]
    pub fn of(&self, corner: CornerId) -> f64 {
        self.cost[corner.index()]
    }

    /// Sets the cost of the edge that a corner faces.
    pub fn set(&mut self, topology: &Topology, corner: CornerId, cost: f64) {
        self.cost[corner.index()] = cost;
        if let Some(opposite) = topology.opposite(corner) {
            self.cost[opposite.index()] = cost;
        }
    }
}

/// How deep every vertex lies in a valley, from 0 on ridges and plains to 1.
fn valleys(mesh: &TriMesh, topology: &Topology, face_normals: &[Vector3<f64>]) -> Vec<f64> {
    /// Rounds of averaging: how many rings away a valley is felt.
    const ROUNDS: usize = 10;
    /// The mean slope of the surroundings that counts as a valley of full depth: about 15°.
    const STEEP: f64 = 0.25;
    let vertices = 0..topology.vertex_count();
    let around = |v: usize| edges_at(topology, VertexId::new(v)).map(|(_, w)| w.index());
    let slope = |v: usize| {
        let fan = topology.fan(VertexId::new(v));
        let normal: Vector3<f64> = fan.map(|c| face_normals[c.face().index()]).sum();
        let normal = normal.try_normalize(0.0).unwrap_or_default();
        let here = mesh.positions()[v];
        let (rise, run) = around(v)
            .map(|w| mesh.positions()[w] - here)
            .fold((0.0, 0.0), |(rise, run), e| (rise + e.dot(&normal), run + e.norm()));
        if run > 0.0 { rise / run } else { 0.0 }
    };
    let mut depth: Vec<f64> = vertices.clone().into_par_iter().map(slope).collect();
    for _ in 0..ROUNDS {
        let averaged = |v: usize| {
            let (sum, count) = around(v).fold((depth[v], 1.0), |(sum, count), w| (sum + depth[w], count + 1.0));
            sum / count
        };
        depth = vertices.clone().into_par_iter().map(averaged).collect();
    }
    depth.iter().map(|d| (d / STEEP).clamp(0.0, 1.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::folded;

    #[test]
    fn creases_and_valleys_are_cheaper_than_plains_and_a_forbidden_edge_costs_everything() {
        for (up, cheap) in [(true, true), (false, true)] {
            let mesh = folded(12, up);
            let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
            let costs = EdgeCosts::new(&mesh, &topology, &CostSettings::default(), |_| false);
            let fold = |c: CornerId| ends(&topology, c).iter().all(|v| mesh.positions()[v.index()].x == 0.0);
            let on_fold = interior_edges(&topology).map(|(c, _)| c).find(|&c| fold(c)).expect("a fold");
            assert_eq!(costs.of(on_fold) < 0.6 * edge_length(&mesh, &topology, on_fold), cheap);
        }
        let cost_of_fold = |up| {
            let mesh = folded(12, up);
            let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
            let costs = EdgeCosts::new(&mesh, &topology, &CostSettings::default(), |_| false);
            let fold = |c: CornerId| ends(&topology, c).iter().all(|v| mesh.positions()[v.index()].x == 0.0);
            interior_edges(&topology).filter(|&(c, _)| fold(c)).map(|(c, _)| costs.of(c)).sum::<f64>()
        };
        assert!(cost_of_fold(true) < cost_of_fold(false), "a valley is better hidden than a ridge");
        let mesh = folded(4, true);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let costs = EdgeCosts::new(&mesh, &topology, &CostSettings::default(), |_| true);
        assert!(interior_edges(&topology).all(|(c, o)| costs.of(c).is_infinite() && costs.of(o).is_infinite()));
    }
}
