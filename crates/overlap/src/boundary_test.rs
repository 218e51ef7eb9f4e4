//! Drawings of one mesh, one after the other: does the boundary keep clear of itself?

use crate::overlaps::Overlaps;
use crate::sheet::{Fan, Sheet};
use crate::winding::winds_twice;
use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{Point2, Topology, UvId, VertexId};

/// The test of one mesh, with what all its drawings have in common.
pub struct BoundaryTest<'t> {
    topology: &'t Topology,
    corners: Vec<UvId>,
    vertices: Vec<VertexId>,
}

impl<'t> BoundaryTest<'t> {
    /// The test of a manifold.
    #[must_use]
    pub fn new(topology: &'t Topology) -> Self {
        let vertices: Vec<VertexId> = topology.faces().flat_map(|face| topology.face_vertices(face)).collect();
        let corners = vertices.iter().map(|v| UvId::new(v.index())).collect();
        Self { topology, corners, vertices }
    }

    /// Whether the boundary of a drawing, one point per vertex, neither meets itself nor encloses a point twice. Then the drawing
    /// is one to one if all its triangles are counter-clockwise and wind once around every interior vertex, which the caller
    /// sees to.
    ///
    /// # Errors
    /// [`Cancelled`], from the checkpoint.
    pub fn is_clear(&self, uv: &[Point2<f64>], checkpoint: &mut Checkpoint<'_>) -> Result<bool, Cancelled> {
        let sheet = Sheet::of_drawing(self.topology, &self.corners, &self.vertices, uv);
        let fan = |v: VertexId| self.topology.fan_start(v).map(|first| sheet.fan_from(first));
        let on_boundary = self.topology.vertices().filter(|&v| self.topology.is_boundary(v));
        let fans: Vec<Fan> = on_boundary.filter_map(fan).collect();
        if fans.iter().any(|&fan| winds_twice(&sheet, fan)) {
            return Ok(false);
        }
        let found = Overlaps::find(&sheet, &fans, &[], 0, |_| 0.0, checkpoint)?;
        Ok(found.crossings + found.meetings + found.nested + found.touches == 0 && !found.are_least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::{Point3, TriMesh};

    /// A strip of squares, and where its vertices are drawn: those of both sides, from one end to the other.
    fn strip(sides: &[[[f64; 2]; 2]]) -> (TriMesh, Vec<Point2<f64>>) {
        let faces: Vec<[usize; 3]> =
            (0..2 * (sides.len() - 1)).step_by(2).flat_map(|k| [[k, k + 2, k + 1], [k + 1, k + 2, k + 3]]).collect();
        let points = (0..sides.len()).flat_map(|k| [0.0, 1.0].map(|y| Point3::new(k as f64, y, 0.0))).collect();
        let uv = sides.iter().flatten().copied().map(Point2::from).collect();
        (TriMesh::new(points, &faces).expect("indices in range"), uv)
    }

    fn is_clear(sides: &[[[f64; 2]; 2]]) -> bool {
        let (mesh, uv) = strip(sides);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        for face in topology.faces() {
            let [a, b, c] = topology.face_vertices(face).map(|v| uv[v.index()]);
            assert!(abf_mesh::predicates::orient2d(a, b, c) > 0.0, "a drawing");
        }
        BoundaryTest::new(&topology).is_clear(&uv, &mut || Ok(())).expect("not cancelled")
    }

    /// A strip once around, whose end is drawn this far beyond its begin.
    fn ring(beyond: f64) -> bool {
        let steps = 12;
        let side = |k: usize| {
            let turn = (std::f64::consts::TAU + beyond) * k as f64 / f64::from(steps);
            [2.0, 1.0].map(|radius: f64| [radius * turn.cos(), radius * turn.sin()])
        };
        is_clear(&(0..=steps as usize).map(side).collect::<Vec<_>>())
    }

    #[test]
    fn a_ring_with_a_slit_is_clear_and_one_that_goes_over_itself_is_not() {
        assert!(ring(-1e-9) && ring(-0.5));
        assert!(!ring(1e-9) && !ring(0.5));
    }

    #[test]
    fn a_boundary_that_touches_itself_is_not_clear() {
        let square = |x: f64| [[x, 0.0], [x, 1.0]];
        assert!(is_clear(&[square(0.0), square(1.0), square(2.0)]));
        // The last corner comes back to the side of the first square.
        let bent = |y: f64| [square(0.0), square(2.0), [[3.0, 1.5], [2.0, 1.5]], [[2.0, 3.0], [1.0, y]]];
        assert!(is_clear(&bent(1.5)));
        assert!(!is_clear(&bent(1.0)));
    }
}
