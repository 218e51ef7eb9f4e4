//! Tutte's embedding of a disk on a circle.
//!
//! Boundary vertices are put on the unit circle, every interior vertex in the weighted mean of its neighbours:
//! `Σ_j λ_ij (u_j − u_i) = 0` with positive `λ`. For a disk whose boundary is mapped onto a convex curve this is a
//! drawing without flips (Tutte 1963; for weights without symmetry Floater 1997), in exact arithmetic. In doubles
//! it is checked, triangle by triangle, by an exact predicate.
//!
//! Mean-value weights (Floater 2003), `λ_ij = (tan(α/2) + tan(β/2)) / |p_j − p_i|` with the angles α and β at `i`
//! on either side of the edge, follow the shape of the triangles and are positive on every mesh.

use crate::EmbedError;
use crate::plane::not_counter_clockwise;
use abf_control::{Silent, StopCriteria, Watch, at_block};
use abf_linalg::{LinearError, Refinement, SparseMatrix, SymbolicLu};
use abf_mesh::{CornerId, Point2, Topology, TriMesh, Vector2, VertexId};
use std::f64::consts::TAU;

/// How the boundary vertices are spread on the circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum BoundarySpacing {
    /// By the lengths of the boundary edges in space.
    ArcLength,
    /// At equal distances.
    Uniform,
}

/// The weights of the means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum TutteWeights {
    /// Floater's, of the triangles in space.
    MeanValue,
    /// All the same: Tutte's own.
    Uniform,
}

/// A drawing of a disk in which every triangle is counter-clockwise, by an exact predicate.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TutteEmbedding {
    /// One point per vertex, inside the unit circle; the origin for vertices that no face uses.
    pub uv: Vec<Point2<f64>>,
    /// How the boundary was spread.
    pub spacing: BoundarySpacing,
    /// The weights that led there.
    pub weights: TutteWeights,
}

/// What is tried, in this order, until doubles hold the result. Arc lengths keep the boundary's proportions; short
/// edges between long ones give triangles too flat for doubles there. Uniform weights ignore the geometry: slivers
/// and spikes that pull mean values together beyond the resolution of doubles no longer do.
const LADDER: [(BoundarySpacing, TutteWeights); 4] = [
    (BoundarySpacing::ArcLength, TutteWeights::MeanValue),
    (BoundarySpacing::Uniform, TutteWeights::MeanValue),
    (BoundarySpacing::ArcLength, TutteWeights::Uniform),
    (BoundarySpacing::Uniform, TutteWeights::Uniform),
];

/// Corrections `u ← u + A⁻¹r`, `r` computed from differences `u_j − u_i` and so to the precision of a crowded
/// neighbourhood, which the residual `b − Au` of the linear solve is not.
const CORRECTIONS: usize = 2;

/// Embeds a disk on the unit circle without a flipped or collapsed triangle.
///
/// Arc lengths and mean-value weights first; where doubles do not hold that drawing, equal spacing, then uniform
/// weights. One sparse LU factorisation each.
///
/// # Errors
/// [`EmbedError::NotADisk`]; [`EmbedError::TutteFlipped`] naming the first bad triangle of the first attempt when none
/// of the attempts is a drawing in doubles; [`EmbedError::Linear`] when none could even be computed.
///
/// # Panics
/// If `topology` is not that of `mesh`.
pub fn tutte(mesh: &TriMesh, topology: &Topology) -> Result<TutteEmbedding, EmbedError> {
    tutte_watched(mesh, topology, &mut Watch::start(&StopCriteria::default(), &mut Silent))
}

/// The same for someone who may have no time: told of after every solve. A drawing that is there by then is a result;
/// it is left as it is, and nothing else is tried.
///
/// # Errors
/// Those of [`tutte()`], and [`EmbedError::Interrupted`] when there is no drawing yet.
pub(crate) fn tutte_watched(
    mesh: &TriMesh,
    topology: &Topology,
    watch: &mut Watch<'_>,
) -> Result<TutteEmbedding, EmbedError> {
    assert_eq!(mesh.vertex_count(), topology.vertex_count(), "the topology of this mesh");
    topology.require_disk()?;
    let mut first_failure = None;
    for (spacing, weights) in LADDER {
        if let Some(interruption) = watch.interruption() {
            return Err(EmbedError::Interrupted(interruption));
        }
        let failure = match place(mesh, topology, spacing, weights, watch) {
            Ok(uv) => match not_counter_clockwise(topology, &uv) {
                None => return Ok(TutteEmbedding { uv, spacing, weights }),
                Some((face, count)) => EmbedError::TutteFlipped { face, count },
            },
            Err(error) => {
                watch.aborted()?;
                error.into()
            }
        };
        first_failure.get_or_insert(failure);
    }
    Err(first_failure.expect("the ladder is not empty"))
}

/// One attempt, not checked.
fn place(
    mesh: &TriMesh,
    topology: &Topology,
    spacing: BoundarySpacing,
    weights: TutteWeights,
    watch: &mut Watch<'_>,
) -> Result<Vec<Point2<f64>>, LinearError> {
    let mut uv = on_circle(mesh, topology, spacing);
    let interior: Vec<VertexId> = topology.vertices().filter(|&v| topology.is_interior(v)).collect();
    let mut unknown = vec![u32::MAX; topology.vertex_count()];
    interior.iter().enumerate().for_each(|(u, v)| unknown[v.index()] = u as u32);
    let mut rows: Vec<Vec<(VertexId, f64)>> = Vec::with_capacity(interior.len());
    for (u, &v) in interior.iter().enumerate() {
        at_block(u, &mut || watch.checkpoint())?;
        rows.push(means(mesh, topology, v, weights));
    }
    watch.checkpoint()?;

    let mut triplets = Vec::new();
    for (u, row) in rows.iter().enumerate() {
        at_block(u, &mut || watch.checkpoint())?;
        triplets.push((u as u32, u as u32, 1.0));
        let inner = row.iter().map(|&(j, weight)| (u as u32, unknown[j.index()], -weight));
        triplets.extend(inner.filter(|&(_, column, _)| column != u32::MAX));
    }
    watch.checkpoint()?;
    let matrix = SparseMatrix::from_triplets(interior.len(), &triplets);
    watch.checkpoint()?;
    let symbolic = SymbolicLu::analyse(&matrix)?;
    watch.checkpoint()?;
    let factors = symbolic.factorise(&matrix)?;
    watch.checkpoint()?;
    for _ in 0..=CORRECTIONS {
        let pull = |uv: &[Point2<f64>], v: VertexId, row: &[(VertexId, f64)]| -> Vector2<f64> {
            row.iter().map(|&(j, weight)| (uv[j.index()] - uv[v.index()]) * weight).sum()
        };
        let pulls: Vec<Vector2<f64>> = interior.iter().zip(&rows).map(|(&v, row)| pull(&uv, v, row)).collect();
        for axis in 0..2 {
            let mut rhs: Vec<f64> = pulls.iter().map(|pull| pull[axis]).collect();
            match factors.solve_asking(&matrix, &mut rhs, Refinement::default(), &mut || watch.checkpoint()) {
                Ok(_) => {}
                // A residual that is all rounding has nothing left to correct.
                Err(LinearError::NoSolution { .. }) if pulls.iter().all(|p| p.amax() <= f64::EPSILON) => continue,
                Err(error) => return Err(error),
            }
            watch.checkpoint()?;
            interior.iter().zip(&rhs).for_each(|(v, correction)| uv[v.index()][axis] += correction);
        }
        // The first solve makes a drawing of it; what follows are digits.
        if !watch.inner(0, f64::NAN)? {
            break;
        }
    }
    Ok(uv)
}

/// The boundary vertices on the unit circle, counter-clockwise; all others at the origin.
fn on_circle(mesh: &TriMesh, topology: &Topology, spacing: BoundarySpacing) -> Vec<Point2<f64>> {
    let loops = topology.boundary_loops();
    let boundary = &loops[0].vertices;
    let position = |i: usize| mesh.positions()[boundary[i % boundary.len()].index()];
    let length = |i: usize| match spacing {
        BoundarySpacing::ArcLength => (position(i + 1) - position(i)).norm(),
        BoundarySpacing::Uniform => 1.0,
    };
    let total: f64 = (0..boundary.len()).map(length).sum();
    let mut uv = vec![Point2::origin(); topology.vertex_count()];
    let mut walked = 0.0;
    for (i, v) in boundary.iter().enumerate() {
        let angle = TAU * walked / total;
        uv[v.index()] = Point2::new(angle.cos(), angle.sin());
        walked += length(i);
    }
    uv
}

/// The neighbours of an interior vertex with their weights, which sum to 1.
fn means(mesh: &TriMesh, topology: &Topology, vertex: VertexId, weights: TutteWeights) -> Vec<(VertexId, f64)> {
    let half_tangent = |corner: CornerId| {
        let [a, b, c] = [corner, corner.next(), corner.prev()].map(|c| mesh.positions()[topology.vertex(c).index()]);
        let (e, f) = (b - a, c - a);
        // tan(α/2) = sin α / (1 + cos α), without computing α.
        e.cross(&f).norm() / (e.norm() * f.norm() + e.dot(&f))
    };
    let fan: Vec<CornerId> = topology.fan(vertex).collect();
    let mut row: Vec<(VertexId, f64)> = Vec::with_capacity(fan.len());
    for (k, &corner) in fan.iter().enumerate() {
        // The edge from the vertex to the corner's next lies between this corner and the one before it.
        let neighbour = topology.vertex(corner.next());
        let before = fan[(k + fan.len() - 1) % fan.len()];
        let weight = match weights {
            TutteWeights::Uniform => 1.0,
            TutteWeights::MeanValue => {
                let length = (mesh.positions()[neighbour.index()] - mesh.positions()[vertex.index()]).norm();
                (half_tangent(before) + half_tangent(corner)) / length
            }
        };
        row.push((neighbour, weight));
    }
    let total: f64 = row.iter().map(|(_, weight)| weight).sum();
    row.iter_mut().for_each(|(_, weight)| *weight /= total);
    row
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use abf_control::Termination;
    use abf_mesh::{DiskError, FaceId, Point3};
    use abf_shapes::Shape;
    use std::time::Duration;

    fn topology(mesh: &TriMesh) -> Topology {
        Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold")
    }

    #[test]
    fn every_shape_has_an_embedding_at_the_first_attempt() {
        for shape in Shape::ALL {
            let mesh = shape.mesh(1500);
            let embedding = tutte(&mesh, &topology(&mesh)).expect("a drawing");
            assert_eq!((embedding.spacing, embedding.weights), LADDER[0], "{}", shape.name());
            assert!(embedding.uv.iter().all(|p| p.coords.norm() <= 1.0 + 1e-12));
        }
    }

    #[test]
    fn interior_vertices_are_the_means_of_their_neighbours() {
        let mesh = Shape::Mask.mesh(800);
        let topology = topology(&mesh);
        let embedding = tutte(&mesh, &topology).expect("a drawing");
        for v in topology.vertices().filter(|&v| topology.is_interior(v)) {
            let row = means(&mesh, &topology, v, TutteWeights::MeanValue);
            let pull: Vector2<f64> =
                row.iter().map(|&(j, weight)| (embedding.uv[j.index()] - embedding.uv[v.index()]) * weight).sum();
            assert!(pull.norm() < 1e-14);
            assert!(row.iter().all(|&(_, weight)| weight > 0.0));
        }
    }

    #[test]
    fn mean_value_weights_reproduce_a_flat_drawing() {
        // Floater 2003: a vertex in the plane is the mean of its neighbours with these weights.
        let mesh = Shape::FatDisk.mesh(300);
        let flat: Vec<Point3<f64>> = mesh.positions().iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
        let faces: Vec<[usize; 3]> = mesh.faces().iter().map(|f| f.map(VertexId::index)).collect();
        let mesh = TriMesh::new(flat, &faces).expect("indices in range");
        let topology = topology(&mesh);
        for v in topology.vertices().filter(|&v| topology.is_interior(v)) {
            let row = means(&mesh, &topology, v, TutteWeights::MeanValue);
            let mean: abf_mesh::Vector3<f64> = row
                .iter()
                .map(|&(j, weight)| (mesh.positions()[j.index()] - mesh.positions()[v.index()]) * weight)
                .sum();
            assert!(mean.norm() < 1e-12);
        }
    }

    /// A mesh that arc lengths spoil.
    fn short_rim() -> TriMesh {
        // A fan whose short rim edges are 1e-13 of the others: their triangles are flat on a circle by arc length.
        let mut points = vec![Point3::new(0.0, 0.0, 0.0)];
        for k in 0..6 {
            for offset in [0.0, 1e-13, 2e-13] {
                let angle = f64::from(k) + offset;
                points.push(Point3::new(angle.cos(), angle.sin(), 0.3));
            }
        }
        let n = points.len() - 1;
        let mut faces: Vec<[usize; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
        // An ear over two short edges makes three nearly equal points a triangle.
        faces[0] = [0, 1, 3];
        faces[1] = [1, 2, 3];
        TriMesh::new(points, &faces).expect("indices in range")
    }

    #[test]
    fn equal_spacing_helps_where_arc_lengths_are_beyond_doubles() {
        let mesh = short_rim();
        let embedding = tutte(&mesh, &topology(&mesh)).expect("a drawing");
        assert_eq!(embedding.spacing, BoundarySpacing::Uniform);
    }

    /// A long narrow pocket, of three vertices a ring. In Tutte's embedding every ring is half as far from the apex: after
    /// 1 100 rings no boundary and no weights leave room in doubles.
    pub(crate) fn deep_pocket(rings: usize) -> TriMesh {
        let ring = |i: usize, k: usize| 3 * i + k % 3;
        let mut points = Vec::new();
        for i in 0..rings {
            points.extend((0..3).map(|k| {
                let angle = TAU * f64::from(k) / 3.0;
                Point3::new(angle.cos(), angle.sin(), i as f64)
            }));
        }
        let mut faces = vec![[ring(rings - 1, 0), ring(rings - 1, 1), ring(rings - 1, 2)]];
        for i in 0..rings - 1 {
            for k in 0..3 {
                faces.push([ring(i, k), ring(i, k + 1), ring(i + 1, k)]);
                faces.push([ring(i, k + 1), ring(i + 1, k + 1), ring(i + 1, k)]);
            }
        }
        TriMesh::new(points, &faces).expect("indices in range")
    }

    #[test]
    fn what_doubles_cannot_hold_is_named() {
        let mesh = deep_pocket(1100);
        let error = tutte(&mesh, &topology(&mesh)).expect_err("too deep for doubles");
        assert!(matches!(error, EmbedError::TutteFlipped { face, count } if face == FaceId::new(0) && count > 1));
    }

    #[test]
    fn without_time_there_is_a_drawing_or_a_name_for_it() {
        let stop = StopCriteria { time_limit: Some(Duration::ZERO), ..StopCriteria::default() };
        let hurried = |mesh: &TriMesh| tutte_watched(mesh, &topology(mesh), &mut Watch::start(&stop, &mut Silent));
        // The first solve is a drawing.
        assert!(hurried(&Shape::Mask.mesh(500)).is_ok());
        // Here it is none, and there is no time for equal spacing.
        assert_eq!(hurried(&short_rim()), Err(EmbedError::Interrupted(Termination::TimeLimit)));
    }

    #[test]
    fn surfaces_that_are_no_disks_are_refused() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Point3::from).to_vec();
        let mesh = TriMesh::new(points, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).expect("indices in range");
        let error = tutte(&mesh, &topology(&mesh)).expect_err("a closed surface");
        assert_eq!(error, EmbedError::NotADisk(DiskError::NoBoundary { genus: 0 }));
    }

    #[test]
    fn a_single_triangle_is_embedded() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]].map(Point3::from).to_vec();
        let mesh = TriMesh::new(points, &[[0, 1, 2]]).expect("indices in range");
        assert!(tutte(&mesh, &topology(&mesh)).is_ok());
    }
}
