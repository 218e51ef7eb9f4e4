//! The reduced system `S μ_R = r`: vertex and wheel multipliers only.

use crate::{KktSystem, KktVector, LinearError};
use abf_constraints::{BoundaryConditions, ConstraintRows, TriangleReduction, TriangleRows};
use abf_control::{Cancelled, Checkpoint, at_block};
use abf_linalg::{Graph, Permutation, SymmetricMatrix, SymmetricPattern};
use abf_mesh::{CornerId, FaceId, Topology, VertexId};
use std::sync::Arc;

/// Marks an edge of a triangle with an end that has no row: it has no block in `S`.
const NO_BLOCK: u32 = u32::MAX;

/// The rows of boundary vertices in a step: `B δ − C μ_B = −r`, with `B` the sums at the vertices. An upper bound with a
/// slack is such a row, and one that is not active has no multiplier.
#[derive(Clone, Copy, Debug)]
pub struct BoundaryTerms<'a> {
    /// Which vertices.
    pub conditions: &'a BoundaryConditions,
    /// Which rows there are at all, one per condition.
    pub active: &'a [bool],
    /// `r = Σ x − b` (with a slack `+ s` and what else its elimination leaves), rad.
    pub residual: &'a [f64],
    /// The diagonal of `C`, at least 0; empty for zero.
    pub compliance: &'a [f64],
}

impl BoundaryTerms<'_> {
    fn active_row(&self, vertex: VertexId) -> Option<usize> {
        self.conditions.place(vertex).filter(|&j| self.active[j])
    }
}

/// The pattern of `S` and the place of every triangle in it, made once per topology.
///
/// `S` has a 2 × 2 block (vertex, wheel) for every interior vertex and every edge between two of
/// them. The vertices are ordered to keep the fill low, each then takes two unknowns in a row. Boundary vertices that
/// have conditions come after the interior ones, by number; they have no wheel, and a one in its place.
#[derive(Debug)]
pub struct ReducedSystem {
    graph: Graph,
    order: Permutation,
    pattern: Arc<SymmetricPattern>,
    /// For each triangle and `k`, where the block between corners `k` and `k + 1` begins.
    edge_slot: Vec<[u32; 3]>,
}

impl ReducedSystem {
    /// Orders the interior vertices and lays out `S`.
    ///
    /// # Errors
    /// [`LinearError`] when the ordering does not fit in memory or in 32-bit indices.
    pub fn new(topology: &Topology, rows: &ConstraintRows) -> Result<Self, LinearError> {
        Self::asking(topology, rows, &mut || Ok(()))
    }

    /// [`ReducedSystem::new`] that asks between its parts whether to go on.
    ///
    /// # Errors
    /// As `new`, and [`LinearError::Cancelled`].
    pub fn asking(
        topology: &Topology,
        rows: &ConstraintRows,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        Self::with_boundary(topology, rows, None, checkpoint)
    }

    /// The system with a row for every boundary vertex that has a condition.
    ///
    /// # Errors
    /// As `new`, and [`LinearError::Cancelled`].
    pub fn with_boundary(
        topology: &Topology,
        rows: &ConstraintRows,
        boundary: Option<&BoundaryConditions>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let number = |v: VertexId| {
            let on_boundary = || boundary.and_then(|b| b.place(v)).map(|j| rows.interior_count() + j);
            rows.interior_index(v).or_else(on_boundary)
        };
        let count = rows.interior_count() + boundary.map_or(0, BoundaryConditions::len);
        let graph = Graph::from_edges(count, edges(topology, number));
        checkpoint()?;
        let order = graph.amd()?;
        checkpoint()?;
        let pattern = Arc::new(SymmetricPattern::of_blocks(&graph, &order, 2));
        let interior = |c: CornerId| number(topology.vertex(c));
        let mut edge_slot = Vec::with_capacity(topology.face_count());
        for f in topology.faces() {
            at_block(f.index(), checkpoint)?;
            edge_slot.push([0, 1, 2].map(|k| match (interior(f.corner(k)), interior(f.corner((k + 1) % 3))) {
                (Some(a), Some(b)) => {
                    let (a, b) = (order.new_index(a), order.new_index(b));
                    pattern.slot(2 * a.max(b), 2 * a.min(b)) as u32
                }
                _ => NO_BLOCK,
            }));
        }
        Ok(Self { graph, order, pattern, edge_slot })
    }

    /// Where `S` has entries.
    #[must_use]
    pub fn pattern(&self) -> &Arc<SymmetricPattern> {
        &self.pattern
    }

    /// The pattern with one unknown per interior vertex, in the same order: that of the V–V and of
    /// the W–W block of `S`. Entry for entry it is every second one of [`ReducedSystem::pattern`]
    /// within a column, the vertex unknown's column for V–V and the wheel unknown's for W–W.
    #[must_use]
    pub fn vertex_pattern(&self) -> SymmetricPattern {
        SymmetricPattern::of_blocks(&self.graph, &self.order, 1)
    }

    /// For each unknown of `S` the constraint whose multiplier it is, as a row of [`ConstraintRows`].
    #[must_use]
    pub fn constraint_of_unknown(&self, rows: &ConstraintRows) -> Vec<u32> {
        let vertices = (0..rows.interior_count()).map(|new| self.order.old_index(new));
        vertices.flat_map(|i| [rows.vertex(i) as u32, rows.wheel(i) as u32]).collect()
    }

    /// The unknown of the vertex multiplier of the `interior`-th interior vertex; that of its wheel
    /// multiplier is the next one.
    #[inline]
    #[must_use]
    pub fn unknown(&self, interior: usize) -> usize {
        2 * self.order.new_index(interior)
    }

    /// `S = Σ R P Rᵀ`, triangle by triangle, into `matrix`; and `r = h_R − Σ R (P g + s h_t)` into `rhs`.
    ///
    /// # Panics
    /// If `matrix` has another pattern or `rhs` another length.
    pub fn assemble(&self, kkt: &KktSystem<'_>, matrix: &mut SymmetricMatrix<f64>, rhs: &mut [f64]) {
        let assembled = self.assemble_asking(kkt, matrix, rhs, &mut || Ok(()));
        assembled.expect("nobody ends it");
    }

    /// [`ReducedSystem::assemble`] that asks between its blocks whether to go on.
    ///
    /// # Errors
    /// [`Cancelled`].
    ///
    /// # Panics
    /// As `assemble`.
    pub fn assemble_asking(
        &self,
        kkt: &KktSystem<'_>,
        matrix: &mut SymmetricMatrix<f64>,
        rhs: &mut [f64],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), Cancelled> {
        self.assemble_bounded(kkt, None, matrix, rhs, checkpoint)
    }

    /// [`ReducedSystem::assemble_asking`] with rows of boundary vertices: those this system was made with.
    ///
    /// # Errors
    /// [`Cancelled`].
    ///
    /// # Panics
    /// As `assemble`.
    pub fn assemble_bounded(
        &self,
        kkt: &KktSystem<'_>,
        boundary: Option<&BoundaryTerms<'_>>,
        matrix: &mut SymmetricMatrix<f64>,
        rhs: &mut [f64],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), Cancelled> {
        assert!(Arc::ptr_eq(matrix.pattern(), &self.pattern), "a matrix of this system");
        matrix.values.fill(0.0);
        for i in 0..kkt.rows.interior_count() {
            let u = self.unknown(i);
            rhs[u] = kkt.residual[kkt.rows.vertex(i)];
            rhs[u + 1] = kkt.residual[kkt.rows.wheel(i)];
        }
        if let Some(terms) = boundary {
            self.begin_boundary(kkt, terms, matrix, rhs);
        }
        for face in kkt.topology.faces() {
            at_block(face.index(), checkpoint)?;
            let local = LocalSystem::new(kkt, boundary, face);
            let block = local.rows.schur_block(&local.reduction);
            self.scatter(&local.rows, face, &block, &mut matrix.values);
            self.scatter_rhs(&local, kkt, rhs);
        }
        Ok(())
    }

    /// What the rows of boundary vertices have besides their triangles. One that is not active has no multiplier.
    fn begin_boundary(
        &self,
        kkt: &KktSystem<'_>,
        terms: &BoundaryTerms<'_>,
        matrix: &mut SymmetricMatrix<f64>,
        rhs: &mut [f64],
    ) {
        for (j, &active) in terms.active.iter().enumerate() {
            let u = self.unknown(kkt.rows.interior_count() + j);
            let own = if active { terms.compliance.get(j).copied().unwrap_or(0.0) } else { 1.0 };
            matrix.values[self.pattern.column(u).start] = own;
            matrix.values[self.pattern.column(u + 1).start] = 1.0;
            rhs[u] = if active { terms.residual[j] } else { 0.0 };
            rhs[u + 1] = 0.0;
        }
    }

    /// Everything else of the step from the solution of the reduced system: `δ` and all multipliers.
    pub fn back_substitute(&self, kkt: &KktSystem<'_>, solution: &[f64], out: &mut KktVector) {
        self.back_substitute_bounded(kkt, None, solution, out);
    }

    /// [`ReducedSystem::back_substitute`] with rows of boundary vertices. Their multipliers: [`ReducedSystem::of_boundary`].
    pub fn back_substitute_bounded(
        &self,
        kkt: &KktSystem<'_>,
        boundary: Option<&BoundaryTerms<'_>>,
        solution: &[f64],
        out: &mut KktVector,
    ) {
        out.delta.resize(kkt.lambda.len(), 0.0);
        out.multipliers.resize(kkt.rows.len(), 0.0);
        for i in 0..kkt.rows.interior_count() {
            let u = self.unknown(i);
            out.multipliers[kkt.rows.vertex(i)] = solution[u];
            out.multipliers[kkt.rows.wheel(i)] = solution[u + 1];
        }
        for face in kkt.topology.faces() {
            let local = LocalSystem::new(kkt, boundary, face);
            let of = |part: usize| local.rows.interior.map(|i| i.map_or(0.0, |i| solution[self.unknown(i) + part]));
            let back = local.rows.apply_transposed(of(0), of(1));
            let q = [0, 1, 2].map(|k| local.gradient[k] + back[k]);
            for (c, x) in face.corners().into_iter().zip(local.reduction.opposite_change(q, local.residual)) {
                out.delta[c.index()] = -x;
            }
            out.multipliers[kkt.rows.triangle(face)] = local.reduction.multiplier(local.residual, q);
        }
    }

    /// The multipliers of the rows of `boundary` in a solution of the reduced system.
    #[must_use]
    pub fn of_boundary(&self, rows: &ConstraintRows, boundary: &BoundaryConditions, solution: &[f64]) -> Vec<f64> {
        (0..boundary.len()).map(|j| solution[self.unknown(rows.interior_count() + j)]).collect()
    }

    /// Adds one triangle's 6 × 6 block to the lower triangle of `S`.
    fn scatter(&self, rows: &TriangleRows, face: FaceId, block: &[[f64; 6]; 6], values: &mut [f64]) {
        for k in 0..3 {
            let Some(a) = rows.interior[k].map(|i| self.unknown(i)) else { continue };
            let diagonal = self.pattern.column(a).start;
            let wheel_diagonal = self.pattern.column(a + 1).start;
            values[diagonal] += block[k][k];
            values[diagonal + 1] += block[3 + k][k];
            values[wheel_diagonal] += block[3 + k][3 + k];

            let next = (k + 1) % 3;
            let Some(b) = rows.interior[next].map(|i| self.unknown(i)) else { continue };
            let (lower, upper) = if a > b { (k, next) } else { (next, k) };
            let slot = self.edge_slot[face.index()][k] as usize;
            // The next column holds the same later rows, but one entry less above them.
            let wheel_slot = slot + self.pattern.column(a.min(b)).len() - 1;
            values[slot] += block[lower][upper];
            values[slot + 1] += block[3 + lower][upper];
            values[wheel_slot] += block[lower][3 + upper];
            values[wheel_slot + 1] += block[3 + lower][3 + upper];
        }
    }

    fn scatter_rhs(&self, local: &LocalSystem, kkt: &KktSystem<'_>, rhs: &mut [f64]) {
        debug_assert!(rhs.len() >= 2 * kkt.rows.interior_count());
        let (vertex, wheel) = local.rows.apply(local.reduction.opposite_change(local.gradient, local.residual));
        for (k, i) in local.rows.interior.into_iter().enumerate() {
            if let Some(u) = i.map(|i| self.unknown(i)) {
                rhs[u] -= vertex[k];
                rhs[u + 1] -= wheel[k];
            }
        }
    }
}

/// What one triangle contributes.
struct LocalSystem {
    reduction: TriangleReduction,
    rows: TriangleRows,
    gradient: [f64; 3],
    residual: f64,
}

impl LocalSystem {
    #[inline]
    fn new(kkt: &KktSystem<'_>, boundary: Option<&BoundaryTerms<'_>>, face: FaceId) -> Self {
        let at = |values: &[f64]| face.corners().map(|c| values[c.index()]);
        let mut rows = TriangleRows::new(kkt.topology, kkt.rows, kkt.wheel, face);
        if let Some(terms) = boundary {
            for (place, c) in rows.interior.iter_mut().zip(face.corners()) {
                let row = || terms.active_row(kkt.topology.vertex(c)).map(|j| kkt.rows.interior_count() + j);
                *place = place.or_else(row);
            }
        }
        Self {
            reduction: TriangleReduction::new(at(kkt.lambda)),
            rows,
            gradient: at(kkt.gradient),
            residual: kkt.residual[kkt.rows.triangle(face)],
        }
    }
}

/// Every edge between two vertices that have a number, once, as their numbers.
fn edges<'a>(
    topology: &'a Topology,
    number: impl Fn(VertexId) -> Option<usize> + Clone + 'a,
) -> impl Iterator<Item = (u32, u32)> + Clone + 'a {
    (0..topology.corner_count()).map(CornerId::new).filter_map(move |c| {
        let once = topology.opposite(c).is_none_or(|o| c < o);
        let ends = [c.next(), c.prev()].map(|end| number(topology.vertex(end)));
        match ends {
            [Some(a), Some(b)] if once => Some((a as u32, b as u32)),
            _ => None,
        }
    })
}
