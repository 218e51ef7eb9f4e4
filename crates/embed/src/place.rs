//! Where a drawing lies, and how large it is.

use crate::EmbedError;
use crate::plane::{not_counter_clockwise, of_face, orientation};
use abf_mesh::{Point2, Topology, UvMap, Vector2, VertexId};

/// One point per vertex from a map, as [`Descent::solve`](crate::Descent::solve) takes its start; vertices that no face uses are at the origin.
///
/// # Errors
/// The first vertex that the map gives two places: a seam.
///
/// # Panics
/// If the map has not three corners for every face.
pub fn vertex_points(topology: &Topology, uv: &UvMap) -> Result<Vec<Point2<f64>>, VertexId> {
    assert_eq!(uv.corners().len(), topology.corner_count(), "a map of this mesh");
    let point = |v: VertexId| match topology.fan_start(v) {
        None => Ok(Point2::origin()),
        Some(first) if topology.fan(v).all(|c| uv.corner(c) == uv.corner(first)) => Ok(uv.corner(first)),
        Some(_) => Err(v),
    };
    topology.vertices().map(point).collect()
}

/// Whether a start is a drawing.
pub(crate) fn check_start(topology: &Topology, uv: &[Point2<f64>]) -> Result<(), EmbedError> {
    if uv.len() != topology.vertex_count() {
        return Err(EmbedError::PointCount { given: uv.len(), vertices: topology.vertex_count() });
    }
    match not_counter_clockwise(topology, uv) {
        None => Ok(()),
        Some((face, count)) => Err(EmbedError::StartFlipped { face, count }),
    }
}

/// A vertex on the shortest edge and the one farthest from it.
///
/// The first stays at the origin, around which doubles are dense: the most crowded neighbourhood keeps its digits, and
/// needs not be carried along by the rest.
pub(crate) fn pins(topology: &Topology, uv: &[Point2<f64>]) -> [VertexId; 2] {
    let at = |v: VertexId| uv[v.index()];
    let length = |c: &abf_mesh::CornerId| (at(topology.vertex(c.next())) - at(topology.vertex(*c))).norm_squared();
    let shortest = topology.corners().min_by(|a, b| length(a).total_cmp(&length(b))).expect("a disk has corners");
    let crowded = topology.vertex(shortest);
    let distance = |v: VertexId| (at(v) - at(crowded)).norm_squared();
    let used = topology.vertices().filter(|&v| topology.fan_start(v).is_some());
    let far = used.max_by(|&a, &b| distance(a).total_cmp(&distance(b))).expect("a disk has vertices");
    [crowded, far]
}

/// The drawing with this vertex at the origin, unless the rounding of the others spoils it. Vertices that no face uses
/// are at the origin either way.
pub(crate) fn centred(topology: &Topology, uv: &[Point2<f64>], centre: VertexId) -> Vec<Point2<f64>> {
    let moved_by = |shift: Vector2<f64>| -> Vec<Point2<f64>> {
        let moved = |v: VertexId| topology.fan_start(v).map_or(Point2::origin(), |_| uv[v.index()] - shift);
        topology.vertices().map(moved).collect()
    };
    let centred = moved_by(uv[centre.index()].coords);
    if not_counter_clockwise(topology, &centred).is_none() { centred } else { moved_by(Vector2::zeros()) }
}

/// The drawing with this area if doubles hold it there, else as near as a power of two brings it; and which.
pub(crate) fn scaled_to(topology: &Topology, uv: Vec<Point2<f64>>, area: f64) -> (Vec<Point2<f64>>, bool) {
    let double_area =
        |uv: &[Point2<f64>]| -> f64 { topology.faces().map(|f| orientation(&of_face(topology, uv, f))).sum() };
    let scale = (2.0 * area / double_area(&uv)).sqrt();
    let by = |scale: f64| -> Vec<Point2<f64>> { uv.iter().map(|p| p * scale).collect() };
    let valid = |uv: &[Point2<f64>]| not_counter_clockwise(topology, uv).is_none();
    let matched = by(scale);
    if valid(&matched) {
        return (matched, true);
    }
    let near = by(scale.log2().round().exp2());
    // A power of two moves no bit but where it underflows.
    if valid(&near) { (near, false) } else { (uv, false) }
}
