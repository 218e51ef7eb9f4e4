//! Poisson layout: coordinates whose differences come as close as possible to given edge vectors.
//!
//! Minimises `Σ cot x_c |z[prev] − z[next] − e_c|²` over all corners, `e_c` being the integrated
//! vector of the edge facing corner `c`: the Dirichlet energy of the difference on the flat
//! triangles, so the matrix is the cotangent Laplacian of the solved angles, positive definite once
//! one vertex is fixed.

use crate::numbering::Numbering;
use crate::tree::EdgeVectors;
use crate::{LinearError, LinearStats, PinnedPair};
use abf_control::{Checkpoint, at_block};
use abf_linalg::{Complex64, Refinement, SymbolicCholesky, SymmetricMatrix};
use abf_mesh::Topology;

/// One coordinate per vertex, the first pin at 0.
pub(crate) fn place(
    topology: &Topology,
    angles: &[f64],
    edges: &EdgeVectors,
    pins: PinnedPair,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<(Vec<Complex64>, LinearStats), LinearError> {
    let numbering = Numbering::new(topology, &[pins.origin], checkpoint)?;
    checkpoint()?;
    let mut matrix = SymmetricMatrix::<f64>::zeros(numbering.pattern.clone());
    let (mut x, mut y) = (vec![0.0; matrix.size()], vec![0.0; matrix.size()]);
    for c in topology.corners() {
        at_block(c.index(), checkpoint)?;
        let weight = angles[c.index()].tan().recip();
        let edge = edges.vector(c) * weight;
        let (from, to) = (numbering.unknown(topology.vertex(c.next())), numbering.unknown(topology.vertex(c.prev())));
        for (end, sign) in [(from, -1.0), (to, 1.0)] {
            if let Some(u) = end {
                matrix.add(u, u, weight);
                x[u] += sign * edge.re;
                y[u] += sign * edge.im;
            }
        }
        if let (Some(a), Some(b)) = (from, to) {
            matrix.add(a.max(b), a.min(b), -weight);
        }
    }
    checkpoint()?;
    let symbolic = SymbolicCholesky::analyse(numbering.pattern.clone())?;
    checkpoint()?;
    let factors = symbolic.factorise(&matrix)?;
    checkpoint()?;
    let in_x = factors.solve(&matrix, &mut x, Refinement::default())?;
    checkpoint()?;
    let in_y = factors.solve(&matrix, &mut y, Refinement::default())?;
    let z = topology
        .vertices()
        .map(|v| numbering.unknown(v).map_or(Complex64::default(), |u| Complex64::new(x[u], y[u])))
        .collect();
    let stats = LinearStats {
        iterations: in_x.iterations + in_y.iterations,
        relative_residual: in_x.relative_residual.max(in_y.relative_residual),
    };
    Ok((z, stats))
}
