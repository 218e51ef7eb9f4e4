//! Every setting, and the way from a mesh to its UVs.

use crate::task::Task;
use crate::{FlattenError, Flattening, Passes, SolverKind, ladder, predict_memory};
use abf_constraints::{AngleProblem, EstimateSettings, WheelForm};
use abf_control::{Cancelled, Event, Observer, Silent, Stage, StopCriteria, Verdict};
use abf_embed::Descent;
use abf_mesh::{GeometryError, Topology, TriMesh};
use abf_metrics::Precision;
use abf_reconstruct::{LayoutKind, LayoutSettings};
use abf_solve_abf_newton::AbfNewton;
use abf_solve_barrier::Barrier;
use abf_solve_core::{AngleSolver, BoundRule, Hessian, InnerTolerance, IterativeSettings, LineSearch, NewtonSettings};
use abf_solve_linabf::LinAbf;
use abf_solve_minres::Minres;
use abf_solve_uzawa::Uzawa;
use std::fmt;
use std::str::FromStr;

/// Every setting of a flattening. The default is what [`flatten`] does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pipeline {
    /// Which method. [`SolverKind::Auto`] heeds what concerns LinABF and the descent, and takes the steps with a fixed
    /// target as they are by default.
    pub solver: SolverKind,
    /// How many passes LinABF makes.
    pub passes: Passes,
    /// The wheel form of the solvers with a fixed target; `None`: that of the named solver.
    pub wheel: Option<WheelForm>,
    /// Their Hessian; `None`: that of the named solver.
    pub hessian: Option<Hessian>,
    /// Their line search.
    pub line_search: LineSearch,
    /// How they keep angles inside (0, π).
    pub bounds: BoundRule,
    /// How exactly Uzawa and MINRES solve.
    pub inner_tolerance: InnerTolerance,
    /// What Uzawa and MINRES iterate on, and with which preconditioner.
    pub iterative: IterativeSettings,
    /// The interior point method.
    pub barrier: Barrier,
    /// The barrier of the descent.
    pub descent: Descent,
    /// What becomes of faces without area.
    pub zero_area: ZeroArea,
    /// How the estimate is made from the angles of the surface.
    pub estimate: EstimateSettings,
    /// When the solver stops. A time limit is one for all solvers of [`SolverKind::Auto`] together; the number of
    /// iterations is one for each.
    pub stop: StopCriteria,
    /// How angles become coordinates. [`SolverKind::Lscm`] takes the two least squares kinds, and
    /// reads [`LayoutKind::Auto`] as the weighted one, which is LSCM proper. [`SolverKind::Descent`] lays out nothing.
    pub layout: LayoutSettings,
    /// Scale the UVs into the unit square instead of giving them the area of the surface.
    pub normalize: bool,
    /// What the UVs will be stored in: they are rounded to it, and certified as that.
    pub precision: Precision,
    /// Refuse meshes for which [`predict_memory`] says more bytes than this; `None`: no limit but that of the system,
    /// which may end the program. [`SolverKind::Auto`] leaves out the rungs that would take more.
    pub max_memory: Option<u64>,
}

/// What becomes of faces without area.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ZeroArea {
    /// They get a valid place like all others; their angles, which they do not have, are those of a thin triangle
    /// ([`AngleProblem::new`]). Metrics leave them out and count them.
    #[default]
    Carry,
    /// The first is an error: [`GeometryError::ZeroArea`](abf_mesh::GeometryError::ZeroArea).
    Refuse,
}

impl ZeroArea {
    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Carry => "carry",
            Self::Refuse => "refuse",
        }
    }
}

impl fmt::Display for ZeroArea {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ZeroArea {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let known = [Self::Carry, Self::Refuse];
        known
            .into_iter()
            .find(|rule| rule.name() == s)
            .ok_or_else(|| format!("'{s}' is nothing to do with faces without area; there are: carry, refuse"))
    }
}

/// What a surface has to be.
#[derive(Clone, Copy)]
enum Shape {
    Disk,
    Any,
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
        self.run_on(mesh, Shape::Disk, observer)
    }

    /// Flattens a component without handles as if its holes were not there: nothing sees to it that they close.
    ///
    /// # Errors
    /// [`FlattenError`] when there is no usable result at all.
    pub(crate) fn run_unclosed(&self, mesh: &TriMesh, observer: &mut dyn Observer) -> Result<Flattening, FlattenError> {
        self.run_on(mesh, Shape::Any, observer)
    }

    fn run_on(&self, mesh: &TriMesh, shape: Shape, observer: &mut dyn Observer) -> Result<Flattening, FlattenError> {
        self.check_layout()?;
        self.check_memory(mesh)?;
        if matches!(self.solver, SolverKind::Auto | SolverKind::Descent) {
            self.descent.check()?;
        }
        if matches!(self.solver, SolverKind::Auto | SolverKind::Barrier) {
            let named = |source| FlattenError::Solve { solver: SolverKind::Barrier.name(), source };
            self.barrier.check().map_err(named)?;
        }
        begin(observer, Stage::Topology)?;
        // No faces is the more useful complaint, so topology comes before geometry.
        let in_range = mesh.in_range();
        let (working, scale) = in_range.as_ref().map_or((mesh, 1.0), |(scaled, scale)| (scaled, *scale));
        let (topology, angles) =
            rayon::join(|| Topology::build(mesh.vertex_count(), mesh.faces()), || self.corner_angles(mesh, working));
        let topology = topology?;
        let problem = match shape {
            Shape::Disk => AngleProblem::new(&topology, angles?, self.estimate)?,
            Shape::Any => AngleProblem::unclosed(&topology, angles?, self.estimate)?,
        };
        let task = Task { pipeline: *self, original: mesh, mesh: working, scale, problem: &problem, start: None };
        match self.solver {
            SolverKind::Auto => ladder::climb(&task, observer),
            _ => task.run(observer),
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
        let Some(limit) = self.max_memory else { return Ok(()) };
        let (triangles, vertices) = (mesh.face_count(), mesh.vertex_count());
        let lean = Self { solver: SolverKind::LinAbf, passes: Passes::Auto, ..*self };
        let predicted = predict_memory(if self.solver == SolverKind::Auto { &lean } else { self }, triangles, vertices);
        if predicted <= limit {
            return Ok(());
        }
        let leaner = Some((lean.solver.name(), predict_memory(&lean, triangles, vertices)));
        let leaner = leaner.filter(|&(_, bytes)| bytes <= limit);
        Err(FlattenError::Memory { solver: self.solver.name(), triangles, predicted, limit, leaner })
    }

    fn check_layout(&self) -> Result<(), FlattenError> {
        let kind = self.layout.kind;
        match (self.solver, kind) {
            (SolverKind::Lscm, LayoutKind::Tree | LayoutKind::Poisson) => Err(FlattenError::LscmLayout(kind)),
            (SolverKind::Descent, kind) if kind != LayoutKind::Auto => Err(FlattenError::DescentLayout(kind)),
            _ => Ok(()),
        }
    }

    /// The solver with its settings; `None` for those that are no [`AngleSolver`]: LSCM, the descent, and the ladder.
    #[must_use]
    pub fn angle_solver(&self) -> Option<Box<dyn AngleSolver>> {
        let Some(newton) = self.newton_settings() else {
            return match self.solver {
                SolverKind::LinAbf => Some(Box::new(LinAbf { passes: self.passes })),
                SolverKind::Barrier => Some(Box::new(self.barrier)),
                _ => None,
            };
        };
        let iterative = self.iterative;
        Some(match self.solver {
            SolverKind::Uzawa => Box::new(Uzawa { newton, iterative }),
            SolverKind::Minres => Box::new(Minres { newton, iterative }),
            SolverKind::Abf => Box::new(AbfNewton { newton, ..AbfNewton::abf() }),
            SolverKind::AbfPlusPlus => Box::new(AbfNewton { newton, ..AbfNewton::abf_plus_plus() }),
            SolverKind::AbfNewton => Box::new(AbfNewton { newton, ..AbfNewton::exact_newton() }),
            _ => Box::new(AbfNewton { newton, ..AbfNewton::fixed_target() }),
        })
    }

    /// The point of the grid this pipeline runs: that of its solver, with its own settings where it has
    /// any. `None` for the solvers that are none: LinABF, the interior point, the descent, LSCM, and the ladder.
    #[must_use]
    pub fn newton_settings(&self) -> Option<NewtonSettings> {
        let named = match self.solver {
            SolverKind::Abf => AbfNewton::abf().newton,
            SolverKind::AbfPlusPlus => AbfNewton::abf_plus_plus().newton,
            SolverKind::AbfNewton => AbfNewton::exact_newton().newton,
            SolverKind::AbfFixedTarget => AbfNewton::fixed_target().newton,
            SolverKind::Uzawa => Uzawa::default().newton,
            SolverKind::Minres => Minres::default().newton,
            SolverKind::Auto | SolverKind::LinAbf | SolverKind::Barrier | SolverKind::Descent | SolverKind::Lscm => {
                return None;
            }
        };
        Some(NewtonSettings {
            wheel: self.wheel.unwrap_or(named.wheel),
            hessian: self.hessian.unwrap_or(named.hessian),
            line_search: self.line_search,
            bounds: self.bounds,
            inner_tolerance: self.inner_tolerance,
        })
    }
}

/// Reports a stage before which there is no result to keep.
pub(crate) fn begin(observer: &mut dyn Observer, stage: Stage) -> Result<(), FlattenError> {
    match observer.observe(Event::StageStarted(stage)) {
        Verdict::Continue => Ok(()),
        Verdict::Stop | Verdict::Abort => Err(FlattenError::Cancelled(Cancelled)),
    }
}
