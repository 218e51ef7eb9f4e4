//! One solver on one problem, from angles or positions to certified UVs.

use crate::pipeline::begin;
use crate::{FlattenError, Flattening, LayoutReport, Pipeline, PrecisionLimits, SolverKind};
use abf_constraints::{AngleProblem, KktCounts, WheelForm};
use abf_control::{Event, Observer, Stage, Termination, ask};
use abf_mesh::{FaceId, Point2, TriMesh, UvMap};
use abf_metrics::{Certificate, certify_connected};
use abf_reconstruct::{Layout, LayoutKind, LayoutSettings, aligned, layout};
use abf_solve_core::AngleSolution;

/// A problem, and how to solve it.
#[derive(Clone, Copy)]
pub(crate) struct Task<'t> {
    pub(crate) pipeline: Pipeline,
    /// The mesh as it was given.
    pub(crate) original: &'t TriMesh,
    /// The mesh that is worked on: the same, or scaled into the range of doubles.
    pub(crate) mesh: &'t TriMesh,
    /// By what power of two it is scaled.
    pub(crate) scale: f64,
    pub(crate) problem: &'t AngleProblem<'t>,
    /// A valid drawing for the descent to start from, one point per vertex; otherwise it is Tutte's embedding.
    pub(crate) start: Option<&'t [Point2<f64>]>,
}

/// UVs as they will be stored, and what is proved of them.
struct Certified {
    uv: UvMap,
    certificate: Certificate,
}

impl Task<'_> {
    /// Runs the one solver of the pipeline.
    pub(crate) fn run(&self, observer: &mut dyn Observer) -> Result<Flattening, FlattenError> {
        match self.pipeline.solver {
            SolverKind::Descent => self.descend(observer),
            _ => self.solve_and_lay_out(observer),
        }
    }

    fn solve_and_lay_out(&self, observer: &mut dyn Observer) -> Result<Flattening, FlattenError> {
        begin(observer, Stage::Solve)?;
        let solution = self.solve(observer)?;
        self.laid_out(solution, self.layout_settings(), observer)
    }

    /// `None` for LSCM, which solves for no angles.
    fn solve(&self, observer: &mut dyn Observer) -> Result<Option<AngleSolution>, FlattenError> {
        let Some(solver) = self.pipeline.angle_solver() else { return Ok(None) };
        let solution = solver.solve(self.problem, &self.pipeline.stop, observer);
        solution.map(Some).map_err(|source| FlattenError::of_solver(solver.name(), source))
    }

    fn layout_settings(&self) -> LayoutSettings {
        let mut settings = self.pipeline.layout;
        if self.pipeline.solver == SolverKind::Lscm && settings.kind == LayoutKind::Auto {
            settings.kind = LayoutKind::LeastSquaresWeighted;
        }
        settings
    }

    /// Lays out the angles of a solution, or those of the surface.
    fn laid_out(
        &self,
        solution: Option<AngleSolution>,
        settings: LayoutSettings,
        observer: &mut dyn Observer,
    ) -> Result<Flattening, FlattenError> {
        // A stopped solve still has angles worth laying out.
        ask(observer, Event::StageStarted(Stage::Layout))?;
        let angles = solution.as_ref().map_or(self.problem.mesh_angles(), AngleSolution::angles);
        let Layout { uv, kind, linear, closing_error, moved_angles } =
            layout(self.mesh, self.problem.topology(), angles, &settings)?;
        let uv = if self.pipeline.normalize { uv.normalized() } else { uv };
        ask(observer, Event::StageStarted(Stage::Certificate))?;
        let certified = self.certified(uv)?;
        let report = LayoutReport {
            kind: Some(kind),
            linear_residual: linear.map(|stats| stats.relative_residual),
            closing_error,
            moved_angles,
            pinned: !self.pipeline.normalize,
            scaled: true,
        };
        Ok(self.flattening(certified, solution, report, &[]))
    }

    /// The same angles by least squares, which averages what the tree carries from triangle to triangle. An error means
    /// no better result.
    pub(crate) fn laid_out_again(&self, flat: &Flattening, observer: &mut dyn Observer) -> Option<Flattening> {
        let settings = LayoutSettings { kind: LayoutKind::LeastSquares, ..self.pipeline.layout };
        self.laid_out(flat.solution.clone(), settings, observer).ok()
    }

    /// The descent, from a drawing that is there or from Tutte's embedding.
    fn descend(&self, observer: &mut dyn Observer) -> Result<Flattening, FlattenError> {
        begin(observer, Stage::Solve)?;
        let Pipeline { descent, stop, .. } = &self.pipeline;
        let descended = descent.solve(self.mesh, self.problem, self.start, stop, observer)?;
        ask(observer, Event::StageStarted(Stage::Layout))?;
        let candidates = self.placements(&descended.uv, descended.area_matched);
        ask(observer, Event::StageStarted(Stage::Certificate))?;
        let (certified, pinned, scaled) = self.first_valid(candidates)?;
        let solution =
            AngleSolution::measure(self.problem, descended.angles, descended.termination, descended.iterations);
        let report =
            LayoutReport { kind: None, linear_residual: None, closing_error: None, moved_angles: 0, pinned, scaled };
        Ok(self.flattening(certified, Some(solution), report, &descended.held))
    }

    /// Where a drawing may be put, the best place first: where every layout is, then without moving and turning it,
    /// then as it is. Each with whether it is pinned and whether it has the scale asked for.
    fn placements(&self, uv: &[Point2<f64>], area_matched: bool) -> Vec<(UvMap, bool, bool)> {
        let as_it_is = UvMap::per_vertex(self.mesh, uv);
        let aligned = aligned(self.mesh, self.problem.topology(), uv);
        let mut places = Vec::new();
        if self.pipeline.normalize {
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
    fn first_valid(&self, places: Vec<(UvMap, bool, bool)>) -> Result<(Certified, bool, bool), FlattenError> {
        let mut first = None;
        for (uv, pinned, scaled) in places {
            let placed = (self.certified(uv)?, pinned, scaled);
            if placed.0.certificate.valid() {
                return Ok(placed);
            }
            first.get_or_insert(placed);
        }
        Ok(first.expect("there is always the drawing as it is"))
    }

    fn certified(&self, uv: UvMap) -> Result<Certified, FlattenError> {
        let precision = self.pipeline.precision;
        let scale = if self.pipeline.normalize { 1.0 } else { self.scale };
        let uv = uv.mapped(|p| p.map(|x| precision.round(x / scale)));
        let certificate = certify_connected(self.original, self.problem.topology(), &uv, precision)?;
        Ok(Certified { uv, certificate })
    }

    fn flattening(
        &self,
        certified: Certified,
        solution: Option<AngleSolution>,
        layout: LayoutReport,
        held: &[FaceId],
    ) -> Flattening {
        let Certified { uv, certificate } = certified;
        let constraint_residual = solution.as_ref().map(AngleSolution::constraint_residual);
        let certificate = Certificate { constraint_residual, ..certificate };
        let starts_from_an_estimate = !matches!(self.pipeline.solver, SolverKind::Lscm | SolverKind::Descent);
        Flattening {
            uv,
            precision_limits: PrecisionLimits::of(&certificate, held),
            certificate,
            solver: self.pipeline.solver,
            termination: solution.as_ref().map_or(Termination::OnePass, AngleSolution::termination),
            layout,
            interior_vertices: self.problem.rows().interior_count(),
            kkt: [WheelForm::Log, WheelForm::Product].map(|form| KktCounts::of(form, self.problem.rows())),
            shapeless_faces: self.problem.shapeless_faces(),
            switched_rings: if starts_from_an_estimate { self.problem.switched_rings() } else { 0 },
            solution,
            rungs: Vec::new(),
        }
    }
}
