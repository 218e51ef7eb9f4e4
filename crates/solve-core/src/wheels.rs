//! The reduced system spoke by spoke.
//!
//! `S` couples an interior vertex with its ring only, and the corners of the ring are in order: spoke
//! `k` of a wheel is the edge to the `next` vertex of its `k`-th corner. Kept in this order, every
//! entry of `S` has its place without a search, a row is computed from its own ring alone, and a
//! product gathers. So all of it runs in parallel, without atomics, with the same bits for any number
//! of threads.

use abf_constraints::{ConstraintRows, WheelDerivative};
use abf_linalg::{Graph, Permutation, SymmetricMatrix, SymmetricPattern};
use abf_mesh::{CornerId, FaceId, Topology};
use abf_parallel::prelude::*;
use std::sync::Arc;

/// How many rows one task computes.
const PER_TASK: usize = 1 << 10;

/// Which interior vertex is at the other end of every spoke.
#[derive(Debug)]
pub(crate) struct Spokes {
    /// Per spoke, in the order of [`ConstraintRows::hub_range`]; `ni` for a boundary vertex.
    columns: Vec<u32>,
}

impl Spokes {
    pub(crate) fn new(topology: &Topology, rows: &ConstraintRows) -> Self {
        let end = |c: &CornerId| rows.interior_index(topology.vertex(c.next())).unwrap_or(rows.interior_count()) as u32;
        let of_vertex = |i: usize| rows.hubs(i).iter().map(end);
        Self { columns: (0..rows.interior_count()).flat_map(of_vertex).collect() }
    }

    /// The graph of the edges between interior vertices.
    pub(crate) fn graph(&self, rows: &ConstraintRows) -> Graph {
        let ni = rows.interior_count();
        Graph::from_neighbours(ni, |i| {
            self.columns[rows.hub_range(i)].iter().copied().filter(move |&j| (j as usize) < ni)
        })
    }

    /// `out = Σ values · x` over the spokes of each vertex, plus its own. `x` has a zero for the boundary.
    pub(crate) fn multiply(&self, rows: &ConstraintRows, block: &Block, x: &[f64], out: &mut [f64]) {
        self.for_each_row(rows, out, |i, range, out| *out = self.row_product(block, i, range, x));
    }

    #[inline]
    fn row_product(&self, block: &Block, i: usize, range: std::ops::Range<usize>, x: &[f64]) -> f64 {
        let spokes = self.columns[range.clone()].iter().zip(&block.spokes[range]);
        block.own[i] * x[i] + spokes.map(|(&j, value)| value * x[j as usize]).sum::<f64>()
    }

    /// `out = D x − C y`.
    pub(crate) fn multiply_difference(
        &self,
        rows: &ConstraintRows,
        (d, x): (&Block, &[f64]),
        (c, y): (&Block, &[f64]),
        out: &mut [f64],
    ) {
        self.for_each_row(rows, out, |i, range, out| {
            *out = self.row_product(d, i, range.clone(), x) - self.row_product(c, i, range, y);
        });
    }

    /// `out = b − F x − G y`.
    pub(crate) fn residual(
        &self,
        rows: &ConstraintRows,
        b: &[f64],
        (f, x): (&Block, &[f64]),
        (g, y): (&Block, &[f64]),
        out: &mut [f64],
    ) {
        self.for_each_row(rows, out, |i, range, out| {
            *out = b[i] - self.row_product(f, i, range.clone(), x) - self.row_product(g, i, range, y);
        });
    }

    fn for_each_row(
        &self,
        rows: &ConstraintRows,
        out: &mut [f64],
        row: impl Fn(usize, std::ops::Range<usize>, &mut f64) + Sync,
    ) {
        out[..rows.interior_count()].par_chunks_mut(PER_TASK).enumerate().for_each(|(task, out)| {
            for (k, out) in out.iter_mut().enumerate() {
                let i = task * PER_TASK + k;
                row(i, rows.hub_range(i), out);
            }
        });
    }

    /// One symmetric block of `S` as the factorisation takes it.
    pub(crate) fn symmetric(
        &self,
        rows: &ConstraintRows,
        block: &Block,
        pattern: &Arc<SymmetricPattern>,
        order: &Permutation,
    ) -> SymmetricMatrix<f64> {
        let mut matrix = SymmetricMatrix::zeros(Arc::clone(pattern));
        for i in 0..rows.interior_count() {
            let column = order.new_index(i);
            matrix.values[pattern.column(column).start] = block.own[i];
            let range = rows.hub_range(i);
            for (&j, &value) in self.columns[range.clone()].iter().zip(&block.spokes[range]) {
                if (j as usize) < rows.interior_count() && order.new_index(j as usize) > column {
                    let slot = pattern.slot(order.new_index(j as usize), column);
                    matrix.values[slot] += value;
                }
            }
        }
        matrix
    }
}

/// One of the four blocks of `S`: an entry per interior vertex and one per spoke.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    own: Vec<f64>,
    spokes: Vec<f64>,
}

impl Block {
    pub(crate) fn zeros(rows: &ConstraintRows) -> Self {
        Self { own: vec![0.0; rows.interior_count()], spokes: vec![0.0; rows.hub_count()] }
    }

    /// The rows, a task of them at a time.
    fn tasks<'a>(&'a mut self, rows: &ConstraintRows) -> impl Iterator<Item = Rows<'a>> {
        let mut rest = self.spokes.as_mut_slice();
        self.own.chunks_mut(PER_TASK).enumerate().map(move |(task, own)| {
            let first = task * PER_TASK;
            let count = rows.hub_range(first + own.len() - 1).end - rows.hub_range(first).start;
            let (spokes, after) = std::mem::take(&mut rest).split_at_mut(count);
            rest = after;
            Rows { own, spokes }
        })
    }
}

/// Some rows of a block.
struct Rows<'a> {
    own: &'a mut [f64],
    spokes: &'a mut [f64],
}

/// Sums what every corner of a wheel contributes to the row of its hub: to the hub's own entry, to the
/// spoke of `next` and to that of `prev`, which is the next corner's `next`.
fn accumulate<const N: usize>(
    rows: &ConstraintRows,
    blocks: [&mut Block; N],
    contribution: impl Fn(CornerId) -> [[f64; 3]; N] + Sync,
) {
    let mut tasks = blocks.map(|block| block.tasks(rows));
    let task_count = rows.interior_count().div_ceil(PER_TASK);
    let tasks: Vec<[Rows<'_>; N]> = (0..task_count)
        .map(|_| tasks.each_mut().map(|rows| rows.next().expect("as many tasks in every block")))
        .collect();
    tasks.into_par_iter().enumerate().for_each(|(task, mut blocks)| {
        let first = task * PER_TASK;
        let offset = rows.hub_range(first).start;
        for k in 0..blocks[0].own.len() {
            let (hubs, range) = (rows.hubs(first + k), rows.hub_range(first + k));
            let (begin, end) = (range.start - offset, range.end - offset);
            for block in &mut blocks {
                block.own[k] = 0.0;
                block.spokes[begin..end].fill(0.0);
            }
            for (spoke, &hub) in (begin..end).zip(hubs) {
                let after = if spoke + 1 == end { begin } else { spoke + 1 };
                for (block, [own, next, prev]) in blocks.iter_mut().zip(contribution(hub)) {
                    block.own[k] += own;
                    block.spokes[spoke] += next;
                    block.spokes[after] += prev;
                }
            }
        }
    });
}

/// `P = Λ⁻¹ − Λ⁻¹ 1 1ᵀ Λ⁻¹ / 1ᵀ Λ⁻¹ 1` of the triangle of a corner, rows and columns in the order hub,
/// next, prev.
struct Projection {
    inverse: [f64; 3],
    sum: f64,
}

impl Projection {
    #[inline]
    fn new(inverse: &[f64], hub: CornerId) -> Self {
        let inverse = [hub, hub.next(), hub.prev()].map(|c| inverse[c.index()]);
        Self { inverse, sum: inverse[0] + inverse[1] + inverse[2] }
    }

    /// The hub's row of `P`.
    #[inline]
    fn row(&self) -> [f64; 3] {
        let share = self.inverse[0] / self.sum;
        [self.inverse[0] - share * self.inverse[0], -share * self.inverse[1], -share * self.inverse[2]]
    }

    /// `P r`, `r` being the wheel row of the hub.
    #[inline]
    fn wheel(&self, [_, next, prev]: [f64; 3]) -> [f64; 3] {
        let mean = (self.inverse[1] * next - self.inverse[2] * prev) / self.sum;
        [-self.inverse[0] * mean, self.inverse[1] * (next - mean), -self.inverse[2] * (prev + mean)]
    }
}

/// The V–V block, which depends on the metric alone: `inverse` is `Λ⁻¹`.
pub(crate) fn vertex_block(rows: &ConstraintRows, inverse: &[f64], vertex: &mut Block) {
    accumulate(rows, [vertex], |hub| [Projection::new(inverse, hub).row()]);
}

/// The blocks that change with the angles: V–W, W–V (its transpose, by rows) and W–W.
pub(crate) fn wheel_blocks(rows: &ConstraintRows, inverse: &[f64], wheel: &WheelDerivative, blocks: [&mut Block; 3]) {
    let cotangents = wheel.cotangents();
    accumulate(rows, blocks, |hub| {
        let cot = [hub, hub.next(), hub.prev()].map(|c| cotangents[c.index()]);
        // The wheel rows of the three vertices are (0, cot₁, −cot₂), (−cot₀, 0, cot₂), (cot₀, −cot₁, 0).
        let dot_next = |q: [f64; 3]| cot[2] * q[2] - cot[0] * q[0];
        let dot_prev = |q: [f64; 3]| cot[0] * q[0] - cot[1] * q[1];
        let projection = Projection::new(inverse, hub);
        let (p, u) = (projection.row(), projection.wheel(cot));
        [[u[0], dot_next(p), dot_prev(p)], u, [cot[1] * u[1] - cot[2] * u[2], dot_next(u), dot_prev(u)]]
    });
}

/// What every triangle is asked for beyond the multipliers: `g`, where there is one, and `h_t`.
#[derive(Clone, Copy)]
pub(crate) struct Given<'a> {
    /// Λ⁻¹, length 3 nt.
    pub inverse: &'a [f64],
    /// g, length 3 nt; empty for zero.
    pub gradient: &'a [f64],
    /// h, length nt + 2 ni.
    pub residual: &'a [f64],
    /// The wheel part of `J`.
    pub wheel: &'a WheelDerivative,
}

impl Given<'_> {
    #[inline]
    fn gradient(&self, c: CornerId) -> f64 {
        if self.gradient.is_empty() { 0.0 } else { self.gradient[c.index()] }
    }
}

/// The right-hand side `h − Σ R (P g + s h_t)`, vertex and wheel part; `s = Λ⁻¹ 1 / 1ᵀ Λ⁻¹ 1`.
pub(crate) fn right_hand_side(rows: &ConstraintRows, given: &Given<'_>, [vertices, wheels]: [&mut [f64]; 2]) {
    let cotangents = given.wheel.cotangents();
    let parts = vertices.par_chunks_mut(PER_TASK).zip(wheels.par_chunks_mut(PER_TASK)).enumerate();
    parts.for_each(|(task, (vertices, wheels))| {
        for (k, (vertex, wheel)) in vertices.iter_mut().zip(wheels).enumerate() {
            let i = task * PER_TASK + k;
            (*vertex, *wheel) = (given.residual[rows.vertex(i)], given.residual[rows.wheel(i)]);
            for &hub in rows.hubs(i) {
                let corners = [hub, hub.next(), hub.prev()];
                let Projection { inverse: d, sum } = Projection::new(given.inverse, hub);
                let g = corners.map(|c| given.gradient(c));
                let h = given.residual[rows.triangle(hub.face())];
                // P g + s h = Λ⁻¹ (g + (h − 1ᵀ Λ⁻¹ g) / 1ᵀ Λ⁻¹ 1).
                let shift = (h - d[0] * g[0] - d[1] * g[1] - d[2] * g[2]) / sum;
                let (next, prev) = (cotangents[corners[1].index()], cotangents[corners[2].index()]);
                *vertex -= d[0] * (g[0] + shift);
                *wheel -= next * d[1] * (g[1] + shift) - prev * d[2] * (g[2] + shift);
            }
        }
    });
}

/// `δ = −P (g + Rᵀ μ) − s h_t` and the multipliers of the triangles; those of vertices and wheels padded
/// with a zero for the boundary.
pub(crate) fn back_substitute(
    topology: &Topology,
    rows: &ConstraintRows,
    given: &Given<'_>,
    [vertices, wheels]: [&[f64]; 2],
    change: &mut [f64],
    triangles: &mut [f64],
) {
    let cotangents = given.wheel.cotangents();
    let tasks = change.par_chunks_mut(3 * PER_TASK).zip(triangles.par_chunks_mut(PER_TASK)).enumerate();
    tasks.for_each(|(task, (change, triangles))| {
        for (k, (change, triangle)) in change.chunks_exact_mut(3).zip(triangles).enumerate() {
            let face = FaceId::new(task * PER_TASK + k);
            let corners = face.corners();
            let at = corners.map(|c| rows.interior_index(topology.vertex(c)).unwrap_or(rows.interior_count()));
            let d = corners.map(|c| given.inverse[c.index()]);
            let (v, w) = (at.map(|i| vertices[i]), at.map(|i| wheels[i]));
            // A corner is `next` for the corner before it and `prev` for the one after it.
            let q = [0, 1, 2].map(|k| {
                let cotangent = cotangents[corners[k].index()];
                given.gradient(corners[k]) + v[k] + cotangent * (w[(k + 2) % 3] - w[(k + 1) % 3])
            });
            let sum = d[0] + d[1] + d[2];
            *triangle = (given.residual[rows.triangle(face)] - d[0] * q[0] - d[1] * q[1] - d[2] * q[2]) / sum;
            for k in 0..3 {
                change[k] = -d[k] * (q[k] + *triangle);
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{Planted, apart, wave};
    use crate::{KktSystem, ReducedSystem};
    use abf_linalg::LinOp;

    /// The four blocks, by spokes, against the assembled matrix: the same product, whatever the order of
    /// the unknowns.
    #[test]
    fn the_blocks_are_those_of_the_assembled_system() {
        let planted = Planted::new(300);
        let kkt = planted.kkt();
        let kkt = KktSystem { lambda: kkt.gauss_newton, ..kkt };
        let rows = kkt.rows;
        let ni = rows.interior_count();
        let inverse: Vec<f64> = kkt.lambda.iter().map(|l| 1.0 / l).collect();
        let spokes = Spokes::new(kkt.topology, rows);
        let mut blocks = [(); 4].map(|()| Block::zeros(rows));
        let [a, b, c, d] = &mut blocks;
        vertex_block(rows, &inverse, a);
        wheel_blocks(rows, &inverse, kkt.wheel, [b, c, d]);
        let (mut v, mut w) = (wave(ni + 1), wave(2 * ni)[ni - 1..].to_vec());
        (v[ni], w[ni]) = (0.0, 0.0);
        let mut given = [vec![0.0; ni], vec![0.0; ni]];
        let right = Given { inverse: &inverse, gradient: kkt.gradient, residual: kkt.residual, wheel: kkt.wheel };
        right_hand_side(rows, &right, given.each_mut().map(|x| &mut x[..]));
        let [a, b, c, d] = &blocks;
        let (mut top, mut bottom) = (vec![0.0; ni], vec![0.0; ni]);
        spokes.residual(rows, &given[0], (a, &v), (b, &w), &mut top);
        spokes.residual(rows, &given[1], (c, &v), (d, &w), &mut bottom);

        let system = ReducedSystem::new(kkt.topology, rows).expect("fits");
        let mut matrix = SymmetricMatrix::zeros(Arc::clone(system.pattern()));
        let mut rhs = vec![0.0; matrix.size()];
        system.assemble(&kkt, &mut matrix, &mut rhs);
        let mut x = vec![0.0; rhs.len()];
        for i in 0..ni {
            (x[system.unknown(i)], x[system.unknown(i) + 1]) = (v[i], w[i]);
        }
        let mut product = vec![0.0; rhs.len()];
        matrix.apply(&x, &mut product);
        let left = |part: usize| -> Vec<f64> {
            (0..ni).map(|i| system.unknown(i) + part).map(|u| rhs[u] - product[u]).collect()
        };
        assert!(apart(&top, &left(0)) < 1e-11 && apart(&bottom, &left(1)) < 1e-11);
    }
}
