//! The interior point method on whole shapes.

use abf_constraints::{AngleProblem, GuessSettings};
use abf_control::{Event, Observer, SettingError, Silent, StopCriteria, Termination, Verdict};
use abf_mesh::{Point3, Topology, TriMesh, VertexId};
use abf_reconstruct::{LayoutKind, LayoutSettings, layout};
use abf_shapes::Shape;
use abf_solve_abf_newton::AbfNewton;
use abf_solve_barrier::Barrier;
use abf_solve_core::{AngleSolution, AngleSolver, Hessian, SolveError};
use std::time::Duration;

fn with_problem<T>(mesh: &TriMesh, body: impl FnOnce(&AngleProblem<'_>) -> T) -> T {
    let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
    let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
    body(&problem)
}

fn solve(solver: &dyn AngleSolver, mesh: &TriMesh) -> AngleSolution {
    with_problem(mesh, |problem| solver.solve(problem, &StopCriteria::default(), &mut Silent)).expect("angles")
}

fn apart(a: &AngleSolution, b: &AngleSolution) -> f64 {
    a.angles().iter().zip(b.angles()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

fn flips(mesh: &TriMesh, angles: &[f64], kind: LayoutKind) -> usize {
    let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
    let settings = LayoutSettings { kind, ..LayoutSettings::default() };
    let map = layout(mesh, &topology, angles, &settings).expect("a layout");
    let metrics = abf_metrics::measure(mesh, &map.uv).expect("metrics");
    metrics.certificate.flips + metrics.certificate.collapsed
}

/// The shape, eight times as high: angles that want to leave (0, π).
fn towering(shape: Shape, triangles: usize) -> TriMesh {
    let mesh = shape.mesh(triangles);
    let positions = mesh.positions().iter().map(|p| Point3::new(p.x, p.y, 8.0 * p.z)).collect();
    let faces: Vec<[usize; 3]> = mesh.faces().iter().map(|f| f.map(VertexId::index)).collect();
    TriMesh::new(positions, &faces).expect("a mesh")
}

#[test]
fn a_vanishing_floor_leads_to_the_optimum_of_abf() {
    let barrier = Barrier { barrier_floor: 1e-9, smallest_angle: 0.0, ..Barrier::default() };
    for shape in [Shape::BumpySheet, Shape::LetterX, Shape::Hemisphere, Shape::SpikyField, Shape::Obtuse] {
        let mesh = shape.mesh(600);
        let (reference, solution) = (solve(&AbfNewton::fixed_target(), &mesh), solve(&barrier, &mesh));
        assert_eq!(solution.termination(), Termination::Converged, "{shape}");
        assert!(apart(&reference, &solution) < 1e-6, "{shape}: {:e}", apart(&reference, &solution));
    }
}

#[test]
fn both_hessians_lead_to_the_same_angles() {
    let mesh = Shape::Mask.mesh(800);
    let plain = solve(&Barrier { hessian: Hessian::GaussNewton, ..Barrier::default() }, &mesh);
    let exact = solve(&Barrier::default(), &mesh);
    assert_eq!((plain.termination(), exact.termination()), (Termination::Converged, Termination::Converged));
    assert!(exact.iterations() <= plain.iterations());
    assert!(apart(&plain, &exact) < 1e-6, "{:e}", apart(&plain, &exact));
}

#[test]
fn shapes_whose_angles_leave_by_other_methods_are_laid_out_without_flips() {
    for shape in [Shape::SpikyField, Shape::BumpySheet] {
        let mesh = towering(shape, 600);
        let other = solve(&AbfNewton::fixed_target(), &mesh);
        assert_ne!(other.termination(), Termination::Converged, "{shape} is too easy for this test");
        let solution = solve(&Barrier::default(), &mesh);
        assert_eq!(solution.termination(), Termination::Converged, "{shape}");
        assert_eq!(solution.angles_out_of_range(), 0, "{shape}");
        for kind in [LayoutKind::Tree, LayoutKind::LeastSquares] {
            assert_eq!(flips(&mesh, solution.angles(), kind), 0, "{shape} by {kind}");
        }
    }
}

#[test]
fn the_barrier_stays_up_where_angles_would_vanish() {
    let mesh = towering(Shape::SpikyField, 600);
    let smallest = |smallest_angle: f64| {
        let solution = solve(&Barrier { barrier_floor: 1e-6, smallest_angle, ..Barrier::default() }, &mesh);
        (solution.termination(), solution.angles().iter().copied().fold(f64::INFINITY, f64::min))
    };
    let (kept, vanishing) = (smallest(1e-3), smallest(0.0));
    assert_eq!(kept.0, Termination::Converged);
    assert!(kept.1 > 1e-4 && vanishing.1 < 1e-5, "{kept:?} {vanishing:?}");
}

#[test]
fn every_shape_converges() {
    for shape in Shape::ALL {
        let solution = solve(&Barrier::default(), &shape.mesh(600));
        assert_eq!(solution.termination(), Termination::Converged, "{shape}");
        assert!(solution.constraint_residual() <= StopCriteria::default().tolerance, "{shape}");
        let last = solution.history().last().expect("a step");
        assert!(last.step_length == 1.0 && last.step <= StopCriteria::default().step_tolerance, "{shape}");
        assert_eq!(last.energy, Some(solution.energy()), "{shape}");
    }
}

#[test]
fn the_angles_of_a_result_are_a_warm_start() {
    let mesh = towering(Shape::SpikyField, 600);
    let barrier = Barrier { barrier_start: 1e-3, ..Barrier::default() };
    with_problem(&mesh, |problem| {
        let stop = StopCriteria::default();
        let cold = Barrier::default().solve(problem, &stop, &mut Silent).expect("angles");
        let warm = barrier.solve_from(problem, cold.angles(), &stop, &mut Silent).expect("angles");
        assert_eq!(warm.termination(), Termination::Converged);
        assert!(warm.iterations() < cold.iterations(), "{} {}", warm.iterations(), cold.iterations());
        assert!(apart(&cold, &warm) < 1e-6);
        let short = barrier.solve_from(problem, &[1.0; 4], &stop, &mut Silent).unwrap_err();
        assert!(matches!(short, SolveError::Unsupported(_)));
    });
}

#[test]
fn the_same_input_gives_the_same_bits() {
    let mesh = towering(Shape::BumpySheet, 600);
    let (a, b) = (solve(&Barrier::default(), &mesh), solve(&Barrier::default(), &mesh));
    assert!(a.angles().iter().zip(b.angles()).all(|(x, y)| x.to_bits() == y.to_bits()));
    assert_eq!(a, b);
}

/// Cancels at the n-th event, and counts what is still reported afterwards.
struct CancelAt {
    events: usize,
    last: usize,
}

impl Observer for CancelAt {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        // What asks inside a step can be aborted there, and is not stopped there.
        self.events += usize::from(!matches!(event, Event::Working));
        if self.events >= self.last { Verdict::Stop } else { Verdict::Continue }
    }
}

#[test]
fn cancelling_returns_at_once_with_angles_inside() {
    let mesh = towering(Shape::SpikyField, 600);
    for last in [1, 2, 5, 8] {
        let mut observer = CancelAt { events: 0, last };
        let solution = with_problem(&mesh, |problem| {
            Barrier::default().solve(problem, &StopCriteria::default(), &mut observer).expect("angles")
        });
        assert_eq!(solution.termination(), Termination::Cancelled);
        assert_eq!(observer.events, last, "went on after being cancelled");
        assert_eq!(solution.angles_out_of_range(), 0);
    }
}

#[test]
fn limits_of_time_and_of_iterations_are_obeyed() {
    let mesh = towering(Shape::SpikyField, 600);
    let with = |stop: StopCriteria| {
        with_problem(&mesh, |problem| Barrier::default().solve(problem, &stop, &mut Silent)).expect("angles")
    };
    let none = with(StopCriteria { time_limit: Some(Duration::ZERO), ..StopCriteria::default() });
    assert_eq!((none.termination(), none.iterations()), (Termination::TimeLimit, 0));
    let two = with(StopCriteria { max_iterations: 2, ..StopCriteria::default() });
    assert_eq!((two.termination(), two.iterations()), (Termination::MaxIterations, 2));
    let least = two.history().iter().map(|r| r.constraint_residual).fold(f64::INFINITY, f64::min);
    assert_eq!(two.constraint_residual(), least, "the best angles so far");
    let one = with(StopCriteria { max_iterations: 1, ..StopCriteria::default() });
    assert_eq!((one.termination(), one.iterations()), (Termination::MaxIterations, 1));
}

#[test]
fn settings_out_of_range_are_refused() {
    let mesh = Shape::Obtuse.mesh(3);
    let refused = |barrier: Barrier, stop: StopCriteria| {
        with_problem(&mesh, |problem| barrier.solve(problem, &stop, &mut Silent)).unwrap_err()
    };
    let error = refused(Barrier { barrier_floor: -1.0, ..Barrier::default() }, StopCriteria::default());
    assert!(matches!(error, SolveError::Setting(SettingError { name: "barrier_floor", .. })));
    let error = refused(Barrier::default(), StopCriteria { tolerance: 0.0, ..StopCriteria::default() });
    assert!(matches!(error, SolveError::Setting(SettingError { name: "tolerance", .. })));
}
