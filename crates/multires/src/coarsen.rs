//! Rounds of collapses.

use crate::cost::{Limits, cheapest};
use crate::hierarchy::{Hierarchy, Level, Removal};
use crate::working::Working;
use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{Point3, Topology, TriMesh, VertexId};
use abf_parallel::prelude::*;

/// A level has a fourth of the faces of the one before.
const FACTOR: usize = 4;

/// A round that removes less than this part of the vertices is followed by less strict ones.
const LEAST_PROGRESS: f64 = 0.02;

/// How often the limits are relaxed. What is left then stays.
const MOST_RELAXED: usize = 4;

/// So many vertices are looked at between two questions whether to go on.
pub(crate) const BLOCK: usize = 1 << 14;

/// Fewer vertices are not worth a thread.
pub(crate) const PER_TASK: usize = 1 << 9;

/// A collapse that may be made.
struct Candidate {
    cost: f64,
    vertex: u32,
    target: u32,
}

impl Hierarchy {
    /// Collapses edges until at most `triangles` are left, or no more of them can go.
    ///
    /// A vertex collapses into a neighbour, on the boundary along it only, where the result stays a manifold of the same
    /// kind (the link condition) and its triangles have a shape. The cheapest go first. A round removes vertices that are
    /// no neighbours of each other. Same input, same bits.
    ///
    /// # Errors
    /// [`Cancelled`], if the checkpoint ends it.
    ///
    /// # Panics
    /// If the topology is not that of the mesh.
    pub fn coarsen(
        mesh: &TriMesh,
        topology: &Topology,
        triangles: usize,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, Cancelled> {
        Rounds::new(mesh, topology).run(triangles, false, checkpoint)
    }

    /// The same for drawings that need nothing but the connections: where no collapse leaves triangles with a shape, others
    /// are made. A vertex of the interior never collapses into the boundary, which may wind more than once around its own
    /// vertices in a drawing; so there is a place for every vertex in every drawing of the rest.
    ///
    /// # Errors
    /// [`Cancelled`], if the checkpoint ends it.
    ///
    /// # Panics
    /// If the topology is not that of the mesh.
    pub fn coarsen_in_any_shape(
        mesh: &TriMesh,
        topology: &Topology,
        triangles: usize,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, Cancelled> {
        Rounds::new(mesh, topology).run(triangles, true, checkpoint)
    }
}

struct Rounds<'m> {
    points: &'m [Point3<f64>],
    working: Working,
    /// The vertices that are left, in their order.
    live: Vec<u32>,
    /// In which round a vertex lost a neighbour last, counted from 1.
    blocked: Vec<u32>,
    hierarchy: Hierarchy,
}

impl<'m> Rounds<'m> {
    fn new(mesh: &'m TriMesh, topology: &Topology) -> Self {
        assert_eq!(mesh.face_count(), topology.face_count(), "the topology of this mesh");
        let working = Working::new(topology);
        Self {
            points: mesh.positions(),
            blocked: vec![0; mesh.vertex_count()],
            live: (0..mesh.vertex_count() as u32).filter(|&v| working.is_used(v)).collect(),
            working,
            hierarchy: Hierarchy { vertices: mesh.vertex_count(), ..Hierarchy::default() },
        }
    }

    fn run(
        mut self,
        triangles: usize,
        in_any_shape: bool,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Hierarchy, Cancelled> {
        let (mut limits, mut relaxed) = (if in_any_shape { Limits::APART } else { Limits::STRICT }, 0);
        let mut last_level = self.working.face_count();
        while self.working.face_count() > triangles && relaxed <= MOST_RELAXED {
            let candidates = self.candidates(limits, checkpoint)?;
            checkpoint()?;
            let removed = self.collapse(&candidates, triangles);
            if removed > 0 {
                self.hierarchy.rounds.push(self.hierarchy.removals.len());
            }
            let is_little = (removed as f64) < LEAST_PROGRESS * (self.live.len() + removed) as f64;
            if in_any_shape && relaxed == MOST_RELAXED && (is_little || limits == Limits::ANY_SHAPE) {
                // As long as anything goes.
                relaxed += usize::from(removed == 0 && limits == Limits::ANY_SHAPE);
                limits = Limits::ANY_SHAPE;
            } else if is_little {
                limits = limits.relaxed();
                relaxed += 1;
            }
            if self.working.face_count() * FACTOR <= last_level {
                last_level = self.working.face_count();
                self.keep_level();
            }
        }
        if self.hierarchy.levels.last().is_none_or(|level| level.rounds < self.hierarchy.rounds.len()) {
            self.keep_level();
        }
        Ok(self.hierarchy)
    }

    /// The cheapest collapse of every vertex that has one, the cheapest of all first.
    fn candidates(&self, limits: Limits, checkpoint: &mut Checkpoint<'_>) -> Result<Vec<Candidate>, Cancelled> {
        let of_vertex = |&vertex: &u32| {
            let (cost, target) = cheapest(&self.working, self.points, vertex, limits)?;
            Some(Candidate { cost, vertex, target })
        };
        let mut found = Vec::with_capacity(self.live.len());
        for block in self.live.chunks(BLOCK) {
            checkpoint()?;
            let of_block: Vec<Option<Candidate>> = block.par_iter().with_min_len(PER_TASK).map(of_vertex).collect();
            found.extend(of_block.into_iter().flatten());
        }
        found.sort_unstable_by(|a, b| a.cost.total_cmp(&b.cost).then(a.vertex.cmp(&b.vertex)));
        Ok(found)
    }

    /// Makes those that are still possible, down to so many triangles, and says how many these were.
    fn collapse(&mut self, candidates: &[Candidate], triangles: usize) -> usize {
        let round = self.hierarchy.rounds.len() as u32 + 1;
        let before = self.hierarchy.removals.len();
        for &Candidate { vertex, target, .. } in candidates {
            if self.working.face_count() <= triangles {
                break;
            }
            if self.blocked[vertex as usize] == round {
                continue;
            }
            // Its own faces are as they were, or it would be blocked; those of the target need not be.
            let Some(ring) = self.working.ring(vertex) else { continue };
            let Some(place) = ring.vertices().iter().position(|&v| v == target) else { continue };
            if !self.working.may_collapse(vertex, &ring, place) {
                continue;
            }
            self.working.collapse(vertex, &ring, target);
            ring.vertices().iter().for_each(|&v| self.blocked[v as usize] = round);
            self.hierarchy.rings.extend(ring.vertices().iter().map(|&v| VertexId::new(v as usize)));
            let ring_end = self.hierarchy.rings.len();
            let vertex = VertexId::new(vertex as usize);
            self.hierarchy.removals.push(Removal { vertex, ring_end, is_closed: ring.is_closed });
        }
        self.live.retain(|&v| self.working.is_used(v));
        self.hierarchy.removals.len() - before
    }

    fn keep_level(&mut self) {
        let faces = self.working.faces().map(|face| face.map(|v| VertexId::new(v as usize))).collect();
        self.hierarchy.levels.push(Level { faces, rounds: self.hierarchy.rounds.len() });
    }
}
