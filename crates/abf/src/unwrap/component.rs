//! One component: filled, opened, and cut where the stretch is, until it is flat enough.

use super::finish::finish;
use super::overlap::take_apart;
use super::relay::Ear;
use super::stretch::Stretch;
use super::{HoleRule, SeamRule, Unwrap};
use crate::{FlattenError, LayoutReport, Pipeline, RungReport, SolverKind, ZeroArea};
use abf_constraints::AngleProblem;
use abf_control::{Cancelled, Event, Observer, Stage, Termination, TimeBudget, Verdict, ask};
use abf_cut::{Chart, EdgeCosts, Filled, Seams, distances, extend, fill, open, outer_loop, split};
use abf_mesh::{CornerId, FaceId, Topology, TriMesh, UvMap, VertexId};
use abf_metrics::Metrics;
use abf_reconstruct::{LayoutKind, LayoutSettings, layout};
use abf_solve_core::AngleSolver;
use abf_solve_linabf::{LinAbf, Passes};
use std::num::NonZeroUsize;

/// A component, or what kept seams have made of one.
pub(super) struct Component<'c> {
    pub(super) settings: &'c Unwrap,
    pub(super) part: &'c Chart,
    /// Whether the edge that a corner of `part` faces may not be a seam.
    pub(super) is_forbidden: &'c (dyn Fn(CornerId) -> bool + Sync),
    /// The time there is for all of them.
    pub(super) budget: &'c TimeBudget,
}

/// A chart as it comes out, by the faces of its component.
#[derive(Clone)]
pub(super) struct Finished {
    /// Its faces, by their numbers in the component, ascending.
    pub(super) faces: Vec<FaceId>,
    /// Corner `k` of its `i`-th face is corner `k` of `faces[i]`.
    pub(super) uv: UvMap,
    pub(super) metrics: Metrics,
    pub(super) solver: SolverKind,
    pub(super) termination: Termination,
    pub(super) layout: LayoutReport,
    pub(super) rungs: Vec<RungReport>,
    pub(super) layout_error: Option<f64>,
    pub(super) rounds: usize,
    pub(super) holes_filled: usize,
    pub(super) virtual_faces: usize,
}

/// A component with its holes closed, and where it is cut.
struct Surface {
    mesh: TriMesh,
    topology: Topology,
    /// How many faces are real; the others are virtual.
    real: usize,
    costs: EdgeCosts,
    diagonal: f64,
    seams: Seams,
    holes_filled: usize,
}

impl Component<'_> {
    pub(super) fn run(&self, observer: &mut Ear<'_, '_>) -> Result<Vec<Finished>, FlattenError> {
        let part = self.part;
        let is_disk = part.topology.require_disk().is_ok();
        if is_disk && !self.settings.cut_disks {
            let flat = self.pipeline().run(&part.mesh, observer)?;
            return Ok(vec![finish(part, part.mesh.face_count(), flat)?]);
        }
        if self.settings.holes == HoleRule::Free && is_planar_with_holes(&part.topology) {
            let flat = self.pipeline().run_unclosed(&part.mesh, observer)?;
            return Ok(vec![finish(part, part.mesh.face_count(), flat)?]);
        }
        self.settings.pipeline.check_memory(&part.mesh)?;
        ask(observer, Event::Working)?;
        let mut surface = self.surface()?;
        let rounds = self.cut_where_stretched(&mut surface, observer)?;
        let (chart, flat, more) = self.flatten(&mut surface, observer)?;
        ask(observer, Event::Working)?;
        let real = surface.real;
        let virtual_faces = surface.mesh.face_count() - real;
        let holes_filled = surface.holes_filled;
        let whole = Finished { rounds: rounds + more, holes_filled, virtual_faces, ..finish(&chart, real, flat)? };
        if self.settings.part_overlaps { take_apart(&chart.mesh, whole) } else { Ok(vec![whole]) }
    }

    /// The settings for one chart: its scale is that of the surface. Faces without area have been refused before, if they
    /// are to be: those that close holes may have none.
    fn pipeline(&self) -> Pipeline {
        let (normalize, zero_area, stop) = (false, ZeroArea::Carry, self.budget.left());
        Pipeline { normalize, zero_area, stop, ..self.settings.pipeline.clone() }
    }

    /// Closes what is to be closed and opens the rest.
    fn surface(&self) -> Result<Surface, FlattenError> {
        let Chart { mesh, topology, .. } = self.part;
        let mut holes = topology.boundary_loops();
        let filling = match self.settings.holes {
            HoleRule::Fill(filling) => filling,
            HoleRule::Cut | HoleRule::Free => {
                holes.clear();
                Default::default()
            }
        };
        if let Some(outer) = outer_loop(mesh, &holes) {
            holes.remove(outer);
        }
        let Filled { mesh, topology, first_virtual: real } = fill(mesh, topology, &holes, filling)?;
        let costs = self.costs(&mesh, &topology, real);
        let seams = open(&topology, &costs);
        let diagonal = diagonal(&mesh);
        Ok(Surface { mesh, topology, real, costs, diagonal, seams, holes_filled: holes.len() })
    }

    /// Seams may not run inside a hole; along its rim they cost nothing, because nothing is cut there.
    fn costs(&self, mesh: &TriMesh, topology: &Topology, real: usize) -> EdgeCosts {
        let is_virtual = |c: CornerId| c.face().index() >= real;
        let sides = |c: CornerId| (is_virtual(c), topology.opposite(c).is_none_or(is_virtual));
        let is_forbidden = |c: CornerId| match sides(c) {
            (true, true) => true,
            (false, false) => (self.is_forbidden)(c) || topology.opposite(c).is_some_and(self.is_forbidden),
            _ => false,
        };
        let mut costs = EdgeCosts::new(mesh, topology, &self.settings.costs, is_forbidden);
        for c in topology.corners().filter(|&c| is_virtual(c)) {
            if topology.opposite(c).is_some_and(|o| !is_virtual(o)) {
                costs.set(topology, c, 0.0);
            }
        }
        costs
    }

    /// Flattens quickly, joins the places of largest stretch to the seam, and again; how often.
    fn cut_where_stretched(&self, surface: &mut Surface, observer: &mut Ear<'_, '_>) -> Result<usize, FlattenError> {
        if self.settings.seams == SeamRule::Keep {
            return Ok(0);
        }
        for round in 1..=self.settings.max_rounds {
            observer.begin_round(round);
            ask(observer, Event::Working)?;
            let chart = surface.chart()?;
            let uv = self.flatten_quickly(&chart, observer)?;
            ask(observer, Event::Working)?;
            let stretch = Stretch::measure(&chart, &uv, surface.real, surface.mesh.vertex_count())?;
            let is_over = stretch.l2 <= self.settings.max_stretch || self.budget.is_spent();
            if is_over || !self.cut_further(surface, &stretch) {
                return Ok(round);
            }
        }
        Ok(self.settings.max_rounds)
    }

    /// Joins the places of largest stretch to the seam; `false` when there is nothing to join, or the seam is long enough.
    fn cut_further(&self, surface: &mut Surface, stretch: &Stretch) -> bool {
        let Unwrap { terminals, spacing, reach, max_seam, .. } = *self.settings;
        let is_long =
            |surface: &Surface| max_seam.is_some_and(|limit| surface.seam_length() >= limit * surface.diagonal);
        if is_long(surface) {
            return false;
        }
        let Surface { mesh, topology, costs, diagonal, seams, .. } = surface;
        let way = distances(topology, costs, seams);
        let may_be = |v: VertexId| way[v.index()] > reach * *diagonal && way[v.index()].is_finite();
        let peaks = stretch.peaks(mesh, terminals, spacing * *diagonal, may_be);
        extend(topology, costs, seams, &peaks) > 0
    }

    /// Two passes of LinABF and least squares: near enough to see where the stretch is.
    fn flatten_quickly(&self, chart: &Chart, observer: &mut Ear<'_, '_>) -> Result<UvMap, FlattenError> {
        const PASSES: NonZeroUsize = NonZeroUsize::new(2).unwrap();
        if observer.observe(Event::StageStarted(Stage::Topology)) != Verdict::Continue {
            return Err(FlattenError::Cancelled(Cancelled));
        }
        let settings = &self.settings.pipeline;
        let problem = AngleProblem::new(&chart.topology, chart.mesh.corner_angles(), settings.estimate)?;
        let solver = LinAbf { passes: Passes::Exactly(PASSES) };
        let named = |source| FlattenError::of_solver(SolverKind::LinAbf, source);
        let solution = solver.solve(&problem, &self.budget.left(), observer).map_err(named)?;
        ask(observer, Event::Working)?;
        if solution.termination() == Termination::Cancelled {
            return Err(FlattenError::Cancelled(Cancelled));
        }
        let kind = LayoutSettings { kind: LayoutKind::LeastSquares, ..settings.layout };
        Ok(layout(&chart.mesh, &chart.topology, solution.angles(), &kind)?.uv)
    }

    /// Flattens as asked. Where that comes to no valid map, cuts further and tries again.
    fn flatten(
        &self,
        surface: &mut Surface,
        observer: &mut Ear<'_, '_>,
    ) -> Result<(Chart, crate::Flattening, usize), FlattenError> {
        const ATTEMPTS: usize = 3;
        let mut attempt = 0;
        loop {
            attempt += 1;
            let chart = surface.chart()?;
            let flat = self.pipeline().run(&chart.mesh, observer)?;
            let is_over = flat.certificate.valid()
                || attempt == ATTEMPTS
                || self.settings.seams == SeamRule::Keep
                || matches!(flat.termination, Termination::Cancelled | Termination::TimeLimit);
            let real = surface.real;
            if is_over
                || !self.cut_further(surface, &Stretch::measure(&chart, &flat.uv, real, surface.mesh.vertex_count())?)
            {
                return Ok((chart, flat, attempt - 1));
            }
        }
    }
}

impl Surface {
    /// The surface cut along its seams, which is one disk.
    fn chart(&self) -> Result<Chart, FlattenError> {
        let mut charts = split(&self.mesh, &self.topology, &self.seams)?;
        let chart = charts.swap_remove(0);
        chart.topology.require_disk()?;
        Ok(chart)
    }

    /// The length of the seams between real faces.
    fn seam_length(&self) -> f64 {
        let is_real = |c: CornerId| c.face().index() < self.real;
        let at = |v: VertexId| self.mesh.positions()[v.index()];
        let seams = self.seams.edges(&self.topology);
        let cut = seams.filter(|&c| is_real(c) && self.topology.opposite(c).is_some_and(is_real));
        cut.map(|c| (at(self.topology.vertex(c.next())) - at(self.topology.vertex(c.prev()))).norm()).sum()
    }
}

/// Whether it is a disk with holes: boundary, and no handle.
fn is_planar_with_holes(topology: &Topology) -> bool {
    let loops = topology.boundary_loops().len() as isize;
    loops > 0 && topology.euler_characteristic() == 2 - loops
}

/// The diagonal of the bounding box.
pub(super) fn diagonal(mesh: &TriMesh) -> f64 {
    let mut points = mesh.faces().iter().flatten().map(|v| mesh.positions()[v.index()]);
    let Some(first) = points.next() else { return 0.0 };
    let (low, high) = points.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)));
    (high - low).norm()
}
