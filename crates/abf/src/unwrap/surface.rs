//! A piece with its holes closed, and where it is cut.

use crate::FlattenError;
use abf_cut::{Chart, EdgeCosts, Filled, HoleFilling, SeamWays, Seams, fill, open, outer_loop, split};
use abf_mesh::{BoundaryLoop, CornerId, Topology, TriMesh, VertexId};

/// A piece with its holes closed, and where it is cut.
pub(super) struct Surface {
    pub(super) mesh: TriMesh,
    pub(super) topology: Topology,
    /// How many faces are real; the others are virtual.
    pub(super) real: usize,
    pub(super) costs: EdgeCosts,
    pub(super) diagonal: f64,
    pub(super) seams: Seams,
    ways: SeamWays,
    /// The holes that are closed.
    holes: Vec<BoundaryLoop>,
}

/// Seams, and the ways to them.
pub(super) struct Growth {
    seams: Seams,
    ways: SeamWays,
}

impl Surface {
    /// Closes the holes of a piece, if that is asked for, and opens the rest. `costs` are asked for the closed surface, of
    /// which so many faces are real.
    pub(super) fn new(
        piece: &Chart,
        filling: Option<HoleFilling>,
        costs: &dyn Fn(&TriMesh, &Topology, usize) -> EdgeCosts,
    ) -> Result<Self, FlattenError> {
        let mut holes = filling.map_or_else(Vec::new, |_| piece.topology.boundary_loops());
        if let Some(outer) = outer_loop(&piece.mesh, &holes) {
            holes.remove(outer);
        }
        let Filled { mesh, topology, first_virtual: real, .. } =
            fill(&piece.mesh, &piece.topology, &holes, filling.unwrap_or_default())?;
        let costs = costs(&mesh, &topology, real);
        let seams = open(&topology, &costs);
        let ways = SeamWays::new(&topology, &costs, &seams);
        let diagonal = mesh.diagonal();
        Ok(Self { mesh, topology, real, costs, diagonal, seams, ways, holes })
    }

    /// The cost of the cheapest way from a vertex to the seam or the boundary; infinite where there is none.
    pub(super) fn way(&self, vertex: VertexId) -> f64 {
        self.ways.distance(vertex)
    }

    /// Joins vertices to the seam; how many edges that took.
    pub(super) fn extend(&mut self, terminals: &[VertexId]) -> usize {
        let Self { topology, costs, seams, ways, .. } = self;
        ways.extend(topology, costs, seams, terminals)
    }

    /// How far the seams have grown, to come [`back_to`](Self::back_to) as long as no cap was taken away.
    pub(super) fn growth(&self) -> Growth {
        Growth { seams: self.seams.clone(), ways: self.ways.clone() }
    }

    pub(super) fn back_to(&mut self, Growth { seams, ways }: Growth) {
        (self.seams, self.ways) = (seams, ways);
    }

    pub(super) fn holes_filled(&self) -> usize {
        self.holes.len()
    }

    /// Takes away the caps of holes whose rims a seam has reached, as long as what is left is one disk.
    pub(super) fn release_caps(
        &mut self,
        piece: &Chart,
        filling: HoleFilling,
        costs: &dyn Fn(&TriMesh, &Topology, usize) -> EdgeCosts,
    ) -> Result<(), FlattenError> {
        let mut is_cut = vec![false; self.topology.vertex_count()];
        for c in self.seams.edges(&self.topology).filter(|&c| self.is_real_edge(c)) {
            [c.next(), c.prev()].iter().for_each(|e| is_cut[self.topology.vertex(*e).index()] = true);
        }
        let is_reached = |hole: &BoundaryLoop| hole.vertices.iter().any(|v| is_cut[v.index()]);
        let (reached, holes): (Vec<_>, Vec<_>) = self.holes.iter().cloned().partition(is_reached);
        if reached.is_empty() {
            return Ok(());
        }
        let Filled { mesh, topology, first_virtual: real, .. } = fill(&piece.mesh, &piece.topology, &holes, filling)?;
        let mut seams = Seams::none(&topology);
        for c in self.seams.edges(&self.topology) {
            let sides = [Some(c), self.topology.opposite(c)];
            // Real faces have the same numbers in both.
            sides.into_iter().flatten().filter(|c| c.face().index() < real).for_each(|c| seams.insert(&topology, c));
        }
        let is_one_disk = split(&mesh, &topology, &seams)
            .is_ok_and(|charts| charts.len() == 1 && charts[0].topology.require_disk().is_ok());
        if is_one_disk {
            let costs = costs(&mesh, &topology, real);
            let ways = SeamWays::new(&topology, &costs, &seams);
            *self = Self { mesh, topology, real, costs, seams, ways, holes, diagonal: self.diagonal };
        }
        Ok(())
    }

    /// The surface cut along its seams, which is one disk.
    pub(super) fn chart(&self) -> Result<Chart, FlattenError> {
        let mut charts = split(&self.mesh, &self.topology, &self.seams)?;
        let chart = charts.swap_remove(0);
        chart.topology.require_disk()?;
        Ok(chart)
    }

    /// The length of the seams between real faces.
    pub(super) fn seam_length(&self) -> f64 {
        let at = |v: VertexId| self.mesh.positions()[v.index()];
        let cut = self.seams.edges(&self.topology).filter(|&c| self.is_real_edge(c));
        cut.map(|c| (at(self.topology.vertex(c.next())) - at(self.topology.vertex(c.prev()))).norm()).sum()
    }

    /// Whether the faces on both sides of an edge are real.
    fn is_real_edge(&self, c: CornerId) -> bool {
        let is_real = |c: CornerId| c.face().index() < self.real;
        is_real(c) && self.topology.opposite(c).is_some_and(is_real)
    }
}
