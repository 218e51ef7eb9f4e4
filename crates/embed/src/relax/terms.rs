//! What a drawing costs, all together, and the direction in which it costs less.

use super::energy::{Derivatives, TriangleEnergy};
use super::guard::{Barrier, Pair};
use crate::plane::{first_collapse, of_face};
use crate::system::FaceSystem;
use abf_control::{Cancelled, Checkpoint};
use abf_linalg::{LinearError, LinearStats, Refinement};
use abf_mesh::{FaceId, Point2, Topology, Vector2, VertexId};
use abf_parallel::prelude::*;

/// So many faces are summed up, and differentiated, by one thread at a time. Sums are added block by block, in order.
const BLOCK: usize = 1 << 10;

/// The derivatives of so many blocks are held at once.
const BLOCKS_AT_ONCE: usize = 16;

/// A direction is checked by its descent, not by its digits.
const REFINEMENT: Refinement = Refinement { tolerance: 1e-8, max_steps: 2 };

/// A vertex drawn to a place by `weight |u − target|²`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spring {
    pub(crate) vertex: VertexId,
    pub(crate) target: Point2<f64>,
    pub(crate) weight: f64,
}

/// The terms of the cost of a drawing.
#[derive(Clone, Copy)]
pub(crate) struct Terms<'t> {
    pub(crate) topology: &'t Topology,
    pub(crate) triangles: &'t dyn TriangleEnergy,
    pub(crate) springs: &'t [Spring],
    /// What keeps parts of the boundary apart.
    pub(crate) barrier: Option<&'t Barrier<'t>>,
}

/// Where to go.
pub(crate) struct Direction {
    /// Per vertex.
    pub(crate) motion: Vec<Vector2<f64>>,
    /// What a full step promises, twice; negative.
    pub(crate) slope: f64,
    /// The linear solve.
    pub(crate) linear: LinearStats,
}

impl Terms<'_> {
    /// The cost; infinite where a triangle is not counter-clockwise.
    pub(crate) fn value(&self, uv: &[Point2<f64>]) -> f64 {
        let of = |face: FaceId| self.triangles.value(face, &of_face(self.topology, uv, face));
        let own = self.of_blocks(|faces| faces.map(of).sum::<f64>()).into_iter().sum::<f64>() + self.of_springs(uv);
        match self.barrier {
            Some(barrier) if own.is_finite() => own + barrier.value(uv),
            _ => own,
        }
    }

    /// The cost without the barriers of triangles.
    pub(crate) fn without_barrier(&self, uv: &[Point2<f64>]) -> f64 {
        if self.triangles.barrier_size() == 0.0 {
            return self.value(uv);
        }
        let of = |face: FaceId| self.triangles.without_barrier(face, &of_face(self.topology, uv, face));
        self.of_blocks(|faces| faces.map(of).sum::<f64>()).into_iter().sum::<f64>() + self.of_springs(uv)
    }

    /// The size of what the cost is made of, without the cancellation between its parts: what a decrease is small against.
    pub(crate) fn size(&self, uv: &[Point2<f64>], value: f64) -> f64 {
        match self.triangles.barrier_size() {
            0.0 => value,
            barrier => self.without_barrier(uv) + barrier * self.topology.face_count() as f64,
        }
    }

    /// The same, but hardly anything where it is less than that.
    pub(crate) fn size_at_least(&self, uv: &[Point2<f64>]) -> f64 {
        self.size(uv, self.value(uv)).abs().max(self.triangles.hardly_anything())
    }

    fn of_springs(&self, uv: &[Point2<f64>]) -> f64 {
        self.springs.iter().map(|s| s.weight * (uv[s.vertex.index()] - s.target).norm_squared()).sum()
    }

    /// The first share of a motion at which a triangle collapses.
    pub(crate) fn first_collapse(&self, uv: &[Point2<f64>], motion: &[Vector2<f64>]) -> f64 {
        let of = |f| first_collapse(&of_face(self.topology, uv, f), &of_face(self.topology, motion, f));
        self.of_blocks(|faces| faces.map(of).fold(f64::INFINITY, f64::min)).into_iter().fold(f64::INFINITY, f64::min)
    }

    fn of_blocks<R: Send>(&self, of: impl Fn(&mut dyn Iterator<Item = FaceId>) -> R + Sync + Send) -> Vec<R> {
        let count = self.topology.face_count();
        let of_block = |block: usize| of(&mut (block * BLOCK..count.min((block + 1) * BLOCK)).map(FaceId::new));
        (0..count.div_ceil(BLOCK)).into_par_iter().map(of_block).collect()
    }

    fn derivatives(&self, uv: &[Point2<f64>], faces: std::ops::Range<usize>) -> Vec<Derivatives> {
        let of = |face: usize| {
            let face = FaceId::new(face);
            self.triangles.derivatives(face, &of_face(self.topology, uv, face))
        };
        faces.into_par_iter().with_min_len(BLOCK).map(of).collect()
    }
}

/// The linear systems of a descent: analysed once, and again where parts of the boundary come near that were not before.
pub(crate) struct Directions {
    system: FaceSystem<6>,
    pinned: Vec<VertexId>,
    /// The pairs of a vertex and an edge of the boundary that have entries, in order.
    known: Vec<Pair>,
}

impl Directions {
    /// The pinned vertices do not move.
    pub(crate) fn new(
        topology: &Topology,
        pinned: &[VertexId],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let system = FaceSystem::new(topology, pinned, checkpoint)?;
        Ok(Self { system, pinned: pinned.to_vec(), known: Vec::new() })
    }

    /// The Newton direction with the positive part of the second derivatives.
    pub(crate) fn at(
        &mut self,
        terms: &Terms<'_>,
        uv: &[Point2<f64>],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Direction, LinearError> {
        if let Some(barrier) = terms.barrier {
            self.make_room(terms.topology, barrier, uv, checkpoint)?;
        }
        let gradient = self.assemble(terms, uv, checkpoint)?;
        let factors = self.system.factorise(checkpoint)?;
        let unknown = |v: VertexId| self.system.numbering.unknown(v);
        let mut rhs = vec![0.0; self.system.matrix.size()];
        for (v, slope) in terms.topology.vertices().zip(&gradient) {
            if let Some(u) = unknown(v) {
                (0..2).for_each(|axis| rhs[2 * u + axis] = -slope[axis]);
            }
        }
        let linear = factors.solve_asking(&self.system.matrix, &mut rhs, REFINEMENT, checkpoint)?;
        let motion_of = |v| unknown(v).map_or(Vector2::zeros(), |u| Vector2::new(rhs[2 * u], rhs[2 * u + 1]));
        let motion: Vec<Vector2<f64>> = terms.topology.vertices().map(motion_of).collect();
        let slope = gradient.iter().zip(&motion).map(|(g, d)| g.dot(d)).sum();
        Ok(Direction { motion, slope, linear })
    }

    /// Gives entries to all pairs of the boundary that are near, if those that are in reach have none yet.
    fn make_room(
        &mut self,
        topology: &Topology,
        barrier: &Barrier<'_>,
        uv: &[Point2<f64>],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), LinearError> {
        if barrier.contacts(uv).iter().all(|contact| self.known.binary_search(&contact.pair).is_ok()) {
            return Ok(());
        }
        self.known = barrier.near(uv);
        let pairs: Vec<(VertexId, VertexId)> = self.known.iter().flat_map(|&pair| barrier.vertices(pair)).collect();
        self.system = FaceSystem::with_pairs(topology, &self.pinned, &pairs, checkpoint)?;
        Ok(())
    }

    /// Fills the matrix, face by face in their order; returns the gradient.
    fn assemble(
        &mut self,
        terms: &Terms<'_>,
        uv: &[Point2<f64>],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Vec<Vector2<f64>>, Cancelled> {
        let topology = terms.topology;
        let mut gradient = vec![Vector2::zeros(); uv.len()];
        self.system.clear();
        for begin in (0..topology.face_count()).step_by(BLOCKS_AT_ONCE * BLOCK) {
            checkpoint()?;
            let faces = begin..topology.face_count().min(begin + BLOCKS_AT_ONCE * BLOCK);
            for (face, of) in faces.clone().zip(terms.derivatives(uv, faces)) {
                let vertices = topology.face_vertices(FaceId::new(face));
                for (v, slope) in vertices.iter().zip(of.gradient.chunks_exact(2)) {
                    gradient[v.index()] += Vector2::new(slope[0], slope[1]);
                }
                self.system.add(face, &of.hessian);
            }
        }
        for spring in terms.springs {
            gradient[spring.vertex.index()] += (uv[spring.vertex.index()] - spring.target) * (2.0 * spring.weight);
            self.system.add_to_diagonal(spring.vertex, 2.0 * spring.weight);
        }
        for contact in terms.barrier.map_or(Vec::new(), |barrier| barrier.contacts(uv)) {
            for (v, slope) in contact.vertices.iter().zip(contact.slopes()) {
                gradient[v.index()] += slope;
            }
            self.system.add_triple(contact.vertices, &contact.hessian());
        }
        Ok(gradient)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relax::energy::{Isometric, SymmetricDirichlet};
    use crate::relax::rest::rest_shapes;
    use crate::tutte;
    use abf_shapes::Shape;
    use std::sync::Arc;

    #[test]
    fn the_slope_of_a_direction_is_what_the_cost_does_along_it() {
        let mesh = Shape::BumpySheet.mesh(300);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let uv = tutte(&mesh, &topology).expect("an embedding").uv;
        let springs = [Spring { vertex: VertexId::new(5), target: Point2::new(0.3, 0.4), weight: 2.0 }];
        let energy = Isometric { density: Arc::new(SymmetricDirichlet), rest: rest_shapes(&mesh) };
        let terms = Terms { topology: &topology, triangles: &energy, springs: &springs, barrier: None };
        let mut directions = Directions::new(&topology, &[], &mut || Ok(())).expect("a pattern");
        let direction = directions.at(&terms, &uv, &mut || Ok(())).expect("a direction");
        let along = |s: f64| -> f64 {
            terms.value(&uv.iter().zip(&direction.motion).map(|(p, d)| p + d * s).collect::<Vec<_>>())
        };
        let h = 1e-6 * terms.first_collapse(&uv, &direction.motion).min(1.0);
        let slope = (along(h) - along(-h)) / (2.0 * h);
        assert!(direction.slope < 0.0 && (slope - direction.slope).abs() < 1e-5 * slope.abs(), "{slope}");
    }
}
