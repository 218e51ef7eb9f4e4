//! The threads of a process.
//!
//! Threads do not survive `fork`, so every pool belongs to the process that made it; a child forgets those of its parent.
//! The lists are touched with the interpreter's lock held only: who forks from Python holds it, too, so that no child is
//! born with a locked list.

use crate::errors::{SettingError, chain};
use abf::parallel::Pool;
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// More threads than any machine this was tried on has cores; some systems die of many more.
const MOST_THREADS: usize = 1024;
/// So many idle threads are kept for later calls that ask for a number of threads.
const IDLE_THREADS: usize = 64;

static POOLS: Mutex<Pools> = Mutex::new(Pools { process: 0, shared: None, idle: Vec::new() });

struct Pools {
    process: u32,
    /// The one of all calls that ask for no number.
    shared: Option<Arc<Pool>>,
    /// Those of earlier calls that asked for a number.
    idle: Vec<Arc<Pool>>,
}

/// Threads for one call.
pub(crate) struct Lease {
    pool: Arc<Pool>,
    process: u32,
    is_shared: bool,
}

impl Lease {
    /// Threads: `None` is one per processor, shared by all calls of the process that ask for no number. A number is that of
    /// threads for this call alone.
    pub(crate) fn new(_py: Python<'_>, threads: Option<usize>) -> PyResult<Self> {
        if let Some(threads) = threads.filter(|threads| !(1..=MOST_THREADS).contains(threads)) {
            return Err(SettingError::new_err(format!("threads must be in 1..={MOST_THREADS}, got {threads}")));
        }
        let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
        pools.forget_those_of_a_parent();
        let start = |threads| match Pool::new(threads) {
            Ok(pool) => Ok(Arc::new(pool)),
            Err(error) => Err(SettingError::new_err(chain(&error))),
        };
        let pool = match threads {
            None => match &pools.shared {
                Some(shared) => Arc::clone(shared),
                None => Arc::clone(pools.shared.insert(start(0)?)),
            },
            Some(threads) => match pools.idle.iter().position(|pool| pool.threads() == threads) {
                Some(at) => pools.idle.swap_remove(at),
                None => start(threads)?,
            },
        };
        Ok(Self { pool, process: pools.process, is_shared: threads.is_none() })
    }

    /// The threads.
    pub(crate) fn pool(&self) -> &Pool {
        &self.pool
    }

    /// Keeps the threads for a later call, as long as there are not too many.
    pub(crate) fn give_back(self, _py: Python<'_>) {
        let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
        let idle: usize = pools.idle.iter().map(|pool| pool.threads()).sum();
        if !self.is_shared && self.process == pools.process && idle + self.pool.threads() <= IDLE_THREADS {
            pools.idle.push(self.pool);
        }
    }
}

impl Pools {
    fn forget_those_of_a_parent(&mut self) {
        let process = std::process::id();
        if self.process != process {
            self.process = process;
            std::mem::forget(self.shared.take());
            self.idle.drain(..).for_each(std::mem::forget);
        }
    }
}
