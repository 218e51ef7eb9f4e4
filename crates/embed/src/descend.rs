//! The descent over vertex positions: from a valid drawing to a better one, through valid ones only.
//!
//! Minimises `E(u) = Σ w (x(u) − a)² − μ Σ [log x(u) + log(π − x(u))]` over the UVs `u` of the vertices, `x(u)` being the
//! angles of their drawing, `a` and `w` the targets and weights of the [`AngleProblem`]. A drawing closes by itself, so
//! there are no constraints; what the other solvers keep by multipliers, here is kept by construction. The barrier μ
//! falls from [`Descent::barrier_start`] to [`Descent::barrier_floor`].
//!
//! Every step is a Gauss–Newton direction (`newton.rs`), followed with turning and scaling edges or along a straight
//! line (`retract.rs`), no further than an exact predicate allows (`line_search.rs`).

use crate::drawn::Drawn;
use crate::line_search::{AcceptedDrawing, Search, StepKind, measured};
use crate::newton::{Direction, Newton};
use crate::objective::Objective;
use crate::place::{centred, check_start, pins, scaled_to};
use crate::progressive::first_drawing_watched;
use crate::retract::Retraction;
use crate::{BoundarySpacing, EmbedError, TutteWeights};
use abf_constraints::{AngleProblem, max_residual};
use abf_control::{Cancelled, IterationRecord, Observer, SettingError, StopCriteria, Termination, Watch};
use abf_linalg::LinearStats;
use abf_mesh::{FaceId, Point2, TriMesh};

/// The descent and its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Descent {
    /// The first μ, in units of energy per corner: weights are `1/a²`, so 1 is the energy of an angle that is off by
    /// all of its target.
    pub barrier_start: f64,
    /// The last μ. As μ → 0 the result tends to the optimum of ABF, which on some meshes has angles of 0: there the floor
    /// is what keeps every triangle usable.
    pub barrier_floor: f64,
    /// By what μ is multiplied, in (0, 1).
    pub barrier_reduction: f64,
    /// Converged means that at the floor a full step promises to lower `E` by no more than this share of
    /// `Σ w (x − a)² + 3 nt μ`.
    pub energy_tolerance: f64,
}

impl Default for Descent {
    fn default() -> Self {
        Self { barrier_start: 1.0, barrier_floor: 1e-3, barrier_reduction: 0.1, energy_tolerance: 3e-6 }
    }
}

/// One step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DescentRecord {
    /// Counted from 1.
    pub iteration: usize,
    /// μ.
    pub barrier: f64,
    /// `Σ w (x − a)²` after it.
    pub energy: f64,
    /// `E` after it, with this μ.
    pub objective: f64,
    /// `⟨dE/du, d⟩` before it: what a full step promises, twice.
    pub slope: f64,
    /// `max |δ|` of the full step, rad.
    pub step: f64,
    /// The share of the full step that was taken; 0 when no share of it led anywhere.
    pub step_length: f64,
    /// How it moved the vertices.
    pub kind: StepKind,
    /// How many faces were held in place by it, because a few roundings of their coordinates could turn them over. A
    /// descent that converges with some has found the best drawing around them.
    pub held_faces: usize,
    /// The smallest angle after it, rad.
    pub smallest_angle: f64,
    /// Its linear solve.
    pub linear: LinearStats,
}

/// A drawing in which every triangle is counter-clockwise, by an exact predicate.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct DescentSolution {
    /// One point per vertex; the origin for vertices that no face uses.
    pub uv: Vec<Point2<f64>>,
    /// The angles of the drawing, one per corner, rad. For the residual and the interval of
    /// `AngleSolution::measure`.
    pub angles: Vec<f64>,
    /// How it ended. [`Termination::Stalled`]: no step led anywhere, mostly because triangles have come to the
    /// resolution of doubles.
    pub termination: Termination,
    /// Every step.
    pub history: Vec<DescentRecord>,
    /// The faces that the last step held in place.
    pub held: Vec<FaceId>,
    /// The same steps as observers were told of them.
    pub iterations: Vec<IterationRecord>,
    /// The embedding it started from, where no start was given and doubles hold one.
    pub tutte: Option<(BoundarySpacing, TutteWeights)>,
    /// Whether the UV area is the area of the surface. If doubles do not hold the drawing at that scale it is the
    /// nearest power of two that multiplies the scale, which moves no bit.
    pub area_matched: bool,
}

impl Descent {
    /// Descends from `start`, one point per vertex, or from [`first_drawing`](crate::first_drawing()).
    ///
    /// Without time there is the start, or the first drawing there is. Of `stop` it heeds the number of iterations, the time limit and the step tolerance (a full step below it is
    /// converged, too); a drawing has no constraint residual to bring down. Same input, same bits.
    ///
    /// # Errors
    /// [`EmbedError::Setting`]; [`EmbedError::PointCount`] and [`EmbedError::StartFlipped`] for a start that is not a
    /// drawing; the errors of [`first_drawing`](crate::first_drawing()), among them [`EmbedError::Interrupted`] if it was stopped
    /// before it had a drawing; [`EmbedError::Linear`] for a mesh whose matrices are too large.
    ///
    /// # Panics
    /// If the problem is not that of `mesh`.
    pub fn solve(
        &self,
        mesh: &TriMesh,
        problem: &AngleProblem<'_>,
        start: Option<&[Point2<f64>]>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<DescentSolution, EmbedError> {
        self.check()?;
        stop.check()?;
        let topology = problem.topology();
        let mut watch = Watch::start(stop, observer);
        let (uv, embedding) = match start {
            Some(start) => (start.to_vec(), None),
            None => {
                let first = first_drawing_watched(mesh, topology, &mut watch)?;
                (first.uv, first.tutte)
            }
        };
        check_start(topology, &uv)?;
        watch.inner(0, f64::NAN)?;
        if let Some(interruption) = watch.interruption() {
            let angles = measured(topology, &uv);
            let (uv, area_matched) = scaled_to(topology, uv, mesh.area());
            return Ok(DescentSolution {
                uv,
                angles,
                termination: interruption,
                history: Vec::new(),
                held: Vec::new(),
                iterations: Vec::new(),
                tutte: embedding,
                area_matched,
            });
        }
        let mut run = DescentRun::new(*self, problem, &uv, &mut watch)?;
        watch.drawing(&run.drawn())?;
        let residual = max_residual(topology, problem.rows(), &run.angles);
        watch.start_from(run.angles.len(), residual, Some(problem.energy(&run.angles)))?;
        let termination = run.descend(stop, &mut watch)?;
        let (uv, area_matched) = scaled_to(topology, run.uv, mesh.area());
        // Those of the last step: scaling may round, and no angle is changed by it.
        let angles = run.angles;
        Ok(DescentSolution {
            uv,
            angles,
            termination,
            history: run.history,
            held: run.held,
            iterations: run.reported,
            tutte: embedding,
            area_matched,
        })
    }

    /// Checks that every setting is in its range; [`Descent::solve`] calls it first.
    ///
    /// # Errors
    /// [`EmbedError::Setting`] naming the setting and its range.
    pub fn check(&self) -> Result<(), EmbedError> {
        let positive = "positive and finite";
        let fault = |name, allowed, value| Err(SettingError::new(name, allowed, value).into());
        for (name, value) in [
            ("barrier_start", self.barrier_start),
            ("barrier_floor", self.barrier_floor),
            ("energy_tolerance", self.energy_tolerance),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return fault(name, positive, value);
            }
        }
        if self.barrier_floor > self.barrier_start {
            return fault("barrier_floor", "at most barrier_start", self.barrier_floor);
        }
        if !(self.barrier_reduction > 0.0 && self.barrier_reduction < 1.0) {
            return fault("barrier_reduction", "in (0, 1)", self.barrier_reduction);
        }
        Ok(())
    }
}

/// The workspace of one descent.
struct DescentRun<'p, 'a> {
    settings: Descent,
    objective: Objective<'p, 'a>,
    newton: Newton,
    retraction: Retraction,
    uv: Vec<Point2<f64>>,
    angles: Vec<f64>,
    held: Vec<FaceId>,
    history: Vec<DescentRecord>,
    reported: Vec<IterationRecord>,
}

impl<'p, 'a> DescentRun<'p, 'a> {
    fn new(
        settings: Descent,
        problem: &'p AngleProblem<'a>,
        uv: &[Point2<f64>],
        watch: &mut Watch<'_>,
    ) -> Result<Self, EmbedError> {
        let topology = problem.topology();
        let pins = pins(topology, uv);
        let uv = centred(topology, uv, pins[0]);
        Ok(Self {
            settings,
            objective: Objective { problem, barrier: settings.barrier_start },
            newton: Newton::new(topology, pins, &mut || watch.checkpoint())?,
            retraction: Retraction::new(topology, pins[0], &mut || watch.checkpoint())?,
            angles: measured(topology, &uv),
            uv,
            held: Vec::new(),
            history: Vec::new(),
            reported: Vec::new(),
        })
    }

    fn descend(&mut self, stop: &StopCriteria, watch: &mut Watch<'_>) -> Result<Termination, Cancelled> {
        loop {
            // The matrices are set up, which takes as long as a step.
            if self.history.is_empty() && !watch.inner(0, f64::NAN)? {
                return Ok(watch.interruption().unwrap_or(Termination::Cancelled));
            }
            // Without a direction the drawing so far is still valid, be it the start.
            let checkpoint = &mut || watch.checkpoint();
            let Ok(direction) = self.newton.direction(&self.objective, &self.uv, &self.angles, checkpoint) else {
                watch.aborted()?;
                return Ok(Termination::Stalled);
            };
            let at_floor = self.objective.barrier <= self.settings.barrier_floor;
            let scale = self.objective.scale(&self.angles);
            let found = self.step(&direction, watch)?;
            self.held = direction.held;
            let last = self.history.last().expect("a step is always recorded");
            let promise = -last.slope / 2.0;
            let small = last.step <= stop.step_tolerance || promise <= self.settings.energy_tolerance * scale;
            if at_floor && small {
                return Ok(Termination::Converged);
            }
            if let Some(interruption) = watch.interruption() {
                return Ok(interruption);
            }
            if self.history.len() >= stop.max_iterations {
                return Ok(Termination::MaxIterations);
            }
            match (found, at_floor) {
                (false, true) if !self.newton.hold_more() => return Ok(Termination::Stalled),
                (found, false) if !found || self.is_centred() => self.lower_barrier(),
                _ => {}
            }
        }
    }

    /// Whether the last step leaves nothing to gain from another with the same μ: it was nearly a full one, or promised
    /// little.
    fn is_centred(&self) -> bool {
        /// The share of a full step that is nearly one.
        const NEARLY_FULL: f64 = 0.9;
        /// The promise per corner, in units of μ, that is little.
        const LITTLE: f64 = 0.1;
        self.history.last().is_some_and(|last| {
            last.step_length > NEARLY_FULL || -last.slope < LITTLE * last.barrier * self.angles.len() as f64
        })
    }

    fn lower_barrier(&mut self) {
        let lower = self.objective.barrier * self.settings.barrier_reduction;
        self.objective.barrier = lower.max(self.settings.barrier_floor);
    }

    /// Takes the best step along a direction and records it; `false` when there is none.
    fn step(&mut self, direction: &Direction, watch: &mut Watch<'_>) -> Result<bool, Cancelled> {
        let value = self.objective.value(&self.angles);
        let (objective, uv, angles) = (self.objective, &self.uv, &self.angles);
        let place =
            Search { objective, uv, angles, value, direction }.run(&mut self.retraction, &mut || watch.checkpoint())?;
        let found = place.is_some();
        let place = place.unwrap_or_else(|| AcceptedDrawing {
            uv: self.uv.clone(),
            angles: self.angles.clone(),
            objective: value,
            share: 0.0,
            kind: StepKind::Straight,
        });
        self.uv = place.uv;
        self.angles = place.angles;
        let record = DescentRecord {
            iteration: self.history.len() + 1,
            barrier: self.objective.barrier,
            energy: self.objective.problem.energy(&self.angles),
            objective: place.objective,
            slope: direction.slope,
            step: direction.angle_change.iter().fold(0.0, |most, d| d.abs().max(most)),
            step_length: place.share,
            kind: place.kind,
            held_faces: direction.held.len(),
            smallest_angle: self.angles.iter().copied().fold(f64::INFINITY, f64::min),
            linear: direction.linear,
        };
        self.history.push(record);
        let reported = self.reported(&record);
        self.reported.push(reported);
        watch.drawing(&self.drawn())?;
        watch.iteration(&reported)?;
        Ok(found)
    }

    fn drawn(&self) -> Drawn<'_> {
        let problem = self.objective.problem;
        Drawn { topology: problem.topology(), mesh_angles: problem.mesh_angles(), uv: &self.uv }
    }

    /// What observers of other solvers know how to read.
    fn reported(&self, record: &DescentRecord) -> IterationRecord {
        let problem = self.objective.problem;
        IterationRecord {
            iteration: record.iteration,
            constraint_residual: max_residual(problem.topology(), problem.rows(), &self.angles),
            step: record.step,
            inner_iterations: record.linear.iterations,
            inner_residual: record.linear.relative_residual,
            inner_converged: true,
            energy: Some(record.energy),
            step_length: record.step_length,
            ..IterationRecord::default()
        }
    }
}
