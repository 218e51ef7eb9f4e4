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
//! M = [ I       0 ] [ T  0 ] [ I  T⁻¹Kᵀ ]        C = the same with diag(S_vv, S_ww) for S.
//!     [ K T⁻¹   I ] [ 0  S ] [ 0  I     ]
//! ```
//!
//! `C⁻¹M` has `nt` eigenvalues 1 and beyond these the ones that `S` has with its own blocks.

use crate::schur::schur_diagonal;
use crate::{ConstraintProducts, KktSystem, LinearError, PreconditionerKind, ReducedSystem};
use abf_constraints::{ConstraintRows, TriangleReduction};
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
    current: Box<dyn Preconditioner>,
    is_outdated: bool,
    factorisations: usize,
}

/// How to build it.
enum Recipe {
    Identity,
    DiagonalOfM,
    DiagonalOfS(Arc<ReducedSystem>),
    Block(Box<BlockRecipe>),
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
        let recipe = match (kind, reduced) {
            (PreconditionerKind::None, _) => Recipe::Identity,
            (PreconditionerKind::Jacobi, None) => Recipe::DiagonalOfM,
            (PreconditionerKind::Jacobi, Some(system)) => Recipe::DiagonalOfS(Arc::clone(system)),
            (PreconditionerKind::Block, _) => Recipe::Block(Box::new(BlockRecipe::new(topology, rows, reduced)?)),
        };
        Ok(Self { recipe, current: Box::new(Identity), is_outdated: true, factorisations: 0 })
    }

    /// The preconditioner for a system: a diagonal is always fresh, factors are frozen until
    /// [`Preconditioning::used`] finds them outdated.
    ///
    /// # Errors
    /// [`LinearError`] when a block cannot be factorised.
    pub fn prepare(&mut self, kkt: &KktSystem<'_>) -> Result<&dyn Preconditioner, LinearError> {
        let kkt = KktSystem { lambda: kkt.gauss_newton, off_diagonal: None, ..*kkt };
        match &self.recipe {
            Recipe::DiagonalOfM => self.current = Box::new(Jacobi::new(&schur_diagonal(&kkt))?),
            Recipe::DiagonalOfS(system) => self.current = Box::new(Jacobi::new(&diagonal(&assemble(system, &kkt)))?),
            Recipe::Block(block) if self.is_outdated => {
                self.current = block.factorise(&kkt)?;
                self.is_outdated = false;
                self.factorisations += 1;
            }
            Recipe::Identity | Recipe::Block(_) => {}
        }
        Ok(&*self.current)
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

fn assemble(system: &ReducedSystem, kkt: &KktSystem<'_>) -> SymmetricMatrix<f64> {
    let mut matrix = SymmetricMatrix::zeros(Arc::clone(system.pattern()));
    let mut rhs = vec![0.0; matrix.size()];
    system.assemble(kkt, &mut matrix, &mut rhs);
    matrix
}

fn diagonal(matrix: &SymmetricMatrix<f64>) -> Vec<f64> {
    (0..matrix.size()).map(|column| matrix.values[matrix.pattern().column(column).start]).collect()
}

/// What the block preconditioner needs once per topology.
struct BlockRecipe {
    system: Arc<ReducedSystem>,
    symbolic: Arc<SymbolicCholesky>,
    /// `J_R`, to eliminate the triangle rows of `M` with.
    elimination: Option<ConstraintProducts>,
}

impl BlockRecipe {
    fn new(
        topology: &Topology,
        rows: &ConstraintRows,
        reduced: Option<&Arc<ReducedSystem>>,
    ) -> Result<Self, LinearError> {
        let (system, elimination) = match reduced {
            Some(system) => (Arc::clone(system), None),
            None => {
                let system = Arc::new(ReducedSystem::new(topology, rows)?);
                let products = ConstraintProducts::reduced(topology, rows, &system);
                (system, Some(products))
            }
        };
        let symbolic = SymbolicCholesky::analyse(Arc::new(system.vertex_pattern()))?;
        Ok(Self { system, symbolic, elimination })
    }

    fn factorise(&self, kkt: &KktSystem<'_>) -> Result<Box<dyn Preconditioner>, LinearError> {
        let s = assemble(&self.system, kkt);
        let block = |part| self.symbolic.factorise(&s.every_second(self.symbolic.pattern(), part));
        let blocks = Blocks { vertex: block(0)?, wheel: block(1)? };
        Ok(match &self.elimination {
            None => Box::new(blocks),
            Some(products) => Box::new(BlocksWithTriangles::new(blocks, products.clone(), kkt)),
        })
    }
}

/// `diag(S_vv, S_ww)⁻¹`, vectors in the order of the unknowns of `S`: vertex, wheel, vertex, wheel, …
pub(crate) struct Blocks<F> {
    pub vertex: F,
    pub wheel: F,
}

impl<F: Preconditioner + Sync> Preconditioner for Blocks<F> {
    fn apply(&self, r: &[f64], out: &mut [f64]) {
        let solve = |factors: &F, part: usize| {
            let part: Vec<f64> = r.iter().skip(part).step_by(2).copied().collect();
            let mut solved = vec![0.0; part.len()];
            factors.apply(&part, &mut solved);
            solved
        };
        let (vertex, wheel) = if r.len() < PARALLEL_LEN {
            (solve(&self.vertex, 0), solve(&self.wheel, 1))
        } else {
            rayon::join(|| solve(&self.vertex, 0), || solve(&self.wheel, 1))
        };
        for ((pair, v), w) in out.chunks_exact_mut(2).zip(vertex).zip(wheel) {
            pair.copy_from_slice(&[v, w]);
        }
    }
}

/// `C⁻¹` for `M`, vectors in the order of [`ConstraintRows`].
struct BlocksWithTriangles {
    blocks: Blocks<Cholesky<f64>>,
    /// With 2w: `T⁻¹` and the two products with `Λ⁻¹ J_tᵀ T⁻¹`.
    triangles: Vec<TriangleReduction>,
    /// `J_R`.
    products: ConstraintProducts,
}

impl BlocksWithTriangles {
    fn new(blocks: Blocks<Cholesky<f64>>, mut products: ConstraintProducts, kkt: &KktSystem<'_>) -> Self {
        products.update(kkt);
        let triangles = kkt.lambda.chunks_exact(3).map(|l| TriangleReduction::new([l[0], l[1], l[2]])).collect();
        Self { blocks, triangles, products }
    }
}

impl Preconditioner for BlocksWithTriangles {
    fn apply(&self, r: &[f64], out: &mut [f64]) {
        // Down: r_R − K T⁻¹ r_t.
        let mut corners: Vec<f64> = self.triangles.iter().zip(r).flat_map(|(t, &r)| t.shift(r)).collect();
        let kept = self.products.kept_rows();
        let (mut reduced, mut solved) = (vec![0.0; kept.len()], vec![0.0; kept.len()]);
        self.products.multiply(&corners, &mut reduced);
        reduced.iter_mut().zip(kept).for_each(|(v, &row)| *v = r[row as usize] - *v);
        self.blocks.apply(&reduced, &mut solved);
        // Up: T⁻¹ (r_t − Kᵀ z_R).
        self.products.multiply_transposed(&solved, &mut corners);
        for (t, triangle) in self.triangles.iter().enumerate() {
            out[t] = triangle.multiplier(r[t], [corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]]);
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
                let c = preconditioning.prepare(&kkt).expect("positive definite");
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
        let s = assemble(&system, &with_2w(&kkt));
        let mut preconditioning =
            Preconditioning::new(PreconditionerKind::Block, kkt.topology, kkt.rows, Some(&system)).expect("fits");
        let c = preconditioning.prepare(&kkt).expect("positive definite");
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

    /// `C⁻¹ M` is the identity on what only the triangle rows hold: `M` and `C` share these columns.
    #[test]
    fn the_triangle_rows_of_m_are_eliminated_exactly() {
        let planted = Planted::new(300);
        let kkt = with_2w(&planted.kkt());
        let mut products = ConstraintProducts::whole(kkt.topology, kkt.rows);
        products.update(&kkt);
        let m = SchurComplement::new(&products, &kkt);
        let mut preconditioning =
            Preconditioning::new(PreconditionerKind::Block, kkt.topology, kkt.rows, None).expect("fits");
        let c = preconditioning.prepare(&kkt).expect("positive definite");
        let mut x = wave(m.size());
        x[kkt.rows.triangle_count()..].fill(0.0);
        let (mut mx, mut back) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        m.apply(&x, &mut mx);
        c.apply(&mx, &mut back);
        assert!(apart(&back, &x) < 1e-12);
    }

    #[test]
    fn factors_are_frozen_until_a_solve_takes_too_long() {
        let planted = Planted::new(100);
        let kkt = planted.kkt();
        let mut preconditioning =
            Preconditioning::new(PreconditionerKind::Block, kkt.topology, kkt.rows, None).expect("fits");
        for (iterations, factorisations) in [(10, 1), (REFACTOR_AFTER, 1), (REFACTOR_AFTER + 1, 1), (5, 2), (5, 2)] {
            preconditioning.prepare(&kkt).expect("positive definite");
            assert_eq!(preconditioning.factorisations(), factorisations);
            preconditioning.used(iterations);
        }
    }
}
