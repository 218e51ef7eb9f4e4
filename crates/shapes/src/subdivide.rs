//! Loop subdivision.

use abf_mesh::{CornerId, Point3, Topology, TriMesh, Vector3, VertexId};

/// Replaces every triangle by four and smooths, in time linear in the size of the mesh.
///
/// Loop, *Smooth Subdivision Surfaces Based on Triangles*, 1987, with the weights of Warren, which
/// need no cosine: an interior vertex of valence n moves to `(1 − nβ) p + β Σ neighbours` with
/// β = 3/(8n), or 3/16 for n = 3; a new vertex inside is `3/8` of the ends of its edge and `1/8` of
/// the two points facing it. The boundary becomes a cubic spline of itself, whatever lies inside:
/// `1/8, 3/4, 1/8` at its vertices, midpoints on its edges. Hence a flat mesh stays flat and the
/// boundary never grows.
///
/// The vertices of the input come first, in their order, then one vertex per edge.
///
/// # Panics
/// If the faces are not an oriented manifold; see [`Topology::build`].
#[must_use]
pub fn loop_subdivide(mesh: &TriMesh) -> TriMesh {
    let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("subdivision needs a manifold");
    let mut positions: Vec<Point3<f64>> = topology.vertices().map(|v| moved(mesh, &topology, v)).collect();
    let edge_vertex = add_edge_vertices(mesh, &topology, &mut positions);
    let mut faces = Vec::with_capacity(4 * topology.face_count());
    for face in topology.faces() {
        let [a, b, c] = topology.face_vertices(face).map(VertexId::index);
        let [bc, ca, ab] = face.corners().map(|k| edge_vertex[k.index()]);
        faces.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    TriMesh::new(positions, &faces).expect("faces use old vertices and the new ones on edges")
}

/// The new place of a vertex of the input; one without faces stays where it is.
fn moved(mesh: &TriMesh, topology: &Topology, vertex: VertexId) -> Point3<f64> {
    let at = |v: VertexId| mesh.positions()[v.index()].coords;
    if topology.is_interior(vertex) {
        let (sum, valence) = topology
            .fan(vertex)
            .fold((Vector3::zeros(), 0_u32), |(sum, n), c| (sum + at(topology.vertex(c.next())), n + 1));
        let valence = f64::from(valence);
        let beta = if valence == 3.0 { 3.0 / 16.0 } else { 3.0 / (8.0 * valence) };
        return Point3::from(at(vertex) * (1.0 - valence * beta) + sum * beta);
    }
    match boundary_neighbours(topology, vertex) {
        Some([before, after]) => Point3::from(at(vertex) * 0.75 + (at(before) + at(after)) * 0.125),
        None => mesh.positions()[vertex.index()],
    }
}

/// The vertices before and after a boundary vertex on its loop.
fn boundary_neighbours(topology: &Topology, vertex: VertexId) -> Option<[VertexId; 2]> {
    let after = topology.next_on_boundary(vertex)?;
    let last = topology.fan(vertex).last()?;
    Some([topology.vertex(last.prev()), after])
}

/// Appends one vertex per edge; returns, for every corner, the vertex on the edge that faces it.
fn add_edge_vertices(mesh: &TriMesh, topology: &Topology, positions: &mut Vec<Point3<f64>>) -> Vec<usize> {
    let at = |c: CornerId| mesh.positions()[topology.vertex(c).index()].coords;
    let mut edge_vertex = vec![0; topology.corner_count()];
    for c in topology.corners() {
        let ends = at(c.next()) + at(c.prev());
        let p = match topology.opposite(c) {
            Some(o) if o < c => continue,
            Some(o) => {
                edge_vertex[o.index()] = positions.len();
                ends * 0.375 + (at(c) + at(o)) * 0.125
            }
            None => ends * 0.5,
        };
        edge_vertex[c.index()] = positions.len();
        positions.push(Point3::from(p));
    }
    edge_vertex
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shape;

    fn topology(mesh: &TriMesh) -> Topology {
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        topology.check().expect("the laws of the corner table");
        topology
    }

    fn boundary_length(mesh: &TriMesh) -> f64 {
        let walk = &topology(mesh).boundary_loops()[0].vertices;
        let at = |i: usize| mesh.positions()[walk[i % walk.len()].index()];
        (0..walk.len()).map(|i| (at(i + 1) - at(i)).norm()).sum()
    }

    #[test]
    fn subdivision_quadruples_the_triangles_and_keeps_the_disk() {
        for shape in Shape::ALL {
            let mesh = shape.mesh(300);
            let finer = loop_subdivide(&mesh);
            assert_eq!(finer.face_count(), 4 * mesh.face_count());
            topology(&finer).require_disk().expect("a disk");
            finer.check_geometry().expect("no degenerate face");
            assert_eq!(finer.unreferenced_vertices(), 0);
            assert_eq!(topology(&finer).boundary_edge_count(), 2 * topology(&mesh).boundary_edge_count());
        }
    }

    #[test]
    fn subdivision_keeps_a_flat_mesh_flat() {
        let mesh = Shape::BumpySheet.mesh(200);
        let flat = mesh.positions().iter().map(|p| Point3::new(p.x, p.y, 0.75)).collect();
        let faces: Vec<_> = mesh.faces().iter().map(|f| f.map(VertexId::index)).collect();
        let finer = loop_subdivide(&TriMesh::new(flat, &faces).expect("the same faces"));
        assert!(finer.positions().iter().all(|p| p.z == 0.75));
    }

    #[test]
    fn subdivision_never_lengthens_the_boundary() {
        for shape in Shape::ALL {
            let mesh = shape.mesh(300);
            let finer = loop_subdivide(&mesh);
            assert!(boundary_length(&finer) <= boundary_length(&mesh) * (1.0 + 1e-12), "{shape}");
        }
    }

    #[test]
    fn a_regular_fan_moves_as_the_masks_say() {
        let mesh = Shape::Pyramid.mesh(6);
        let finer = loop_subdivide(&mesh);
        // Valence 6: β = 1/16, so the apex keeps 5/8 of its height; spokes get 3/8 of it.
        let height = mesh.positions()[0].z;
        assert!((finer.positions()[0].z - 0.625 * height).abs() < 1e-12);
        assert!(finer.positions()[7..].iter().filter(|p| (p.z - 0.375 * height).abs() < 1e-12).count() == 6);
    }
}
