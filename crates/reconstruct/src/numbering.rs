//! The free vertices of a layout, ordered for elimination.

use abf_control::Checkpoint;
use abf_linalg::{Graph, LinearError, Permutation, SymmetricPattern};
use abf_mesh::{CornerId, Topology, VertexId};
use std::sync::Arc;

/// Marks a vertex that is pinned, or that no face uses.
const FIXED: u32 = u32::MAX;

/// One unknown per vertex that has faces and is not pinned, in a fill-reducing order, with the
/// pattern of a matrix that couples the vertices of every triangle.
pub(crate) struct Numbering {
    unknown: Vec<u32>,
    pub(crate) pattern: Arc<SymmetricPattern>,
}

impl Numbering {
    pub(crate) fn new(
        topology: &Topology,
        pinned: &[VertexId],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let mut free = vec![FIXED; topology.vertex_count()];
        let mut count = 0;
        for v in topology.vertices() {
            if topology.fan_start(v).is_some() && !pinned.contains(&v) {
                free[v.index()] = count;
                count += 1;
            }
        }
        let edges = topology.corners().filter_map(|c| edge_once(topology, c));
        let edges = edges.map(|(a, b)| (free[a.index()], free[b.index()])).filter(|&(a, b)| a != FIXED && b != FIXED);
        let graph = Graph::from_edges(count as usize, edges.collect::<Vec<_>>().into_iter());
        checkpoint()?;
        let order: Permutation = graph.amd()?;
        checkpoint()?;
        let pattern = Arc::new(SymmetricPattern::of_blocks(&graph, &order, 1));
        let unknown = free.iter().map(|&f| if f == FIXED { f } else { order.new_index(f as usize) as u32 }).collect();
        Ok(Self { unknown, pattern })
    }

    /// The unknown of a vertex; `None` when it is pinned.
    #[inline]
    pub(crate) fn unknown(&self, vertex: VertexId) -> Option<usize> {
        match self.unknown[vertex.index()] {
            FIXED => None,
            u => Some(u as usize),
        }
    }
}

/// The edge facing a corner, from one of its two sides only.
fn edge_once(topology: &Topology, corner: CornerId) -> Option<(VertexId, VertexId)> {
    let once = topology.opposite(corner).is_none_or(|o| corner < o);
    once.then(|| (topology.vertex(corner.next()), topology.vertex(corner.prev())))
}
