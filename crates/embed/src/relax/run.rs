//! The steps of a relaxation.

use super::guard::Guard;
use super::settings::Relax;
use super::terms::{Direction, Directions, Terms};
use crate::drawn::Drawn;
use crate::plane::{angles, of_face};
use abf_control::{Cancelled, IterationRecord, Termination, Watch};
use abf_linalg::{LinearError, LinearStats};
use abf_mesh::{Point2, Topology, Vector2, VertexId};
use abf_parallel::prelude::*;
use std::f64::consts::PI;

/// The least part of the decrease that the slope promises (Armijo 1966).
const SUFFICIENT: f64 = 1e-4;
/// The part of the way to the first collapsing triangle that is gone at most.
const WAY_TO_COLLAPSE: f64 = 0.9;
/// A step is halved so often at most.
const TRIALS: usize = 40;
/// A surface of area 1 whose energy is below this is as it is in space, to the rounding of its points.
const NOTHING_TO_GAIN: f64 = 1e-18;

/// One step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RelaxStep {
    /// Counted from 1.
    pub iteration: usize,
    /// Whether it went for shapes within reach. Energy and slope are those of such shapes then.
    pub is_progressive: bool,
    /// The energy after it, with all that is asked of the drawing beside.
    pub energy: f64,
    /// What a full step promised, twice: the derivative of the energy along it; negative.
    pub slope: f64,
    /// The longest way of a vertex in a full step; the side of a square as large as the surface is 1.
    pub step: f64,
    /// The share of the full step that was taken; 0 when no share of it led anywhere.
    pub step_length: f64,
    /// Its linear solve.
    pub linear: LinearStats,
}

/// A drawing on its way.
pub(crate) struct Run<'r> {
    pub(crate) topology: &'r Topology,
    pub(crate) uv: Vec<Point2<f64>>,
    pub(crate) directions: Directions,
    pub(crate) steps: Vec<RelaxStep>,
    /// As observers were told of them.
    pub(crate) reported: Vec<IterationRecord>,
    /// Of the surface, one per corner, rad; empty for a quiet run, which shows no drawing.
    pub(crate) mesh_angles: &'r [f64],
    pub(crate) tolerance: f64,
    pub(crate) max_steps: usize,
    /// The side of a square as large as the surface.
    pub(crate) unit: f64,
    /// Whether steps are told of as inner work only.
    pub(crate) is_quiet: bool,
    /// Keeps the boundary clear of itself, where that is asked for.
    pub(crate) guard: Option<Guard<'r>>,
}

/// What came of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Outcome {
    /// It was taken, and there may be more to gain.
    Better,
    /// It was taken, if it led anywhere, and there is nothing more to gain.
    Done,
    /// No share of it led anywhere.
    Stuck,
}

impl<'r> Run<'r> {
    /// A drawing of a surface with these angles and this area.
    pub(crate) fn new(
        relax: &Relax,
        (topology, mesh_angles): (&'r Topology, &'r [f64]),
        uv: Vec<Point2<f64>>,
        directions: Directions,
        area: f64,
    ) -> Self {
        let (tolerance, max_steps, unit) = (relax.energy_tolerance, relax.max_steps, area.sqrt());
        let (steps, reported) = (Vec::new(), Vec::new());
        Self {
            topology,
            uv,
            directions,
            steps,
            reported,
            mesh_angles,
            tolerance,
            max_steps,
            unit,
            is_quiet: false,
            guard: None,
        }
    }

    /// Steps until there is nothing more to gain.
    pub(crate) fn descend(&mut self, terms: &Terms<'_>, watch: &mut Watch<'_>) -> Result<Termination, Cancelled> {
        loop {
            if let Some(end) = self.end(watch) {
                return Ok(end);
            }
            match self.step(terms, false, watch)? {
                Outcome::Better => {}
                Outcome::Done => return Ok(Termination::Converged),
                Outcome::Stuck => return Ok(Termination::Stalled),
            }
        }
    }

    /// Reports the drawing that there is, and what it costs.
    pub(crate) fn start(&self, terms: &Terms<'_>, watch: &mut Watch<'_>) -> Result<(), Cancelled> {
        watch.drawing(&self.drawn())?;
        watch.start_from(self.mesh_angles.len(), 0.0, Some(terms.value(&self.uv)))
    }

    fn drawn(&self) -> Drawn<'_> {
        Drawn { topology: self.topology, mesh_angles: self.mesh_angles, uv: &self.uv }
    }

    /// Why there must be no further step.
    pub(crate) fn end(&self, watch: &Watch<'_>) -> Option<Termination> {
        watch.interruption().or((self.steps.len() >= self.max_steps).then_some(Termination::MaxIterations))
    }

    /// One step.
    pub(crate) fn step(
        &mut self,
        terms: &Terms<'_>,
        is_progressive: bool,
        watch: &mut Watch<'_>,
    ) -> Result<Outcome, Cancelled> {
        if let Some(guard) = &mut self.guard {
            guard.follow(&self.uv, terms.size_at_least(&self.uv));
        }
        let barrier = self.guard.as_ref().map(|guard| guard.barrier(&self.uv));
        let terms = &Terms { barrier: barrier.as_ref(), ..*terms };
        let before = terms.value(&self.uv);
        let direction = match self.directions.at(terms, &self.uv, &mut || watch.checkpoint()) {
            Ok(direction) => direction,
            Err(LinearError::Cancelled(cancelled)) => return Err(cancelled),
            Err(_) => return Ok(Outcome::Stuck),
        };
        let is_last = -direction.slope <= self.tolerance * terms.size(&self.uv, before) + NOTHING_TO_GAIN;
        let found = self.search(terms, &direction, before, watch)?;
        let (energy, step_length) = found.as_ref().map_or((before, 0.0), |found| (found.value, found.share));
        let step = RelaxStep {
            iteration: self.steps.len() + 1,
            is_progressive,
            energy,
            slope: direction.slope,
            step: direction.motion.iter().map(Vector2::norm).fold(0.0, f64::max) / self.unit,
            step_length,
            linear: direction.linear,
        };
        self.steps.push(step);
        let has_moved = found.is_some();
        if let Some(found) = found {
            self.uv = found.uv;
        }
        if self.is_quiet {
            watch.inner(step.iteration, f64::NAN)?;
        } else {
            let record = reported(&step);
            self.reported.push(record);
            watch.drawing(&self.drawn())?;
            watch.iteration(&record)?;
        }
        Ok(match (is_last, has_moved) {
            (true, _) => Outcome::Done,
            (false, true) => Outcome::Better,
            (false, false) => Outcome::Stuck,
        })
    }

    /// The longest step along a direction, halved from the first collapse on, that costs enough less.
    fn search(
        &self,
        terms: &Terms<'_>,
        direction: &Direction,
        before: f64,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Found>, Cancelled> {
        let mut end: f64 = (WAY_TO_COLLAPSE * terms.first_collapse(&self.uv, &direction.motion)).min(1.0);
        if let Some(barrier) = terms.barrier {
            end = end.min(WAY_TO_COLLAPSE * barrier.first_contact(&self.uv, &direction.motion, end));
        }
        for share in std::iter::successors(Some(end), |s| Some(0.5 * s)).take(TRIALS) {
            watch.checkpoint()?;
            let uv: Vec<Point2<f64>> = self.uv.iter().zip(&direction.motion).map(|(p, d)| p + d * share).collect();
            let value = terms.value(&uv);
            let is_enough = value < before && value <= before + SUFFICIENT * share * direction.slope;
            let is_clear = |guard: &Guard<'_>, watch: &mut Watch<'_>| guard.is_clear(&uv, &mut || watch.checkpoint());
            if is_enough
                && !winds_twice(self.topology, &uv)
                && self.guard.as_ref().map_or(Ok(true), |guard| is_clear(guard, watch))?
            {
                return Ok(Some(Found { uv, value, share }));
            }
        }
        Ok(None)
    }
}

/// A better drawing.
struct Found {
    uv: Vec<Point2<f64>>,
    value: f64,
    share: f64,
}

/// What observers of solvers know how to read. A drawing closes by itself, so there is no residual. The energy of shapes
/// within reach is another at every step, and none to follow.
fn reported(step: &RelaxStep) -> IterationRecord {
    IterationRecord {
        iteration: step.iteration,
        step: step.step,
        inner_iterations: step.linear.iterations,
        inner_residual: step.linear.relative_residual,
        inner_converged: true,
        energy: Some(step.energy).filter(|_| !step.is_progressive),
        step_length: step.step_length,
        ..IterationRecord::default()
    }
}

/// Whether the triangles around an interior vertex, all counter-clockwise, turn around it more than once. Their angles sum
/// to a multiple of 2π, so rounding cannot make one of another.
fn winds_twice(topology: &Topology, uv: &[Point2<f64>]) -> bool {
    const BETWEEN_ONCE_AND_TWICE: f64 = 3.0 * PI;
    const PER_TASK: usize = 1 << 10;
    let of = |v: usize| {
        let v = VertexId::new(v);
        let angle = |c: abf_mesh::CornerId| angles(&of_face(topology, uv, c.face()))[c.index() % 3];
        topology.is_interior(v) && topology.fan(v).map(angle).sum::<f64>() > BETWEEN_ONCE_AND_TWICE
    };
    (0..topology.vertex_count()).into_par_iter().with_min_len(PER_TASK).any(of)
}
