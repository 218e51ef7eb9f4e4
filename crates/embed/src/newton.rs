//! One Gauss–Newton direction.

use crate::objective::Objective;
use crate::plane::{add_edge_damping, angle_derivatives, at_resolution, of_face};
use crate::system::FaceSystem;
use abf_control::{Cancelled, Checkpoint, at_block};
use abf_linalg::{Cholesky, LinearError, LinearStats, Refinement};
use abf_mesh::{FaceId, Point2, Topology, Vector2, VertexId};

/// The weight of `Σ |δe|² / |e|²` over the edges of all faces, beside energies of about 1 per corner. It bends no
/// optimum (it damps steps only) and keeps changes of scale that cost next to nothing within bounds.
const EDGE_DAMPING: f64 = 1e-6;

/// By what the diagonal of a triangle at the resolution of doubles is multiplied. Its vertices are held where they are:
/// carried along with the others they would be rounded over one another, and no step, however short, would be left.
const HOLD: f64 = 1e8;

/// How many roundings of its coordinates may turn over a triangle at the resolution of doubles: at first, and at most.
const ROUNDINGS: std::ops::RangeInclusive<f64> = 32.0..=32.0 * 32.0 * 32.0;
/// By what that number is multiplied when no step leads anywhere.
const MORE_ROUNDINGS: f64 = 32.0;

/// The refinement of the linear solves: a direction is checked by its descent, not by its digits.
const REFINEMENT: Refinement = Refinement { tolerance: 1e-8, max_steps: 2 };

/// `JᵀΛJ d = −Jᵀ dE/dx` with `J = dx/du` and `Λ = d²E/dx²`: Gauss–Newton in the angles, exact in the barrier.
pub(crate) struct Newton {
    system: FaceSystem<6>,
    /// A triangle that so many roundings can turn over is held.
    roundings: f64,
}

/// Where to go.
pub(crate) struct Direction {
    /// `d`, per vertex.
    pub(crate) motion: Vec<Vector2<f64>>,
    /// `δ = J d`, per corner, rad.
    pub(crate) angle_change: Vec<f64>,
    /// `⟨dE/du, d⟩`, negative.
    pub(crate) slope: f64,
    /// The faces that were held.
    pub(crate) held: Vec<FaceId>,
    /// The linear solve.
    pub(crate) linear: LinearStats,
}

impl Newton {
    /// Two pinned vertices take away the four similarities.
    pub(crate) fn new(
        topology: &Topology,
        pinned: [VertexId; 2],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        Ok(Self { system: FaceSystem::new(topology, &pinned, checkpoint)?, roundings: *ROUNDINGS.start() })
    }

    /// Holds more triangles from now on: those whose angles have digits left, but too few for the last of the way. `false`
    /// where that has no end.
    pub(crate) fn hold_more(&mut self) -> bool {
        let more = self.roundings * MORE_ROUNDINGS;
        let may = ROUNDINGS.contains(&more);
        if may {
            self.roundings = more;
        }
        may
    }

    pub(crate) fn direction(
        &mut self,
        objective: &Objective<'_, '_>,
        uv: &[Point2<f64>],
        angles: &[f64],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Direction, LinearError> {
        let topology = objective.problem.topology();
        let (gradient, held) = self.assemble(objective, uv, angles, checkpoint)?;
        let factors = self.system.factorise(checkpoint)?;
        let (motion, linear) = self.solve(topology, &factors, &gradient, checkpoint)?;
        checkpoint()?;
        let slope = gradient.iter().zip(&motion).map(|(g, d)| g.dot(d)).sum();
        let angle_change = topology.faces().flat_map(|face| angle_change(topology, uv, &motion, face)).collect();
        Ok(Direction { motion, angle_change, slope, held, linear })
    }

    /// Fills the matrix; returns `dE/du` and the faces held.
    fn assemble(
        &mut self,
        objective: &Objective<'_, '_>,
        uv: &[Point2<f64>],
        angles: &[f64],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(Vec<Vector2<f64>>, Vec<FaceId>), Cancelled> {
        let mut held = Vec::new();
        let topology = objective.problem.topology();
        let mut gradient = vec![Vector2::zeros(); uv.len()];
        self.system.clear();
        for face in topology.faces() {
            at_block(face.index(), checkpoint)?;
            let points = of_face(topology, uv, face);
            let vertices = topology.face_vertices(face);
            let mut block = [[0.0; 6]; 6];
            for (corner, row) in face.corners().into_iter().zip(angle_derivatives(&points)) {
                let (slope, curvature) = objective.derivatives(corner.index(), angles[corner.index()]);
                for i in 0..6 {
                    gradient[vertices[i / 2].index()][i % 2] += slope * row[i];
                    let scaled = curvature * row[i];
                    (0..6).for_each(|j| block[i][j] += scaled * row[j]);
                }
            }
            add_edge_damping(&mut block, &points, EDGE_DAMPING);
            if at_resolution(&points, self.roundings) {
                held.push(face);
                (0..6).for_each(|i| block[i][i] *= HOLD);
            }
            self.system.add(face.index(), &block);
        }
        Ok((gradient, held))
    }

    fn solve(
        &self,
        topology: &Topology,
        factors: &Cholesky<f64>,
        gradient: &[Vector2<f64>],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(Vec<Vector2<f64>>, LinearStats), LinearError> {
        let unknown = |v| self.system.numbering.unknown(v);
        let mut rhs = vec![0.0; self.system.matrix.size()];
        for v in topology.vertices() {
            if let Some(u) = unknown(v) {
                (0..2).for_each(|axis| rhs[2 * u + axis] = -gradient[v.index()][axis]);
            }
        }
        let linear = factors.solve_asking(&self.system.matrix, &mut rhs, REFINEMENT, checkpoint)?;
        let motion = |v| unknown(v).map_or(Vector2::zeros(), |u| Vector2::new(rhs[2 * u], rhs[2 * u + 1]));
        Ok((topology.vertices().map(motion).collect(), linear))
    }
}

fn angle_change(topology: &Topology, uv: &[Point2<f64>], motion: &[Vector2<f64>], face: FaceId) -> [f64; 3] {
    let [a, b, c] = of_face(topology, motion, face);
    // Differences first: in a small triangle that is carried far they are what is left.
    let relative = [0.0, 0.0, b.x - a.x, b.y - a.y, c.x - a.x, c.y - a.y];
    angle_derivatives(&of_face(topology, uv, face)).map(|row| row.iter().zip(&relative).map(|(j, d)| j * d).sum())
}
