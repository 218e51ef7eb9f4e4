//! From a mesh to UVs: the stages in order.

use crate::{Passes, SolverKind, predict_memory};
use abf_constraints::{AngleProblem, EstimateSettings, ProblemError, WheelForm};
use abf_mesh::{DiskError, GeometryError, Topology, TopologyError, TriMesh, UvMap};
use abf_metrics::{Certificate, Metrics, MetricsError, Precision, certify, measure_certified};
use abf_reconstruct::{Layout, LayoutError, LayoutKind, LayoutSettings, layout};
use abf_solve_abf_newton::AbfNewton;
use abf_solve_core::{
    AngleSolution, AngleSolver, BoundRule, Event, Hessian, InnerTolerance, IterativeSettings, LineSearch,
    NewtonSettings, Observer, Silent, SolveError, Stage, StopCriteria, Termination, Verdict,
};
use abf_solve_linabf::LinAbf;
use abf_solve_minres::Minres;
use abf_solve_uzawa::Uzawa;

/// Every setting of a flattening. The default is what [`flatten`] does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pipeline {
    /// Which method finds the angles.
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
    /// How the estimate is made from the angles of the surface.
    pub estimate: EstimateSettings,
    /// When the solver stops.
    pub stop: StopCriteria,
    /// How angles become coordinates. [`SolverKind::Lscm`] takes the two least squares kinds, and
    /// reads [`LayoutKind::Auto`] as the weighted one, which is LSCM proper.
    pub layout: LayoutSettings,
    /// Scale the UVs into the unit square instead of giving them the area of the surface.
    pub normalize: bool,
    /// What the UVs will be stored in: they are rounded to it, and certified as that.
    pub precision: Precision,
    /// Refuse meshes for which [`predict_memory`] says more bytes than this; `None`: no limit but that of the system,
    /// which may end the program.
    pub max_memory: Option<u64>,
}

/// A flattened mesh.
#[derive(Clone, Debug)]
pub struct Flattening {
    /// One UV per vertex, in the precision asked for.
    pub uv: UvMap,
    /// What is proved of these UVs: whether triangles are turned over, wind, or lie over each other.
    pub certificate: Certificate,
    /// How the solver ended; [`Termination::OnePass`] for LSCM, which is one linear solve.
    pub termination: Termination,
    /// The angles; `None` for LSCM, which does not solve for any.
    pub solution: Option<AngleSolution>,
    /// What the layout did.
    pub layout: LayoutReport,
    /// How many vertices have faces all around: `ni`.
    pub interior_vertices: usize,
    /// How many rings started from their target angles because of their deficit.
    pub switched_rings: usize,
}

/// What the layout did: [`Layout`] without its UVs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayoutReport {
    /// The method that was used; never [`LayoutKind::Auto`].
    pub kind: LayoutKind,
    /// The true relative residual of its linear solve; `None` for the tree.
    pub linear_residual: Option<f64>,
    /// The largest disagreement between the two sides of an edge; `None` where nothing was integrated.
    pub closing_error: Option<f64>,
    /// How many angles had to be moved into the open interval (0, π) to be laid out.
    pub moved_angles: usize,
}

/// Why a mesh could not be flattened.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlattenError {
    /// Coordinates that are not finite, or faces without area.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Faces that do not form an oriented manifold.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// A manifold that is not a disk.
    #[error(transparent)]
    NotADisk(#[from] DiskError),
    /// A setting out of range, or angles no triangle has.
    #[error(transparent)]
    Problem(ProblemError),
    /// The solver found no angles.
    #[error("the solver '{solver}' found no angles")]
    Solve {
        /// Which solver.
        solver: &'static str,
        /// Why.
        source: SolveError,
    },
    /// The angles could not be laid out.
    #[error("the angles could not be laid out")]
    Layout(#[from] LayoutError),
    /// LSCM is a least squares layout and has no angles to integrate.
    #[error("lscm is a least squares layout: it cannot use the layout '{0}'")]
    LscmLayout(LayoutKind),
    /// The UVs could not be judged: they do not fit into the precision asked for.
    #[error("the UVs could not be judged")]
    Certificate(#[from] MetricsError),
    /// It would take more memory than [`Pipeline::max_memory`]; none of it was taken.
    #[error(
        "the solver '{solver}' would take about {} for {triangles} triangles, and the limit is {}{}",
        in_units(*predicted), in_units(*limit), instead(*leaner)
    )]
    Memory {
        /// Which solver.
        solver: &'static str,
        /// How many triangles the mesh has.
        triangles: usize,
        /// See [`predict_memory`], bytes.
        predicted: u64,
        /// What is allowed, bytes.
        limit: u64,
        /// A solver that keeps within the limit, and what is predicted for it.
        leaner: Option<(&'static str, u64)>,
    },
    /// Cancelled before there was anything to return.
    #[error("cancelled before there was a result")]
    Cancelled,
}

impl From<ProblemError> for FlattenError {
    fn from(error: ProblemError) -> Self {
        match error {
            ProblemError::NotADisk(disk) => Self::NotADisk(disk),
            other => Self::Problem(other),
        }
    }
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
        let layout_settings = self.layout_settings()?;
        self.check_memory(mesh)?;
        begin(observer, Stage::Topology)?;
        // No faces is the more useful complaint, so topology comes before geometry.
        let topology = Topology::build(mesh.vertex_count(), mesh.faces())?;
        mesh.check_geometry()?;
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), self.estimate)?;
        begin(observer, Stage::Solve)?;
        let solution = self.solve(&problem, observer)?;
        // A cancelled solve still has angles worth laying out.
        let _ = observer.observe(Event::StageStarted(Stage::Layout));
        let angles = solution.as_ref().map_or(problem.mesh_angles(), AngleSolution::angles);
        let Layout { uv, kind, linear, closing_error, moved_angles } =
            layout(mesh, &topology, angles, &layout_settings)?;
        let uv = if self.normalize { uv.normalized() } else { uv };
        let uv = uv.mapped(|p| p.map(|x| self.precision.round(x)));
        let _ = observer.observe(Event::StageStarted(Stage::Certificate));
        let constraint_residual = solution.as_ref().map(AngleSolution::constraint_residual);
        let certificate = Certificate { constraint_residual, ..certify(mesh, &uv, self.precision)? };
        Ok(Flattening {
            uv,
            certificate,
            termination: solution.as_ref().map_or(Termination::OnePass, AngleSolution::termination),
            layout: LayoutReport {
                kind,
                linear_residual: linear.map(|stats| stats.relative_residual),
                closing_error,
                moved_angles,
            },
            interior_vertices: problem.rows().interior_count(),
            switched_rings: if solution.is_some() { problem.switched_rings() } else { 0 },
            solution,
        })
    }

    fn check_memory(&self, mesh: &TriMesh) -> Result<(), FlattenError> {
        let Some(limit) = self.max_memory else { return Ok(()) };
        let (triangles, vertices) = (mesh.face_count(), mesh.vertex_count());
        let predicted = predict_memory(self, triangles, vertices);
        if predicted <= limit {
            return Ok(());
        }
        let lean = Self { solver: SolverKind::LinAbf, passes: Passes::Auto, ..*self };
        let leaner = Some((lean.solver.name(), predict_memory(&lean, triangles, vertices)));
        let leaner = leaner.filter(|&(_, bytes)| bytes <= limit);
        Err(FlattenError::Memory { solver: self.solver.name(), triangles, predicted, limit, leaner })
    }

    fn layout_settings(&self) -> Result<LayoutSettings, FlattenError> {
        let mut settings = self.layout;
        if self.solver == SolverKind::Lscm {
            settings.kind = match settings.kind {
                LayoutKind::Auto | LayoutKind::LeastSquaresWeighted => LayoutKind::LeastSquaresWeighted,
                LayoutKind::LeastSquares => LayoutKind::LeastSquares,
                other => return Err(FlattenError::LscmLayout(other)),
            };
        }
        Ok(settings)
    }

    /// The solver with its settings; `None` for LSCM, which solves for no angles.
    #[must_use]
    pub fn angle_solver(&self) -> Option<Box<dyn AngleSolver>> {
        let Some(newton) = self.newton_settings() else {
            return match self.solver {
                SolverKind::LinAbf => Some(Box::new(LinAbf { passes: self.passes })),
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
    /// any. `None` for the solvers without a fixed target, LinABF and LSCM.
    #[must_use]
    pub fn newton_settings(&self) -> Option<NewtonSettings> {
        let named = match self.solver {
            SolverKind::Abf => AbfNewton::abf().newton,
            SolverKind::AbfPlusPlus => AbfNewton::abf_plus_plus().newton,
            SolverKind::AbfNewton => AbfNewton::exact_newton().newton,
            SolverKind::AbfFixedTarget => AbfNewton::fixed_target().newton,
            SolverKind::Uzawa => Uzawa::default().newton,
            SolverKind::Minres => Minres::default().newton,
            SolverKind::LinAbf | SolverKind::Lscm => return None,
        };
        Some(NewtonSettings {
            wheel: self.wheel.unwrap_or(named.wheel),
            hessian: self.hessian.unwrap_or(named.hessian),
            line_search: self.line_search,
            bounds: self.bounds,
            inner_tolerance: self.inner_tolerance,
        })
    }

    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        observer: &mut dyn Observer,
    ) -> Result<Option<AngleSolution>, FlattenError> {
        let Some(solver) = self.angle_solver() else { return Ok(None) };
        let solution = solver.solve(problem, &self.stop, observer);
        solution.map(Some).map_err(|source| FlattenError::Solve { solver: solver.name(), source })
    }
}

fn begin(observer: &mut dyn Observer, stage: Stage) -> Result<(), FlattenError> {
    match observer.observe(Event::StageStarted(stage)) {
        Verdict::Continue => Ok(()),
        Verdict::Cancel => Err(FlattenError::Cancelled),
    }
}

/// Bytes in thousands, millions or billions, with no more digits than a prediction has.
fn in_units(bytes: u64) -> String {
    let bytes = bytes as f64;
    let (scale, unit) = if bytes < 1e6 {
        (1e3, "kB")
    } else if bytes < 1e9 {
        (1e6, "MB")
    } else {
        (1e9, "GB")
    };
    let amount = bytes / scale;
    if amount < 10.0 { format!("{amount:.1} {unit}") } else { format!("{amount:.0} {unit}") }
}

fn instead(leaner: Option<(&'static str, u64)>) -> String {
    leaner.map_or_else(String::new, |(solver, bytes)| format!("; '{solver}' takes about {}", in_units(bytes)))
}

impl Flattening {
    /// Distortion, measured on the UVs, with their certificate.
    ///
    /// # Errors
    /// [`MetricsError`] when `mesh` is not the mesh that was flattened.
    pub fn metrics(&self, mesh: &TriMesh) -> Result<Metrics, MetricsError> {
        measure_certified(mesh, &self.uv, self.certificate.clone())
    }
}
