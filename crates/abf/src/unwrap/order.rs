//! A component in the order of its places, so that the order of vertices and faces in a file decides nothing.

use crate::FlattenError;
use abf_cut::Chart;
use abf_mesh::{CornerId, FaceId, Point3, Topology, TriMesh, VertexId};
use std::cmp::Ordering;

/// A component, its vertices and faces in an order that their places decide.
pub(super) struct InOrder {
    /// The component. Its faces and vertices are not ascending.
    pub(super) chart: Chart,
    /// Corner `k` of a face is corner `k + first` of [`Chart::faces`], modulo 3.
    first: Vec<u8>,
}

impl InOrder {
    /// The order it has.
    pub(super) fn as_it_is(chart: Chart) -> Self {
        let first = vec![0; chart.faces.len()];
        Self { chart, first }
    }

    /// Vertices ascend along the second side of the bounding box, then along the longest and the shortest: of such orders the one
    /// that led to the fewest charts. Of vertices in one place their neighbours decide. Faces begin at their lowest vertex, and
    /// ascend.
    ///
    /// # Errors
    /// Never, for a component: its topology is built again.
    pub(super) fn of_places(chart: &Chart) -> Result<Self, FlattenError> {
        let Chart { mesh, topology, .. } = chart;
        let vertices = vertices_in_order(mesh, topology);
        let mut rank = vec![0; vertices.len()];
        vertices.iter().enumerate().for_each(|(i, v)| rank[v.index()] = i);
        let mut faces: Vec<([usize; 3], u8, usize)> = Vec::with_capacity(mesh.face_count());
        for (f, face) in mesh.faces().iter().enumerate() {
            let mut corners = face.map(|v| rank[v.index()]);
            let first = (0..3_u8).min_by_key(|&k| corners[usize::from(k)]).unwrap_or(0);
            corners.rotate_left(usize::from(first));
            faces.push((corners, first, f));
        }
        faces.sort_unstable();
        let positions = vertices.iter().map(|v| mesh.positions()[v.index()]).collect();
        let corners: Vec<[usize; 3]> = faces.iter().map(|face| face.0).collect();
        let mesh = TriMesh::new(positions, &corners)?;
        let topology = Topology::build(mesh.vertex_count(), mesh.faces())?;
        let chart = Chart {
            mesh,
            topology,
            faces: faces.iter().map(|face| chart.faces[face.2]).collect(),
            vertices: vertices.iter().map(|v| chart.vertices[v.index()]).collect(),
        };
        Ok(Self { chart, first: faces.iter().map(|face| face.1).collect() })
    }

    /// The corner, in the mesh that the component was taken from, of one of its corners.
    pub(super) fn corner(&self, c: CornerId) -> CornerId {
        let face = c.face().index();
        self.chart.faces[face].corner((c.place() + usize::from(self.first[face])) % 3)
    }

    /// The lowest of its faces, in the mesh that it was taken from.
    pub(super) fn lowest_face(&self) -> FaceId {
        self.chart.faces.iter().copied().min().unwrap_or(FaceId::new(0))
    }
}

fn vertices_in_order(mesh: &TriMesh, topology: &Topology) -> Vec<VertexId> {
    let [longest, second, shortest] = longest_first(mesh.positions());
    let axes = [second, longest, shortest];
    // Zeros of both signs are one place.
    let place = |v: VertexId| axes.map(|axis| mesh.positions()[v.index()][axis] + 0.0);
    let mut order: Vec<([f64; 3], VertexId)> = topology.vertices().map(|v| (place(v), v)).collect();
    order.sort_unstable_by(|a, b| compare(&a.0, &b.0).then(a.1.cmp(&b.1)));
    for same in order.chunk_by_mut(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
        let around = |v: VertexId| -> Vec<[f64; 3]> {
            let corners = topology.fan(v).flat_map(|c| [c.next(), c.prev()]);
            let mut places: Vec<[f64; 3]> = corners.map(|c| place(topology.vertex(c))).collect();
            places.sort_unstable_by(compare);
            places
        };
        let mut with_places: Vec<(Vec<[f64; 3]>, VertexId)> = same.iter().map(|&(_, v)| (around(v), v)).collect();
        with_places.sort_by(|a, b| compare_lists(&a.0, &b.0).then(a.1.cmp(&b.1)));
        same.iter_mut().zip(with_places).for_each(|(slot, (_, v))| slot.1 = v);
    }
    order.into_iter().map(|(_, v)| v).collect()
}

/// The axes by the extents along them, the longest first.
fn longest_first(points: &[Point3<f64>]) -> [usize; 3] {
    let Some(&first) = points.first() else { return [0, 1, 2] };
    let (low, high) = points.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    let extent = high - low;
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| extent[b].total_cmp(&extent[a]));
    axes
}

fn compare(a: &[f64; 3], b: &[f64; 3]) -> Ordering {
    a.iter().zip(b).map(|(x, y)| x.total_cmp(y)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

fn compare_lists(a: &[[f64; 3]], b: &[[f64; 3]]) -> Ordering {
    let of_places = a.iter().zip(b).map(|(p, q)| compare(p, q)).find(|order| order.is_ne());
    of_places.unwrap_or_else(|| a.len().cmp(&b.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_cut::{Seams, split};

    /// A bent sheet of 6 × 4 squares, its vertices, its faces and their corners in another order for each `step`, which has no
    /// divisor in common with 35 and 48.
    fn sheet(step: usize) -> Chart {
        let place = |i: usize| Point3::new((i % 7) as f64, (i / 7) as f64, 0.1 * ((i % 7) as f64).powi(2));
        let renamed = |i: usize| step * i % 35;
        let mut points = vec![Point3::origin(); 35];
        (0..35).for_each(|i| points[renamed(i)] = place(i));
        let mut faces = vec![[0; 3]; 48];
        for square in 0..24 {
            let a = square / 6 * 7 + square % 6;
            for (k, mut face) in [[a, a + 1, a + 8], [a, a + 8, a + 7]].into_iter().enumerate() {
                face.rotate_left(step % 3);
                faces[step * (2 * square + k) % 48] = face.map(renamed);
            }
        }
        let mesh = TriMesh::new(points, &faces).expect("indices in range");
        let topology = Topology::build(35, mesh.faces()).expect("a manifold");
        split(&mesh, &topology, &Seams::none(&topology)).expect("one component").swap_remove(0)
    }

    #[test]
    fn a_component_is_the_same_whatever_the_order_of_its_file() {
        let first = InOrder::of_places(&sheet(1)).expect("in order").chart;
        for step in [11, 13, 17] {
            let chart = sheet(step);
            let other = InOrder::of_places(&chart).expect("in order");
            assert_eq!((&other.chart.mesh, &other.chart.topology), (&first.mesh, &first.topology), "{step}");
            for c in other.chart.topology.corners() {
                let (here, there) = (other.chart.topology.vertex(c), chart.topology.vertex(other.corner(c)));
                assert_eq!(other.chart.mesh.positions()[here.index()], chart.mesh.positions()[there.index()]);
                assert_eq!(other.chart.vertices[here.index()], chart.vertices[there.index()]);
            }
        }
    }

    #[test]
    fn vertices_in_one_place_are_told_apart_by_their_neighbours() {
        // Two pages that meet at their backs.
        let points = [[0.0, 0.0], [0.0, 1.0], [0.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]];
        let points = points.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
        let build = |faces: &[[usize; 3]]| {
            let mesh = TriMesh::new(points.clone(), faces).expect("indices in range");
            let topology = Topology::build(6, mesh.faces()).expect("a manifold");
            let vertices = topology.vertices().collect();
            let faces = topology.faces().collect();
            InOrder::of_places(&Chart { mesh, topology, faces, vertices }).expect("in order").chart.mesh
        };
        let one = build(&[[0, 1, 4], [2, 5, 3]]);
        let other = build(&[[2, 3, 4], [0, 5, 1]]);
        assert_eq!(one, other);
    }
}
