//! One quadratic step by Uzawa, with all constraints or with the triangle rows eliminated.

use crate::{RightHandSide, SaddlePoint, uzawa};
use abf_constraints::{ConstraintRows, TriangleReduction};
use abf_control::{Checkpoint, Fallback, Watch};
use abf_linalg::{KrylovEnd, KrylovParams, KrylovStats};
use abf_mesh::Topology;
use abf_solve_core::{
    ConstraintProducts, IterativeSettings, KktStep, KktSystem, KktVector, LinearError, Preconditioning, ReducedSystem,
    Reduction, StepError, StepReport,
};
use std::sync::Arc;

/// Solves a step by conjugate-direction Uzawa.
///
/// With the exact Hessian the Schur complement need not be positive definite. When the method meets
/// `⟨p, h⟩ ≤ 0` the step is solved again with `Λ = 2w`, and the report says so. With the triangle rows
/// eliminated that is rarer: there a negative entry of `Λ` does no harm as long as its triangle, with
/// its sum of angles held, is still convex.
pub struct UzawaStep {
    settings: IterativeSettings,
    products: ConstraintProducts,
    /// With the triangle rows eliminated.
    reduced: Option<Arc<ReducedSystem>>,
    preconditioning: Preconditioning,
}

impl UzawaStep {
    /// Prepares what the settings need of a topology.
    ///
    /// # Errors
    /// [`LinearError`] when that does not fit in memory or in 32-bit indices.
    pub fn new(topology: &Topology, rows: &ConstraintRows, settings: IterativeSettings) -> Result<Self, LinearError> {
        Self::asking(topology, rows, settings, &mut || Ok(()))
    }

    /// [`UzawaStep::new`] that asks between its parts whether to go on.
    ///
    /// # Errors
    /// As `new`, and [`LinearError::Cancelled`].
    pub fn asking(
        topology: &Topology,
        rows: &ConstraintRows,
        settings: IterativeSettings,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let reduced = match settings.reduction {
            Reduction::None => None,
            Reduction::Triangles => Some(Arc::new(ReducedSystem::asking(topology, rows, checkpoint)?)),
        };
        let products = match &reduced {
            None => ConstraintProducts::whole(topology, rows),
            Some(system) => ConstraintProducts::reduced(topology, rows, system),
        };
        let preconditioning =
            Preconditioning::asking(settings.preconditioner, topology, rows, reduced.as_ref(), checkpoint)?;
        Ok(Self { settings, products, reduced, preconditioning })
    }

    /// How often the blocks of the preconditioner were factorised.
    #[must_use]
    pub fn factorisations(&self) -> usize {
        self.preconditioning.factorisations()
    }

    /// Solves with the `Λ` of this system, `done` iterations of the step being used up.
    fn solve(
        &mut self,
        kkt: &KktSystem<'_>,
        tolerance: f64,
        done: usize,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<KrylovStats, StepError> {
        let c = self.preconditioning.prepare(kkt, &mut || watch.checkpoint())?;
        let saddle = Saddle::new(&self.products, kkt, self.settings.reduction);
        let (f, g) = saddle.right_hand_side(kkt);
        let max_iterations = self.settings.max_inner_iterations - done;
        let params = KrylovParams { max_iterations, ..self.settings.krylov(tolerance) };
        let mut go_on = |iteration, estimate| watch.inner(done + iteration, estimate).unwrap_or(false);
        let (unknowns, stats) = uzawa(&saddle, c, RightHandSide { f: &f, g: &g }, &params, &mut go_on);
        watch.aborted()?;
        self.preconditioning.used(stats.iterations);
        match &self.reduced {
            None => *out = KktVector { delta: unknowns.x, multipliers: unknowns.lambda },
            // Repeats the last computation of x, and adds the shift and the triangle multipliers.
            Some(system) => system.back_substitute(kkt, &unknowns.lambda, out),
        }
        Ok(stats)
    }
}

impl KktStep for UzawaStep {
    fn step(
        &mut self,
        kkt: &KktSystem<'_>,
        tolerance: f64,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<StepReport, StepError> {
        self.products.update(kkt);
        let first = self.solve(kkt, tolerance, 0, watch, out)?;
        if first.end != KrylovEnd::NegativeCurvature || kkt.lambda == kkt.gauss_newton {
            return StepReport::from_krylov(first);
        }
        let gauss_newton = KktSystem { lambda: kkt.gauss_newton, ..*kkt };
        let second = self.solve(&gauss_newton, tolerance, first.iterations, watch, out)?;
        let both = KrylovStats { iterations: first.iterations + second.iterations, ..second };
        Ok(StepReport { fallback: Some(Fallback::NegativeCurvature), ..StepReport::from_krylov(both)? })
    }
}

/// The saddle point of a step.
///
/// * All constraints: `A = Λ`, `B = J`, `f = −g`, right-hand side `−h`; `x = δ`.
/// * Triangle rows eliminated: `A⁻¹ = P`, triangle by triangle ([`TriangleReduction`]), `B = R`, the
///   vertex and wheel rows. `P` keeps every sum of angles, so the triangle rows hold by themselves for
///   `x = δ + s h_t` if the shift `s h_t` is taken to the right: `R x = R s h_t − h_R`. `P` has no
///   inverse; the algorithm asks for none.
struct Saddle<'a> {
    products: &'a ConstraintProducts,
    inverse: Inverse,
}

/// `A⁻¹`.
enum Inverse {
    Diagonal(Vec<f64>),
    Triangles(Vec<TriangleReduction>),
}

impl<'a> Saddle<'a> {
    fn new(products: &'a ConstraintProducts, kkt: &KktSystem<'_>, reduction: Reduction) -> Self {
        let triangles = kkt.lambda.chunks_exact(3);
        let inverse = match reduction {
            Reduction::None => Inverse::Diagonal(kkt.lambda.iter().map(|l| l.recip()).collect()),
            Reduction::Triangles => {
                Inverse::Triangles(triangles.map(|l| TriangleReduction::new([l[0], l[1], l[2]])).collect())
            }
        };
        Self { products, inverse }
    }

    /// `f` and `g` of the saddle point.
    fn right_hand_side(&self, kkt: &KktSystem<'_>) -> (Vec<f64>, Vec<f64>) {
        let f = kkt.gradient.iter().map(|g| -g).collect();
        let kept = self.products.kept_rows();
        let mut g = vec![0.0; kept.len()];
        if let Inverse::Triangles(triangles) = &self.inverse {
            let shift: Vec<f64> = triangles.iter().zip(kkt.residual).flat_map(|(t, &h)| t.shift(h)).collect();
            self.products.multiply(&shift, &mut g);
        }
        g.iter_mut().zip(kept).for_each(|(g, &row)| *g -= kkt.residual[row as usize]);
        (f, g)
    }
}

impl SaddlePoint for Saddle<'_> {
    fn sizes(&self) -> (usize, usize) {
        (self.products.corner_count(), self.products.kept_rows().len())
    }

    fn solve_a(&self, p: &[f64], out: &mut [f64]) {
        match &self.inverse {
            Inverse::Diagonal(inverse) => {
                out.iter_mut().zip(p).zip(inverse).for_each(|((x, p), inverse)| *x = p * inverse);
            }
            Inverse::Triangles(triangles) => {
                for ((x, p), triangle) in out.chunks_exact_mut(3).zip(p.chunks_exact(3)).zip(triangles) {
                    x.copy_from_slice(&triangle.project([p[0], p[1], p[2]]));
                }
            }
        }
    }

    fn multiply_b(&self, x: &[f64], out: &mut [f64]) {
        self.products.multiply(x, out);
    }

    fn multiply_b_transposed(&self, lambda: &[f64], out: &mut [f64]) {
        self.products.multiply_transposed(lambda, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_constraints::{AngleProblem, GuessSettings};
    use abf_control::{Silent, StopCriteria};
    use abf_shapes::Shape;
    use abf_solve_core::{DirectStep, InnerTolerance, NewtonSettings};

    /// Solves the first step of a sheet with this Λ in place of 2w, and compares with a direct solve.
    struct Bent<F> {
        bend: F,
        tested: UzawaStep,
        report: Option<StepReport>,
    }

    impl<F: Fn(&mut [f64])> KktStep for Bent<F> {
        fn step(
            &mut self,
            kkt: &KktSystem<'_>,
            tolerance: f64,
            watch: &mut Watch<'_>,
            out: &mut KktVector,
        ) -> Result<StepReport, StepError> {
            let mut lambda = kkt.gauss_newton.to_vec();
            lambda.chunks_exact_mut(3).step_by(5).for_each(&self.bend);
            let bent = KktSystem { lambda: &lambda, ..*kkt };
            let report = self.tested.step(&bent, tolerance, watch, out)?;
            self.report = Some(report);

            let mut expected = KktVector::default();
            let solved = if report.fallback.is_some() { *kkt } else { bent };
            DirectStep::new(kkt.topology, kkt.rows)?.step(&solved, tolerance, watch, &mut expected)?;
            let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0_f64, |max, (x, y)| max.max((x - y).abs()));
            assert!(apart(&out.delta, &expected.delta) < 1e-8);
            assert!(apart(&out.multipliers, &expected.multipliers) < 1e-6);
            Ok(report)
        }
    }

    fn bent(settings: IterativeSettings, bend: impl Fn(&mut [f64])) -> StepReport {
        let mesh = Shape::BumpySheet.mesh(300);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
        let tested = UzawaStep::new(&topology, problem.rows(), settings).expect("fits");
        let mut step = Bent { bend, tested, report: None };
        let newton = NewtonSettings { inner_tolerance: InnerTolerance::Fixed(1e-12), ..NewtonSettings::default() };
        let stop = StopCriteria { max_iterations: 1, ..StopCriteria::default() };
        newton.solve(&problem, &stop, &mut Silent, &mut step).expect("angles");
        step.report.expect("one step")
    }

    fn reduced(reduction: Reduction) -> IterativeSettings {
        IterativeSettings { reduction, ..IterativeSettings::default() }
    }

    #[test]
    fn negative_curvature_ends_in_a_step_with_two_w_and_counts_both_tries() {
        for reduction in [Reduction::None, Reduction::Triangles] {
            let plain = bent(reduced(reduction), |_| ());
            assert_eq!(plain.fallback, None);
            let report = bent(reduced(reduction), |l| l[1] = -l[1]);
            assert_eq!(report.fallback, Some(Fallback::NegativeCurvature), "{reduction}");
            assert!(report.iterations >= plain.iterations && report.inner_converged, "{reduction}");
        }
    }

    /// `Λ` is positive on the changes that keep the sum of the angles, so `P` and `S` are, though `M`
    /// is not.
    #[test]
    fn a_negative_entry_in_a_convex_triangle_does_no_harm_once_its_row_is_eliminated() {
        let bend = |l: &mut [f64]| l[1] = -0.2 * l[0].min(l[2]);
        assert_eq!(bent(reduced(Reduction::Triangles), bend).fallback, None);
        assert_eq!(bent(reduced(Reduction::None), bend).fallback, Some(Fallback::NegativeCurvature));
    }

    #[test]
    fn frozen_factors_serve_the_whole_solve_of_an_easy_mesh() {
        let mesh = Shape::BumpySheet.mesh(300);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
        let mut step = UzawaStep::new(&topology, problem.rows(), IterativeSettings::default()).expect("fits");
        let newton = NewtonSettings::default();
        let solution = newton.solve(&problem, &StopCriteria::default(), &mut Silent, &mut step).expect("angles");
        assert!(solution.iterations() > 2);
        assert_eq!(step.factorisations(), 1);
    }
}
