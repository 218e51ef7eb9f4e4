//! A pool of so many threads.

/// Threads that cannot be started.
#[derive(Debug, thiserror::Error)]
#[error("{threads} threads cannot be started: {source}; ask for fewer")]
#[non_exhaustive]
pub struct PoolError {
    /// How many were asked for.
    pub threads: usize,
    /// What the system says.
    pub source: Box<dyn std::error::Error + Send + Sync>,
}

/// Runs `run` in a pool of that many threads of its own, and waits for it; 0 is one thread per processor.
///
/// Everything that `run` does in parallel is done by these threads. A caller that has a pool of rayon calls
/// `ThreadPool::install` of it instead. Without the feature `rayon` it runs on the thread that calls.
///
/// # Errors
/// [`PoolError`] when the system gives no threads. `run` has not been called then.
pub fn with_threads<R: Send>(threads: usize, run: impl FnOnce() -> R + Send) -> Result<R, PoolError> {
    #[cfg(feature = "rayon")]
    {
        match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
            Ok(pool) => Ok(pool.install(run)),
            Err(cause) => Err(PoolError { threads, source: cause.into() }),
        }
    }
    #[cfg(not(feature = "rayon"))]
    {
        let _ = threads;
        Ok(run())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_run_has_that_many_threads() {
        for threads in [1, 3] {
            let expected = if cfg!(feature = "rayon") { threads } else { 1 };
            assert_eq!(with_threads(threads, crate::current_num_threads).expect("threads"), expected);
        }
    }
}
