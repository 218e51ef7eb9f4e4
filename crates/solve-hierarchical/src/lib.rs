//! Hierarchical solvers: the angles of a coarse mesh, carried to the fine one.
//!
//! A large mesh is coarsened by edge collapses, the coarse mesh is solved and drawn, and its drawing is carried back, vertex
//! by vertex, without turning a triangle over (`abf-multires`). Two methods end there in different ways:
//!
//! * **HABF++** ([`HierarchicalMethod::HabfPlusPlus`]): ABF++ on the coarse mesh. The drawing that comes back is the result;
//!   the fine mesh is never solved.
//! * **Hierarchical LinABF** ([`HierarchicalMethod::HLinAbf`]): LinABF on the coarse mesh. The angles of the drawing are where
//!   the passes on the fine mesh linearise, `centred.rs`. Its result is angles.
//!
//! Sheffer, Lévy, Mogilnitsky, Bogomyakov (*ABF++: Fast and Robust Angle Based Flattening*, 2005) describe HABF++ as a
//! hierarchical technique for millions of faces "at the expense of a minor increase in parametric distortion". The steps
//! here are a reconstruction from that description, not the authors' program. `docs/hierarchy.md` has what they cost and gain.

mod centred;

use abf_constraints::AngleProblem;
use abf_control::{Cancelled, Checkpoint, Event, Observer, SettingError, StopCriteria, TimeBudget, UnknownName, ask};
use abf_mesh::predicates::angles;
use abf_mesh::{Point2, Topology, TriMesh};
use abf_multires::{CoarseMesh, Hierarchy};
use abf_parallel::prelude::*;
use abf_solve_core::{AngleSolution, AngleSolver, SolveError};
use std::sync::Arc;

pub use abf_multires::{LevelReport, RefineError};

/// Fewer faces are not worth a thread.
const PER_TASK: usize = 1 << 12;

/// The coarse mesh is solved until a step moves no angle by more, rad: its solution is further than that from the drawing of
/// the fine mesh, and its constraints hold to the tolerance.
const COARSE_STEP: f64 = 1e-3;

/// How a hierarchy is used.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    Hash,
    strum::Display,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantNames,
)]
#[strum(parse_err_ty = UnknownName, parse_err_fn = unknown)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum HierarchicalMethod {
    /// The drawing of the coarse mesh, carried back, is the result.
    #[default]
    #[strum(serialize = "habf++")]
    #[cfg_attr(feature = "serde", serde(rename = "habf++"))]
    HabfPlusPlus,
    /// It is where LinABF linearises on the fine mesh.
    #[strum(serialize = "hlinabf")]
    #[cfg_attr(feature = "serde", serde(rename = "hlinabf"))]
    HLinAbf,
}

impl HierarchicalMethod {
    /// The name on the command line and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<HierarchicalMethod>("hierarchical method", given)
}

/// A hierarchical solver and its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Hierarchical {
    /// What is done with the hierarchy.
    pub method: HierarchicalMethod,
    /// How many times fewer triangles the coarsest level has, where collapses can do that.
    pub factor: usize,
    /// No fewer than so many. A mesh that has no more is solved as it is.
    pub least_triangles: usize,
    /// How often every vertex of a level makes a step towards the least energy around it, after all of them are back.
    pub sweeps: usize,
}

impl Default for Hierarchical {
    fn default() -> Self {
        Self { method: HierarchicalMethod::HabfPlusPlus, factor: 20, least_triangles: 2500, sweeps: 2 }
    }
}

/// Draws a mesh from its angles, one per corner, rad: one point for every vertex, every triangle counter-clockwise and no
/// vertex wound around twice; `None` where these angles have no such drawing.
pub type CoarseLayout<'a> =
    dyn FnMut(&TriMesh, &Topology, &[f64], &mut Checkpoint<'_>) -> Result<Option<Vec<Point2<f64>>>, Cancelled> + 'a;

/// How a coarse mesh gets a drawing.
pub struct Coarse<'a> {
    /// What finds its angles.
    pub solver: Arc<dyn AngleSolver>,
    /// What draws it.
    pub layout: &'a mut CoarseLayout<'a>,
}

/// Why the fine mesh was solved without a hierarchy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoHierarchy {
    /// The coarse mesh has no angles.
    #[error("the coarsest level ({triangles} triangles) has no angles: {source}")]
    CoarseAngles {
        /// How many triangles it has.
        triangles: usize,
        /// What its solver says.
        source: SolveError,
    },
    /// It has angles, but their drawing is not valid.
    #[error("the drawing of the coarsest level ({triangles} triangles) is not valid")]
    CoarseDrawing {
        /// How many triangles it has.
        triangles: usize,
    },
    /// Its drawing cannot be carried back.
    #[error(transparent)]
    Refine(RefineError),
}

/// What a hierarchical solver found.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct HierarchicalSolution {
    /// The drawing that was carried to the fine mesh, one point for every vertex, where it is the result; `None` where the
    /// angles of the solution are, and have to be laid out. Vertices that no face uses are at the origin.
    pub uv: Option<Vec<Point2<f64>>>,
    /// The angles, measured: those of the drawing, or those that were solved for. Its history is that of the coarse mesh,
    /// or that of the passes on the fine one.
    pub solution: AngleSolution,
    /// Every level, the coarsest first; empty where there is no hierarchy.
    pub levels: Vec<LevelReport>,
    /// Why there is none, where there should be one. Then the coarse solver has solved the fine mesh.
    pub fallback: Option<NoHierarchy>,
}

impl Hierarchical {
    /// HABF++.
    #[must_use]
    pub fn habf_plus_plus() -> Self {
        Self::default()
    }

    /// Hierarchical LinABF.
    #[must_use]
    pub fn hlinabf() -> Self {
        Self { method: HierarchicalMethod::HLinAbf, ..Self::default() }
    }

    /// Checks that every setting is in its range; [`Hierarchical::solve`] calls it first.
    ///
    /// # Errors
    /// [`SolveError::Setting`] naming the setting and its range.
    pub fn check(&self) -> Result<(), SolveError> {
        for (name, value) in [("factor", self.factor), ("least_triangles", self.least_triangles)] {
            if value == 0 {
                return Err(SettingError::new(name, "at least 1", 0).into());
            }
        }
        Ok(())
    }

    /// How many triangles the coarsest level of a mesh should have.
    fn coarse_triangles(&self, mesh: &TriMesh) -> usize {
        (mesh.face_count() / self.factor).max(self.least_triangles)
    }

    /// Solves one problem, of `mesh`. Same input, same bits.
    ///
    /// The stopping criteria are those of the coarse solver and of the passes on the fine mesh, but that the last step of
    /// Newton's method on the coarse mesh need not be shorter than 1e-3 rad. The time limit is that of all together; it does not cut coarsening and
    /// the way back short. An observer that stops it has the drawing that there is carried to the fine mesh.
    ///
    /// # Errors
    /// [`SolveError`] when a setting is out of range, the observer aborts, or the coarse solver, in place of a hierarchy,
    /// finds no angles for the fine mesh.
    ///
    /// # Panics
    /// If the problem is not that of `mesh`.
    pub fn solve(
        &self,
        mesh: &TriMesh,
        problem: &AngleProblem<'_>,
        coarse: Coarse<'_>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<HierarchicalSolution, SolveError> {
        self.check()?;
        stop.check()?;
        let budget = TimeBudget::start(stop);
        let solver = Arc::clone(&coarse.solver);
        let fallback = if mesh.face_count() <= self.coarse_triangles(mesh) {
            None
        } else {
            match self.carried(mesh, problem, coarse, &budget, observer)? {
                Ok(Carried { uv, solution, levels }) => {
                    return self.finished((problem, &budget), (uv, solution), levels, observer);
                }
                Err(fallback) => Some(fallback),
            }
        };
        let solution = solver.solve(problem, &budget.left(), observer)?;
        Ok(HierarchicalSolution { uv: None, solution, levels: Vec::new(), fallback })
    }

    /// The drawing of the coarsest level, carried to the mesh.
    fn carried(
        &self,
        mesh: &TriMesh,
        problem: &AngleProblem<'_>,
        Coarse { solver, layout }: Coarse<'_>,
        budget: &TimeBudget,
        observer: &mut dyn Observer,
    ) -> Result<Result<Carried, NoHierarchy>, Cancelled> {
        let topology = problem.topology();
        let size = self.coarse_triangles(mesh);
        let hierarchy = Hierarchy::coarsen(mesh, topology, size, &mut || ask(observer, Event::Working))?;
        let CoarseMesh { mesh: coarse, vertices, .. } = hierarchy.coarsest(mesh);
        let triangles = coarse.face_count();
        let solved = {
            let topology = Topology::build(coarse.vertex_count(), coarse.faces()).expect("collapses keep a manifold");
            let problem = AngleProblem::unclosed(&topology, coarse.corner_angles(), *problem.settings());
            let problem = problem.expect("the angles of triangles");
            let left = budget.left();
            let stop = StopCriteria { step_tolerance: left.step_tolerance.max(COARSE_STEP), ..left };
            match solver.solve(&problem, &stop, observer) {
                Err(SolveError::Cancelled(cancelled)) => return Err(cancelled),
                Err(source) => return Ok(Err(NoHierarchy::CoarseAngles { triangles, source })),
                Ok(solution) => {
                    let drawn = layout(&coarse, &topology, solution.angles(), &mut || ask(observer, Event::Working))?;
                    drawn.map(|uv| (uv, solution))
                }
            }
        };
        let Some((drawing, solution)) = solved else { return Ok(Err(NoHierarchy::CoarseDrawing { triangles })) };
        let mut uv = vec![Point2::origin(); mesh.vertex_count()];
        for (v, p) in vertices.iter().zip(drawing) {
            uv[v.index()] = p;
        }
        let checkpoint = &mut || ask(observer, Event::Working);
        match hierarchy.refine((mesh, topology), problem.target(), &mut uv, self.sweeps, checkpoint) {
            Ok(levels) => Ok(Ok(Carried { uv, solution, levels })),
            Err(RefineError::Cancelled(cancelled)) => Err(cancelled),
            Err(error) => Ok(Err(NoHierarchy::Refine(error))),
        }
    }

    /// What the method makes of a drawing of the fine mesh.
    fn finished(
        &self,
        (problem, budget): (&AngleProblem<'_>, &TimeBudget),
        (uv, coarse): (Vec<Point2<f64>>, AngleSolution),
        levels: Vec<LevelReport>,
        observer: &mut dyn Observer,
    ) -> Result<HierarchicalSolution, SolveError> {
        let angles = angles_of(problem.topology(), &uv);
        let (uv, solution) = match self.method {
            HierarchicalMethod::HabfPlusPlus => {
                let history = coarse.history().to_vec();
                (Some(uv), AngleSolution::measure(problem, angles, coarse.termination(), history))
            }
            HierarchicalMethod::HLinAbf => (None, centred::solve(problem, angles, &budget.left(), observer)?),
        };
        Ok(HierarchicalSolution { uv, solution, levels, fallback: None })
    }
}

/// A drawing of the fine mesh.
struct Carried {
    uv: Vec<Point2<f64>>,
    /// That of the coarse mesh.
    solution: AngleSolution,
    levels: Vec<LevelReport>,
}

/// The angles of a drawing, one per corner, rad.
fn angles_of(topology: &Topology, uv: &[Point2<f64>]) -> Vec<f64> {
    let of_face = |f: usize| angles(&topology.face_vertices(abf_mesh::FaceId::new(f)).map(|v| uv[v.index()]));
    let faces: Vec<[f64; 3]> = (0..topology.face_count()).into_par_iter().with_min_len(PER_TASK).map(of_face).collect();
    faces.into_flattened()
}
