//! Hierarchical solvers beside those of the fine mesh.

#![allow(clippy::print_stdout, reason = "the distances are the point")]

use abf::mesh::TriMesh;
use abf::{
    AbfNewton, Cancelled, Event, FlattenError, Flattening, Hierarchical, LinAbf, Observer, Pipeline, Silent, Solver,
    SolverKind, Termination, Verdict,
};
use abf_shapes::Shape;

fn flat(mesh: &TriMesh, solver: impl Into<Solver>) -> Flattening {
    Pipeline { solver: solver.into(), ..Pipeline::default() }.run(mesh, &mut Silent).expect("a result")
}

fn f(mesh: &TriMesh, flat: &Flattening) -> f64 {
    flat.metrics(mesh).expect("the same mesh").f
}

#[test]
fn a_carried_drawing_is_certified_and_not_much_worse_than_the_optimum() {
    for shape in [Shape::BumpySheet, Shape::Mask, Shape::Hemisphere, Shape::Letter2] {
        let mesh = shape.mesh(8000);
        let (carried, optimum) = (flat(&mesh, Hierarchical::habf_plus_plus()), flat(&mesh, AbfNewton::abf_plus_plus()));
        assert!(carried.is_certified() && carried.solver == SolverKind::HabfPlusPlus, "{shape:?}");
        let hierarchy = carried.hierarchy.as_ref().expect("levels");
        assert_eq!(hierarchy.fallback, None, "{shape:?}");
        assert_eq!(hierarchy.levels.last().map(|level| level.triangles), Some(mesh.face_count()));
        assert!(carried.layout.kind.is_none() && carried.layout.scaled);
        let (of_carried, of_optimum) = (f(&mesh, &carried), f(&mesh, &optimum));
        assert!(of_carried <= 3.3 * of_optimum, "{shape:?}: {of_carried} {of_optimum}");
    }
}

#[test]
fn hierarchical_linabf_meets_the_tolerance_with_the_distortion_of_linabf() {
    for shape in [Shape::BumpySheet, Shape::Mask, Shape::SpikyField] {
        let mesh = shape.mesh(8000);
        let (ours, plain) = (flat(&mesh, Hierarchical::hlinabf()), flat(&mesh, LinAbf::default()));
        assert!(ours.is_certified() && ours.termination == Termination::Converged, "{shape:?}");
        assert!(ours.solution.as_ref().is_some_and(|solution| solution.constraint_residual() <= 1e-8));
        let (of_ours, of_plain) = (f(&mesh, &ours), f(&mesh, &plain));
        assert!((of_ours / of_plain - 1.0).abs() < 0.01, "{shape:?}: {of_ours} {of_plain}");
        let [ours, plain] = [&ours, &plain].map(|flat| flat.solution.as_ref().expect("angles").angles());
        let square: f64 = ours.iter().zip(plain).map(|(x, y)| (x - y).powi(2)).sum();
        let rms = (square / ours.len() as f64).sqrt();
        println!("{shape:?}: F {of_ours:.4e} beside {of_plain:.4e}, angles {rms:.2e} rad apart");
        assert!(rms < 0.02, "{shape:?}: {rms}");
    }
}

#[test]
fn a_mesh_below_the_least_size_has_the_result_of_the_coarse_solver() {
    let mesh = Shape::BumpySheet.mesh(500);
    for (hierarchical, plain) in [
        (Hierarchical::habf_plus_plus(), AbfNewton::abf_plus_plus().into()),
        (Hierarchical::hlinabf(), LinAbf::default().into()),
    ] {
        let (whole, plain): (_, Flattening) = (flat(&mesh, hierarchical), flat(&mesh, Solver::clone(&plain)));
        assert_eq!(whole.uv, plain.uv);
        assert_eq!(whole.hierarchy, Some(abf::HierarchyReport::default()));
    }
}

/// Answers so from a question on, counted from 1.
struct AnswerFrom(usize, Verdict);

impl Observer for AnswerFrom {
    fn observe(&mut self, _: Event<'_>) -> Verdict {
        self.0 = self.0.saturating_sub(1);
        if self.0 == 0 { self.1 } else { Verdict::Continue }
    }
}

#[test]
fn levels_can_be_aborted_and_stopped() {
    let mesh = Shape::BumpySheet.mesh(3000);
    for hierarchical in [Hierarchical::habf_plus_plus(), Hierarchical::hlinabf()] {
        let solver: Solver = Hierarchical { least_triangles: 300, ..hierarchical }.into();
        let pipeline = Pipeline { solver, ..Pipeline::default() };
        for question in (2..120).step_by(7) {
            match pipeline.run(&mesh, &mut AnswerFrom(question, Verdict::Abort)) {
                Err(error) => assert_eq!(error, FlattenError::Cancelled(Cancelled)),
                Ok(_) => assert!(question > 30, "question {question} was never asked"),
            }
            if let Ok(flat) = pipeline.run(&mesh, &mut AnswerFrom(question, Verdict::Stop)) {
                assert!(flat.uv.points().iter().all(|p| p.x.is_finite() && p.y.is_finite()));
            }
        }
    }
}
