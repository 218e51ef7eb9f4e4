//! One component: a list of pieces, each worked on until it is as it should be, or in smaller pieces.

use super::finish::{Finished, finish};
use super::relay::{Ear, Relay};
use super::{SeamRule, Unwrap};
use crate::{FlattenError, Injective, Pipeline, ZeroArea};
use abf_constraints::ProblemError;
use abf_control::{Cancelled, Event, Termination, TimeBudget, ask};
use abf_cut::{Chart, CostSettings, EdgeCosts, Seams, hard_surface_asking, split, split_asking, two_parts_asking};
use abf_embed::EmbedError;
use abf_mesh::{CornerId, FaceId, Topology, TriMesh};
use abf_metrics::MetricsError;
use abf_parallel::prelude::*;
use abf_solve_core::SolveError;

/// A component, or what kept seams have made of one.
#[derive(Clone, Copy)]
pub(super) struct Component<'c, 'o> {
    pub(super) settings: &'c Unwrap,
    pub(super) part: &'c Chart,
    /// Which one it is.
    pub(super) number: usize,
    /// Which of its charts is worked on.
    pub(super) chart: usize,
    /// Whether it comes out as it is if it is a disk, whatever its stretch.
    pub(super) stays_whole: bool,
    /// Whether the edge that a corner of `part` faces may not be a seam.
    pub(super) is_forbidden: &'c (dyn Fn(CornerId) -> bool + Sync),
    /// The time there is for all of them.
    pub(super) budget: &'c TimeBudget,
    pub(super) relay: &'c Relay<'o>,
}

/// What became of a piece.
pub(super) enum Attempt {
    /// Charts that are as they should be, and pieces that are not.
    Done(Vec<Finished>, Vec<Chart>),
    /// No map of it is as it should be.
    Missed,
    /// There was no time to finish it; with its last valid map.
    Interrupted(Termination, Option<Box<Finished>>),
}

impl<'o> Component<'_, 'o> {
    /// Faces that are in none of the charts have no area.
    pub(super) fn run(&self) -> Result<Vec<Finished>, FlattenError> {
        let part = self.part;
        if self.stays_whole && part.topology.require_disk().is_ok() {
            self.relay.begin_charts(self.number, 1);
            let flat = self.pipeline().run(&part.mesh, &mut self.ear())?;
            self.end_chart(part.faces.len());
            return Ok(vec![finish(part, part.mesh.face_count(), flat, &mut || self.go_on())?]);
        }
        self.settings.pipeline.check_memory(&part.mesh)?;
        let mut charts = self.all_of(self.first_pieces()?)?;
        if charts.is_empty() {
            return Err(FlattenError::Certificate(MetricsError::NoArea { faces: part.mesh.face_count() }));
        }
        charts.sort_by_key(|chart| chart.faces[0]);
        Ok(charts)
    }

    /// The nets of a hard surface, or the whole component.
    fn first_pieces(&self) -> Result<Vec<Chart>, FlattenError> {
        let Chart { mesh, topology, .. } = self.part;
        let hard = match self.settings.seams {
            SeamRule::Auto => {
                let may_not_cut = |c| self.may_not_cut(topology, c);
                let crease_angle = self.settings.crease_angle;
                hard_surface_asking(mesh, topology, crease_angle, may_not_cut, &mut || self.go_on())?
            }
            SeamRule::Keep => None,
        };
        self.go_on()?;
        match hard {
            Some(hard) => Ok(split_asking(mesh, topology, &hard.seams, &mut || self.go_on())??),
            None => Ok(vec![self.whole()]),
        }
    }

    /// All of the component as one piece.
    fn whole(&self) -> Chart {
        let Chart { mesh, topology, .. } = self.part;
        let (faces, vertices) = (topology.faces().collect(), topology.vertices().collect());
        Chart { mesh: mesh.clone(), topology: topology.clone(), faces, vertices }
    }

    /// Whether an edge of the component may not be a seam, seen from either side.
    pub(super) fn may_not_cut(&self, topology: &Topology, c: CornerId) -> bool {
        (self.is_forbidden)(c) || topology.opposite(c).is_some_and(self.is_forbidden)
    }

    /// Works on pieces side by side; the order of what comes out is that of the pieces.
    fn all_of(&self, pieces: Vec<Chart>) -> Result<Vec<Finished>, FlattenError> {
        let first = self.relay.begin_charts(self.number, pieces.len());
        let of_piece = |(i, piece): (usize, Chart)| Self { chart: first + i, ..*self }.finish_piece(&piece);
        let finished: Vec<_> = pieces.into_par_iter().enumerate().map(of_piece).collect();
        let mut charts = Vec::new();
        for one in finished {
            charts.extend(one?);
        }
        Ok(charts)
    }

    /// Works on a piece until all of it is in charts that are as they should be: parts of it have fewer faces, and a single
    /// face always is.
    fn finish_piece(&self, piece: &Chart) -> Result<Vec<Finished>, FlattenError> {
        if self.relay.is_aborted() {
            return Err(Cancelled.into());
        }
        let attempt = match self.interruption() {
            Some(end) => Ok(Attempt::Interrupted(end, None)),
            None => self.attempt(piece),
        };
        match attempt {
            Ok(Attempt::Done(mut charts, pieces)) => {
                self.end_chart(charts.iter().map(|chart| chart.faces.len()).sum());
                charts = self.numbered(charts);
                charts.extend(self.all_of(pieces)?);
                Ok(charts)
            }
            Ok(Attempt::Interrupted(end, last)) => {
                self.end_chart(piece.faces.len());
                self.given_up(piece, end, last.map(|last| *last)).map(|charts| self.numbered(charts))
            }
            Err(FlattenError::Cancelled(_)) if !self.relay.is_aborted() => {
                self.end_chart(piece.faces.len());
                self.given_up(piece, Termination::Cancelled, None).map(|charts| self.numbered(charts))
            }
            Err(error) if is_fatal(&error) => Err(error),
            // Nothing to see: its faces are put into one point.
            Err(error) if is_without_area(&error) => {
                self.end_chart(piece.faces.len());
                Ok(Vec::new())
            }
            Err(error) if piece.mesh.face_count() == 1 => Err(error),
            Ok(Attempt::Missed) | Err(_) => {
                self.end_chart(0);
                self.all_of(self.in_two(piece)?)
            }
        }
    }

    /// Charts of the piece that is worked on.
    fn numbered(&self, charts: Vec<Finished>) -> Vec<Finished> {
        charts.into_iter().map(|chart| Finished { piece: self.chart, ..chart }).collect()
    }

    /// The chart that is worked on is done, with so many faces.
    fn end_chart(&self, faces: usize) {
        self.relay.end_chart(self.number, faces);
    }

    fn in_two(&self, piece: &Chart) -> Result<Vec<Chart>, FlattenError> {
        let is_forbidden = |c| self.is_forbidden_in(piece, c);
        let seams = two_parts_asking(&piece.mesh, &piece.topology, is_forbidden, &mut || self.go_on())?;
        self.go_on()?;
        parts(piece, &seams)
    }

    /// Whether the edge that a corner of a piece faces may not be a seam.
    fn is_forbidden_in(&self, piece: &Chart, c: CornerId) -> bool {
        let in_part = |c: CornerId| piece.faces[c.face().index()].corner(c.place());
        (self.is_forbidden)(in_part(c)) || piece.topology.opposite(c).is_some_and(|o| (self.is_forbidden)(in_part(o)))
    }

    /// Why there is no time to go on.
    pub(super) fn interruption(&self) -> Option<Termination> {
        if self.relay.is_stopped() {
            return Some(Termination::Cancelled);
        }
        self.budget.is_spent().then_some(Termination::TimeLimit)
    }

    /// Asks whether to go on, between two parts of the work or two blocks of one.
    pub(super) fn go_on(&self) -> Result<(), Cancelled> {
        ask(&mut self.ear(), Event::Working)
    }

    /// What was tried; `None` where it came to nothing, for any reason but an abort.
    pub(super) fn tried<T>(&self, result: Result<T, FlattenError>) -> Result<Option<T>, FlattenError> {
        match result {
            Err(FlattenError::Cancelled(cancelled)) if self.relay.is_aborted() => Err(cancelled.into()),
            result => Ok(result.ok()),
        }
    }

    /// Someone to tell of the work on a piece.
    pub(super) fn ear(&self) -> Ear<'_, 'o> {
        self.relay.ear(self.number, self.chart)
    }

    /// The settings for one chart: its scale is that of the surface. Faces without area have been refused before, if they
    /// are to be: those that close holes may have none.
    pub(super) fn pipeline(&self) -> Pipeline {
        let (normalize, zero_area, stop) = (false, ZeroArea::Carry, self.budget.left());
        // Charts that lie over themselves are parted here.
        let injective = match self.settings.pipeline.injective {
            Injective::Split => Injective::Off,
            other => other,
        };
        Pipeline { normalize, zero_area, stop, injective, ..self.settings.pipeline.clone() }
    }

    /// The costs of cutting a piece with its holes closed by the faces from `real` on.
    pub(super) fn costs(&self, piece: &Chart, mesh: &TriMesh, topology: &Topology, real: usize) -> EdgeCosts {
        costs_with_caps(mesh, topology, real, &self.settings.costs, |c| self.is_forbidden_in(piece, c))
    }

    /// Whether a chart is as it should be.
    pub(super) fn fits(&self, chart: &Finished) -> bool {
        let metrics = &chart.metrics;
        let is_apart = !self.settings.part_overlaps || metrics.injective();
        // All faces without area: there is no stretch.
        let is_flat = metrics.stretch_l2.is_nan() || metrics.stretch_l2 <= self.settings.max_stretch;
        metrics.valid() && is_apart && is_flat && chart.termination.is_as_asked()
    }
}

/// A piece cut along seams, its parts by the faces of the component.
pub(super) fn parts(piece: &Chart, seams: &Seams) -> Result<Vec<Chart>, FlattenError> {
    let mut charts = split(&piece.mesh, &piece.topology, seams)?;
    for chart in &mut charts {
        chart.faces.iter_mut().for_each(|f| *f = piece.faces[f.index()]);
    }
    Ok(charts)
}

/// The parts of a piece that have these faces of the component each.
pub(super) fn parts_of_faces(piece: &Chart, sets: &[Vec<FaceId>]) -> Result<Vec<Chart>, FlattenError> {
    let mut set_of = vec![u32::MAX; piece.faces.len()];
    for (i, set) in (0..).zip(sets) {
        // Faces of a piece are ascending.
        set.iter().filter_map(|f| piece.faces.binary_search(f).ok()).for_each(|place| set_of[place] = i);
    }
    let side = |c: CornerId| set_of[c.face().index()];
    let seams = Seams::where_edges(&piece.topology, |c, o| side(c) != side(o));
    let charts = parts(piece, &seams)?;
    let is_asked =
        |chart: &Chart| piece.faces.binary_search(&chart.faces[0]).is_ok_and(|place| set_of[place] != u32::MAX);
    Ok(charts.into_iter().filter(is_asked).collect())
}

/// The costs of cutting a mesh whose holes are closed by the faces from `real` on. Seams may not run inside a hole; along its
/// rim they cost nothing, because nothing is cut there. `is_forbidden` is asked about the other edges.
pub(super) fn costs_with_caps(
    mesh: &TriMesh,
    topology: &Topology,
    real: usize,
    settings: &CostSettings,
    is_forbidden: impl Fn(CornerId) -> bool,
) -> EdgeCosts {
    let is_virtual = |c: CornerId| c.face().index() >= real;
    let sides = |c: CornerId| (is_virtual(c), topology.opposite(c).is_none_or(is_virtual));
    let is_forbidden = |c: CornerId| match sides(c) {
        (true, true) => true,
        (false, false) => is_forbidden(c),
        (true, false) | (false, true) => false,
    };
    let mut costs = EdgeCosts::new(mesh, topology, settings, is_forbidden);
    for c in topology.corners().filter(|&c| is_virtual(c)) {
        if topology.opposite(c).is_some_and(|o| !is_virtual(o)) {
            costs.set(topology, c, 0.0);
        }
    }
    costs
}

/// Whether the same error would come of every piece: a setting, or a limit that was asked for.
fn is_fatal(error: &FlattenError) -> bool {
    matches!(
        error,
        FlattenError::Cancelled(_)
            | FlattenError::Memory { .. }
            | FlattenError::LscmLayout(_)
            | FlattenError::DescentLayout(_)
            | FlattenError::Problem(ProblemError::Setting(_))
            | FlattenError::Solve { source: SolveError::Setting(_) | SolveError::Unsupported(_), .. }
            | FlattenError::Descent(EmbedError::Setting(_))
    )
}

fn is_without_area(error: &FlattenError) -> bool {
    matches!(error, FlattenError::Certificate(MetricsError::NoArea { .. }))
}
