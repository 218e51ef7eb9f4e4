//! What every solver must do, whichever it is.

use abf::constraints::AngleProblem;
use abf::mesh::{Topology, TriMesh};
use abf::{
    AngleSolution, AngleSolver, Barrier, Event, GuessSettings, IterativeSettings, Minres, Observer, Silent, Solver,
    SolverKind, StopCriteria, Termination, Uzawa, Verdict,
};
use abf_shapes::Shape;
use proptest::prelude::*;
use std::time::{Duration, Instant};

/// Every solver that solves for angles, with its default settings; but the barrier all but gone where the interior
/// point ends, which else stays in its optimum.
fn solvers() -> Vec<Box<dyn AngleSolver>> {
    let solvers = Solver::all().into_iter().filter(|solver| solver.angle_solver().is_some());
    solvers.map(|solver| Box::new(OfAngles(without_a_floor(solver))) as Box<dyn AngleSolver>).collect()
}

fn without_a_floor(mut solver: Solver) -> Solver {
    if let Some(barrier) = solver.parts_mut().barrier {
        *barrier = Barrier { barrier_floor: 1e-11, smallest_angle: 0.0, ..*barrier };
    }
    solver
}

/// A solver of angles as [`Solver`] has it.
struct OfAngles(Solver);

impl OfAngles {
    fn angle_solver(&self) -> &dyn AngleSolver {
        self.0.angle_solver().expect("a solver of angles")
    }
}

impl AngleSolver for OfAngles {
    fn name(&self) -> &'static str {
        self.angle_solver().name()
    }

    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<AngleSolution, abf::solve_core::SolveError> {
        self.angle_solver().solve(problem, stop, observer)
    }
}

fn with_problem<T>(mesh: &TriMesh, body: impl FnOnce(&AngleProblem<'_>) -> T) -> T {
    let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
    let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
    body(&problem)
}

fn solve(solver: &dyn AngleSolver, mesh: &TriMesh) -> AngleSolution {
    with_problem(mesh, |problem| solver.solve(problem, &StopCriteria::default(), &mut Silent)).expect("angles")
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

#[test]
fn names_are_those_on_the_command_line() {
    for solver in solvers() {
        assert_eq!(solver.name().parse::<SolverKind>().expect("a solver").name(), solver.name());
    }
}

#[test]
fn a_developable_sheet_keeps_its_angles() {
    let mesh = Shape::FoldedSheet.mesh(400);
    for solver in solvers() {
        let solution = solve(solver.as_ref(), &mesh);
        assert_eq!(solution.termination(), Termination::Converged, "{}", solver.name());
        assert!(apart(solution.angles(), &mesh.corner_angles()) < 1e-10, "{}", solver.name());
    }
}

#[test]
fn every_solver_converges_on_ordinary_shapes() {
    for shape in [Shape::Hemisphere, Shape::BumpySheet, Shape::LetterV, Shape::Pyramid, Shape::Obtuse] {
        let mesh = shape.mesh(500);
        for solver in solvers() {
            let solution = solve(solver.as_ref(), &mesh);
            assert_eq!(solution.termination(), Termination::Converged, "{} on {shape}", solver.name());
            assert!(solution.constraint_residual() <= 1e-8, "{} on {shape}", solver.name());
            assert_eq!(solution.angles_out_of_range(), 0, "{} on {shape}", solver.name());
            assert_eq!(solution.history().len(), solution.iterations());
        }
    }
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let mesh = Shape::Mask.mesh(3000);
    let with_threads = |threads: usize, solver: &dyn AngleSolver| {
        abf_parallel::with_threads(threads, || solve(solver, &mesh)).expect("threads")
    };
    for solver in solvers() {
        let (one, two) = (with_threads(1, solver.as_ref()), with_threads(2, solver.as_ref()));
        let same = one.angles().iter().zip(two.angles()).all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same, "{}", solver.name());
    }
}

/// Cancels at the first event of a kind and counts what is still reported afterwards.
struct CancelAtInner {
    cancelled: bool,
    events_after: usize,
}

impl Observer for CancelAtInner {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        self.events_after += usize::from(self.cancelled);
        self.cancelled |= matches!(event, Event::Inner { .. });
        if self.cancelled { Verdict::Stop } else { Verdict::Continue }
    }
}

#[test]
fn cancelling_returns_at_once_with_measured_angles() {
    let mesh = Shape::Mask.mesh(2000);
    for solver in solvers() {
        let mut observer = CancelAtInner { cancelled: false, events_after: 0 };
        let solution = with_problem(&mesh, |problem| solver.solve(problem, &StopCriteria::default(), &mut observer))
            .expect("angles");
        assert_eq!(solution.termination(), Termination::Cancelled, "{}", solver.name());
        assert_eq!(observer.events_after, 0, "{} went on after being cancelled", solver.name());
        assert_eq!(solution.angles().len(), 3 * mesh.face_count());
    }
}

#[test]
fn a_time_limit_ends_the_solve_and_says_so() {
    let mesh = Shape::Mask.mesh(6000);
    let stop = StopCriteria { time_limit: Some(Duration::ZERO), ..StopCriteria::default() };
    for solver in solvers() {
        let started = Instant::now();
        let solution = with_problem(&mesh, |problem| solver.solve(problem, &stop, &mut Silent)).expect("angles");
        assert_eq!(solution.termination(), Termination::TimeLimit, "{} after {:?}", solver.name(), started.elapsed());
    }
}

#[test]
fn an_iteration_limit_is_obeyed() {
    let mesh = Shape::SpikyField.mesh(800);
    // A tolerance nobody meets.
    let stop = StopCriteria { max_iterations: 2, tolerance: 1e-30, ..StopCriteria::default() };
    for solver in solvers() {
        let solution = with_problem(&mesh, |problem| solver.solve(problem, &stop, &mut Silent)).expect("angles");
        assert_eq!(solution.termination(), Termination::MaxIterations, "{}", solver.name());
        assert_eq!(solution.iterations(), 2, "{}", solver.name());
    }
}

#[test]
fn a_single_iteration_returns_the_angles_it_led_to() {
    let mesh = Shape::SpikyField.mesh(800);
    let stop = StopCriteria { max_iterations: 1, ..StopCriteria::default() };
    for solver in solvers() {
        let solution = with_problem(&mesh, |problem| solver.solve(problem, &stop, &mut Silent)).expect("angles");
        let last = solution.history().last().expect("an iteration");
        assert_eq!(solution.termination(), Termination::MaxIterations, "{}", solver.name());
        assert_eq!(solution.constraint_residual(), last.constraint_residual, "{}", solver.name());
    }
}

#[test]
fn a_single_iteration_whose_solve_broke_off_is_not_what_was_asked() {
    let mesh = Shape::SpikyField.mesh(800);
    let stop = StopCriteria { max_iterations: 1, ..StopCriteria::default() };
    let iterative = IterativeSettings { max_inner_iterations: 5, ..IterativeSettings::as_published() };
    let uzawa = Uzawa { iterative, ..Uzawa::default() };
    let minres = Minres { iterative, ..Minres::default() };
    for solver in [&uzawa as &dyn AngleSolver, &minres] {
        let solution = with_problem(&mesh, |problem| solver.solve(problem, &stop, &mut Silent)).expect("angles");
        assert!(!solution.termination().is_as_asked(), "{}: {}", solver.name(), solution.termination());
    }
}

#[test]
fn settings_out_of_range_are_refused_by_every_solver() {
    let mesh = Shape::Obtuse.mesh(3);
    let stop = StopCriteria { tolerance: f64::NAN, ..StopCriteria::default() };
    for solver in solvers() {
        let result = with_problem(&mesh, |problem| solver.solve(problem, &stop, &mut Silent));
        assert!(result.is_err(), "{}", solver.name());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// All solvers with a fixed target minimise the same energy, so where the problem is easy they
    /// reach the same angles; LinABF moves its target, so it only comes close.
    #[test]
    fn solvers_agree_where_the_problem_is_easy(
        shape in proptest::sample::select(vec![Shape::Hemisphere, Shape::BumpySheet, Shape::LetterX, Shape::WavySaddle]),
        triangles in 200_usize..900,
    ) {
        let mesh = shape.mesh(triangles);
        let reference = solve(solvers().iter().find(|s| s.name() == "abf-fixed-target").expect("there is one").as_ref(), &mesh);
        for solver in solvers().iter().filter(|s| s.name() != "linabf") {
            let solution = solve(solver.as_ref(), &mesh);
            prop_assert_eq!(solution.termination(), Termination::Converged, "{}", solver.name());
            let difference = apart(solution.angles(), reference.angles());
            prop_assert!(difference < 1e-6, "{}: {difference:e}", solver.name());
        }
    }
}
