//! The corners and the edges of a chart.

use crate::unwrap::UnwrappedChart;
use abf_mesh::{TriMesh, UvId, VertexId};

/// The points and the vertices of every face of a chart.
pub(super) fn corners<'a>(
    mesh: &'a TriMesh,
    chart: &'a UnwrappedChart,
) -> impl Iterator<Item = ([usize; 3], [VertexId; 3])> + 'a {
    let points = chart.uv.corners().as_chunks::<3>().0.iter().map(|three| three.map(UvId::index));
    points.zip(chart.faces.iter().map(|face| mesh.faces()[face.index()]))
}

/// The length of an edge on the surface.
pub(super) fn length(mesh: &TriMesh, [a, b]: [VertexId; 2]) -> f64 {
    (mesh.positions()[a.index()] - mesh.positions()[b.index()]).norm()
}
