//! MINRES and Uzawa, each against a direct solve of the same steps, and as solvers.

use abf_constraints::{AngleProblem, GuessSettings, WheelForm};
use abf_control::{Event, Fallback, Observer, Silent, StopCriteria, Termination, Verdict, Watch};
use abf_mesh::Topology;
use abf_shapes::Shape;
use abf_solve_core::{
    AngleSolution, AngleSolver, DirectStep, Hessian, InnerTolerance, IterativeSettings, KktStep, KktSystem, KktVector,
    NewtonSettings, PreconditionerKind, Reduction, SolveError, StepError, StepReport,
};
use abf_solve_minres::{Minres, MinresStep};
use abf_solve_uzawa::{Uzawa, UzawaStep};

const REDUCTIONS: [Reduction; 2] = [Reduction::None, Reduction::Triangles];
const PRECONDITIONERS: [PreconditionerKind; 3] =
    [PreconditionerKind::None, PreconditionerKind::Jacobi, PreconditionerKind::Block];
/// Shapes on which Newton converges from the initial guess.
const SHAPES: [(Shape, usize); 3] = [(Shape::BumpySheet, 600), (Shape::LetterX, 1_000), (Shape::SpikyField, 800)];

fn every_setting() -> impl Iterator<Item = IterativeSettings> {
    let settings = |reduction, preconditioner| IterativeSettings { reduction, preconditioner, ..Default::default() };
    REDUCTIONS.into_iter().flat_map(move |r| PRECONDITIONERS.map(|p| settings(r, p)))
}

fn with_problem<R>(shape: Shape, triangles: usize, run: impl FnOnce(&AngleProblem<'_>) -> R) -> R {
    let mesh = shape.mesh(triangles);
    let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
    run(&AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk"))
}

fn exact_newton() -> NewtonSettings {
    NewtonSettings { hessian: Hessian::Exact, ..NewtonSettings::default() }
}

fn steps(problem: &AngleProblem<'_>, settings: IterativeSettings) -> [(&'static str, Box<dyn KktStep>); 2] {
    let minres = MinresStep::new(problem.topology(), problem.rows(), settings).expect("fits");
    let uzawa = UzawaStep::new(problem.topology(), problem.rows(), settings).expect("fits");
    [("minres", Box::new(minres)), ("uzawa", Box::new(uzawa))]
}

fn solvers(iterative: IterativeSettings) -> [Box<dyn AngleSolver>; 2] {
    [Box::new(Minres { iterative, ..Minres::default() }), Box::new(Uzawa { iterative, ..Uzawa::default() })]
}

fn direct(problem: &AngleProblem<'_>) -> AngleSolution {
    let mut step = DirectStep::new(problem.topology(), problem.rows()).expect("fits");
    exact_newton().solve(problem, &StopCriteria::default(), &mut Silent, &mut step).expect("angles")
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |max, (x, y)| (x - y).abs().max(max))
}

/// Solves every step twice and compares. The direct step is checked against both block rows of its
/// system where it is defined.
struct Compared<'s> {
    direct: DirectStep,
    tested: &'s mut dyn KktStep,
    what: String,
}

impl KktStep for Compared<'_> {
    fn step(
        &mut self,
        kkt: &KktSystem<'_>,
        tolerance: f64,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<StepReport, StepError> {
        let report = self.tested.step(kkt, tolerance, watch, out)?;
        assert!(report.inner_converged && report.relative_residual <= 2.0 * tolerance, "{}: {report:?}", self.what);
        let solved = match report.fallback {
            Some(Fallback::NegativeCurvature) => KktSystem { lambda: kkt.gauss_newton, ..*kkt },
            _ => *kkt,
        };
        let mut expected = KktVector::default();
        self.direct.step(&solved, tolerance, watch, &mut expected)?;
        let size = |v: &[f64]| v.iter().fold(1.0_f64, |max, x| max.max(x.abs()));
        let (delta, multipliers) = (apart(&out.delta, &expected.delta), apart(&out.multipliers, &expected.multipliers));
        assert!(delta <= 1e-8 * size(&expected.delta), "{}: delta {delta:e}", self.what);
        assert!(multipliers <= 1e-8 * size(&expected.multipliers), "{}: multipliers {multipliers:e}", self.what);
        Ok(report)
    }
}

#[test]
fn every_step_is_the_one_a_direct_solve_takes() {
    for (shape, triangles) in [(Shape::BumpySheet, 400), (Shape::SpikyField, 400)] {
        with_problem(shape, triangles, |problem| {
            for settings in every_setting() {
                for (name, mut tested) in steps(problem, settings) {
                    let what = format!("{name} {} {} on {shape}", settings.reduction, settings.preconditioner);
                    let direct = DirectStep::new(problem.topology(), problem.rows()).expect("fits");
                    let mut compared = Compared { direct, tested: tested.as_mut(), what };
                    let newton = NewtonSettings { inner_tolerance: InnerTolerance::Fixed(1e-12), ..exact_newton() };
                    let solution = newton.solve(problem, &StopCriteria::default(), &mut Silent, &mut compared);
                    assert!(solution.expect("angles").iterations() > 1);
                }
            }
        });
    }
}

#[test]
fn all_settings_converge_to_the_angles_of_the_direct_solver() {
    for (shape, triangles) in SHAPES {
        with_problem(shape, triangles, |problem| {
            let expected = direct(problem);
            for settings in every_setting() {
                for solver in solvers(settings) {
                    let what = format!("{} {settings:?} on {shape}", solver.name());
                    let solution = solver.solve(problem, &StopCriteria::default(), &mut Silent).expect("angles");
                    assert_eq!(solution.termination(), Termination::Converged, "{what}");
                    assert!(solution.constraint_residual() <= 1e-8, "{what}");
                    let difference = apart(solution.angles(), expected.angles());
                    assert!(difference < 1e-6, "{what}: {difference:e}");
                    assert!(solution.history().iter().all(|r| r.inner_estimate.is_some()), "{what}");
                }
            }
        });
    }
}

#[test]
fn the_product_wheel_with_two_w_is_solved_too() {
    with_problem(Shape::BumpySheet, 600, |problem| {
        let newton = NewtonSettings { wheel: WheelForm::Product, ..NewtonSettings::default() };
        let expected = direct(problem);
        for reduction in REDUCTIONS {
            let iterative = IterativeSettings { reduction, ..IterativeSettings::default() };
            for solver in [&Minres { newton, iterative } as &dyn AngleSolver, &Uzawa { newton, iterative }] {
                let solution = solver.solve(problem, &StopCriteria::default(), &mut Silent).expect("angles");
                assert_eq!(solution.termination(), Termination::Converged);
                assert!(apart(solution.angles(), expected.angles()) < 1e-6);
            }
        }
    });
}

#[test]
fn the_exact_hessian_of_the_product_wheel_is_refused() {
    with_problem(Shape::BumpySheet, 60, |problem| {
        let newton = NewtonSettings { wheel: WheelForm::Product, ..exact_newton() };
        let iterative = IterativeSettings::default();
        for solver in [&Minres { newton, iterative } as &dyn AngleSolver, &Uzawa { newton, iterative }] {
            let refused = solver.solve(problem, &StopCriteria::default(), &mut Silent);
            assert!(matches!(refused, Err(SolveError::Unsupported(_))));
        }
    });
}

#[test]
fn as_published_the_letters_converge() {
    for letter in [Shape::Letter2, Shape::LetterV, Shape::LetterX] {
        with_problem(letter, 500, |problem| {
            for solver in solvers(IterativeSettings::as_published()) {
                let solution = solver.solve(problem, &StopCriteria::default(), &mut Silent).expect("angles");
                assert_eq!(solution.termination(), Termination::Converged, "{} on {letter}", solver.name());
            }
        });
    }
}

/// Every step of a solve to 1e-10, with the factors of the first while they last.
#[test]
fn blocks_precondition_at_any_size() {
    for (shape, triangles) in [(Shape::Mask, 1_000), (Shape::Mask, 20_000), (Shape::SpikyField, 20_000)] {
        with_problem(shape, triangles, |problem| {
            let newton = NewtonSettings { inner_tolerance: InnerTolerance::Fixed(1e-10), ..exact_newton() };
            for reduction in REDUCTIONS {
                let iterative = IterativeSettings { reduction, ..IterativeSettings::default() };
                for solver in [&Minres { newton, iterative } as &dyn AngleSolver, &Uzawa { newton, iterative }] {
                    let solution = solver.solve(problem, &StopCriteria::default(), &mut Silent).expect("angles");
                    let most = solution.history().iter().map(|r| r.inner_iterations).max().expect("an iteration");
                    assert!(most <= 60, "{} {reduction} on {triangles} triangles of {shape}: {most}", solver.name());
                }
            }
        });
    }
}

/// Makes Λ negative at one corner of every fifth triangle.
struct Bent<'s>(&'s mut dyn KktStep);

impl KktStep for Bent<'_> {
    fn step(
        &mut self,
        kkt: &KktSystem<'_>,
        tolerance: f64,
        watch: &mut Watch<'_>,
        out: &mut KktVector,
    ) -> Result<StepReport, StepError> {
        let mut lambda = kkt.gauss_newton.to_vec();
        lambda.chunks_exact_mut(3).step_by(5).for_each(|l| l[1] = -0.2 * l[0].min(l[2]));
        self.0.step(&KktSystem { lambda: &lambda, ..*kkt }, tolerance, watch, out)
    }
}

/// `M` then has as many negative eigenvalues as `Λ` has negative entries, 400 here.
#[test]
fn blocks_precondition_m_though_it_is_indefinite() {
    with_problem(Shape::BumpySheet, 2_000, |problem| {
        let newton = NewtonSettings { inner_tolerance: InnerTolerance::Fixed(1e-10), ..NewtonSettings::default() };
        let stop = StopCriteria { max_iterations: 1, ..StopCriteria::default() };
        for reduction in REDUCTIONS {
            let settings = IterativeSettings { reduction, ..IterativeSettings::default() };
            let mut minres = MinresStep::new(problem.topology(), problem.rows(), settings).expect("fits");
            let solution = newton.solve(problem, &stop, &mut Silent, &mut Bent(&mut minres)).expect("angles");
            let first = solution.history()[0];
            assert!(first.inner_iterations <= 60 && first.inner_residual <= 2e-10, "{reduction}: {first:?}");
        }
    });
}

/// Large enough for every parallel path: products, sums and the two blocks side by side.
#[test]
fn results_have_the_same_bits_for_one_and_two_threads() {
    with_problem(Shape::Mask, 14_000, |problem| {
        let stop = StopCriteria { max_iterations: 2, ..StopCriteria::default() };
        for preconditioner in [PreconditionerKind::Jacobi, PreconditionerKind::Block] {
            for reduction in REDUCTIONS {
                let settings = IterativeSettings { reduction, preconditioner, ..IterativeSettings::default() };
                for solver in solvers(settings) {
                    let with_threads = |threads: usize| {
                        let solve = || solver.solve(problem, &stop, &mut Silent);
                        abf_parallel::with_threads(threads, solve).expect("threads").expect("angles")
                    };
                    assert_eq!(with_threads(1), with_threads(2), "{} {settings:?}", solver.name());
                }
            }
        }
    });
}

/// Cancels at one inner iteration, and counts how many are reported after that.
struct CancelAt {
    inner: usize,
    after: usize,
}

impl Observer for CancelAt {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        match event {
            Event::Inner { inner, .. } if inner >= self.inner => {
                self.after += 1;
                Verdict::Stop
            }
            _ => Verdict::Continue,
        }
    }
}

#[test]
fn an_inner_iteration_can_be_cancelled_and_is_the_last() {
    with_problem(Shape::BumpySheet, 600, |problem| {
        for settings in every_setting() {
            for solver in solvers(settings) {
                let mut observer = CancelAt { inner: 2, after: 0 };
                let solution = solver.solve(problem, &StopCriteria::default(), &mut observer).expect("angles");
                assert_eq!(solution.termination(), Termination::Cancelled);
                assert_eq!((observer.after, solution.iterations()), (1, 0), "{} {settings:?}", solver.name());
                assert_eq!(solution.angles(), problem.initial_guess());
            }
        }
    });
}

#[test]
fn too_few_inner_iterations_are_never_called_converged() {
    for (shape, triangles) in [(Shape::LetterX, 1_000), (Shape::SpikyField, 800)] {
        with_problem(shape, triangles, |problem| {
            for max_inner_iterations in [1, 5, 20] {
                let settings = IterativeSettings { max_inner_iterations, ..IterativeSettings::as_published() };
                for solver in solvers(settings) {
                    let solution = solver.solve(problem, &StopCriteria::default(), &mut Silent).expect("angles");
                    let what = format!("{} {max_inner_iterations} on {shape}", solver.name());
                    assert!(!solution.termination().is_as_asked(), "{what}: {}", solution.termination());
                    assert!(
                        solution.history().iter().all(|r| r.inner_iterations <= 2 * max_inner_iterations),
                        "{what}"
                    );
                    assert_eq!(solution.angles_out_of_range(), 0, "{what}");
                }
            }
        });
    }
}
