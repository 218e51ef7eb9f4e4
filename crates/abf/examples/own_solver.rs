//! A solver of your own, run by `Pipeline` on a disk and by `Unwrap` on a closed mesh.
//!
//! ```text
//! cargo run -p abf --example own_solver
//! ```

#![allow(clippy::print_stdout, reason = "examples talk")]

use abf::constraints::AngleProblem;
use abf::solve_core::SolveError;
use abf::{
    AngleSolution, AngleSolver, Observer, Pipeline, Silent, Solver, StopCriteria, SurfaceHints, Termination, Unwrap,
};
use abf_shapes::Shape;

/// Takes the target angles as they are. The layout has to live with wheels that do not close.
struct Targets;

impl AngleSolver for Targets {
    fn name(&self) -> &'static str {
        "targets"
    }

    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        _: &StopCriteria,
        _: &mut dyn Observer,
    ) -> Result<AngleSolution, SolveError> {
        // The residual of the constraints is measured, whatever a solver believes.
        Ok(AngleSolution::measure(problem, problem.target().to_vec(), Termination::OnePass, Vec::new()))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pipeline = Pipeline { solver: Solver::custom(Targets), ..Pipeline::default() };

    let disk = Shape::Hemisphere.mesh(400);
    let flat = pipeline.run(&disk, &mut Silent)?;
    println!("{}: F/3nt {:.2e}, valid: {}", flat.solver, flat.metrics(&disk)?.f, flat.certificate.valid());

    let unwrap = Unwrap { pipeline, ..Unwrap::default() };
    let (points, faces) = octahedron();
    let closed = abf::mesh::TriMesh::new(points.map(Into::into).to_vec(), &faces)?;
    for chart in unwrap.run(&closed, &SurfaceHints::default(), &mut Silent)?.charts {
        println!("{}: {} faces, L2 {:.3}", chart.solver, chart.faces.len(), chart.metrics.stretch_l2);
    }
    Ok(())
}

fn octahedron() -> ([[f64; 3]; 6], [[usize; 3]; 8]) {
    let points = [[1., 0., 0.], [0., 1., 0.], [-1., 0., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    (points, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]])
}
