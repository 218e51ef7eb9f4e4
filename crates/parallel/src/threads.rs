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

/// Threads that stay for one call after the other.
///
/// Everything that a call does in parallel is done by these threads, and not by those of rayon's global pool. Without the
/// feature `rayon` there are none, and the thread that calls does the work.
///
/// Threads do not survive `fork`. A child that has its parent's pool must not use it, and has to [`forget`](std::mem::forget)
/// it: dropping it would wait for threads that are not there.
#[derive(Debug)]
pub struct Pool {
    #[cfg(feature = "rayon")]
    threads: rayon::ThreadPool,
}

impl Pool {
    /// A pool of that many threads; 0 is one thread per processor.
    ///
    /// # Errors
    /// [`PoolError`] when the system gives no threads.
    pub fn new(threads: usize) -> Result<Self, PoolError> {
        #[cfg(feature = "rayon")]
        {
            let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            built.map(|threads| Self { threads }).map_err(|cause| PoolError { threads, source: cause.into() })
        }
        #[cfg(not(feature = "rayon"))]
        {
            let _ = threads;
            Ok(Self {})
        }
    }

    /// How many threads it has.
    #[must_use]
    pub fn threads(&self) -> usize {
        #[cfg(feature = "rayon")]
        {
            self.threads.current_num_threads()
        }
        #[cfg(not(feature = "rayon"))]
        {
            1
        }
    }

    /// Runs `run` in the pool, and waits for it.
    pub fn run<R: Send>(&self, run: impl FnOnce() -> R + Send) -> R {
        #[cfg(feature = "rayon")]
        {
            self.threads.install(run)
        }
        #[cfg(not(feature = "rayon"))]
        {
            run()
        }
    }

    /// Runs `run` in the pool, and `meanwhile` on the thread that calls; waits for both.
    ///
    /// It is for a caller that has something to attend to, such as signals. How `meanwhile` learns that `run` has ended is
    /// theirs: by a channel, say. Without the feature `rayon` it is called after `run`.
    ///
    /// # Panics
    /// When one of the two panics.
    pub fn run_beside<R: Send>(&self, run: impl FnOnce() -> R + Send, meanwhile: impl FnOnce()) -> R {
        #[cfg(feature = "rayon")]
        {
            let mut result = None;
            self.threads.in_place_scope(|scope| {
                let result = &mut result;
                scope.spawn(move |_| *result = Some(run()));
                meanwhile();
            });
            result.expect("the scope has waited for it")
        }
        #[cfg(not(feature = "rayon"))]
        {
            let result = run();
            meanwhile();
            result
        }
    }
}

/// Runs `run` in a pool of that many threads of its own, and waits for it; 0 is one thread per processor.
///
/// Everything that `run` does in parallel is done by these threads. A caller that has a pool of rayon calls
/// `ThreadPool::install` of it instead. Without the feature `rayon` it runs on the thread that calls.
///
/// # Errors
/// [`PoolError`] when the system gives no threads. `run` has not been called then.
pub fn with_threads<R: Send>(threads: usize, run: impl FnOnce() -> R + Send) -> Result<R, PoolError> {
    Pool::new(threads).map(|pool| pool.run(run))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    #[test]
    fn what_is_run_has_that_many_threads() {
        for threads in [1, 3] {
            let expected = if cfg!(feature = "rayon") { threads } else { 1 };
            assert_eq!(with_threads(threads, crate::current_num_threads).expect("threads"), expected);
            assert_eq!(Pool::new(threads).expect("threads").threads(), expected);
        }
    }

    #[test]
    fn the_thread_that_calls_hears_when_the_work_beside_it_has_ended() {
        let pool = Pool::new(1).expect("a thread");
        let caller = std::thread::current().id();
        let (done, ended) = mpsc::channel::<()>();
        let mut heard = None;
        let run = move || {
            let _dropped_at_the_end = done;
            std::thread::current().id()
        };
        let worker = pool.run_beside(run, || heard = Some((ended.recv(), std::thread::current().id())));
        assert_eq!(heard, Some((Err(mpsc::RecvError), caller)));
        assert_eq!(worker != caller, cfg!(feature = "rayon"));
    }
}
