//! When to stop.

use crate::{SettingError, clock};
use std::time::Duration;

/// When a solver stops.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct StopCriteria {
    /// Converged means a constraint residual `max |h|` (log form, rad) of at most this …
    pub tolerance: f64,
    /// … and, for solvers that minimise an energy, a last full step `max |δ|` (rad) of at most this:
    /// a small residual alone is not yet the optimum.
    pub step_tolerance: f64,
    /// At most so many outer iterations or passes.
    pub max_iterations: usize,
    /// At most so long, counted from the start of the solve. `None`: however long it takes. Where there is no clock
    /// ([`set_clock`](crate::set_clock)) it has to be `None`.
    pub time_limit: Option<Duration>,
}

impl Default for StopCriteria {
    fn default() -> Self {
        Self { tolerance: 1e-8, step_tolerance: 1e-7, max_iterations: 50, time_limit: None }
    }
}

impl StopCriteria {
    /// Checks that every setting is in its range; solvers call it first.
    ///
    /// # Errors
    /// [`SettingError`] naming the setting and its range.
    pub fn check(&self) -> Result<(), SettingError> {
        for (name, value) in [("tolerance", self.tolerance), ("step_tolerance", self.step_tolerance)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SettingError::new(name, "positive and finite", value));
            }
        }
        if self.max_iterations == 0 {
            return Err(SettingError::new("max_iterations", "at least 1", 0));
        }
        match self.time_limit {
            Some(limit) if clock::now().is_none() => {
                let allowed = "none where there is no clock: hand one to abf_control::set_clock";
                Err(SettingError::new("time_limit", allowed, format_args!("{limit:?}")))
            }
            _ => Ok(()),
        }
    }

    /// Starts the clock, if there is a limit. Nothing else in the library reads a clock.
    pub(crate) fn deadline(&self) -> Option<Duration> {
        // A limit too far away to be represented is no limit.
        self.time_limit.and_then(|limit| clock::now()?.checked_add(limit))
    }
}

/// One time limit for several solves in a row.
#[derive(Clone, Copy, Debug)]
pub struct TimeBudget {
    stop: StopCriteria,
    deadline: Option<Duration>,
}

impl TimeBudget {
    /// Starts the clock, if there is a limit.
    #[must_use]
    pub fn start(stop: &StopCriteria) -> Self {
        Self { stop: *stop, deadline: stop.deadline() }
    }

    /// The criteria for the next solve: the same, with the time that is left.
    #[must_use]
    pub fn left(&self) -> StopCriteria {
        let time_limit = self.deadline.map(|deadline| deadline.saturating_sub(clock::now().unwrap_or_default()));
        StopCriteria { time_limit, ..self.stop }
    }

    /// Whether no time is left.
    #[must_use]
    pub fn is_spent(&self) -> bool {
        self.left().time_limit.is_some_and(|left| left.is_zero())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_out_of_range_are_named() {
        let e = StopCriteria { tolerance: -1.0, ..StopCriteria::default() }.check().unwrap_err();
        assert_eq!(e.to_string(), "tolerance must be positive and finite, got -1");
        assert!(StopCriteria { max_iterations: 0, ..StopCriteria::default() }.check().is_err());
        assert!(StopCriteria::default().check().is_ok());
    }

    #[test]
    fn solves_in_a_row_share_their_time() {
        let without = TimeBudget::start(&StopCriteria::default());
        assert!(without.left().time_limit.is_none() && !without.is_spent());
        let of = |limit| TimeBudget::start(&StopCriteria { time_limit: Some(limit), ..StopCriteria::default() });
        assert!(of(Duration::ZERO).is_spent());
        let hour = of(Duration::from_secs(3600));
        assert!(!hour.is_spent() && hour.left().time_limit <= Some(Duration::from_secs(3600)));
    }
}
