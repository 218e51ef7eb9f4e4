//! The whole KKT matrix, factorised.

use abf_constraints::Jacobian;
use abf_control::Watch;
use abf_linalg::{Refinement, SparseMatrix, SymbolicLu};
use abf_mesh::CornerId;
use abf_solve_core::{KktStep, KktSystem, KktVector, ProductCurvature, StepError, StepReport};
use std::sync::Arc;

/// Solves `[Λ Jᵀ; J 0] [δ; μ] = −[g; h]` as it stands, by sparse LU, with the non-diagonal second
/// derivatives of the product wheel where the Hessian is exact: ABF as published in 2001. Every ring
/// of `d` corners fills two `d × d` blocks, which is what the log form does away with (VMV04 fig. 2).
#[derive(Debug, Default)]
pub struct FullKktStep {
    /// Of the patterns without and with the non-diagonal second derivatives: the outer loop may give up the
    /// exact Hessian for a step.
    symbolic: [Option<Arc<SymbolicLu>>; 2],
}

impl KktStep for FullKktStep {
    fn step(
        &mut self,
        kkt: &KktSystem<'_>,
        tolerance: f64,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<StepReport, StepError> {
        let matrix = assemble(kkt);
        if !watch.inner(0, f64::NAN)? {
            return Err(StepError::Interrupted);
        }
        let analysed = &mut self.symbolic[usize::from(kkt.off_diagonal.is_some())];
        let symbolic = match analysed {
            Some(symbolic) => Arc::clone(symbolic),
            None => Arc::clone(analysed.insert(SymbolicLu::analyse(&matrix)?)),
        };
        let factors = symbolic.factorise(&matrix)?;
        let mut solution: Vec<f64> = kkt.gradient.iter().chain(kkt.residual).map(|x| -x).collect();
        let refinement =
            Refinement { tolerance: tolerance.min(Refinement::default().tolerance), ..Refinement::default() };
        let stats = factors.solve(&matrix, &mut solution, refinement)?;
        out.multipliers = solution.split_off(kkt.gradient.len());
        out.delta = solution;
        Ok(stats.into())
    }
}

/// The matrix in one piece; its pattern depends on whether there is non-diagonal curvature, and on nothing else.
fn assemble(kkt: &KktSystem<'_>) -> SparseMatrix {
    let corners = kkt.lambda.len();
    let mut jacobian = Jacobian::new(kkt.topology, kkt.rows);
    jacobian.update(kkt.topology, kkt.rows, kkt.wheel);
    let mut triplets: Vec<(u32, u32, f64)> = Vec::with_capacity(corners + 2 * jacobian.view().nnz());
    triplets.extend(kkt.lambda.iter().enumerate().map(|(c, &l)| (c as u32, c as u32, l)));
    for (&value, (row, column)) in &jacobian.view() {
        let row = corners as u32 + row;
        triplets.extend([(row, column, value), (column, row, value)]);
    }
    if let Some(curvature) = kkt.off_diagonal {
        add_product_curvature(kkt, curvature, &mut triplets);
    }
    SparseMatrix::from_triplets(corners + kkt.rows.len(), &triplets)
}

/// `m N cot xᵢ cot xⱼ` for every pair of `next` corners of a ring, `−m N` on the diagonal, and the
/// same with `−m` for its `prev` corners, `N` being the product of their sines.
fn add_product_curvature(kkt: &KktSystem<'_>, curvature: ProductCurvature<'_>, triplets: &mut Vec<(u32, u32, f64)>) {
    let angle = |c: CornerId| curvature.angles[c.index()];
    for (i, &v) in kkt.rows.interior().iter().enumerate() {
        let multiplier = curvature.multipliers[kkt.rows.wheel(i)];
        let next: Vec<CornerId> = kkt.topology.fan(v).map(CornerId::next).collect();
        let prev: Vec<CornerId> = kkt.topology.fan(v).map(CornerId::prev).collect();
        for (side, sign) in [(&next, multiplier), (&prev, -multiplier)] {
            let scale = sign * side.iter().map(|&c| angle(c).sin()).product::<f64>();
            for &a in side {
                for &b in side {
                    let value = if a == b { -scale } else { scale / (angle(a).tan() * angle(b).tan()) };
                    triplets.push((a.index() as u32, b.index() as u32, value));
                }
            }
        }
    }
}
