//! [`Solver::Auto`]: one solver after the other, until a result is certified.
//!
//! A rung is certified when its UVs are valid as they will be written *and* its solver ended as asked. The cheap rungs
//! come first. LinABF gives up early where it is hopeless. What follows it is the descent, which cannot leave the valid
//! drawings: where LinABF has no success the other solvers for angles seldom have any, and take longer. They come last, for
//! meshes on which the descent stalls or finds no start. What is valid and not converged is kept, and the ladder goes on. When nothing is certified the best there is comes out: valid before
//! not valid, then fewer bad triangles, then the smaller F. With conditions on the boundary the rungs that do not keep
//! them are left out, and the smaller violation decides before F.

use super::boundary::MET;
use super::check_memory;
use super::hearing::Hearing;
use super::task::{Given, Single, Task};
use crate::settings::{Ladder, Solver, SolverKind};
use crate::{FlattenError, Flattening, RungReport};
use abf_control::{Cancelled, Event, IterationRecord, Observer, StopCriteria, Termination, TimeBudget, Verdict};
use abf_embed::{EmbedError, vertex_points};
use abf_mesh::{Point2, TriMesh};
use abf_reconstruct::LayoutKind;
use abf_solve_core::AngleSolution;
use abf_solve_linabf::Passes;
use std::cmp::Ordering;

/// One solver of the ladder.
struct LadderRung<'l> {
    solver: Solver,
    method: Single<'l>,
    /// At most so many iterations, whatever was asked for.
    most_iterations: usize,
}

/// LinABF is hopeless when a pass leaves the constraints off by more than this, rad: the number of the pass, the limit.
///
/// Of the disks measured, those on which it converges have at most 20.5 after the first pass and 5.5 after the third. Those
/// above the limits stall: 35 and 38 after the first, 12 and more after the third.
const HOPELESS: [(usize, f64); 2] = [(1, 30.0), (3, 10.0)];

/// Steps with a fixed target that converge at all take about a dozen; this leaves room.
const MOST_FIXED_TARGET_STEPS: usize = 25;

/// The ladder, from the bottom. LinABF stops by itself when its passes no longer help.
fn rungs(ladder: &Ladder) -> [LadderRung<'_>; 4] {
    let Ladder { linabf, descent, newton, barrier } = ladder;
    let any = usize::MAX;
    [
        LadderRung { solver: (*linabf).into(), method: Single::Angles(linabf), most_iterations: any },
        LadderRung { solver: (*descent).into(), method: Single::Positions(descent), most_iterations: any },
        LadderRung {
            solver: (*newton).into(),
            method: Single::Angles(newton),
            most_iterations: MOST_FIXED_TARGET_STEPS,
        },
        LadderRung { solver: (*barrier).into(), method: Single::Angles(barrier), most_iterations: any },
    ]
}

/// Climbs until a rung is certified.
pub(super) fn climb(
    given: &Given<'_>,
    ladder: &Ladder,
    observer: &mut dyn Observer,
) -> Result<Flattening, FlattenError> {
    let budget = TimeBudget::start(&given.pipeline.stop);
    let observer = &mut Hopes { observer: Hearing::new(observer), may_be_hopeless: false, is_hopeless: false };
    let mut climb = Climb { mesh: given.original, best: None, rungs: Vec::new(), first_error: None };
    for LadderRung { solver, method, most_iterations } in rungs(ladder) {
        if given.problem.boundary().is_some() && !method.keeps_boundary() {
            continue;
        }
        let kind = solver.kind();
        let interruption = climb.interruption(&budget, kind, observer);
        observer.observer.aborted()?;
        if let Some(interruption) = interruption {
            return climb.end(Some(interruption));
        }
        let left = budget.left();
        let stop = StopCriteria { max_iterations: left.max_iterations.min(most_iterations), ..left };
        let start = climb.drawing(given, method);
        let task = Task { stop, start: start.as_deref(), ..Task::new(*given, kind, method) };
        // A rung that would take too much is left out: what is below it has its result.
        let fits = check_memory(&solver, kind, given.pipeline.max_memory, given.mesh);
        // Conditions on the boundary leave out the descent, so LinABF gets all the passes it wants.
        observer.may_be_hopeless =
            kind == SolverKind::LinAbf && ladder.linabf.passes == Passes::Auto && given.problem.boundary().is_none();
        let mut result = fits.and_then(|()| climb.attempt(&task, observer));
        if std::mem::take(&mut observer.is_hopeless)
            && let Ok(flat) = &mut result
        {
            flat.termination = Termination::Stalled;
        }
        // An aborted climb has no result, even where an earlier rung has one.
        observer.observer.aborted()?;
        if climb.take(kind, result) {
            break;
        }
    }
    climb.end(None)
}

/// An observer that stops passes that are hopeless.
struct Hopes<'o> {
    observer: Hearing<'o>,
    /// Whether it looks for passes that are hopeless, and whether it found one.
    may_be_hopeless: bool,
    is_hopeless: bool,
}

impl Observer for Hopes<'_> {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        let is_hopeless = self.may_be_hopeless && matches!(event, Event::Iteration(record) if is_hopeless(record));
        let verdict = self.observer.observe(event);
        if is_hopeless && verdict == Verdict::Continue {
            self.is_hopeless = true;
            return Verdict::Stop;
        }
        verdict
    }
}

fn is_hopeless(pass: &IterationRecord) -> bool {
    HOPELESS.iter().any(|&(number, limit)| pass.iteration == number && pass.constraint_residual > limit)
}

/// What has been found so far.
struct Climb<'t> {
    mesh: &'t TriMesh,
    best: Option<Candidate>,
    rungs: Vec<RungReport>,
    first_error: Option<FlattenError>,
}

struct Candidate {
    flat: Flattening,
    report: RungReport,
}

impl Climb<'_> {
    /// Why the next rung is not tried; it is announced if it is. There is always a first one, however little time there
    /// is: its solver stops itself, with something to give.
    fn interruption(&self, budget: &TimeBudget, next: SolverKind, observer: &mut dyn Observer) -> Option<Termination> {
        let last = self.rungs.last();
        if last.is_some_and(|rung| rung.termination == Some(Termination::Cancelled)) {
            return Some(Termination::Cancelled);
        }
        if last.is_some() && budget.is_spent() {
            return Some(Termination::TimeLimit);
        }
        let verdict = observer.observe(Event::RungStarted(next.name()));
        (verdict != Verdict::Continue).then_some(Termination::Cancelled)
    }

    /// The valid drawing of an earlier rung, for the rung that can start from one.
    fn drawing(&self, given: &Given<'_>, next: Single<'_>) -> Option<Vec<Point2<f64>>> {
        let starts_from_one = match next {
            Single::Positions(_) => true,
            Single::Angles(_) | Single::Hierarchy(_) | Single::SurfaceAngles => false,
        };
        let best = self.best.as_ref().filter(|best| starts_from_one && best.report.valid)?;
        // A mirrored drawing is valid, too.
        let is_upright = best.flat.uv.signed_area() > 0.0;
        let points = vertex_points(given.problem.topology(), &best.flat.uv).ok().filter(|_| is_upright)?;
        // As large as the mesh that is worked on: the areas of some would underflow.
        let scale = if given.pipeline.normalize { 1.0 } else { given.scale };
        Some(points.into_iter().map(|p| p * scale).collect())
    }

    fn attempt(&self, task: &Task<'_>, observer: &mut dyn Observer) -> Result<Flattening, FlattenError> {
        let flat = task.run(observer)?;
        let is_interrupted = flat.termination.is_interruption();
        let may_choose = !is_interrupted
            && task.given.pipeline.layout.kind == LayoutKind::Auto
            && flat.layout.kind == Some(LayoutKind::Tree);
        if flat.certificate.valid() || !may_choose {
            return Ok(flat);
        }
        let again = task.laid_out_again(&flat, observer).filter(|again| again.certificate.valid());
        Ok(again.unwrap_or(flat))
    }

    /// Keeps what is better, and reports it either way; `true` when it is certified.
    fn take(&mut self, solver: SolverKind, result: Result<Flattening, FlattenError>) -> bool {
        let flat = match result {
            Ok(flat) => flat,
            Err(error) => {
                self.rungs.push(RungReport::failed(solver, error.clone()));
                self.first_error.get_or_insert(error);
                return false;
            }
        };
        let mut report = RungReport::of(&flat);
        let is_certified = report.is_certified();
        // Where the first rung is certified there is nothing to compare it with.
        if !is_certified || !self.rungs.is_empty() {
            report.f = flat.metrics(self.mesh).ok().map(|metrics| metrics.f);
        }
        self.rungs.push(report.clone());
        let candidate = Candidate { flat, report };
        if self.best.as_ref().is_none_or(|best| candidate.compare(best) == Ordering::Less) {
            self.best = Some(candidate);
        }
        is_certified
    }

    fn end(self, interruption: Option<Termination>) -> Result<Flattening, FlattenError> {
        let Some(Candidate { flat, .. }) = self.best else {
            return Err(self.first_error.unwrap_or(FlattenError::Cancelled(Cancelled)));
        };
        // A last rung that was stopped before it had a drawing has no result to say so.
        let stopped = self.rungs.last().and_then(|rung| match rung.error {
            Some(FlattenError::Descent(EmbedError::Interrupted(interruption))) => Some(interruption),
            _ => None,
        });
        let termination = interruption.or(stopped).unwrap_or(flat.termination);
        Ok(Flattening { termination, rungs: self.rungs, ..flat })
    }
}

impl Candidate {
    /// The better one is less.
    fn compare(&self, other: &Self) -> Ordering {
        let (a, b) = (&self.report, &other.report);
        let f = |report: &RungReport| report.f.filter(|f| !f.is_nan()).unwrap_or(f64::INFINITY);
        let certified = b.is_certified().cmp(&a.is_certified());
        let bad = a.bad_places().cmp(&b.bad_places());
        // What is within the rounding is met.
        let off = |flat: &Flattening| flat.boundary.as_ref().map_or(0.0, |boundary| boundary.violation.max(MET));
        let off = off(&self.flat).total_cmp(&off(&other.flat));
        certified.then(b.valid.cmp(&a.valid)).then(bad).then(off).then(f(a).total_cmp(&f(b)))
    }
}

impl RungReport {
    pub(super) fn of(flat: &Flattening) -> Self {
        Self {
            solver: flat.solver,
            termination: Some(flat.termination),
            iterations: flat.solution.as_ref().map_or(0, AngleSolution::iterations),
            valid: flat.certificate.valid(),
            flips: flat.certificate.flips,
            collapsed: flat.certificate.collapsed,
            wound: flat.certificate.wound,
            f: None,
            error: None,
        }
    }

    fn failed(solver: SolverKind, error: FlattenError) -> Self {
        Self {
            solver,
            termination: None,
            iterations: 0,
            valid: false,
            flips: 0,
            collapsed: 0,
            wound: 0,
            f: None,
            error: Some(error),
        }
    }

    fn bad_places(&self) -> usize {
        self.flips + self.collapsed + self.wound
    }
}
