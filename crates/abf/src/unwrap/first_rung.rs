//! A disk by the first rung of the ladder; its passes are ended where they have become slow.

use super::component::Component;
use super::foresight::Foresight;
use super::stretch::{Stretch, scaled_aim};
use super::surface::Surface;
use crate::run::Prospect;
use crate::{FlattenError, Flattening, Injective, Pipeline, Solver, SolverKind};
use abf_constraints::GuessSettings;
use abf_control::{Event, IterationRecord, Observer, Termination, Verdict};
use abf_cut::Chart;

/// Near the solution, where the constraints are off by less than this, rad, a map shows where the stretch is. There a pass squares
/// what they are off by, …
const NEAR: f64 = 1e-2;

/// … so that it is slow if it leaves more than this part: angles are kept inside their bounds, which each pass moves them out of.
const SLOW: f64 = 0.1;

/// Far from it, passes that have not come near by now are slow …
const LATE: usize = 6;

/// … if they leave more than this part.
const STUCK: f64 = 0.5;

/// Angles may be so small, rad. With the larger bound of a lone disk engine2 takes 1.35 times as long, for more charts.
const LEAST_ANGLE: f64 = 1e-4;

/// After so many maps that missed the aim another is expected to.
const MISSES: usize = 2;

/// Passes that are ended early may come out with so many times the stretch, above 1, that they would end with.
const ALMOST: f64 = 1.02;

impl Component<'_, '_> {
    pub(super) fn pipeline_of_first_rung(&self) -> Pipeline {
        let solver = match &self.settings.pipeline.solver {
            Solver::Auto(ladder) => ladder.linabf.into(),
            other => other.clone(),
        };
        Pipeline { solver, ..self.pipeline() }
    }

    /// A disk by the first rung; `None` where that finds nothing. Only what is flat may have something to gain from angles
    /// below the bound; elsewhere they make many more iterations of it.
    ///
    /// Where a map will miss the aim, passes are ended once they have become slow, or, after this many misses, once it shows
    /// where the stretch is.
    pub(super) fn first_rung(
        &self,
        chart: &Chart,
        surface: &Surface,
        foresight: &Foresight,
        misses: usize,
    ) -> Result<Option<Flattening>, FlattenError> {
        let mut pipeline = self.pipeline_of_first_rung();
        let guess = &mut pipeline.initial_guess;
        guess.keep_thin &= foresight.is_flat();
        // Another bound than that of a lone disk was asked for, and stays.
        if guess.angle_bound == GuessSettings::default().angle_bound {
            guess.angle_bound = LEAST_ANGLE;
        }
        let expected = foresight.angles(chart);
        let prospect = Prospect { enough: Some(self.settings.max_stretch), expected: expected.as_deref() };
        let run = |pipeline: &Pipeline, observer: &mut dyn Observer| {
            self.tried(pipeline.run_within(&chart.mesh, prospect, observer))
        };
        let is_all = pipeline.relax.is_none() && pipeline.injective == Injective::Off;
        if pipeline.solver.kind() != SolverKind::LinAbf || !is_all || pipeline.initial_guess.keep_thin {
            return run(&pipeline, &mut self.ear());
        }
        let mut ear = self.ear();
        let mut impatient = Impatient::new(&mut ear, misses >= MISSES);
        let flat = run(&pipeline, &mut impatient)?;
        let is_ended = |flat: &Flattening| impatient.has_stopped && flat.termination == Termination::Cancelled;
        let mut flat = match flat {
            Some(flat) if is_ended(&flat) => flat,
            flat => return Ok(flat),
        };
        let l2 = Stretch::measure(chart, &flat.uv, surface.real, surface.mesh.vertex_count())?.l2;
        if l2 <= scaled_aim(self.settings.max_stretch, ALMOST) {
            if self.budget.is_spent() {
                flat.termination = Termination::TimeLimit;
                return Ok(Some(flat));
            }
            pipeline.stop = self.budget.left();
            return run(&pipeline, &mut self.ear());
        }
        flat.termination = Termination::Stalled;
        Ok(Some(flat))
    }
}

/// Passes on what it hears, and stops passes of LinABF that have become slow.
struct Impatient<'o> {
    observer: &'o mut dyn Observer,
    before: f64,
    /// Whether it stops others, too, once they have come near.
    is_glance: bool,
    /// Whether it has stopped them.
    has_stopped: bool,
}

impl<'o> Impatient<'o> {
    fn new(observer: &'o mut dyn Observer, is_glance: bool) -> Self {
        Self { observer, before: f64::INFINITY, is_glance, has_stopped: false }
    }

    fn is_slow(&mut self, pass: &IterationRecord) -> bool {
        let before = if pass.iteration == 1 { f64::INFINITY } else { self.before };
        let now = pass.constraint_residual;
        self.before = now;
        if self.is_glance && now <= NEAR {
            return true;
        }
        if before <= NEAR { now > SLOW * before } else { pass.iteration >= LATE && now > STUCK * before }
    }
}

impl Observer for Impatient<'_> {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        let is_slow = matches!(event, Event::Iteration(pass) if self.is_slow(pass));
        let verdict = self.observer.observe(event);
        if is_slow && verdict == Verdict::Continue {
            self.has_stopped = true;
            return Verdict::Stop;
        }
        verdict
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_control::Silent;

    /// The pass after which it stops, of passes that leave the constraints off by so much each.
    fn stops_after(residuals: &[f64], is_glance: bool) -> Option<usize> {
        let mut silent = Silent;
        let mut impatient = Impatient::new(&mut silent, is_glance);
        (1..).zip(residuals).find_map(|(iteration, &constraint_residual)| {
            let pass = IterationRecord { iteration, constraint_residual, ..IterationRecord::default() };
            (impatient.observe(Event::Iteration(&pass)) == Verdict::Stop).then_some(iteration)
        })
    }

    #[test]
    fn passes_that_square_what_is_left_are_not_stopped_and_those_that_leave_a_part_of_it_are() {
        let fast = [2.8, 1.3, 0.45, 0.038, 1.2e-3, 1e-6, 1e-9];
        assert_eq!(stops_after(&fast, false), None);
        assert_eq!(stops_after(&fast, true), Some(5), "one look is enough");
        assert_eq!(stops_after(&[2.8, 1.3, 0.45, 0.038, 1.2e-3, 3.3e-4, 8.7e-5], false), Some(6));
        assert_eq!(stops_after(&[2.2, 1.1, 0.8, 0.72, 0.65, 0.58, 0.5], false), Some(6));
        assert_eq!(stops_after(&[48.0, 30.0, 19.0, 9.0, 4.0, 1.5, 0.4, 0.03, 1e-4], false), None);
    }
}
