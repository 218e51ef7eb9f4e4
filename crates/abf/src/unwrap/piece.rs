//! One piece: flattened as it is, else cut where the stretch is until it is flat enough.

use super::component::{Attempt, Component, parts_of_faces};
use super::finish::{Finished, finish};
use super::foresight::{Foresight, Progress};
use super::overlap::take_apart;
use super::scout::Scouted;
use super::stretch::{Peaks, Stretch};
use super::surface::Surface;
use super::{HoleRule, Unwrap};
use crate::run::Prospect;
use crate::{FlattenError, Flattening, SolverKind};
use abf_constraints::AngleProblem;
use abf_control::{Cancelled, Event, Observer, Stage, Termination, Verdict, ask};
use abf_cut::{Chart, HoleFilling};
use abf_mesh::{Topology, TriMesh, UvMap, VertexId};
use abf_reconstruct::{LayoutKind, LayoutSettings, layout_asking};
use abf_solve_core::AngleSolver;
use abf_solve_linabf::{LinAbf, Passes};
use std::f64::consts::{PI, TAU};
use std::num::NonZeroUsize;

/// A piece that is curved by more than this in all, rad, the sum of its angle deficits, is not worth flattening with its
/// holes open: half a sphere has 2π.
const MOST_CURVED: f64 = 1.5 * PI;

/// A disk unfolds when the sizes of its angle deficits sum to no more than this, rad: no stretch to speak of can be foreseen.
const UNFOLDS: f64 = 1e-4;

impl Component<'_, '_> {
    /// Flattens a piece, or finds that it has to be parted.
    pub(super) fn attempt(&self, piece: &Chart) -> Result<Attempt, FlattenError> {
        // What lies in a plane has a place there already; holes that are to be joined are cut first.
        let may_stay = self.settings.holes != HoleRule::Cut || piece.topology.boundary_loops().len() <= 1;
        let laid_flat = if may_stay { self.laid_flat(piece)? } else { None };
        if let Some(flat) = laid_flat {
            return Ok(Attempt::Done(vec![flat], Vec::new()));
        }
        let is_disk = piece.topology.require_disk().is_ok();
        let curvature = Curvature::of(piece);
        let is_little_curved = curvature.total.abs() <= MOST_CURVED;
        let may_stay_open = match self.settings.holes {
            HoleRule::Free => is_planar_with_holes(&piece.topology),
            HoleRule::Auto => is_planar_with_holes(&piece.topology) && is_little_curved,
            HoleRule::Fill(_) | HoleRule::Cut => false,
        };
        let mut foresight = Foresight::new(self.settings.max_stretch);
        // What is foreseen is the stretch of a conformal map.
        let is_relaxed = self.settings.pipeline.relax.is_some();
        // What unfolds is worth it.
        let is_sure = is_relaxed || curvature.absolute <= UNFOLDS;
        let may_do_as_it_is =
            (is_disk || may_stay_open) && (is_sure || !foresight.is_hopeless_as_it_is(piece, &mut || self.go_on())?);
        let as_it_is = if may_do_as_it_is { self.as_it_is(piece, is_disk, &mut foresight)? } else { None };
        if let Some(attempt) = as_it_is {
            return Ok(attempt);
        }
        let has_holes = !is_disk && piece.topology.boundary_loops().len() > 1;
        let filling = match self.settings.holes {
            HoleRule::Fill(filling) => Some(filling),
            HoleRule::Auto => Some(HoleFilling::default()),
            HoleRule::Cut | HoleRule::Free => None,
        };
        let may_be_cut = self.settings.holes == HoleRule::Auto && has_holes;
        let with_holes_cut =
            if may_be_cut && is_little_curved { self.with_holes_cut(piece, &mut foresight)? } else { None };
        if let Some(attempt) = with_holes_cut {
            return Ok(attempt);
        }
        self.cut_until_it_fits(piece, filling.filter(|_| has_holes), &mut foresight)
    }

    /// The first rung alone: enough for what is flat or nearly so. `None` where more has to be done.
    fn as_it_is(
        &self,
        piece: &Chart,
        is_disk: bool,
        foresight: &mut Foresight,
    ) -> Result<Option<Attempt>, FlattenError> {
        foresight.refine_as_it_is(piece, &mut || self.go_on())?;
        let (pipeline, mut ear) = (self.pipeline_of_first_rung(), self.ear());
        let expected = foresight.angles_as_it_is(&piece.mesh);
        let prospect = Prospect { enough: Some(self.settings.max_stretch), expected: expected.as_deref() };
        let flat = if is_disk {
            pipeline.run_within(&piece.mesh, prospect, &mut ear)
        } else {
            pipeline.run_unclosed(&piece.mesh, prospect, &mut ear)
        };
        let whole = match flat {
            Ok(flat) => self.of_piece(piece, finish(piece, piece.mesh.face_count(), flat, &mut || self.go_on())?),
            Err(error) if piece.mesh.face_count() == 1 => return Err(error),
            Err(FlattenError::Cancelled(cancelled)) => return Err(cancelled.into()),
            // Another rung may do it, or parts of it.
            Err(_) => return Ok(None),
        };
        self.judged(piece, whole)
    }

    /// The same with the holes joined by seams: enough for open tubes.
    fn with_holes_cut(&self, piece: &Chart, foresight: &mut Foresight) -> Result<Option<Attempt>, FlattenError> {
        let surface = self.surface(piece, None)?;
        self.go_on()?;
        if foresight.stretch(&surface, &mut || self.go_on())?.is_some() && foresight.is_hopeless() {
            return Ok(None);
        }
        let chart = surface.chart()?;
        foresight.refine(&surface, &mut || self.go_on())?;
        let Some(flat) = self.first_rung(&chart, &surface, foresight, 0)? else { return Ok(None) };
        let whole = self.of_piece(piece, finish(&chart, surface.real, flat, &mut || self.go_on())?);
        let whole = Finished { rounds: 1, ..whole };
        self.judged(piece, whole)
    }

    /// A map of the piece that is as it should be, or is once it is taken apart where it lies over itself; `None` where it is
    /// neither, or where more than that has to be parted.
    fn judged(&self, piece: &Chart, whole: Finished) -> Result<Option<Attempt>, FlattenError> {
        if self.fits(&whole) {
            return Ok(Some(Attempt::Done(vec![whole], Vec::new())));
        }
        if whole.termination.is_interruption() {
            let last = whole.metrics.valid().then(|| Box::new(whole.clone()));
            return Ok(Some(Attempt::Interrupted(whole.termination, last)));
        }
        let is_flat = whole.metrics.stretch_l2 <= self.settings.max_stretch;
        if whole.metrics.valid() && whole.termination.is_as_asked() && is_flat {
            return self.taken_apart(piece, whole).map(Some);
        }
        // A single face cannot be parted.
        if piece.mesh.face_count() == 1 {
            return Ok(Some(Attempt::Done(vec![whole], Vec::new())));
        }
        Ok(None)
    }

    /// A valid map with little stretch that lies over itself, in parts that do not.
    fn taken_apart(&self, piece: &Chart, whole: Finished) -> Result<Attempt, FlattenError> {
        let parts = self.apart(piece, whole)?;
        let (done, more): (Vec<Finished>, Vec<Finished>) = parts.into_iter().partition(|part| self.fits(part));
        let more: Vec<_> = more.into_iter().map(|part| part.faces).collect();
        let more = if more.is_empty() { Vec::new() } else { parts_of_faces(piece, &more)? };
        Ok(Attempt::Done(done, more))
    }

    /// A map that lies over itself, in parts.
    fn apart(&self, piece: &Chart, whole: Finished) -> Result<Vec<Finished>, FlattenError> {
        let may_not_cut = |c| self.may_not_cut(&self.part.topology, c);
        take_apart(piece, whole, &may_not_cut, &mut || self.go_on())
    }

    /// Faces by their numbers in the component.
    fn of_piece(&self, piece: &Chart, mut chart: Finished) -> Finished {
        chart.faces.iter_mut().for_each(|f| *f = piece.faces[f.index()]);
        chart
    }

    fn surface(&self, piece: &Chart, filling: Option<HoleFilling>) -> Result<Surface, FlattenError> {
        Surface::new(piece, filling, &|mesh, topology, real| self.costs(piece, mesh, topology, real))
    }

    /// Joins the places of largest stretch to the seam until a map is as it should be: where the stretch can be foreseen, a
    /// map is made only where it may be the last one.
    fn cut_until_it_fits(
        &self,
        piece: &Chart,
        filling: Option<HoleFilling>,
        foresight: &mut Foresight,
    ) -> Result<Attempt, FlattenError> {
        self.go_on()?;
        let mut surface = self.surface(piece, filling)?;
        let (mut progress, mut maps) = (Progress::default(), Progress::default());
        let mut last: Option<(Chart, UvMap)> = None;
        let mut round = 1;
        loop {
            self.go_on()?;
            let scouted = self.scout(piece, filling, &mut surface, foresight, round)?;
            if let Some(end) = self.interruption() {
                let last = last.and_then(|(chart, uv)| self.last_valid(piece, &surface, &chart, &uv, end));
                return Ok(Attempt::Interrupted(end, last.map(Box::new)));
            }
            let (is_foreseen, is_stalled) = match scouted {
                Scouted::Hopeless => return Ok(Attempt::Missed),
                // Maps have missed the aim with less than that.
                Scouted::Stalled(_) if last.is_some() => return Ok(Attempt::Missed),
                Scouted::Promising(cuts) | Scouted::Stalled(cuts) => {
                    round += cuts;
                    (true, matches!(scouted, Scouted::Stalled(_)))
                }
                Scouted::Unknown(cuts) => {
                    round += cuts;
                    (false, false)
                }
            };
            // What is foreseen is the stretch of a conformal map.
            let is_relaxed = self.settings.pipeline.relax.is_some();
            let refined =
                if is_foreseen && !is_relaxed { foresight.refine(&surface, &mut || self.go_on())? } else { None };
            // A closer look may tell that a map would miss the aim.
            let may_go_on = |l2: f64| l2 > self.settings.max_stretch && !is_stalled && !self.is_long(&surface);
            if let Some(stretch) = refined.filter(|stretch| may_go_on(stretch.l2))
                && !progress.is_stalled(stretch.l2)
                && self.cut_further(&mut surface, &stretch)
            {
                round += 1;
                self.release_caps(piece, filling, &mut surface)?;
                continue;
            }
            let mut ear = self.ear();
            ear.begin_round(round);
            ask(&mut ear, Event::Working)?;
            let chart = surface.chart()?;
            self.go_on()?;
            let real = surface.real;
            let vertices = surface.mesh.vertex_count();
            let first_rung = if is_foreseen || is_relaxed {
                self.first_rung(&chart, &surface, foresight, maps.rounds())?
            } else {
                None
            };
            let known = first_rung.map(|flat| (flat.uv.clone(), flat));
            let (quick, first_rung) = match known {
                Some((uv, flat)) => (Ok(uv), Some(flat)),
                None => (self.flatten_quickly(&chart, &mut ear), None),
            };
            let mut stretch = match &quick {
                Ok(uv) => Some(Stretch::measure(&chart, uv, real, vertices)?),
                Err(FlattenError::Cancelled(_)) if !self.relay.is_aborted() => continue,
                Err(FlattenError::Cancelled(cancelled)) => return Err((*cancelled).into()),
                Err(_) => None,
            };
            self.go_on()?;
            let is_long = self.is_long(&surface);
            if is_long || stretch.as_ref().is_none_or(|stretch| stretch.l2 <= self.settings.max_stretch) {
                let is_enough = |flat: &Flattening| flat.is_certified();
                let flat = match first_rung.filter(is_enough) {
                    Some(flat) => flat,
                    None => {
                        let prospect = Prospect { enough: Some(self.settings.max_stretch), expected: None };
                        self.pipeline().run_within(&chart.mesh, prospect, &mut ear)?
                    }
                };
                let uv = flat.uv.clone();
                let whole = self.finished(piece, &surface, &chart, flat, round)?;
                if is_long && whole.metrics.valid() {
                    return self.taken_apart_if_over(piece, whole);
                }
                if let Some(attempt) = self.judged(piece, whole)? {
                    return Ok(attempt);
                }
                stretch = Some(Stretch::measure(&chart, &uv, real, vertices)?);
                self.go_on()?;
            }
            let stretch = stretch.expect("measured above where it was not before");
            last = quick.ok().map(|uv| (chart, uv));
            foresight.learn(stretch.l2);
            let aim = self.settings.max_stretch;
            let is_in_vain =
                progress.is_stalled(stretch.l2) || (is_foreseen && maps.is_stalled_in_maps(stretch.l2, aim));
            if is_stalled || is_in_vain || !self.cut_further(&mut surface, &stretch) {
                return Ok(Attempt::Missed);
            }
            round += 1;
            self.go_on()?;
            self.release_caps(piece, filling, &mut surface)?;
        }
    }

    /// Takes away the caps of holes that a seam has reached.
    pub(super) fn release_caps(
        &self,
        piece: &Chart,
        filling: Option<HoleFilling>,
        surface: &mut Surface,
    ) -> Result<(), FlattenError> {
        let costs = |mesh: &TriMesh, topology: &Topology, real: usize| self.costs(piece, mesh, topology, real);
        filling.map_or(Ok(()), |filling| surface.release_caps(piece, filling, &costs))
    }

    /// A chart whose seams are as long as they may be is kept whatever its stretch.
    fn taken_apart_if_over(&self, piece: &Chart, whole: Finished) -> Result<Attempt, FlattenError> {
        if self.settings.part_overlaps && !whole.metrics.injective() {
            let parts = self.apart(piece, whole)?;
            return Ok(Attempt::Done(parts, Vec::new()));
        }
        Ok(Attempt::Done(vec![whole], Vec::new()))
    }

    fn finished(
        &self,
        piece: &Chart,
        surface: &Surface,
        chart: &Chart,
        flat: Flattening,
        rounds: usize,
    ) -> Result<Finished, FlattenError> {
        let virtual_faces = surface.mesh.face_count() - surface.real;
        let holes_filled = surface.holes_filled();
        let whole = self.of_piece(piece, finish(chart, surface.real, flat, &mut || self.go_on())?);
        Ok(Finished { rounds, holes_filled, virtual_faces, ..whole })
    }

    /// The last map of an unfinished piece, if it is valid.
    fn last_valid(
        &self,
        piece: &Chart,
        surface: &Surface,
        chart: &Chart,
        uv: &UvMap,
        end: Termination,
    ) -> Option<Finished> {
        let how = (SolverKind::LinAbf, end);
        let mut last =
            Finished::of_map(chart, surface.real, uv, how, self.settings.pipeline.precision, &mut || self.go_on())
                .ok()?;
        last.faces.iter_mut().for_each(|f| *f = piece.faces[f.index()]);
        last.metrics.valid().then_some(last)
    }

    /// Whether the seams are as long as they may be.
    pub(super) fn is_long(&self, surface: &Surface) -> bool {
        self.settings.max_seam.is_some_and(|limit| surface.seam_length() >= limit * surface.diagonal)
    }

    /// Joins the places of largest stretch to the seam; `false` when there is nothing to join.
    pub(super) fn cut_further(&self, surface: &mut Surface, stretch: &Stretch) -> bool {
        let peaks = self.peaks(surface, stretch);
        surface.extend(&peaks.vertices) > 0
    }

    /// The places of largest stretch that are not on the seam.
    pub(super) fn peaks(&self, surface: &Surface, stretch: &Stretch) -> Peaks {
        let Unwrap { terminals, spacing, reach, .. } = *self.settings;
        let may_be = |v: VertexId| surface.way(v) > reach * surface.diagonal && surface.way(v).is_finite();
        stretch.peaks(&surface.mesh, terminals, spacing * surface.diagonal, may_be)
    }

    /// Two passes of LinABF and least squares: near enough to see where the stretch is.
    pub(super) fn flatten_quickly(&self, chart: &Chart, observer: &mut dyn Observer) -> Result<UvMap, FlattenError> {
        const PASSES: NonZeroUsize = NonZeroUsize::new(2).unwrap();
        if observer.observe(Event::StageStarted(Stage::Topology)) != Verdict::Continue {
            return Err(FlattenError::Cancelled(Cancelled));
        }
        let settings = &self.settings.pipeline;
        let problem = AngleProblem::new(&chart.topology, chart.mesh.corner_angles(), settings.initial_guess)?;
        let solver = LinAbf { passes: Passes::Exactly(PASSES), ..LinAbf::default() };
        ask(observer, Event::StageStarted(Stage::Solve))?;
        let named = |source| FlattenError::of_solver(SolverKind::LinAbf, source);
        let solution = solver.solve(&problem, &self.budget.left(), observer).map_err(named)?;
        if solution.termination() == Termination::Cancelled {
            return Err(FlattenError::Cancelled(Cancelled));
        }
        ask(observer, Event::StageStarted(Stage::Layout))?;
        let kind = LayoutSettings { kind: LayoutKind::LeastSquares, ..settings.layout };
        let checkpoint = &mut || ask(observer, Event::Working);
        let uv = layout_asking(&chart.mesh, &chart.topology, solution.angles(), &kind, checkpoint)?.uv;
        // What follows looks at the map.
        ask(observer, Event::StageStarted(Stage::Certificate))?;
        Ok(uv)
    }
}

/// Whether it is a disk with holes: boundary, and no handle.
fn is_planar_with_holes(topology: &Topology) -> bool {
    let loops = topology.boundary_loops().len() as isize;
    loops > 0 && topology.euler_characteristic() == 2 - loops
}

/// The angle deficits of all interior vertices.
struct Curvature {
    /// Their sum, rad.
    total: f64,
    /// The sum of their sizes, rad.
    absolute: f64,
}

impl Curvature {
    fn of(piece: &Chart) -> Self {
        let topology = &piece.topology;
        let mut sums = vec![0.0; topology.vertex_count()];
        for (c, angle) in topology.corners().zip(piece.mesh.corner_angles()) {
            sums[topology.vertex(c).index()] += angle;
        }
        let interior = topology.vertices().filter(|&v| topology.is_interior(v));
        interior.map(|v| TAU - sums[v.index()]).fold(Self { total: 0.0, absolute: 0.0 }, |sum, deficit| Self {
            total: sum.total + deficit,
            absolute: sum.absolute + deficit.abs(),
        })
    }
}
