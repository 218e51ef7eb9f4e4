//! How far to go.

use crate::newton::Direction;
use crate::objective::Objective;
use crate::plane::{angles, first_collapse, not_counter_clockwise, of_face};
use crate::retract::Retraction;
use abf_control::{Cancelled, Checkpoint};
use abf_linalg::LinearError;
use abf_mesh::{Point2, Topology, Vector2};
use std::f64::consts::PI;

/// The least part of the decrease that the slope promises (Armijo 1966).
const SUFFICIENT: f64 = 1e-4;
/// The part of the way to the first collapsing triangle that is gone at most.
const WAY_TO_COLLAPSE: f64 = 0.9;
/// A step that turns and scales is halved so often; what is still not accepted then is left to the straight line.
const TURNING_TRIALS: usize = 6;
/// The least part of the way to the end of a step that turns and scales that is worth going: less is left to a shorter
/// step, or to the straight line.
const WORTH_GOING: f64 = 0.4;
/// A straight step is halved so often at most.
const STRAIGHT_TRIALS: usize = 40;

/// How a step moved the vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum StepKind {
    /// Along a straight line, every vertex.
    Straight,
    /// Edges turned and scaled.
    Turning,
}

/// A place that is better, and valid by the exact predicate.
pub(crate) struct AcceptedDrawing {
    pub(crate) uv: Vec<Point2<f64>>,
    pub(crate) angles: Vec<f64>,
    pub(crate) objective: f64,
    pub(crate) share: f64,
    pub(crate) kind: StepKind,
}

/// The angles of every corner of a drawing.
pub(crate) fn measured(topology: &Topology, uv: &[Point2<f64>]) -> Vec<f64> {
    topology.faces().flat_map(|f| angles(&of_face(topology, uv, f))).collect()
}

/// Whether the triangles around an interior vertex, all counter-clockwise, turn around it more than once. Their angles sum
/// to a multiple of 2π, so rounding cannot make one of another.
fn winds_twice(objective: &Objective<'_, '_>, angles: &[f64]) -> bool {
    const BETWEEN_ONCE_AND_TWICE: f64 = 3.0 * PI;
    let rows = objective.problem.rows();
    let sum = |i: usize| rows.hubs(i).iter().map(|c| angles[c.index()]).sum::<f64>();
    (0..rows.interior_count()).any(|i| sum(i) > BETWEEN_ONCE_AND_TWICE)
}

/// The search from one place.
pub(crate) struct Search<'s, 'p, 'a> {
    pub(crate) objective: Objective<'p, 'a>,
    pub(crate) uv: &'s [Point2<f64>],
    pub(crate) angles: &'s [f64],
    pub(crate) value: f64,
    pub(crate) direction: &'s Direction,
}

impl Search<'_, '_, '_> {
    /// The better of the best straight step and the best one that turns and scales; `None` when there is neither.
    pub(crate) fn run(
        &self,
        retraction: &mut Retraction,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Option<AcceptedDrawing>, Cancelled> {
        let (turning, straight) = (self.turning(retraction, checkpoint)?, self.straight(checkpoint)?);
        Ok(match (turning, straight) {
            (Some(turning), Some(straight)) if straight.objective < turning.objective => Some(straight),
            (turning, straight) => turning.or(straight),
        })
    }

    fn straight(&self, checkpoint: &mut Checkpoint<'_>) -> Result<Option<AcceptedDrawing>, Cancelled> {
        let end: f64 = (WAY_TO_COLLAPSE * self.first_collapse(&self.direction.motion)).min(1.0);
        let moved = |s: f64| self.uv.iter().zip(&self.direction.motion).map(|(p, d)| p + d * s).collect();
        for s in std::iter::successors(Some(end), |s| Some(0.5 * s)).take(STRAIGHT_TRIALS) {
            checkpoint()?;
            if let Some(place) = self.accept(moved(s), s, StepKind::Straight, checkpoint)? {
                return Ok(Some(place));
            }
        }
        Ok(None)
    }

    fn turning(
        &self,
        retraction: &mut Retraction,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Option<AcceptedDrawing>, Cancelled> {
        let topology = self.objective.problem.topology();
        let laplacian = usable(retraction.at(topology, self.uv, self.angles, checkpoint))?;
        let Some(laplacian) = laplacian else { return Ok(None) };
        for s in std::iter::successors(Some(1.0), |s| Some(0.5 * s)).take(TURNING_TRIALS) {
            let end = usable(laplacian.advance(topology, self.uv, self.angles, self.direction, s, checkpoint))?;
            let Some(end) = end else { continue };
            if let Some(place) = self.towards(end, s, checkpoint)? {
                return Ok(Some(place));
            }
        }
        Ok(None)
    }

    /// The end of a step that turns and scales, or as much of the way there as is worth going.
    fn towards(
        &self,
        end: Vec<Point2<f64>>,
        share: f64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Option<AcceptedDrawing>, Cancelled> {
        if not_counter_clockwise(self.objective.problem.topology(), &end).is_none() {
            return self.accept(end, share, StepKind::Turning, checkpoint);
        }
        let way: Vec<Vector2<f64>> = end.iter().zip(self.uv).map(|(to, from)| to - from).collect();
        let part = WAY_TO_COLLAPSE * self.first_collapse(&way);
        if !(WORTH_GOING..1.0).contains(&part) {
            return Ok(None);
        }
        checkpoint()?;
        let there = self.uv.iter().zip(&way).map(|(p, d)| p + d * part).collect();
        self.accept(there, share * part, StepKind::Turning, checkpoint)
    }

    fn first_collapse(&self, motion: &[Vector2<f64>]) -> f64 {
        let topology = self.objective.problem.topology();
        let of = |f| first_collapse(&of_face(topology, self.uv, f), &of_face(topology, motion, f));
        topology.faces().map(of).fold(f64::INFINITY, f64::min)
    }

    fn accept(
        &self,
        uv: Vec<Point2<f64>>,
        share: f64,
        kind: StepKind,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Option<AcceptedDrawing>, Cancelled> {
        let topology = self.objective.problem.topology();
        if not_counter_clockwise(topology, &uv).is_some() {
            return Ok(None);
        }
        checkpoint()?;
        let angles = measured(topology, &uv);
        checkpoint()?;
        // A step that turns edges may jump: all triangles counter-clockwise, and yet twice around a vertex.
        if winds_twice(&self.objective, &angles) {
            return Ok(None);
        }
        let objective = self.objective.value(&angles);
        let enough = objective < self.value && objective <= self.value + SUFFICIENT * share * self.direction.slope;
        Ok(enough.then_some(AcceptedDrawing { uv, angles, objective, share, kind }))
    }
}

/// What was solved for; `None` where there is no solution.
fn usable<T>(solved: Result<T, LinearError>) -> Result<Option<T>, Cancelled> {
    match solved {
        Ok(solved) => Ok(Some(solved)),
        Err(LinearError::Cancelled(cancelled)) => Err(cancelled),
        Err(_) => Ok(None),
    }
}
