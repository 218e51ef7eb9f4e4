//! From a mesh to its UVs.

mod apart;
mod boundary;
mod check;
mod corners;
mod hearing;
mod injective;
mod ladder;
mod levels;
mod plane;
mod relax;
mod relax_map;
mod task;
mod thin;

use crate::settings::{Descent, Injective, Method, Pipeline, Solver, SolverKind, ZeroArea, predict_memory};
use crate::{FlattenError, Flattening, RungReport};
use abf_constraints::{AngleProblem, BoundaryError, GuessSettings, ProblemError};
use abf_control::{Event, Observer, Silent, Stage, Termination, TimeBudget, ask};
use abf_embed::Relax;
use abf_mesh::{GeometryError, Point2, Topology, TriMesh};
use abf_reconstruct::LayoutKind;
use abf_solve_core::AngleSolution;
use abf_solve_linabf::{LinAbf, Passes};
pub(crate) use apart::{Part, neighbours, taken_apart, walks};
use ladder::climb;
pub(crate) use plane::in_plane;
use std::num::NonZeroUsize;
use task::{Given, Single, Task, begin};
use thin::ThinMesh;

/// What a surface has to be.
#[derive(Clone, Copy)]
enum Shape {
    Disk,
    Any,
}

/// What is known of a mesh before it is flattened, and what is enough.
#[derive(Clone, Copy)]
pub(crate) struct Prospect<'p> {
    /// For a chart that is cut where it stretches more, an L² stretch that is as good as 1: where the chart could be solved in two
    /// ways, the second is tried only if the first misses that. `None` for a lone disk: there the second is tried if the first
    /// is not certified, overlaps, or is worse around thin triangles than elsewhere.
    pub(crate) enough: Option<f64>,
    /// Angles near which those of the map are expected, one per corner, rad: see [`AngleProblem::with_expected`].
    pub(crate) expected: Option<&'p [f64]>,
}

impl Prospect<'_> {
    const NOTHING: Self = Self { enough: None, expected: None };
}

/// Flattens a disk with the default settings.
///
/// # Errors
/// [`FlattenError`]; a result that is not converged or not flip-free is a result that says so.
pub fn flatten(mesh: &TriMesh) -> Result<Flattening, FlattenError> {
    Pipeline::default().run(mesh, &mut Silent)
}

impl Pipeline {
    /// Flattens a disk.
    ///
    /// # Errors
    /// [`FlattenError`] when there is no usable result at all.
    pub fn run(&self, mesh: &TriMesh, observer: &mut dyn Observer) -> Result<Flattening, FlattenError> {
        self.run_on(mesh, Shape::Disk, Prospect::NOTHING, observer)
    }

    /// Flattens a disk of which something is known.
    ///
    /// # Errors
    /// [`FlattenError`] when there is no usable result at all.
    pub(crate) fn run_within(
        &self,
        mesh: &TriMesh,
        prospect: Prospect<'_>,
        observer: &mut dyn Observer,
    ) -> Result<Flattening, FlattenError> {
        self.run_on(mesh, Shape::Disk, prospect, observer)
    }

    /// The same for a component without handles as if its holes were not there: nothing sees to it that they close.
    ///
    /// # Errors
    /// [`FlattenError`] when there is no usable result at all.
    pub(crate) fn run_unclosed(
        &self,
        mesh: &TriMesh,
        prospect: Prospect<'_>,
        observer: &mut dyn Observer,
    ) -> Result<Flattening, FlattenError> {
        self.run_on(mesh, Shape::Any, prospect, observer)
    }

    fn run_on(
        &self,
        mesh: &TriMesh,
        shape: Shape,
        prospect: Prospect<'_>,
        observer: &mut dyn Observer,
    ) -> Result<Flattening, FlattenError> {
        self.check()?;
        if matches!(shape, Shape::Any) && !self.boundary.is_free() {
            return Err(ProblemError::from(BoundaryError::Holes).into());
        }
        self.check_memory(mesh)?;
        let budget = TimeBudget::start(&self.stop);
        begin(observer, Stage::Topology)?;
        // No faces is the more useful complaint, so topology comes before geometry.
        let in_range = mesh.in_range();
        let (working, scale) = in_range.as_ref().map_or((mesh, 1.0), |(scaled, scale)| (scaled, *scale));
        let (topology, angles) = abf_parallel::join(
            || Topology::build(mesh.vertex_count(), mesh.faces()),
            || self.corner_angles(mesh, working),
        );
        ask(observer, Event::Working)?;
        let topology = topology?;
        let angles = angles?;
        self.pins.as_ref().map_or(Ok(()), |pins| pins.check(&topology)).map_err(FlattenError::Pins)?;
        injective::check_gap(self, working, scale)?;
        let pose = |initial_guess: GuessSettings, angles: Vec<f64>| {
            let problem = match shape {
                Shape::Disk => AngleProblem::new(&topology, angles, initial_guess)?,
                Shape::Any => AngleProblem::unclosed(&topology, angles, initial_guess)?,
            };
            Ok::<_, ProblemError>(match prospect.expected {
                Some(expected) => problem.with_expected(expected.to_vec()),
                None => problem,
            })
        };
        let solve = |problem: &AngleProblem<'_>, pipeline: &Self, observer: &mut dyn Observer| {
            let given = Given { pipeline, original: mesh, mesh: working, scale, problem };
            let solver = pipeline.solver.kind();
            match pipeline.solver.method() {
                Method::Ladder(ladder) => climb(&given, ladder, observer),
                Method::Angles(angles) => Task::new(given, solver, Single::Angles(angles)).run(observer),
                Method::Hierarchy(levels) => Task::new(given, solver, Single::Hierarchy(levels)).run(observer),
                Method::Positions(descent) => Task::new(given, solver, Single::Positions(descent)).run(observer),
                Method::SurfaceAngles => Task::new(given, solver, Single::SurfaceAngles).run(observer),
            }
        };
        let problem = pose(self.initial_guess, angles)?;
        ask(observer, Event::Working)?;
        let solve = |problem: &AngleProblem<'_>, pipeline: &Self, observer: &mut dyn Observer| {
            boundary::solve_bounded((pipeline, working), problem, &solve, observer)
        };
        let given = Given { pipeline: self, original: mesh, mesh: working, scale, problem: &problem };
        let finish = |flat: Flattening, observer: &mut dyn Observer| {
            // More pins than a similarity can meet are met from a map of little energy.
            let more = self.pins.as_ref().filter(|pins| !pins.need_a_similarity_only());
            let needed = more.map(|_| Relax::default());
            let flat = match self.relax.as_ref().or(needed.as_ref()) {
                None => flat,
                Some(relax) => relax::relaxed(given, relax, flat, &budget.left(), observer)?,
            };
            match &self.pins {
                None => injective::made_injective(given, flat, &budget.left(), observer),
                Some(pins) => relax::pinned(given, pins, flat, &budget.left(), observer),
            }
        };
        let flat = solve(&problem, self, observer);
        let has_thin = problem.thin_corners() > 0;
        let has_two_ways = has_thin && self.uses_the_initial_guess();
        let may_stay = self.boundary.is_free() && self.layout.kind == LayoutKind::Auto;
        let plane = (has_thin || problem.shapeless_faces() > 0).then(|| in_plane(working)).flatten();
        let plane = plane.filter(|_| may_stay);
        if !(has_two_ways || plane.is_some()) || budget.is_spent() {
            return finish(flat?, observer);
        }
        let angle_bound = self.initial_guess.angle_bound;
        let thin = ThinMesh { mesh, angle_bound, enough: prospect.enough, is_flat: plane.is_some() };
        let flat = thin::better(thin, flat, observer, |own, observer| {
            // What lies in a plane has a place there already, however thin its triangles are.
            let as_it_lies = plane.map(|points| laid_flat(given, own, &points, observer)).transpose()?.flatten();
            if as_it_lies.is_some() || !has_two_ways {
                return Ok(as_it_lies);
            }
            // Measured again: it is a rare mesh that would have to keep its angles for so long.
            let angles = self.corner_angles(mesh, working)?;
            let bounded = pose(GuessSettings { keep_thin: false, ..self.initial_guess }, angles)?;
            // A rung that goes on to the optimum comes to the same one from either start.
            let is_optimal = own.is_some_and(|kind| matches!(kind, SolverKind::Barrier | SolverKind::Descent));
            let rest = Self { stop: budget.left(), ..self.clone() };
            let ladder = match &self.solver {
                Solver::Auto(ladder) if is_optimal => ladder,
                _ => return solve(&bounded, &rest, observer).map(Some),
            };
            ask(observer, Event::RungStarted(SolverKind::LinAbf.name()))?;
            let mut flat = solve(&bounded, &Self { solver: ladder.linabf.into(), ..rest }, observer)?;
            flat.rungs.push(RungReport::of(&flat));
            Ok(Some(flat))
        })?;
        finish(flat, observer)
    }

    /// Whether the result depends on where the angles start.
    fn uses_the_initial_guess(&self) -> bool {
        match self.solver.method() {
            Method::Ladder(_) | Method::Angles(_) | Method::Hierarchy(_) => true,
            Method::Positions(_) | Method::SurfaceAngles => false,
        }
    }

    /// The angles of the surface, if they are to be had: `mesh` as it is given, `working` within range.
    fn corner_angles(&self, mesh: &TriMesh, working: &TriMesh) -> Result<Vec<f64>, GeometryError> {
        mesh.check_finite()?;
        if self.zero_area == ZeroArea::Refuse {
            working.check_geometry()?;
        }
        Ok(working.corner_angles())
    }

    /// Whether the solver keeps within the limit; of the ladder its first rung, for the others are checked when it is
    /// their turn.
    pub(crate) fn check_memory(&self, mesh: &TriMesh) -> Result<(), FlattenError> {
        if self.relax.is_some() || self.injective == Injective::Deform {
            // It has the matrices of the descent.
            check_memory(&Descent::default().into(), self.solver.kind(), self.max_memory, mesh)?;
        }
        match &self.solver {
            // Rows of the boundary are solved for with a factorisation of the whole system.
            Solver::Auto(_) | Solver::LinAbf(_) if !self.boundary.is_free() => {
                let direct = LinAbf { passes: Passes::Exactly(NonZeroUsize::MIN), ..LinAbf::default() }.into();
                check_memory(&direct, self.solver.kind(), self.max_memory, mesh)
            }
            Solver::Auto(_) => check_memory(&lean(), SolverKind::Auto, self.max_memory, mesh),
            solver => check_memory(solver, solver.kind(), self.max_memory, mesh),
        }
    }
}

/// A flat mesh as it lies in its plane, where that is valid. Its angles are those of the surface, and there is nothing to
/// correct: the result is that of the solver, converged without an iteration.
fn laid_flat(
    given: Given<'_>,
    own: Option<SolverKind>,
    points: &[Point2<f64>],
    observer: &mut dyn Observer,
) -> Result<Option<Flattening>, FlattenError> {
    let Given { pipeline, mesh, problem, .. } = given;
    let solver =
        own.unwrap_or(if let Solver::Auto(_) = pipeline.solver { SolverKind::LinAbf } else { pipeline.solver.kind() });
    let task = Task::new(given, solver, Single::SurfaceAngles);
    let solution = AngleSolution::measure(problem, mesh.corner_angles(), Termination::Converged, Vec::new());
    let flat = task.placed((points, true), solution, &[], observer)?;
    Ok(flat.certificate.valid().then_some(flat))
}

/// The solver of angles that takes least.
fn lean() -> Solver {
    LinAbf::default().into()
}

/// Whether a solver keeps within a limit, bytes. An error names `asked`.
fn check_memory(solver: &Solver, asked: SolverKind, limit: Option<u64>, mesh: &TriMesh) -> Result<(), FlattenError> {
    let Some(limit) = limit else { return Ok(()) };
    let (triangles, vertices) = (mesh.face_count(), mesh.vertex_count());
    let predicted = predict_memory(solver, triangles, vertices);
    if predicted <= limit {
        return Ok(());
    }
    let leaner = Some((SolverKind::LinAbf, predict_memory(&lean(), triangles, vertices)));
    let leaner = leaner.filter(|&(_, bytes)| bytes <= limit);
    Err(FlattenError::Memory { solver: asked, triangles, predicted, limit, leaner })
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_control::Verdict;
    use abf_shapes::Shape;
    use abf_solve_uzawa::Uzawa;

    /// An observer that hears nothing, for nothing is begun.
    struct Deaf;

    impl Observer for Deaf {
        fn observe(&mut self, event: Event<'_>) -> Verdict {
            panic!("{event:?}")
        }
    }

    #[test]
    fn a_mesh_over_the_limit_is_refused_before_anything_is_done() {
        let mesh = Shape::BumpySheet.mesh(2000);
        let refused = |solver: Solver, limit| {
            let pipeline = Pipeline { solver, max_memory: Some(limit), ..Pipeline::default() };
            pipeline.run(&mesh, &mut Deaf).unwrap_err()
        };
        let (triangles, limit) = (mesh.face_count(), 2_000_000);
        let error = refused(Uzawa::default().into(), limit);
        let FlattenError::Memory {
            solver: SolverKind::Uzawa,
            predicted,
            leaner: Some((SolverKind::LinAbf, bytes)),
            ..
        } = error
        else {
            panic!("{error:?}")
        };
        assert!(predicted > limit && bytes <= limit, "{error}");
        assert!(error.to_string().contains(&format!("for {triangles} triangles, and the limit is 2.0 MB")), "{error}");
        assert!(matches!(refused(lean(), 1000), FlattenError::Memory { leaner: None, .. }));
    }
}
