//! Memory that several jobs share.

use super::lock::lock;
use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, PoisonError};

/// How much may be taken at a time, and how much is.
#[derive(Debug)]
pub(super) struct Budget {
    limit: Option<u64>,
    state: Mutex<State>,
    freed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    taken: u64,
    /// Who waits, first come first served: small meshes must not keep a large one waiting for ever.
    queue: VecDeque<u64>,
    next: u64,
}

/// A part of the budget, given back when dropped.
#[derive(Debug)]
pub(super) struct Share<'a> {
    budget: &'a Budget,
    bytes: u64,
}

impl Budget {
    /// A budget of so many bytes, or without end.
    pub(super) fn new(limit: Option<u64>) -> Self {
        Self { limit, state: Mutex::default(), freed: Condvar::new() }
    }

    /// Takes so many bytes, when they are there. What can never be there is as much as there can be.
    pub(super) fn wait_for(&self, bytes: u64) -> Share<'_> {
        let Some(limit) = self.limit else { return Share { budget: self, bytes: 0 } };
        let bytes = bytes.min(limit);
        let mut state = lock(&self.state);
        let ticket = state.next;
        state.next += 1;
        state.queue.push_back(ticket);
        while state.queue.front() != Some(&ticket) || bytes > limit - state.taken {
            state = self.freed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state.queue.pop_front();
        state.taken += bytes;
        // The next in the queue may have enough as well.
        self.freed.notify_all();
        Share { budget: self, bytes }
    }
}

impl Share<'_> {
    /// Takes what is missing to so many bytes, if it is there now and nobody waits; otherwise nothing changes.
    pub(super) fn grow_to(&mut self, bytes: u64) -> bool {
        let Some(limit) = self.budget.limit else { return true };
        let mut state = lock(&self.budget.state);
        let more = bytes.saturating_sub(self.bytes);
        if more > 0 && (!state.queue.is_empty() || more > limit - state.taken) {
            return false;
        }
        state.taken += more;
        self.bytes += more;
        true
    }
}

impl Drop for Share<'_> {
    fn drop(&mut self) {
        lock(&self.budget.state).taken -= self.bytes;
        self.budget.freed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::thread;

    #[test]
    fn jobs_never_take_more_than_there_is_and_all_get_their_turn() {
        const LIMIT: u64 = 100;
        let budget = Budget::new(Some(LIMIT));
        let taken = AtomicU64::new(0);
        thread::scope(|scope| {
            for job in 0..8_u64 {
                let (budget, taken) = (&budget, &taken);
                scope.spawn(move || {
                    for round in 0..200 {
                        let bytes = 1 + (37 * job + 11 * round) % LIMIT;
                        let mut share = budget.wait_for(bytes / 2);
                        if !share.grow_to(bytes) {
                            drop(share);
                            share = budget.wait_for(bytes);
                        }
                        assert!(taken.fetch_add(bytes, Ordering::SeqCst) + bytes <= LIMIT);
                        taken.fetch_sub(bytes, Ordering::SeqCst);
                        drop(share);
                    }
                });
            }
        });
        assert_eq!(lock(&budget.state).taken, 0);
    }

    #[test]
    fn without_a_limit_nobody_waits() {
        let budget = Budget::new(None);
        let _large = budget.wait_for(u64::MAX);
        assert!(budget.wait_for(u64::MAX).grow_to(u64::MAX));
    }
}
