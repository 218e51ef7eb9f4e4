//! A clock that is handed in is the one that counts. A program of its own, for there is one clock per program.

use abf_control::{Silent, StopCriteria, Termination, TimeBudget, Watch, set_clock};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

static SECONDS: AtomicU64 = AtomicU64::new(0);

fn clock() -> Duration {
    Duration::from_secs(SECONDS.load(Ordering::Relaxed))
}

#[test]
fn a_time_limit_counts_on_the_clock_that_was_handed_in() {
    assert!(set_clock(clock) && !set_clock(clock));
    let stop = StopCriteria { time_limit: Some(Duration::from_secs(10)), ..StopCriteria::default() };
    stop.check().expect("there is a clock");
    let (mut observer, budget) = (Silent, TimeBudget::start(&stop));
    let mut watch = Watch::start(&stop, &mut observer);
    SECONDS.store(9, Ordering::Relaxed);
    assert!(watch.inner(1, 0.5).expect("not aborted") && !budget.is_spent());
    assert_eq!(budget.left().time_limit, Some(Duration::from_secs(1)));
    SECONDS.store(10, Ordering::Relaxed);
    assert!(!watch.inner(2, 0.5).expect("not aborted") && budget.is_spent());
    assert_eq!(watch.interruption(), Some(Termination::TimeLimit));
}
