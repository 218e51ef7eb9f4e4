//! A solver of a user's own: whoever runs it names it.

use abf::constraints::AngleProblem;
use abf::mesh::TriMesh;
use abf::solve_core::SolveError;
use abf::{
    AngleSolution, AngleSolver, FlattenError, Observer, Pipeline, Silent, Solver, SolverKind, StopCriteria,
    SurfaceHints, Termination, Unwrap,
};
use abf_shapes::Shape;

/// The targets as they are, or nothing.
struct Own {
    finds_any: bool,
}

impl AngleSolver for Own {
    fn name(&self) -> &'static str {
        "my-own"
    }

    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        _: &StopCriteria,
        _: &mut dyn Observer,
    ) -> Result<AngleSolution, SolveError> {
        if !self.finds_any {
            return Err(SolveError::Unsupported("it never does"));
        }
        Ok(AngleSolution::measure(problem, problem.target().to_vec(), Termination::OnePass, Vec::new()))
    }
}

fn pipeline(finds_any: bool) -> Pipeline {
    Pipeline { solver: Solver::custom(Own { finds_any }), ..Pipeline::default() }
}

#[test]
fn a_flattening_names_the_solver_of_a_user() {
    let mesh = Shape::FoldedSheet.mesh(400);
    let flat = pipeline(true).run(&mesh, &mut Silent).expect("a flattening");
    assert_eq!((flat.solver, flat.solver.name()), (SolverKind::Custom("my-own"), "my-own"));
    assert_eq!(flat.termination, Termination::OnePass);
    assert!(flat.is_certified(), "the targets of a developable sheet close");
}

#[test]
fn an_error_names_it_too() {
    let mesh = Shape::FoldedSheet.mesh(100);
    let error = pipeline(false).run(&mesh, &mut Silent).unwrap_err();
    assert_eq!(error.to_string(), "the solver 'my-own' found no angles");
    let tight = Pipeline { max_memory: Some(1), ..pipeline(true) };
    let error = tight.run(&mesh, &mut Silent).unwrap_err();
    assert!(matches!(error, FlattenError::Memory { solver: SolverKind::Custom("my-own"), .. }), "{error}");
}

#[test]
fn unwrapping_runs_it_on_every_chart() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Into::into).to_vec();
    let mesh = TriMesh::new(points, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).expect("indices in range");
    let unwrap = Unwrap { pipeline: pipeline(true), ..Unwrap::default() };
    let unwrapped = unwrap.run(&mesh, &SurfaceHints::default(), &mut Silent).expect("charts");
    assert!(!unwrapped.charts.is_empty());
    assert!(unwrapped.charts.iter().all(|chart| chart.solver.name() == "my-own"));
}
