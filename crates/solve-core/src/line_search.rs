//! How far to go along a step.

use abf_constraints::{AngleProblem, WheelForm, residual};
use abf_control::{Cancelled, Checkpoint, UnknownName};
use std::f64::consts::PI;

/// How angles are kept inside (0, π).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum BoundRule {
    /// Take the step, then move what left the interval to this distance from its ends, rad
    /// (in the spirit of LinABF's end of §6 and of ABF++).
    Clamp(f64),
    /// Shorten the step so that no angle loses more than this share of its distance to 0 or π.
    Fraction(f64),
}

impl Default for BoundRule {
    /// A shortened step keeps the direction, so the merit function can still descend along it.
    fn default() -> Self {
        Self::Fraction(0.9)
    }
}

impl BoundRule {
    /// The largest share of the step that may be tried.
    pub(crate) fn longest_step(self, angles: &[f64], delta: &[f64]) -> f64 {
        match self {
            Self::Clamp(_) => 1.0,
            Self::Fraction(share) => angles.iter().zip(delta).fold(1.0, |longest: f64, (&x, &d)| {
                let room = if d < 0.0 { x } else { PI - x };
                // Angles that stay inside by themselves do not limit.
                if d.abs() > share * room { longest.min(share * room / d.abs()) } else { longest }
            }),
        }
    }

    /// Where a step of this share ends, and how many angles were clamped to the bounds.
    pub(crate) fn advance(self, angles: &[f64], delta: &[f64], share: f64) -> (Vec<f64>, usize) {
        let mut clamped = 0;
        let stepped = angles.iter().zip(delta).map(|(x, d)| x + share * d);
        let next = stepped
            .map(|x| match self {
                Self::Clamp(bound) if !(bound..=PI - bound).contains(&x) => {
                    clamped += 1;
                    x.clamp(bound, PI - bound)
                }
                _ => x,
            })
            .collect();
        (next, clamped)
    }
}

/// How the length of a step is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, strum::Display, strum::EnumString, strum::VariantNames)]
#[strum(serialize_all = "kebab-case", parse_err_ty = UnknownName, parse_err_fn = unknown)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum LineSearch {
    /// The longest step the bound rule allows, unseen (ABF++).
    Full,
    /// Halve until the merit function `Σ w (x − a)² + ν ‖h‖₁` falls enough (Armijo), `ν` above every
    /// multiplier, so that it falls towards the constrained optimum (VMV04 §6 asks for a line search
    /// and leaves open which).
    #[default]
    Merit,
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<LineSearch>("line search", given)
}

/// Armijo's share of the predicted decrease that must be reached.
const ARMIJO: f64 = 1e-4;
/// The step is cut to this share each time.
const BACKTRACK: f64 = 0.5;
/// So often at most.
const MAX_BACKTRACKS: usize = 25;
/// ν is this many times the largest multiplier.
const MULTIPLIER_MARGIN: f64 = 2.0;
/// Changes of the merit below this share of it are rounding.
const ROUNDING: f64 = 1e-13;
/// A step that moves no angle by more than this, rad, is too short for the merit to see.
const INVISIBLE_STEP: f64 = 1e-12;

/// `Σ w (x − a)² + ν ‖h(x)‖₁` of one problem.
pub(crate) struct Merit<'p, 'a> {
    problem: &'p AngleProblem<'a>,
    form: WheelForm,
    penalty: f64,
}

/// A step that was accepted.
pub(crate) struct Accepted {
    pub angles: Vec<f64>,
    pub share: f64,
    pub clamped: usize,
}

impl<'p, 'a> Merit<'p, 'a> {
    pub(crate) fn new(problem: &'p AngleProblem<'a>, form: WheelForm) -> Self {
        Self { problem, form, penalty: 0.0 }
    }

    fn value(&self, angles: &[f64]) -> f64 {
        let h = residual(self.form, self.problem.topology(), self.problem.rows(), angles);
        self.problem.energy(angles) + self.penalty * norm1(&h)
    }

    /// Searches along `delta` from `angles`, where the constraints are `h` and the energy has the
    /// gradient `gradient`; `multipliers` are those the step leads to. `None` when nothing descends.
    #[allow(clippy::too_many_arguments, reason = "a search needs them all")]
    pub(crate) fn search(
        &mut self,
        rule: BoundRule,
        angles: &[f64],
        delta: &[f64],
        h: &[f64],
        gradient: &[f64],
        multipliers: &[f64],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Option<Accepted>, Cancelled> {
        if delta.iter().all(|d| d.abs() <= INVISIBLE_STEP) {
            let (angles, clamped) = rule.advance(angles, delta, 1.0);
            return Ok(Some(Accepted { angles, share: 1.0, clamped }));
        }
        let largest = multipliers.iter().fold(0.0, |max: f64, m| max.max(m.abs()));
        self.penalty = self.penalty.max(MULTIPLIER_MARGIN * largest);
        let slope = gradient.iter().zip(delta).map(|(g, d)| g * d).sum::<f64>() - self.penalty * norm1(h);
        let start = self.value(angles);
        let noise = ROUNDING * start.abs();
        // NaN compares false and is no descent.
        if !(slope <= noise) {
            return Ok(None);
        }
        let mut share = rule.longest_step(angles, delta);
        for _ in 0..MAX_BACKTRACKS {
            checkpoint()?;
            let (next, clamped) = rule.advance(angles, delta, share);
            if self.value(&next) <= start + ARMIJO * share * slope + noise {
                return Ok(Some(Accepted { angles: next, share, clamped }));
            }
            share *= BACKTRACK;
        }
        Ok(None)
    }
}

fn norm1(h: &[f64]) -> f64 {
    h.iter().map(|x| x.abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        for search in [LineSearch::Full, LineSearch::Merit] {
            assert_eq!(search.to_string().parse(), Ok(search));
        }
        assert!("armijo".parse::<LineSearch>().is_err());
    }

    #[test]
    fn the_longest_step_leaves_every_angle_its_share_of_room() {
        let rule = BoundRule::Fraction(0.9);
        assert_eq!(rule.longest_step(&[1.0, 2.0], &[-0.5, 0.5]), 1.0);
        let share = rule.longest_step(&[1.0, 2.0], &[-2.0, 0.5]);
        assert!((share - 0.45).abs() < 1e-15);
        let (next, _) = rule.advance(&[1.0, 2.0], &[-2.0, 0.5], share);
        assert!((next[0] - 0.1).abs() < 1e-15);
    }

    #[test]
    fn clamping_moves_and_counts() {
        let (next, clamped) = BoundRule::Clamp(1e-3).advance(&[1.0, 2.0, 3.0], &[-2.0, 0.5, 1.0], 1.0);
        assert_eq!((next, clamped), (vec![1e-3, 2.5, PI - 1e-3], 2));
    }
}
