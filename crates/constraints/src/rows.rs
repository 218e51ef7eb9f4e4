//! Which constraint is which row.

use abf_mesh::{CornerId, FaceId, Topology, VertexId};

/// Marks a vertex without constraints.
const NONE: u32 = u32::MAX;

/// The numbering of the constraints of a disk: row `t` is triangle `t`, row `nt + i` the vertex
/// condition and row `nt + ni + i` the wheel condition of the `i`-th interior vertex.
#[derive(Clone, Debug)]
pub struct ConstraintRows {
    triangle_count: usize,
    interior: Vec<VertexId>,
    interior_index: Vec<u32>,
    /// Where the corners of each interior vertex begin in `hubs`.
    hub_start: Vec<u32>,
    hubs: Vec<CornerId>,
}

impl ConstraintRows {
    /// The rows of this topology; interior vertices keep the order of the input.
    #[must_use]
    pub fn new(topology: &Topology) -> Self {
        let interior: Vec<VertexId> = topology.vertices().filter(|&v| topology.is_interior(v)).collect();
        let mut interior_index = vec![NONE; topology.vertex_count()];
        for (i, v) in interior.iter().enumerate() {
            interior_index[v.index()] = i as u32;
        }
        let mut hub_start = Vec::with_capacity(interior.len() + 1);
        let mut hubs = Vec::with_capacity(topology.corner_count());
        hub_start.push(0);
        for &v in &interior {
            hubs.extend(topology.fan(v));
            hub_start.push(hubs.len() as u32);
        }
        Self { triangle_count: topology.face_count(), interior, interior_index, hub_start, hubs }
    }

    /// `nt`.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangle_count
    }

    /// `ni`.
    #[must_use]
    pub fn interior_count(&self) -> usize {
        self.interior.len()
    }

    /// `nt + 2 ni`.
    #[must_use]
    pub fn len(&self) -> usize {
        self.triangle_count + 2 * self.interior.len()
    }

    /// Whether there is no constraint at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The interior vertices, in the order of their rows.
    #[must_use]
    pub fn interior(&self) -> &[VertexId] {
        &self.interior
    }

    /// The corners at the `i`-th interior vertex, counter-clockwise: what [`Topology::fan`] walks, kept.
    #[inline]
    #[must_use]
    pub fn hubs(&self, i: usize) -> &[CornerId] {
        &self.hubs[self.hub_range(i)]
    }

    /// Where [`ConstraintRows::hubs`] of the `i`-th interior vertex stands in the list of all of them,
    /// vertex by vertex: the place for data kept per spoke of a wheel.
    #[inline]
    #[must_use]
    pub fn hub_range(&self, i: usize) -> std::ops::Range<usize> {
        self.hub_start[i] as usize..self.hub_start[i + 1] as usize
    }

    /// How many spokes all wheels have together.
    #[must_use]
    pub fn hub_count(&self) -> usize {
        self.hubs.len()
    }

    /// The place of a vertex among the interior ones; `None` on the boundary.
    #[inline]
    #[must_use]
    pub fn interior_index(&self, vertex: VertexId) -> Option<usize> {
        match self.interior_index[vertex.index()] {
            NONE => None,
            i => Some(i as usize),
        }
    }

    /// The row of a triangle condition.
    #[inline]
    #[must_use]
    pub fn triangle(&self, face: FaceId) -> usize {
        face.index()
    }

    /// The row of the vertex condition of the `i`-th interior vertex.
    #[inline]
    #[must_use]
    pub fn vertex(&self, i: usize) -> usize {
        self.triangle_count + i
    }

    /// The row of the wheel condition of the `i`-th interior vertex.
    #[inline]
    #[must_use]
    pub fn wheel(&self, i: usize) -> usize {
        self.triangle_count + self.interior.len() + i
    }
}
