//! Conformal least squares in complex numbers.
//!
//! A triangle with corners 1, 2, 3 and angles x asks for (ABF++ §; LSCM eq. (2) in other words)
//!
//! ```text
//! z₃ − z₁ = c (z₂ − z₁),        c = (sin x₂ / sin x₃) e^{i x₁},
//! ```
//!
//! the corners rotated so that the largest sine divides. One complex unknown per vertex makes the
//! normal matrix `nv × nv` Hermitian with the one-ring pattern: half the work of `2nv × 2nv` reals.
//! Unweighted is what the papers computed; each squared residual weighted by `1 / Im c` is LSCM
//! proper, its area weights included, and no longer depends on the rotation of the corners.

use crate::numbering::Numbering;
use crate::{LinearError, LinearStats, PinnedPair};
use abf_control::{Checkpoint, at_block};
use abf_linalg::{Complex64, Refinement, SymbolicCholesky, SymmetricMatrix};
use abf_mesh::{CornerId, FaceId, Topology, VertexId};

/// One coordinate per vertex, the pins at 0 and 1.
pub(crate) fn place(
    topology: &Topology,
    angles: &[f64],
    pins: PinnedPair,
    weighted: bool,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<(Vec<Complex64>, LinearStats), LinearError> {
    let numbering = Numbering::new(topology, &[pins.origin, pins.axis], checkpoint)?;
    checkpoint()?;
    let mut matrix = SymmetricMatrix::<Complex64>::zeros(numbering.pattern.clone());
    let mut rhs = vec![Complex64::default(); matrix.size()];
    let axis = Complex64::from(1.0);
    for face in topology.faces() {
        at_block(face.index(), checkpoint)?;
        let (vertices, coefficients, weight) = equation(topology, angles, face, weighted);
        for (&v, &a) in vertices.iter().zip(&coefficients) {
            let Some(row) = numbering.unknown(v) else { continue };
            for (&u, &b) in vertices.iter().zip(&coefficients) {
                let entry = a.conj() * b * weight;
                match numbering.unknown(u) {
                    Some(column) if row >= column => matrix.add(row, column, entry),
                    Some(_) => {}
                    None if u == pins.axis => rhs[row] -= entry * axis,
                    None => {}
                }
            }
        }
    }
    checkpoint()?;
    let symbolic = SymbolicCholesky::analyse(numbering.pattern.clone())?;
    checkpoint()?;
    let factors = symbolic.factorise(&matrix)?;
    checkpoint()?;
    let stats = factors.solve_asking(&matrix, &mut rhs, Refinement::default(), checkpoint)?;
    let mut z: Vec<Complex64> =
        topology.vertices().map(|v| numbering.unknown(v).map_or(Complex64::default(), |u| rhs[u])).collect();
    z[pins.axis.index()] = axis;
    Ok((z, stats))
}

/// The vertices of one triangle, the coefficients of its equation and its weight.
fn equation(topology: &Topology, angles: &[f64], face: FaceId, weighted: bool) -> ([VertexId; 3], [Complex64; 3], f64) {
    let sine = |c: CornerId| angles[c.index()].sin();
    let mut third = face.corner(0);
    for c in face.corners() {
        if sine(c) > sine(third) {
            third = c;
        }
    }
    let (first, second) = (third.next(), third.prev());
    let ratio = Complex64::from_polar(sine(second) / sine(third), angles[first.index()]);
    let vertices = [first, second, third].map(|c| topology.vertex(c));
    let one = Complex64::from(1.0);
    (vertices, [ratio - one, -ratio, one], if weighted { 1.0 / ratio.im } else { 1.0 })
}
