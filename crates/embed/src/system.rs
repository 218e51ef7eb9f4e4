//! Linear systems with a block of unknowns for every vertex and a contribution of every face.

use abf_control::{Checkpoint, at_block};
use abf_linalg::{Cholesky, Graph, LinearError, Permutation, SymbolicCholesky, SymmetricMatrix, SymmetricPattern};
use abf_mesh::{Topology, VertexId};
use std::sync::Arc;

/// What is added to the diagonal, as a share of it: a crowded neighbourhood whose triangles are 1e-10 of the others is
/// held in its place by stiffnesses that drown in the rounding of its own.
const DIAGONAL_DAMPING: std::ops::Range<f64> = 1e-13..1e-3;

/// Marks what is not in a system.
const NONE: u32 = u32::MAX;

/// The vertices that have faces and are not pinned, in a fill-reducing order.
pub(crate) struct Numbering {
    unknown: Vec<u32>,
    graph: Graph,
    order: Permutation,
}

impl Numbering {
    /// Vertices with an edge, and further pairs, are neighbours.
    pub(crate) fn new(
        topology: &Topology,
        pinned: &[VertexId],
        further: &[(VertexId, VertexId)],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let mut free = vec![NONE; topology.vertex_count()];
        let mut count = 0;
        for v in topology.vertices().filter(|v| topology.fan_start(*v).is_some() && !pinned.contains(v)) {
            free[v.index()] = count;
            count += 1;
        }
        let edges = topology.corners().map(|c| (topology.vertex(c.next()), topology.vertex(c.prev())));
        let edges = edges.chain(further.iter().copied());
        let edges = edges.map(|(a, b)| (free[a.index()], free[b.index()])).filter(|&(a, b)| a != NONE && b != NONE);
        let graph = Graph::from_edges(count as usize, edges.collect::<Vec<_>>().into_iter());
        checkpoint()?;
        let order = graph.amd()?;
        checkpoint()?;
        let unknown = free.iter().map(|&f| if f == NONE { f } else { order.new_index(f as usize) as u32 }).collect();
        Ok(Self { unknown, graph, order })
    }

    /// The place of a vertex in the order; `None` when it is pinned or has no faces.
    #[inline]
    pub(crate) fn unknown(&self, vertex: VertexId) -> Option<usize> {
        let unknown = self.unknown[vertex.index()];
        (unknown != NONE).then_some(unknown as usize)
    }
}

/// A symmetric matrix, the sum of one dense `N × N` block per face: `N / 3` rows for each of its vertices, in their
/// order. Where the entries of every face go is found once, the pattern analysed once.
pub(crate) struct FaceSystem<const N: usize> {
    pub(crate) numbering: Numbering,
    pub(crate) matrix: SymmetricMatrix<f64>,
    symbolic: Arc<SymbolicCholesky>,
    slots: Vec<[[u32; N]; N]>,
}

impl<const N: usize> FaceSystem<N> {
    pub(crate) fn new(
        topology: &Topology,
        pinned: &[VertexId],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        Self::with_pairs(topology, pinned, &[], checkpoint)
    }

    /// The same with further pairs of vertices that share entries: see [`FaceSystem::add_triple`].
    pub(crate) fn with_pairs(
        topology: &Topology,
        pinned: &[VertexId],
        pairs: &[(VertexId, VertexId)],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let numbering = Numbering::new(topology, pinned, pairs, checkpoint)?;
        let block = N / 3;
        let pattern = Arc::new(SymmetricPattern::of_blocks(&numbering.graph, &numbering.order, block));
        checkpoint()?;
        let mut slots = Vec::with_capacity(topology.face_count());
        for face in topology.faces() {
            at_block(face.index(), checkpoint)?;
            slots.push(slots_of(&pattern, &numbering, topology.face_vertices(face)));
        }
        checkpoint()?;
        let symbolic = SymbolicCholesky::analyse(Arc::clone(&pattern))?;
        checkpoint()?;
        Ok(Self { numbering, matrix: SymmetricMatrix::zeros(pattern), symbolic, slots })
    }

    pub(crate) fn clear(&mut self) {
        self.matrix.values.fill(0.0);
    }

    /// Adds the symmetric block of one face.
    #[inline]
    pub(crate) fn add(&mut self, face: usize, block: &[[f64; N]; N]) {
        for (slots, row) in self.slots[face].iter().zip(block) {
            for (&slot, &value) in slots.iter().zip(row) {
                if slot != NONE {
                    self.matrix.values[slot as usize] += value;
                }
            }
        }
    }

    /// Adds the symmetric block of three vertices, any two of which share a face or were given as a pair.
    pub(crate) fn add_triple(&mut self, vertices: [VertexId; 3], block: &[[f64; N]; N]) {
        let slots: [[u32; N]; N] = slots_of(self.matrix.pattern(), &self.numbering, vertices);
        for (&slot, &value) in slots.as_flattened().iter().zip(block.as_flattened()) {
            if slot != NONE {
                self.matrix.values[slot as usize] += value;
            }
        }
    }

    /// Adds to the diagonal of a vertex, if it is in the system.
    pub(crate) fn add_to_diagonal(&mut self, vertex: VertexId, value: f64) {
        let block = N / 3;
        if let Some(unknown) = self.numbering.unknown(vertex) {
            for row in block * unknown..block * (unknown + 1) {
                let slot = self.matrix.pattern().column(row).start;
                self.matrix.values[slot] += value;
            }
        }
    }

    /// Factorises the matrix with a little more on its diagonal: [`DIAGONAL_DAMPING`] of it, multiplied by 10 until the
    /// factorisation succeeds.
    pub(crate) fn factorise(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<Cholesky<f64>, LinearError> {
        let mut damping = DIAGONAL_DAMPING.start;
        loop {
            checkpoint()?;
            for column in 0..self.matrix.size() {
                let diagonal = self.matrix.pattern().column(column).start;
                self.matrix.values[diagonal] *= 1.0 + damping;
            }
            damping *= 10.0;
            match self.symbolic.factorise(&self.matrix) {
                Err(LinearError::NotPositiveDefinite { .. }) if DIAGONAL_DAMPING.contains(&damping) => {}
                result => {
                    checkpoint()?;
                    return result;
                }
            }
        }
    }
}

/// Where the entries of the block of three vertices go; [`NONE`] for those above the diagonal and of pinned vertices.
fn slots_of<const N: usize>(
    pattern: &SymmetricPattern,
    numbering: &Numbering,
    vertices: [VertexId; 3],
) -> [[u32; N]; N] {
    let block = N / 3;
    let vertices = vertices.map(|v| numbering.unknown(v));
    let rows: [Option<usize>; N] = std::array::from_fn(|i| vertices[i / block].map(|u| block * u + i % block));
    rows.map(|row| {
        rows.map(|column| match (row, column) {
            (Some(row), Some(column)) if row >= column => pattern.slot(row, column) as u32,
            _ => NONE,
        })
    })
}
