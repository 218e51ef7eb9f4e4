//! From any triangle mesh to charts: the flatten–cut loop and everything around it.

mod assemble;
mod component;
mod error;
mod finish;
mod first_rung;
mod flat;
mod foresight;
mod hints;
mod long;
mod order;
mod overlap;
mod piece;
mod relay;
mod rules;
mod scout;
mod stretch;
mod surface;
mod unfinished;

use crate::{
    Elsewhere, FlattenError, InjectiveReport, LayoutReport, Pipeline, RelaxReport, RungReport, SolveReport, SolverKind,
    ZeroArea,
};
use abf_control::{Cancelled, Event, Observer, SettingError, Termination, TimeBudget, ask};
use abf_cut::{
    Chart, CostSettings, DoubleSided, RepairReport, Seams, Weld, label_borders, paired_by_place, repair_asking,
    split_asking, uv_borders, weld_asking,
};
use abf_mesh::{CornerId, FaceId, TriMesh, UvId, UvMap, VertexId};
use abf_metrics::Metrics;
use abf_parallel::prelude::*;
use component::Component;
pub use error::UnwrapError;
use finish::Finished;
pub use hints::SurfaceHints;
use order::InOrder;
use relay::Relay;
pub use rules::{HoleRule, SeamRule};
use std::collections::HashMap;

/// Every setting of an unwrapping: which seams, what becomes of holes, and the [`Pipeline`] for each chart.
///
/// Where seams have to be found, they grow with the stretch: cut to a disk, flatten, look where the map shrinks the
/// surface most, cut there, and again, until the stretch is what is aimed at.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Unwrap {
    /// How each chart is flattened. [`Pipeline::normalize`] does not concern charts: they come out at one scale.
    pub pipeline: Pipeline,
    /// Where seams come from.
    pub seams: SeamRule,
    /// What becomes of holes: of all boundary loops of a component but its longest.
    pub holes: HoleRule,
    /// What seams prefer.
    pub costs: CostSettings,
    /// The L² stretch ([`Metrics::stretch_l2`]) a chart aims at; at least 1.
    pub max_stretch: f64,
    /// Seams of a component grow no further when they are this long, as a multiple of the diagonal of its bounding box.
    pub max_seam: Option<f64>,
    /// Edges where the surface turns by no more than this, rad, are smooth: planar and developable parts are joined across
    /// them first, and across sharper ones as long as nothing meets in the plane. In [0, π].
    pub crease_angle: f64,
    /// A chart longer than so many page widths is parted, unless the mesh is one disk that stays whole: a page is as wide as the
    /// square that all charts together cover half of. At least 1. Below 4, boxes that unfold in one piece are parted, too.
    /// Beside others, a chart whose faces are as long as it is gets a [`scale`](UnwrappedChart::scale) below 1 instead.
    pub max_chart_length: Option<f64>,
    /// How many vertices a round joins to the seam, at most.
    pub terminals: usize,
    /// How far these are apart at least, as a part of the diagonal of the bounding box.
    pub spacing: f64,
    /// How far from the seam such a vertex is at least, at the cost of the way there, as a part of the same diagonal.
    pub reach: f64,
    /// Whether charts that lie over themselves are taken apart.
    pub part_overlaps: bool,
    /// Whether a mesh that is one disk may be cut when it misses the aim: otherwise it comes out whole, as
    /// [`Pipeline::run`] flattens it. Of several components, disks are always worked on like all others.
    pub cut_disks: bool,
    /// Which vertices in one place are joined. The result is in terms of the input: its vertices stay.
    pub weld: Weld,
    /// What becomes of faces with the same three vertices.
    pub double_sided: DoubleSided,
    /// Whether a mesh that needs repair, or has faces without area, is refused.
    pub strict: bool,
}

impl Default for Unwrap {
    fn default() -> Self {
        Self {
            pipeline: Pipeline::default(),
            seams: SeamRule::Auto,
            holes: HoleRule::default(),
            costs: CostSettings::default(),
            max_stretch: 1.15,
            max_seam: None,
            crease_angle: std::f64::consts::FRAC_PI_6,
            max_chart_length: Some(4.0),
            terminals: 3,
            spacing: 0.15,
            reach: 0.0,
            part_overlaps: true,
            cut_disks: false,
            weld: Weld::Auto,
            double_sided: DoubleSided::Own,
            strict: false,
        }
    }
}

/// A mesh in charts.
#[derive(Clone, Debug)]
pub struct Unwrapped {
    /// The charts, in the order of the lowest faces of their components. Each has coordinates of its own.
    pub charts: Vec<UnwrappedChart>,
    /// What had to be repaired.
    pub repairs: RepairReport,
    /// The edges of the input along which charts are cut, lower vertex first, ascending. Edges that a repair split are not
    /// among them.
    pub seams: Vec<[VertexId; 2]>,
    /// Their length, in units of the mesh.
    pub seam_length: f64,
    /// The diagonal of the bounding box of the mesh, to compare lengths with.
    pub diagonal: f64,
    /// How many faces are in no chart because their component, or what kept seams made of it, has no area at all. Their
    /// corners are in one point.
    pub without_area: usize,
    /// Corners of faces that are in no chart, each with the corner whose UV it takes: see [`Unwrapped::assemble`].
    pub followers: Vec<(CornerId, CornerId)>,
    /// The faces of the input that repair turned around, ascending: their UVs run the other way.
    pub turned: Vec<FaceId>,
    /// How many faces lie on the UVs of an earlier face with the same vertices ([`DoubleSided::Shared`]).
    pub shared: usize,
    /// How many charts were parted because they were long ([`Unwrap::max_chart_length`]).
    pub parted: usize,
    corner_count: usize,
}

/// One chart.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct UnwrappedChart {
    /// The component of the repaired mesh it is of.
    pub component: usize,
    /// The number that its events had as [`UnwrapProgress::chart`](crate::UnwrapProgress::chart): charts that were taken apart after they were
    /// flattened have the same.
    pub piece: usize,
    /// Its faces, by their numbers in the input, ascending.
    pub faces: Vec<FaceId>,
    /// Its UVs: corner `3i + k` is corner `k` of the input's face `faces[i]`. The area is that of the surface.
    pub uv: UvMap,
    /// Its distortion and its certificate, without virtual faces. Faces that were turned around count as turned.
    pub metrics: Metrics,
    /// Whose result it is.
    pub solver: SolverKind,
    /// How the solver ended.
    pub termination: Termination,
    /// What the solver did, on its last disk with that disk's virtual faces.
    pub solve: SolveReport,
    /// What the layout did.
    pub layout: LayoutReport,
    /// What relaxing did, on its last disk; `None` where it was not asked for, or the chart lies in a plane.
    pub relaxed: Option<RelaxReport>,
    /// What was done about overlaps, by [`Injective::Deform`](crate::Injective::Deform); `None` where nothing was.
    pub injective: Option<InjectiveReport>,
    /// What the solvers of [`SolverKind::Auto`] came to.
    pub rungs: Vec<RungReport>,
    /// The largest difference between an angle of the UVs and the one solved for, rad, over faces that are not virtual;
    /// `None` where no angles were solved for.
    pub layout_error: Option<f64>,
    /// The length of its seams, in units of the mesh; those with itself on both sides count once.
    pub seam_length: f64,
    /// How many flattenings it took to find its seams; 0 where there was nothing to find.
    pub rounds: usize,
    /// How many holes were filled while it was flattened.
    pub holes_filled: usize,
    /// How many virtual faces that took.
    pub virtual_faces: usize,
    /// The size at which an atlas has it, as a part of that of the other charts: below 1 where it is longer than
    /// [`Unwrap::max_chart_length`] and cannot be parted. Its UVs have the area of the surface all the same.
    pub scale: f64,
    /// Whether there was no time to finish it: it is its last valid map, and may miss the aim.
    pub unfinished: bool,
}

impl UnwrappedChart {
    /// Whether this is what was asked for: valid UVs of a solver that ended as asked.
    #[must_use]
    pub fn is_certified(&self) -> bool {
        self.metrics.valid() && self.termination.is_as_asked()
    }
}

impl Unwrap {
    /// Repairs, cuts and flattens a mesh.
    ///
    /// A mesh that is one clean disk comes back as one chart without seams, with the bits of [`Pipeline::run`], unless
    /// [`cut_disks`](Self::cut_disks) is set. Every other comes out in charts that are valid, do not lie over themselves and are
    /// within [`max_stretch`](Self::max_stretch), each; when it is cancelled or out of time, what is not finished comes out
    /// as [`unfinished`](UnwrappedChart::unfinished) charts. Components and pieces of them
    /// are worked on in parallel; the same input gives the same bits whatever the thread count. A time limit of the
    /// pipeline is one for all flattenings together; a limit of memory is one for each.
    ///
    /// # Errors
    /// [`UnwrapError`] when there are no faces to work with, a setting or a hint does not fit, a strict run would have to
    /// repair, or a chart has no usable result at all.
    pub fn run(
        &self,
        mesh: &TriMesh,
        hints: &SurfaceHints<'_>,
        observer: &mut (dyn Observer + Send),
    ) -> Result<Unwrapped, UnwrapError> {
        self.check()?;
        hints.check(mesh)?;
        let in_range = mesh.in_range();
        let (working, scale) = in_range.as_ref().map_or((mesh, 1.0), |(scaled, scale)| (scaled, *scale));
        ask(observer, Event::Working)?;
        let mut checkpoint = || ask(observer, Event::Working);
        let welded = weld_asking(working, self.weld.scaled(scale), hints.objects, &mut checkpoint)?;
        let joined = welded.as_ref().map_or(working, |welded| &welded.mesh);
        let paired = (self.double_sided == DoubleSided::Shared).then(|| paired_by_place(joined)).flatten();
        let mut repaired = repair_asking(paired.as_ref().unwrap_or(joined), self.double_sided, &mut checkpoint)?;
        repaired.report.joined_vertices = welded.as_ref().map(|welded| welded.joined).unwrap_or_default();
        ask(observer, Event::Working)?;
        if self.strict {
            error::refuse_repairs(&repaired.report)?;
        }
        if self.pipeline.zero_area == ZeroArea::Refuse {
            working.check_geometry().map_err(FlattenError::from)?;
        }
        let budget = TimeBudget::start(&self.pipeline.stop);
        let kept = self.kept_seams(&repaired, working, hints);
        ask(observer, Event::Working)?;
        let checkpoint = &mut || ask(observer, Event::Working);
        let parts = split_asking(&repaired.mesh, &repaired.topology, &kept, checkpoint)?.map_err(FlattenError::from)?;
        checkpoint()?;
        let stays_whole = parts.len() == 1 && !self.cut_disks;
        let in_order = |part: Chart| {
            let is_kept = stays_whole && part.topology.require_disk().is_ok();
            if is_kept { Ok(InOrder::as_it_is(part)) } else { InOrder::of_places(&part) }
        };
        let parts: Vec<InOrder> = parts.into_iter().map(in_order).collect::<Result<_, _>>()?;
        ask(observer, Event::Working)?;
        let relay = Relay::new(observer, parts.len(), repaired.mesh.face_count());
        let finish = |(number, in_order): (usize, &InOrder)| -> Result<Vec<Finished>, UnwrapError> {
            let is_forbidden = |c: CornerId| hints.is_forbidden(repaired.input_corner(in_order.corner(c)));
            let part = &in_order.chart;
            let (settings, is_forbidden, budget, relay) = (self, &is_forbidden, &budget, &relay);
            let component = Component { settings, part, number, chart: 0, stays_whole, is_forbidden, budget, relay };
            let first = repaired.faces[in_order.lowest_face().index()];
            let charts = component.run().map_err(|source| UnwrapError::Chart { first, source })?;
            relay.ear(number, 0).end();
            Ok(charts)
        };
        let finished: Vec<Result<Vec<Finished>, UnwrapError>> = parts.par_iter().enumerate().map(finish).collect();
        if relay.is_aborted() {
            return Err(Cancelled.into());
        }
        // One after the other, so that it is always the first error that is told.
        let mut charts = Vec::with_capacity(parts.len());
        let mut nowhere = None;
        for finished in finished {
            match finished {
                Ok(finished) => charts.push(finished),
                Err(error) if error.is_without_area() => {
                    charts.push(Vec::new());
                    nowhere.get_or_insert(error);
                }
                Err(error) => return Err(error),
            }
        }
        let last = (parts.len() - 1, charts.last().map_or(0, |charts: &Vec<_>| charts.len().saturating_sub(1)));
        let mut go_on = || ask(&mut relay.ear(last.0, last.1), Event::Working);
        let parted = match self.max_chart_length.filter(|_| !stays_whole) {
            None => 0,
            Some(limit) => self.part_long(limit, (&repaired, hints), &parts, &mut charts, &mut go_on)?,
        };
        match nowhere.filter(|_| charts.iter().all(Vec::is_empty)) {
            Some(error) => Err(error),
            None => {
                let whole = assemble::unwrapped(
                    mesh,
                    paired.as_ref().or(welded.as_ref().map(|welded| &welded.mesh)).unwrap_or(mesh),
                    &repaired,
                    &parts,
                    charts,
                    scale,
                    self.pipeline.precision,
                    &mut go_on,
                )?;
                let mut whole = Unwrapped { parted, ..whole };
                if let Some(limit) = self.max_chart_length.filter(|_| !stays_whole) {
                    long::shrink_long(&mut whole.charts, limit);
                }
                Ok(whole)
            }
        }
    }

    /// The seams to begin with.
    fn kept_seams(&self, repaired: &abf_cut::Repaired, written: &TriMesh, hints: &SurfaceHints<'_>) -> Seams {
        let topology = &repaired.topology;
        let mut seams = Seams::none(topology);
        if self.seams == SeamRule::Auto {
            return seams;
        }
        let mut keep = |borders: Seams| borders.edges(topology).for_each(|c| seams.insert(topology, c));
        if repaired.report.joined_vertices.count > 0 {
            // Where the file has two vertices in one place it has a seam.
            let of_corner = |c| {
                let corner = repaired.input_corner(c);
                UvId::new(written.faces()[corner.face().index()][corner.place()].index())
            };
            keep(uv_borders(topology, &topology.corners().map(of_corner).collect::<Vec<_>>()));
        }
        if let Some(uv) = hints.uv {
            // Points of a vertex that are in one place are one: some files repeat them for every corner.
            let mut known = HashMap::new();
            let of_corner = |c| {
                let place = uv.corner(repaired.input_corner(c)).map(|x| (x + 0.0).to_bits());
                let next = UvId::new(known.len());
                *known.entry((topology.vertex(c), place.x, place.y)).or_insert(next)
            };
            let ids: Vec<UvId> = topology.corners().map(of_corner).collect();
            // A vertex that was split has points of its own; only those of one vertex are compared.
            keep(uv_borders(topology, &ids));
        }
        if let Some(labels) = hints.face_labels {
            let of_face = |f: &FaceId| labels[f.index()];
            keep(label_borders(topology, &repaired.faces.iter().map(of_face).collect::<Vec<_>>()));
        }
        if let Some(marked) = hints.seams {
            let is_marked = |c: &CornerId| marked[repaired.input_corner(*c).index()];
            topology.corners().filter(is_marked).for_each(|c| seams.insert(topology, c));
        }
        seams
    }

    /// Checks every setting, those of the [`Pipeline`] included. [`Unwrap::run`] does so first, with the same error.
    ///
    /// # Errors
    /// [`UnwrapError::Setting`] or [`UnwrapError::Flatten`], naming the setting and what it may be.
    pub fn check(&self) -> Result<(), UnwrapError> {
        let wrong = |name, allowed, value: f64| Err(SettingError::new(name, allowed, value).into());
        if !(self.max_stretch >= 1.0) {
            return wrong("max_stretch", "at least 1", self.max_stretch);
        }
        // The rims of filled holes, and charts that lie in a plane, would not keep it.
        if self.pipeline.boundary_gap > 0.0 {
            let allowed = "0 for charts: an inner margin keeps their parts apart";
            return wrong("boundary_gap", allowed, self.pipeline.boundary_gap);
        }
        if let Some(length) = self.max_chart_length.filter(|length| !(*length >= 1.0)) {
            return wrong("max_chart_length", "at least 1", length);
        }
        if let Some(limit) = self.max_seam.filter(|limit| !(*limit >= 0.0)) {
            return wrong("max_seam", "at least 0", limit);
        }
        for (name, value) in [("spacing", self.spacing), ("reach", self.reach)] {
            if !(value >= 0.0) {
                return wrong(name, "at least 0", value);
            }
        }
        if !(0.0..=std::f64::consts::PI).contains(&self.crease_angle) {
            return wrong("crease_angle", "in [0, π]", self.crease_angle);
        }
        if self.terminals == 0 {
            return wrong("terminals", "at least 1", 0.0);
        }
        for (name, value) in [("costs.crease", self.costs.crease), ("costs.hidden", self.costs.hidden)] {
            if !(0.0..1.0).contains(&value) {
                return wrong(name, "in [0, 1)", value);
            }
        }
        if let Weld::Within(distance) = self.weld
            && !(distance >= 0.0 && distance.is_finite())
        {
            return wrong("weld", "a distance of at least 0", distance);
        }
        if !self.pipeline.boundary.is_free() {
            return Err(FlattenError::BoundaryCharts(self.pipeline.boundary.to_string()).into());
        }
        if self.pipeline.pins.is_some() {
            return Err(FlattenError::PinsElsewhere(Elsewhere::Charts).into());
        }
        Ok(self.pipeline.check()?)
    }
}
