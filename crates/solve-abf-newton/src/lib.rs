//! Newton solvers with a direct inner solve.
//!
//! The grid of [`NewtonSettings`] with the step solved by a factorisation. The named points:
//!
//! | name | wheel | Hessian | inner solve | source |
//! | --- | --- | --- | --- | --- |
//! | `abf` | product | exact, not diagonal | whole KKT matrix, sparse LU | Sheffer, de Sturler 2001 |
//! | `abf++` | product | Gauss–Newton | reduced, Cholesky | Sheffer, Lévy, Mogilnitsky, Bogomyakov 2005 |
//! | `abf-newton` | log | exact, diagonal | reduced, LBLᵀ where indefinite | ZRS05; VMV04 with a direct solve |
//! | `abf-fixed-target` | log | Gauss–Newton | reduced, Cholesky | LinABF's matrix, ABF's target |
//!
//! All four minimise the same energy under the same constraints, so they reach the same angles; they
//! differ in what a step costs and in how many they need. Gauss–Newton converges linearly and its
//! system is always positive definite; the exact Hessian converges quadratically and is negative on a
//! few corners.

mod full_kkt;

use abf_constraints::{AngleProblem, WheelForm};
use abf_control::{Observer, StopCriteria, Watch};
use abf_solve_core::{AngleSolution, AngleSolver, DirectStep, FrozenStep, Hessian, NewtonSettings, SolveError};

pub use full_kkt::FullKktStep;

/// How the step is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Inner {
    /// Triangle rows eliminated, two unknowns per interior vertex. Needs a diagonal Hessian.
    Reduced,
    /// The whole matrix `[Λ Jᵀ; J 0]`, `5 nt` unknowns, with any Hessian.
    FullKkt,
}

/// The named points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum NewtonMethod {
    /// ABF as published in 2001.
    Abf,
    /// ABF++.
    #[cfg_attr(feature = "serde", serde(rename = "abf++"))]
    AbfPlusPlus,
    /// Newton's method: log wheel, exact Hessian.
    AbfNewton,
    /// Log wheel, Gauss–Newton, the target of ABF kept.
    AbfFixedTarget,
}

impl NewtonMethod {
    /// The name on the command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Abf => "abf",
            Self::AbfPlusPlus => "abf++",
            Self::AbfNewton => "abf-newton",
            Self::AbfFixedTarget => "abf-fixed-target",
        }
    }
}

/// A Newton solver with a direct inner solve.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct AbfNewton {
    /// Which of the named points it started as. Only its name in reports depends on it.
    pub method: NewtonMethod,
    /// The point of the grid.
    pub newton: NewtonSettings,
    /// How the step is solved. The exact Hessian of the product wheel always takes the whole matrix.
    pub inner: Inner,
}

impl AbfNewton {
    /// ABF as published in 2001: product wheel, exact Hessian, the whole matrix.
    #[must_use]
    pub fn abf() -> Self {
        Self::preset(NewtonMethod::Abf, WheelForm::Product, Hessian::Exact, Inner::FullKkt)
    }

    /// ABF++: product wheel, Gauss–Newton, reduced.
    #[must_use]
    pub fn abf_plus_plus() -> Self {
        Self::preset(NewtonMethod::AbfPlusPlus, WheelForm::Product, Hessian::GaussNewton, Inner::Reduced)
    }

    /// The Newton method of ZRS05 and VMV04: log wheel, exact Hessian.
    #[must_use]
    pub fn exact_newton() -> Self {
        Self::preset(NewtonMethod::AbfNewton, WheelForm::Log, Hessian::Exact, Inner::Reduced)
    }

    /// Log wheel, Gauss–Newton: the matrix of LinABF with ABF's target kept.
    #[must_use]
    pub fn fixed_target() -> Self {
        Self::preset(NewtonMethod::AbfFixedTarget, WheelForm::Log, Hessian::GaussNewton, Inner::Reduced)
    }

    fn preset(method: NewtonMethod, wheel: WheelForm, hessian: Hessian, inner: Inner) -> Self {
        Self { method, newton: NewtonSettings { wheel, hessian, ..NewtonSettings::default() }, inner }
    }
}

impl AngleSolver for AbfNewton {
    fn name(&self) -> &'static str {
        self.method.name()
    }

    fn check(&self) -> Result<(), SolveError> {
        self.newton.check()
    }

    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<AngleSolution, SolveError> {
        let not_diagonal = self.newton.wheel == WheelForm::Product && self.newton.hessian == Hessian::Exact;
        if self.inner == Inner::FullKkt || not_diagonal {
            self.newton.solve_with(problem, stop, observer, |_| Ok(FullKktStep::default()))
        } else if self.newton.wheel == WheelForm::Log && self.newton.hessian == Hessian::GaussNewton {
            // Λ = 2w in every step.
            let lambda = problem.weight().iter().map(|w| 2.0 * w).collect();
            let floor = 0.1 * stop.tolerance;
            let step = |watch: &mut Watch<'_>| {
                FrozenStep::new(problem.topology(), problem.rows(), lambda, floor, &mut || watch.checkpoint())
            };
            self.newton.solve_with(problem, stop, observer, step)
        } else {
            let step = |watch: &mut Watch<'_>| {
                DirectStep::asking(problem.topology(), problem.rows(), &mut || watch.checkpoint())
            };
            self.newton.solve_with(problem, stop, observer, step)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_constraints::GuessSettings;
    use abf_control::{Silent, Termination};
    use abf_mesh::Topology;
    use abf_shapes::Shape;

    fn solve(solver: &AbfNewton, shape: Shape, triangles: usize) -> AngleSolution {
        let mesh = shape.mesh(triangles);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
        solver.solve(&problem, &StopCriteria::default(), &mut Silent).expect("angles")
    }

    fn largest_difference(a: &AngleSolution, b: &AngleSolution) -> f64 {
        a.angles().iter().zip(b.angles()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_four_named_points_reach_the_same_angles() {
        for shape in [Shape::BumpySheet, Shape::LetterX, Shape::SpikyField] {
            let reference = solve(&AbfNewton::fixed_target(), shape, 600);
            assert_eq!(reference.termination(), Termination::Converged);
            for solver in [AbfNewton::abf(), AbfNewton::abf_plus_plus(), AbfNewton::exact_newton()] {
                let solution = solve(&solver, shape, 600);
                assert_eq!(solution.termination(), Termination::Converged, "{} on {shape}", solver.name());
                let apart = largest_difference(&reference, &solution);
                assert!(apart < 1e-6, "{} on {shape}: {apart:e}", solver.name());
            }
        }
    }

    #[test]
    fn the_whole_matrix_and_the_reduced_one_take_the_same_steps() {
        let reduced = solve(&AbfNewton::exact_newton(), Shape::Hemisphere, 400);
        let full = solve(&AbfNewton { inner: Inner::FullKkt, ..AbfNewton::exact_newton() }, Shape::Hemisphere, 400);
        assert_eq!(reduced.iterations(), full.iterations());
        assert!(largest_difference(&reduced, &full) < 1e-12);
    }

    #[test]
    fn a_step_of_abf_may_give_up_the_exact_hessian() {
        // Found by fuzzing: the matrix without second derivatives was factorised with the analysis of that with them.
        let points = [
            [0.0, 4.0, 12.0],
            [1.37, 0.37, 0.123333],
            [4.493333, 0.74, 0.74],
            [1.11, 2.11, 1.11],
            [1.48, 5.4, 1.48],
            [9.233333, 5.425, 9.875],
        ];
        let faces = [[0, 1, 2], [1, 0, 3], [2, 1, 3], [2, 3, 4], [0, 2, 4], [3, 0, 5]];
        let mesh = abf_mesh::TriMesh::new(points.map(Into::into).to_vec(), &faces).expect("a mesh");
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
        let solution = AbfNewton::abf().solve(&problem, &StopCriteria::default(), &mut Silent).expect("angles");
        assert!(solution.fallbacks() > 0, "it is given up");
    }

    #[test]
    fn the_exact_hessian_needs_fewer_steps() {
        let linear = solve(&AbfNewton::fixed_target(), Shape::SpikyField, 1200);
        let quadratic = solve(&AbfNewton::exact_newton(), Shape::SpikyField, 1200);
        assert!(quadratic.iterations() <= linear.iterations());
    }
}
