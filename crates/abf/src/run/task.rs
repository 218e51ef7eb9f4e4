//! One solver on one problem, from angles or positions to certified UVs.

use super::boundary::{MET, report};
use crate::settings::{Pipeline, SolverKind};
use crate::{FlattenError, Flattening, LayoutReport, PrecisionLimits};
use abf_constraints::{AngleProblem, KktCounts, WheelForm};
use abf_control::{Cancelled, Event, Observer, Stage, StopCriteria, Termination, Verdict, ask};
use abf_embed::Descent;
use abf_mesh::{FaceId, Point2, TriMesh, UvMap};
use abf_metrics::{Certificate, Precision, certify_connected_asking};
use abf_reconstruct::{Layout, LayoutKind, LayoutSettings, aligned, layout_asking};
use abf_solve_core::{AngleSolution, AngleSolver};
use abf_solve_hierarchical::Hierarchical;

/// A problem, and what is asked of it whichever solver it is.
#[derive(Clone, Copy)]
pub(super) struct Given<'t> {
    pub(super) pipeline: &'t Pipeline,
    /// The mesh as it was given.
    pub(super) original: &'t TriMesh,
    /// The mesh that is worked on: the same, or scaled into the range of doubles.
    pub(super) mesh: &'t TriMesh,
    /// By what power of two it is scaled.
    pub(super) scale: f64,
    pub(super) problem: &'t AngleProblem<'t>,
}

/// How one solver gets to UVs.
#[derive(Clone, Copy)]
pub(super) enum Single<'t> {
    /// It finds angles, and these are laid out.
    Angles(&'t dyn AngleSolver),
    /// It moves the vertices.
    Positions(&'t Descent),
    /// It solves and draws a coarse version of the mesh, and carries that back.
    Hierarchy(&'t Hierarchical),
    /// The angles of the surface are laid out as they are.
    SurfaceAngles,
}

impl Single<'_> {
    /// Whether it keeps conditions on the boundary.
    pub(super) fn keeps_boundary(self) -> bool {
        match self {
            Self::Angles(solver) => solver.keeps_boundary(),
            Self::Positions(_) | Self::Hierarchy(_) | Self::SurfaceAngles => false,
        }
    }
}

/// One solver on one problem.
#[derive(Clone, Copy)]
pub(super) struct Task<'t> {
    pub(super) given: Given<'t>,
    pub(super) solver: SolverKind,
    pub(super) method: Single<'t>,
    pub(super) stop: StopCriteria,
    /// A valid drawing for the descent to start from, one point per vertex; otherwise it is a first drawing.
    pub(super) start: Option<&'t [Point2<f64>]>,
}

/// UVs as they will be stored, and what is proved of them.
pub(super) struct Certified {
    pub(super) uv: UvMap,
    pub(super) certificate: Certificate,
}

impl<'t> Task<'t> {
    /// With the stopping criteria of the pipeline.
    pub(super) fn new(given: Given<'t>, solver: SolverKind, method: Single<'t>) -> Self {
        Self { given, solver, method, stop: given.pipeline.stop, start: None }
    }

    /// Runs the solver.
    pub(super) fn run(&self, observer: &mut dyn Observer) -> Result<Flattening, FlattenError> {
        begin(observer, Stage::Solve)?;
        let layout = self.given.pipeline.layout;
        match self.method {
            Single::Angles(solver) => {
                let solution = solver.solve(self.given.problem, &self.stop, observer);
                let solution = solution.map_err(|source| FlattenError::of_solver(self.solver, source))?;
                self.laid_out(Some(solution), layout, observer)
            }
            Single::Positions(descent) => self.descend(descent, observer),
            Single::Hierarchy(hierarchical) => self.by_levels(hierarchical, observer),
            Single::SurfaceAngles => {
                let weighted = LayoutSettings { kind: LayoutKind::LeastSquaresWeighted, ..layout };
                let layout = if layout.kind == LayoutKind::Auto { weighted } else { layout };
                self.laid_out(None, layout, observer)
            }
        }
    }

    /// Lays out the angles of a solution, or those of the surface.
    pub(super) fn laid_out(
        &self,
        solution: Option<AngleSolution>,
        settings: LayoutSettings,
        observer: &mut dyn Observer,
    ) -> Result<Flattening, FlattenError> {
        // A stopped solve still has angles worth laying out.
        ask(observer, Event::StageStarted(Stage::Layout))?;
        let angles = solution.as_ref().map_or(self.given.problem.mesh_angles(), AngleSolution::angles);
        let Layout { uv, kind, linear, closing_error, clamped_angles, .. } = {
            let checkpoint = &mut || ask(observer, Event::Working);
            layout_asking(self.given.mesh, self.given.problem.topology(), angles, &settings, checkpoint)?
        };
        let uv = if self.given.pipeline.normalize { uv.normalized() } else { uv };
        ask(observer, Event::StageStarted(Stage::Certificate))?;
        let certified = self.certified(uv, observer)?;
        let report = LayoutReport {
            kind: Some(kind),
            linear_residual: linear.map(|stats| stats.relative_residual),
            closing_error,
            clamped_angles,
            pinned: !self.given.pipeline.normalize,
            scaled: true,
        };
        Ok(self.flattening(certified, solution, report, &[]))
    }

    /// The same angles by least squares, which averages what the tree carries from triangle to triangle. An error means
    /// no better result.
    pub(super) fn laid_out_again(&self, flat: &Flattening, observer: &mut dyn Observer) -> Option<Flattening> {
        let settings = LayoutSettings { kind: LayoutKind::LeastSquares, ..self.given.pipeline.layout };
        self.laid_out(flat.solution.clone(), settings, observer).ok()
    }

    /// The descent, from a drawing that is there or from a first one.
    fn descend(&self, descent: &Descent, observer: &mut dyn Observer) -> Result<Flattening, FlattenError> {
        let Given { mesh, problem, .. } = self.given;
        let descended = descent.solve(mesh, problem, self.start, &self.stop, observer)?;
        let drawing = (&*descended.uv, descended.area_matched);
        let solution = AngleSolution::measure(problem, descended.angles, descended.termination, descended.iterations);
        self.placed(drawing, solution, &descended.held, observer)
    }

    /// A drawing that is a result, one point per vertex, put where every layout is. With it whether it has the area of the
    /// surface.
    pub(super) fn placed(
        &self,
        (uv, area_matched): (&[Point2<f64>], bool),
        solution: AngleSolution,
        held: &[FaceId],
        observer: &mut dyn Observer,
    ) -> Result<Flattening, FlattenError> {
        ask(observer, Event::StageStarted(Stage::Layout))?;
        let candidates = self.placements(uv, area_matched);
        ask(observer, Event::StageStarted(Stage::Certificate))?;
        let (certified, pinned, scaled) = self.first_valid(candidates, observer)?;
        Ok(self.flattening(certified, Some(solution), LayoutReport::placed(pinned, scaled), held))
    }

    /// Where a drawing may be put, the best place first: where every layout is, then without moving and turning it,
    /// then as it is. Each with whether it is pinned and whether it has the scale asked for.
    pub(super) fn placements(&self, uv: &[Point2<f64>], area_matched: bool) -> Vec<(UvMap, bool, bool)> {
        let as_it_is = UvMap::per_vertex(self.given.mesh, uv);
        let aligned = aligned(self.given.mesh, self.given.problem.topology(), uv);
        let mut places = Vec::new();
        if self.given.pipeline.normalize {
            places.extend(aligned.map(|uv| (uv.normalized(), false, true)));
            places.push((as_it_is.clone().normalized(), false, true));
            places.push((as_it_is, false, false));
        } else {
            places.extend(aligned.map(|uv| (uv, true, true)));
            places.push((as_it_is, false, area_matched));
        }
        places
    }

    /// The first of these drawings that is valid as it will be stored; the first of all if none is.
    pub(super) fn first_valid(
        &self,
        places: Vec<(UvMap, bool, bool)>,
        observer: &mut dyn Observer,
    ) -> Result<(Certified, bool, bool), FlattenError> {
        let mut first = None;
        for (uv, pinned, scaled) in places {
            let placed = (self.certified(uv, observer)?, pinned, scaled);
            if placed.0.certificate.valid() {
                return Ok(placed);
            }
            first.get_or_insert(placed);
        }
        Ok(first.expect("there is always the drawing as it is"))
    }

    pub(super) fn certified(&self, uv: UvMap, observer: &mut dyn Observer) -> Result<Certified, FlattenError> {
        let precision = self.given.pipeline.precision;
        let scale = if self.given.pipeline.normalize { 1.0 } else { self.given.scale };
        let uv = uv.mapped(|p| p.map(|x| precision.round(x / scale)));
        let topology = self.given.problem.topology();
        let checkpoint = &mut || ask(observer, Event::Working);
        let certificate = certify_connected_asking(self.given.original, topology, &uv, precision, checkpoint)?;
        Ok(Certified { uv, certificate })
    }

    pub(super) fn flattening(
        &self,
        certified: Certified,
        solution: Option<AngleSolution>,
        layout: LayoutReport,
        held: &[FaceId],
    ) -> Flattening {
        let Certified { uv, mut certificate } = certified;
        certificate.constraint_residual = solution.as_ref().map(AngleSolution::constraint_residual);
        let starts_from_a_guess = match self.method {
            Single::Angles(_) | Single::Hierarchy(_) => true,
            Single::Positions(_) | Single::SurfaceAngles => false,
        };
        let (topology, is_valid) = (self.given.problem.topology(), certificate.valid());
        let conditions = self.given.problem.boundary();
        let boundary = conditions.map(|conditions| report(topology, conditions, &uv, is_valid));
        let ended = solution.as_ref().map_or(Termination::OnePass, AngleSolution::termination);
        // Where doubles cannot hold what the angles have, it is not there.
        let is_missed = self.given.pipeline.precision == Precision::Double
            && boundary.as_ref().is_some_and(|boundary| boundary.violation > MET);
        let termination = if ended.is_as_asked() && is_missed { Termination::Stalled } else { ended };
        Flattening {
            uv,
            precision_limits: PrecisionLimits::of(&certificate, held),
            certificate,
            solver: self.solver,
            termination,
            layout,
            interior_vertices: self.given.problem.rows().interior_count(),
            kkt: [WheelForm::Log, WheelForm::Product].map(|form| KktCounts::of(form, self.given.problem.rows())),
            shapeless_faces: self.given.problem.shapeless_faces(),
            switched_rings: if starts_from_a_guess { self.given.problem.switched_rings() } else { 0 },
            boundary,
            solution,
            hierarchy: None,
            relaxed: None,
            injective: None,
            pinned: None,
            rungs: Vec::new(),
        }
    }
}

/// Reports a stage before which there is no result to keep.
pub(super) fn begin(observer: &mut dyn Observer, stage: Stage) -> Result<(), FlattenError> {
    match observer.observe(Event::StageStarted(stage)) {
        Verdict::Continue => Ok(()),
        Verdict::Stop | Verdict::Abort => Err(FlattenError::Cancelled(Cancelled)),
    }
}
