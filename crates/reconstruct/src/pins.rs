//! Two boundary vertices far apart.

use abf_mesh::{Topology, TriMesh, VertexId};

/// The two vertices that fix the similarity of a layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PinnedPair {
    /// Put at the origin.
    pub origin: VertexId,
    /// Put on the positive x-axis.
    pub axis: VertexId,
}

impl PinnedPair {
    /// The rule behind every published number of this project: with `b` the first boundary vertex
    /// by index, `axis` is the boundary vertex farthest from `b` in space and `origin` the boundary
    /// vertex farthest from `axis`. Ties go to the lower index. `None` without a boundary.
    #[must_use]
    pub fn far_apart(mesh: &TriMesh, topology: &Topology) -> Option<Self> {
        let boundary = || topology.vertices().filter(|&v| topology.is_boundary(v));
        let position = |v: VertexId| mesh.positions()[v.index()];
        let farthest_from = |from: VertexId| {
            let mut best = (from, -1.0);
            for v in boundary() {
                let distance = (position(v) - position(from)).norm_squared();
                if distance > best.1 {
                    best = (v, distance);
                }
            }
            best.0
        };
        let axis = farthest_from(boundary().next()?);
        let origin = farthest_from(axis);
        Some(Self { origin, axis })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_shapes::Shape;

    #[test]
    fn the_pins_are_two_boundary_vertices() {
        for shape in Shape::ALL {
            let mesh = shape.mesh(300);
            let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
            let pins = PinnedPair::far_apart(&mesh, &topology).expect("a boundary");
            assert!(pins.origin != pins.axis && topology.is_boundary(pins.origin) && topology.is_boundary(pins.axis));
        }
    }
}
