//! Preconditioners of `M` and of `S`, and when to build them anew.
//!
//! All of them are built with `Λ = 2w`: MINRES and conjugate directions need a positive definite
//! preconditioner even where the exact `Λ` is not.
//!
//! In `S` the vertex and the wheel multipliers are coupled weakly. Its V–V and W–W blocks each have
//! the pattern of a Laplacian on the interior vertices, so one ordering and one symbolic analysis
//! serve both, and factorising the two costs about a quarter of factorising `S`.
//!
//! `M` holds the triangle rows too, `T = J_t Λ⁻¹ J_tᵀ` and `K = J_R Λ⁻¹ J_tᵀ`, and these are coupled
//! strongly: a preconditioner that ignores `K`, `diag(T, S_vv, S_ww)`, takes two to ten times more
//! iterations than none. But `T` is diagonal, so `K` is eliminated exactly, and back again:
//!
//! ```text
//! M = [ I       0 ] [ T  0 ] [ I  T⁻¹Kᵀ ]        C = the same with diag(|T|, S_vv, S_ww) in the middle.
//!     [ K T⁻¹   I ] [ 0  S ] [ 0  I     ]
//! ```
//!
//! `C⁻¹M` has `nt` eigenvalues ±1 and beyond these the ones that `S` has with its own blocks. Here `T`
//! and `K` are those of the very `Λ` that is solved with, in every step: the absolute value keeps
//! `C` positive definite, and only the factors can be frozen.

use crate::schur::schur_diagonal;
use crate::{ConstraintProducts, KktSystem, LinearError, PreconditionerKind, ReducedSystem};
use abf_constraints::{ConstraintRows, TriangleReduction};
use abf_control::{Cancelled, Checkpoint};
use abf_linalg::{Cholesky, Identity, Jacobi, Preconditioner, SymbolicCholesky, SymmetricMatrix};
use abf_mesh::Topology;
use std::sync::Arc;

/// Factors that a solve needed more iterations than this with are outdated. Fresh ones need 11 to 46
/// to a relative residual of 1e-10 at any size, so frozen ones that stay below this are as good, and
/// above it a few saved iterations pay for a factorisation.
const REFACTOR_AFTER: usize = 60;

/// Blocks with fewer unknowns than this are solved one after the other.
const PARALLEL_LEN: usize = 1 << 12;

/// The preconditioner of one solver, kept across outer steps.
pub struct Preconditioning {
    recipe: Recipe,
    is_outdated: bool,
    factorisations: usize,
}

/// How to build it, and what was built.
enum Recipe {
    Identity(Identity),
    DiagonalOfM(Option<Jacobi>),
    DiagonalOfS(Arc<ReducedSystem>, Option<Jacobi>),
    Block(Box<BlockPreconditioner>),
}

impl Preconditioning {
    /// Analyses what the kind needs of a topology. `reduced` is the system whose `S` is to be solved,
    /// and its order of the unknowns holds; without it the preconditioner is one of `M`.
    ///
    /// # Errors
    /// [`LinearError`] when an ordering or analysis does not fit in memory or in 32-bit indices.
    pub fn new(
        kind: PreconditionerKind,
        topology: &Topology,
        rows: &ConstraintRows,
        reduced: Option<&Arc<ReducedSystem>>,
    ) -> Result<Self, LinearError> {
        Self::asking(kind, topology, rows, reduced, &mut || Ok(()))
    }

    /// [`Preconditioning::new`] that asks between its parts whether to go on.
    ///
    /// # Errors
    /// As `new`, and [`LinearError::Cancelled`].
    pub fn asking(
        kind: PreconditionerKind,
        topology: &Topology,
        rows: &ConstraintRows,
        reduced: Option<&Arc<ReducedSystem>>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let recipe = match (kind, reduced) {
            (PreconditionerKind::None, _) => Recipe::Identity(Identity),
            (PreconditionerKind::Jacobi, None) => Recipe::DiagonalOfM(None),
            (PreconditionerKind::Jacobi, Some(system)) => Recipe::DiagonalOfS(Arc::clone(system), None),
            (PreconditionerKind::Block, _) => {
                Recipe::Block(Box::new(BlockPreconditioner::new(topology, rows, reduced, checkpoint)?))
            }
        };
        Ok(Self { recipe, is_outdated: true, factorisations: 0 })
    }

    /// The preconditioner for a system: a diagonal is always fresh, factors are frozen until
    /// [`Preconditioning::used`] finds them outdated.
    ///
    /// # Errors
    /// [`LinearError`] when a block cannot be factorised, or the checkpoint ends it.
    pub fn prepare(
        &mut self,
        kkt: &KktSystem<'_>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<&dyn Preconditioner, LinearError> {
        let with_2w = KktSystem { lambda: kkt.gauss_newton, off_diagonal: None, ..*kkt };
        Ok(match &mut self.recipe {
            Recipe::Identity(identity) => identity,
            Recipe::DiagonalOfM(built) => built.insert(Jacobi::new(&schur_diagonal(&with_2w))?),
            Recipe::DiagonalOfS(system, built) => {
                built.insert(Jacobi::new(&diagonal(&assemble(system, &with_2w, checkpoint)?))?)
            }
            Recipe::Block(block) => {
                if self.is_outdated {
                    block.factorise(&with_2w, checkpoint)?;
                    self.is_outdated = false;
                    self.factorisations += 1;
                }
                if let Some(elimination) = &mut block.elimination {
                    checkpoint()?;
                    elimination.update(kkt);
                }
                &**block
            }
        })
    }

    /// Says how many iterations a solve with it took.
    pub fn used(&mut self, iterations: usize) {
        self.is_outdated = iterations > REFACTOR_AFTER;
    }

    /// How often blocks were factorised.
    #[must_use]
    pub fn factorisations(&self) -> usize {
        self.factorisations
    }
}

fn assemble(
    system: &ReducedSystem,
    kkt: &KktSystem<'_>,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<SymmetricMatrix<f64>, Cancelled> {
    let mut matrix = SymmetricMatrix::zeros(Arc::clone(system.pattern()));
    let mut rhs = vec![0.0; matrix.size()];
    system.assemble_asking(kkt, &mut matrix, &mut rhs, checkpoint)?;
    Ok(matrix)
}

fn diagonal(matrix: &SymmetricMatrix<f64>) -> Vec<f64> {
    (0..matrix.size()).map(|column| matrix.values[matrix.pattern().column(column).start]).collect()
}

/// `C⁻¹` by blocks.
struct BlockPreconditioner {
    system: Arc<ReducedSystem>,
    symbolic: Arc<SymbolicCholesky>,
    /// Made in the first step and kept.
    blocks: Option<Blocks>,
    /// For `M`, made in every step.
    elimination: Option<Elimination>,
}

impl BlockPreconditioner {
    fn new(
        topology: &Topology,
        rows: &ConstraintRows,
        reduced: Option<&Arc<ReducedSystem>>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let (system, elimination) = match reduced {
            Some(system) => (Arc::clone(system), None),
            None => {
                let system = Arc::new(ReducedSystem::asking(topology, rows, checkpoint)?);
                checkpoint()?;
                let products = ConstraintProducts::reduced(topology, rows, &system);
                (system, Some(Elimination { products, triangles: Vec::new() }))
            }
        };
        checkpoint()?;
        let pattern = Arc::new(system.vertex_pattern());
        checkpoint()?;
        let symbolic = SymbolicCholesky::analyse(pattern)?;
        checkpoint()?;
        Ok(Self { system, symbolic, blocks: None, elimination })
    }

    fn factorise(&mut self, kkt: &KktSystem<'_>, checkpoint: &mut Checkpoint<'_>) -> Result<(), LinearError> {
        let s = assemble(&self.system, kkt, checkpoint)?;
        let mut block = |part| {
            let block = s.every_second(self.symbolic.pattern(), part);
            checkpoint()?;
            self.symbolic.factorise(&block)
        };
        self.blocks = Some(Blocks { vertex: block(0)?, wheel: block(1)? });
        checkpoint()?;
        Ok(())
    }
}

impl Preconditioner for BlockPreconditioner {
    fn apply(&self, r: &[f64], out: &mut [f64]) {
        let blocks = self.blocks.as_ref().expect("prepared before it is used");
        match &self.elimination {
            None => blocks.apply(r, out),
            Some(elimination) => elimination.apply(blocks, r, out),
        }
    }
}

/// `diag(S_vv, S_ww)⁻¹`, vectors in the order of the unknowns of `S`: vertex, wheel, vertex, wheel, …
struct Blocks {
    vertex: Cholesky<f64>,
    wheel: Cholesky<f64>,
}

impl Preconditioner for Blocks {
    fn apply(&self, r: &[f64], out: &mut [f64]) {
        let solve = |factors: &Cholesky<f64>, part: usize| {
            let part: Vec<f64> = r.iter().skip(part).step_by(2).copied().collect();
            let mut solved = vec![0.0; part.len()];
            factors.apply(&part, &mut solved);
            solved
        };
        let (vertex, wheel) = if r.len() < PARALLEL_LEN {
            (solve(&self.vertex, 0), solve(&self.wheel, 1))
        } else {
            abf_parallel::join(|| solve(&self.vertex, 0), || solve(&self.wheel, 1))
        };
        for ((pair, v), w) in out.chunks_exact_mut(2).zip(vertex).zip(wheel) {
            pair.copy_from_slice(&[v, w]);
        }
    }
}

/// The triangle rows of `M`, eliminated before the blocks are solved with and substituted after.
struct Elimination {
    /// `J_R`.
    products: ConstraintProducts,
    /// `T⁻¹` and the two products with `Λ⁻¹ J_tᵀ T⁻¹`.
    triangles: Vec<TriangleReduction>,
}

impl Elimination {
    fn update(&mut self, kkt: &KktSystem<'_>) {
        self.products.update(kkt);
        self.triangles = kkt.lambda.chunks_exact(3).map(|l| TriangleReduction::new([l[0], l[1], l[2]])).collect();
    }

    /// Vectors in the order of [`ConstraintRows`].
    fn apply(&self, blocks: &Blocks, r: &[f64], out: &mut [f64]) {
        // Down: r_R − K T⁻¹ r_t.
        let mut corners: Vec<f64> = self.triangles.iter().zip(r).flat_map(|(t, &r)| t.shift(r)).collect();
        let kept = self.products.kept_rows();
        let (mut reduced, mut solved) = (vec![0.0; kept.len()], vec![0.0; kept.len()]);
        self.products.multiply(&corners, &mut reduced);
        reduced.iter_mut().zip(kept).for_each(|(v, &row)| *v = r[row as usize] - *v);
        blocks.apply(&reduced, &mut solved);
        // Up: |T|⁻¹ r_t − T⁻¹ Kᵀ z_R.
        self.products.multiply_transposed(&solved, &mut corners);
        for (t, triangle) in self.triangles.iter().enumerate() {
            let sign = triangle.multiplier(1.0, [0.0; 3]).signum();
            out[t] = triangle.multiplier(sign * r[t], [corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]]);
        }
        kept.iter().zip(solved).for_each(|(&row, z)| out[row as usize] = z);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SchurComplement;
    use crate::test_support::{Planted, apart, wave};
    use abf_linalg::LinOp;

    const KINDS: [PreconditionerKind; 3] =
        [PreconditionerKind::None, PreconditionerKind::Jacobi, PreconditionerKind::Block];

    fn reduced_system(kkt: &KktSystem<'_>) -> Arc<ReducedSystem> {
        Arc::new(ReducedSystem::new(kkt.topology, kkt.rows).expect("fits"))
    }

    fn with_2w<'a>(kkt: &KktSystem<'a>) -> KktSystem<'a> {
        KktSystem { lambda: kkt.gauss_newton, ..*kkt }
    }

    #[test]
    fn every_preconditioner_is_symmetric_and_positive_though_lambda_is_not() {
        let planted = Planted::new(300);
        let kkt = planted.kkt();
        assert!(kkt.lambda.iter().any(|&l| l < 0.0));
        let system = reduced_system(&kkt);
        for (reduced, size) in [(None, kkt.rows.len()), (Some(&system), 2 * kkt.rows.interior_count())] {
            for kind in KINDS {
                let mut preconditioning = Preconditioning::new(kind, kkt.topology, kkt.rows, reduced).expect("fits");
                let c = preconditioning.prepare(&kkt, &mut || Ok(())).expect("positive definite");
                let inner = |u: &[f64], v: &[f64]| {
                    let mut out = vec![f64::NAN; size];
                    c.apply(v, &mut out);
                    u.iter().zip(&out).map(|(a, b)| a * b).sum::<f64>()
                };
                let u = wave(size);
                let v: Vec<f64> = wave(size + 1)[1..].to_vec();
                assert!((inner(&u, &v) - inner(&v, &u)).abs() < 1e-10 * inner(&u, &u).min(inner(&v, &v)));
                assert!(inner(&u, &u) > 0.0 && inner(&v, &v) > 0.0);
            }
        }
    }

    #[test]
    fn the_blocks_of_s_are_inverted_exactly() {
        let planted = Planted::new(300);
        let kkt = planted.kkt();
        let system = reduced_system(&kkt);
        let s = assemble(&system, &with_2w(&kkt), &mut || Ok(())).expect("nobody ends it");
        let mut preconditioning =
            Preconditioning::new(PreconditionerKind::Block, kkt.topology, kkt.rows, Some(&system)).expect("fits");
        let c = preconditioning.prepare(&kkt, &mut || Ok(())).expect("positive definite");
        for part in [0, 1] {
            let only = |v: &mut [f64]| v.iter_mut().skip(1 - part).step_by(2).for_each(|v| *v = 0.0);
            let mut x = wave(s.size());
            only(&mut x);
            let (mut sx, mut back) = (vec![0.0; x.len()], vec![0.0; x.len()]);
            s.apply(&x, &mut sx);
            only(&mut sx);
            c.apply(&sx, &mut back);
            assert!(apart(&back, &x) < 1e-10);
        }
    }

    /// `C⁻¹ M` is the identity on what only the triangle rows hold, but for the sign of `T`: `M` and `C`
    /// share these columns.
    #[test]
    fn the_triangle_rows_of_m_are_eliminated_exactly() {
        let planted = Planted::new(300);
        let kkt = planted.kkt();
        let mut products = ConstraintProducts::whole(kkt.topology, kkt.rows);
        products.update(&kkt);
        let m = SchurComplement::new(&products, &kkt);
        let mut preconditioning =
            Preconditioning::new(PreconditionerKind::Block, kkt.topology, kkt.rows, None).expect("fits");
        let c = preconditioning.prepare(&kkt, &mut || Ok(())).expect("positive definite");
        let mut x = wave(m.size());
        x[kkt.rows.triangle_count()..].fill(0.0);
        let (mut mx, mut back) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        m.apply(&x, &mut mx);
        c.apply(&mx, &mut back);
        assert!(back.iter().zip(&x).all(|(b, x)| (b.abs() - x.abs()).abs() < 1e-11));
        assert!(back.iter().zip(&x).any(|(b, x)| b * x < 0.0), "a triangle with a negative T");
    }

    #[test]
    fn factors_are_frozen_until_a_solve_takes_too_long() {
        let planted = Planted::new(100);
        let kkt = planted.kkt();
        let mut preconditioning =
            Preconditioning::new(PreconditionerKind::Block, kkt.topology, kkt.rows, None).expect("fits");
        for (iterations, factorisations) in [(10, 1), (REFACTOR_AFTER, 1), (REFACTOR_AFTER + 1, 1), (5, 2), (5, 2)] {
            preconditioning.prepare(&kkt, &mut || Ok(())).expect("positive definite");
            assert_eq!(preconditioning.factorisations(), factorisations);
            preconditioning.used(iterations);
        }
    }
}
