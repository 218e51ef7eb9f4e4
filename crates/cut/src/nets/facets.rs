//! Planar parts of a surface.

use crate::seams::edge_length;
use abf_control::{Cancelled, Checkpoint, at_block};
use abf_mesh::{CornerId, FaceId, Point2, Topology, TriMesh, Vector3};
use std::cmp::Ordering;

/// Faces whose normals differ by no more than this, rad, are in one plane.
const FLAT: f64 = 1e-3;

/// Points nearer than this part of the diagonal to a plane lie in it: the rounding of 32-bit coordinates.
const IN_PLANE: f64 = 1e-6;

/// Faces that are in one plane and connected, each set with a plane of its own.
pub(super) struct Facets {
    /// The facet of every face.
    pub(super) of_face: Vec<u32>,
    /// How many faces every facet has.
    pub(super) sizes: Vec<usize>,
    /// Every corner in the plane of its facet, counter-clockwise seen against its normal.
    pub(super) layout: Vec<Point2<f64>>,
}

impl Facets {
    /// Grows facets from the largest faces; of equals the one that comes first in space.
    pub(super) fn grow(
        mesh: &TriMesh,
        topology: &Topology,
        diagonal: f64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, Cancelled> {
        const NONE: u32 = u32::MAX;
        let normals = normals(mesh);
        let mut of_face = vec![NONE; mesh.face_count()];
        let mut layout = vec![Point2::origin(); topology.corner_count()];
        let mut sizes = Vec::new();
        checkpoint()?;
        for (i, seed) in by_area(mesh, &normals, diagonal, checkpoint)?.into_iter().enumerate() {
            at_block(i, checkpoint)?;
            if of_face[seed.index()] != NONE {
                continue;
            }
            let facet = sizes.len() as u32;
            let plane = Plane::of(mesh, seed, &normals);
            let mut queue = vec![seed];
            of_face[seed.index()] = facet;
            let mut next = 0;
            while let Some(&face) = queue.get(next) {
                next += 1;
                at_block(next, checkpoint)?;
                for c in face.corners() {
                    layout[c.index()] = plane.place(mesh, topology, c);
                    let Some(other) = topology.opposite(c).map(CornerId::face) else { continue };
                    if of_face[other.index()] == NONE && plane.holds(mesh, other, &normals, diagonal) {
                        of_face[other.index()] = facet;
                        queue.push(other);
                    }
                }
            }
            sizes.push(queue.len());
        }
        Ok(Self { of_face, sizes, layout })
    }
}

/// The unit normals; zero where a face has no area.
pub(super) fn normals(mesh: &TriMesh) -> Vec<Vector3<f64>> {
    /// An area below this part of the squared longest edge is none.
    const NO_AREA: f64 = 1e-12;
    let normal = |[a, b, c]: [abf_mesh::Point3<f64>; 3]| {
        let n = (b - a).cross(&(c - a));
        let longest = (b - a).norm_squared().max((c - a).norm_squared()).max((c - b).norm_squared());
        if n.norm() > NO_AREA * longest { n.normalize() } else { Vector3::zeros() }
    };
    mesh.triangles().map(normal).collect()
}

/// Faces from the largest to the smallest; those of one area, to rounding, by where they are.
fn by_area(
    mesh: &TriMesh,
    normals: &[Vector3<f64>],
    diagonal: f64,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Vec<FaceId>, Cancelled> {
    let area = |f: usize| {
        let [a, b, c] = mesh.triangle(FaceId::new(f));
        (b - a).cross(&(c - a)).norm() / (diagonal * diagonal)
    };
    let key = |f: usize| (normals[f] == Vector3::zeros(), -quantised(area(f)));
    let mut order: Vec<((bool, i64), FaceId)> = (0..mesh.face_count()).map(|f| (key(f), FaceId::new(f))).collect();
    checkpoint()?;
    order.sort_unstable();
    for (i, same) in order.chunk_by_mut(|a, b| a.0 == b.0).enumerate() {
        at_block(i, checkpoint)?;
        if same.len() > 1 {
            // Their lowest corners first: those are found once for each face.
            same.sort_by_cached_key(|&(_, f)| (Lowest(lowest(mesh, f)), f));
        }
    }
    Ok(order.into_iter().map(|(_, f)| f).collect())
}

/// A length or an area as a part of the whole, without the digits in which the order of summation shows.
pub(super) fn quantised(part: f64) -> i64 {
    (part * 1e9).round() as i64
}

/// The corners of a face, the lowest first.
fn lowest(mesh: &TriMesh, f: FaceId) -> [[f64; 3]; 3] {
    let mut points = mesh.triangle(f).map(|p| [p.x, p.y, p.z]);
    points.sort_by(compare);
    points
}

/// Points in the order of their coordinates.
#[derive(PartialEq)]
struct Lowest([[f64; 3]; 3]);

impl Eq for Lowest {}

impl PartialOrd for Lowest {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Lowest {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.iter().zip(&other.0).map(|(p, q)| compare(p, q)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    }
}

/// Compares points coordinate by coordinate.
pub(super) fn compare(p: &[f64; 3], q: &[f64; 3]) -> Ordering {
    p.iter().zip(q).map(|(x, y)| x.total_cmp(y)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

/// A plane with two axes.
struct Plane {
    origin: abf_mesh::Point3<f64>,
    normal: Vector3<f64>,
    axes: [Vector3<f64>; 2],
}

impl Plane {
    fn of(mesh: &TriMesh, face: FaceId, normals: &[Vector3<f64>]) -> Self {
        let [a, b, c] = mesh.triangle(face);
        let normal = normals[face.index()];
        let edges = [b - a, c - b, a - c];
        let longest = edges.into_iter().max_by(|u, v| u.norm_squared().total_cmp(&v.norm_squared()));
        let along = longest.and_then(|e| e.try_normalize(0.0)).unwrap_or_else(Vector3::x);
        Self { origin: a, normal, axes: [along, normal.cross(&along)] }
    }

    fn place(&self, mesh: &TriMesh, topology: &Topology, c: CornerId) -> Point2<f64> {
        let from = mesh.positions()[topology.vertex(c).index()] - self.origin;
        Point2::new(from.dot(&self.axes[0]), from.dot(&self.axes[1]))
    }

    /// Whether a face beside the facet is of it: parallel, or so thin that its normal says nothing, and in the plane.
    fn holds(&self, mesh: &TriMesh, face: FaceId, normals: &[Vector3<f64>], diagonal: f64) -> bool {
        let normal = normals[face.index()];
        let turn = normal.cross(&self.normal).norm().atan2(normal.dot(&self.normal));
        if self.normal == Vector3::zeros() {
            return false;
        }
        let height = |p: abf_mesh::Point3<f64>| (p - self.origin).dot(&self.normal).abs();
        let is_near = || mesh.triangle(face).into_iter().all(|p| height(p) <= IN_PLANE * diagonal);
        (turn <= FLAT && normal != Vector3::zeros()) || (is_near() && normal.dot(&self.normal) >= 0.0)
    }
}

/// The angle between the normals of the two faces at an edge, rad; 0 beside a face without area.
pub(super) fn turn(normals: &[Vector3<f64>], c: CornerId, o: CornerId) -> f64 {
    let [n, m] = [c, o].map(|c| normals[c.face().index()]);
    n.cross(&m).norm().atan2(n.dot(&m))
}

/// An interior edge between two facets.
#[derive(Clone, Copy)]
pub(super) struct Fold {
    /// The lower corner that faces it.
    pub(super) corner: CornerId,
    pub(super) opposite: CornerId,
    /// The angle between the normals, rad.
    pub(super) turn: f64,
    /// Its length.
    pub(super) length: f64,
    /// Whether it should not be cut.
    pub(super) is_forbidden: bool,
}

/// Every edge between two facets.
pub(super) fn folds(mesh: &TriMesh, topology: &Topology, facets: &Facets, normals: &[Vector3<f64>]) -> Vec<Fold> {
    crate::seams::interior_edges(topology)
        .filter(|(c, o)| facets.of_face[c.face().index()] != facets.of_face[o.face().index()])
        .map(|(corner, opposite)| Fold {
            corner,
            opposite,
            turn: turn(normals, corner, opposite),
            length: edge_length(mesh, topology, corner),
            is_forbidden: false,
        })
        .collect()
}
