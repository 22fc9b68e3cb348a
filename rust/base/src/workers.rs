//! Threads: pools by size, and work that the calling thread watches and can stop.

use rayon::ThreadPoolBuilder;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// How often the calling thread looks up from waiting.
const WATCH: Duration = Duration::from_millis(20);

/// Raised to ask work to stop soon.
#[derive(Debug, Default)]
pub struct Cancel(AtomicBool);

impl Cancel {
    /// Asks.
    #[inline]
    pub fn raise(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked.
    #[inline]
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Threads that wait for work.
#[derive(Debug)]
pub struct Pool(rayon::ThreadPool);

impl Pool {
    /// Return the number of threads.
    pub fn threads(&self) -> usize {
        self.0.current_num_threads()
    }

    /// Return the result of `work`, which runs on the pool; so does all that it shares with other threads.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        let (mut work, mut result) = (Some(work), None);
        self.install_once(&mut || result = work.take().map(|work| work()));
        result.expect("work that does not panic leaves a result")
    }

    /// [`Pool::install`], compiled once for all sorts of work.
    fn install_once(&self, work: &mut (dyn FnMut() + Send)) {
        self.0.install(work);
    }

    /// Whether this thread is one of the pool's.
    fn is_here(&self) -> bool {
        self.0.current_thread_index().is_some()
    }
}

/// The pool of so many threads, or of one a core. Made once and kept.
///
/// A process that was forked has none of its parent's threads and would wait for them forever, so pools are kept by
/// process as well; this is also why the global pool is never used.
pub fn pool(threads: Option<usize>) -> Result<Arc<Pool>, String> {
    kept(threads, false)
}

/// A pool of one thread a core for those who look at what others work on, and do not wait for these.
pub fn onlookers() -> Result<Arc<Pool>, String> {
    kept(None, true)
}

fn kept(threads: Option<usize>, looks: bool) -> Result<Arc<Pool>, String> {
    type Pools = HashMap<(u32, Option<usize>, bool), Arc<Pool>>;
    static POOLS: Mutex<Option<Pools>> = Mutex::new(None);
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let pools = pools.get_or_insert_with(HashMap::new);
    let key = (std::process::id(), threads, looks);
    if let Some(pool) = pools.get(&key) {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .thread_name(|i| format!("raywright-{i}"))
        .build()
        .map_err(|e| format!("no pool of {threads:?} threads: {e}"))?;
    let pool = Arc::new(Pool(pool));
    pools.insert(key, Arc::clone(&pool));
    Ok(pool)
}

/// Does `work` on the pool of so many threads while the calling thread calls `watch` 50 times a second; when that
/// says false, the work's [`Cancel`] is raised, and it should end soon.
pub fn watched<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce(&Cancel) -> T + Send,
    mut watch: impl FnMut() -> bool,
) -> Result<T, String> {
    let (mut work, mut result) = (Some(work), None);
    let mut once = |cancel: &Cancel| result = work.take().map(|work| work(cancel));
    watched_once(threads, &mut once, &mut watch)?;
    Ok(result.expect("work that does not panic leaves a result"))
}

/// [`watched`], compiled once for all sorts of work. `work` is called once.
fn watched_once(
    threads: Option<usize>,
    work: &mut (dyn FnMut(&Cancel) + Send),
    watch: &mut dyn FnMut() -> bool,
) -> Result<(), String> {
    let pool = pool(threads)?;
    let cancel = Cancel::default();
    if pool.is_here() {
        // One of its own threads, which must not wait for the others: they may all be here. Whoever called it is
        // watched.
        work(&cancel);
        return Ok(());
    }
    let (done, ended) = (Mutex::new(false), Condvar::new());
    /// Tells the watcher even if the work panics; the scope then passes the panic on.
    struct Tell<'a>(&'a Mutex<bool>, &'a Condvar);
    impl Drop for Tell<'_> {
        fn drop(&mut self) {
            *self.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
            self.1.notify_one();
        }
    }
    pool.0.in_place_scope(|scope| {
        scope.spawn(|_| {
            let _tell = Tell(&done, &ended);
            work(&cancel);
        });
        let mut over = done.lock().unwrap_or_else(PoisonError::into_inner);
        while !*over {
            let (guard, wait) = ended.wait_timeout(over, WATCH).unwrap_or_else(PoisonError::into_inner);
            over = guard;
            if wait.timed_out() && !*over && !cancel.is_raised() {
                // Watching may take its time, and the work must be able to end meanwhile.
                drop(over);
                if !watch() {
                    cancel.raise();
                }
                over = done.lock().unwrap_or_else(PoisonError::into_inner);
            }
        }
    });
    Ok(())
}

/// Does `work` on the pool of so many threads while the calling thread calls `watch` 50 times a second. When that says
/// false, nobody waits any longer, and nothing is given. What is left so ends on its own, and had better be told to.
pub fn unless_left<T: Send + 'static>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send + 'static,
    mut watch: impl FnMut() -> bool,
) -> Result<Option<T>, String> {
    let pool = pool(threads)?;
    if pool.is_here() {
        // As in `watched`.
        return Ok(Some(work()));
    }
    let (send, receive) = channel();
    pool.0.spawn(move || {
        // Whoever has left receives nothing; what was made is dropped here.
        let _ = send.send(catch_unwind(AssertUnwindSafe(work)));
    });
    loop {
        match receive.recv_timeout(WATCH) {
            Ok(done) => return done.map_or_else(|panic| resume_unwind(panic), |value| Ok(Some(value))),
            Err(RecvTimeoutError::Timeout) if watch() => {}
            Err(RecvTimeoutError::Timeout) => return Ok(None),
            Err(RecvTimeoutError::Disconnected) => return Err("work has ended without a result".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;
    use std::time::Instant;

    #[test]
    fn pools_have_their_size_and_are_kept() {
        for threads in [1, 3] {
            let pool = pool(Some(threads)).unwrap();
            assert_eq!(pool.threads(), threads);
            assert_eq!(pool.install(crate::parallel::threads), threads);
            assert!(Arc::ptr_eq(&pool, &super::pool(Some(threads)).unwrap()));
        }
    }

    #[test]
    fn work_runs_on_the_pool_and_gives_its_result() {
        let sum = watched(Some(2), |_| (0..1000u64).into_par_iter().sum::<u64>(), || true);
        assert_eq!(sum, Ok(499_500));
    }

    #[test]
    fn work_within_work_does_not_wait_for_its_own_threads() {
        let within = |i: u64| watched(Some(2), |_| (0..=i).into_par_iter().sum::<u64>(), || true).unwrap();
        let sums = watched(Some(2), |_| (0..100).into_par_iter().map(within).sum::<u64>(), || true);
        assert_eq!(sums, Ok((0..100u64).map(|i| i * (i + 1) / 2).sum()));
    }

    #[test]
    fn work_is_asked_to_stop_when_the_watcher_says_so() {
        let start = Instant::now();
        let mut looks = 0;
        let raised = watched(
            Some(1),
            |cancel| {
                while !cancel.is_raised() && start.elapsed() < Duration::from_secs(20) {
                    std::thread::yield_now();
                }
                cancel.is_raised()
            },
            || {
                looks += 1;
                looks < 2
            },
        );
        assert_eq!((raised, looks), (Ok(true), 2));
    }

    #[test]
    fn work_that_nobody_waits_for_is_left() {
        assert_eq!(unless_left(Some(2), || 7, || true), Ok(Some(7)));
        let (release, held) = channel::<()>();
        let (start, mut looks) = (Instant::now(), 0);
        let left = unless_left(
            Some(1),
            move || held.recv_timeout(Duration::from_secs(20)).is_ok(),
            || {
                looks += 1;
                looks < 2
            },
        );
        assert_eq!((left, looks), (Ok(None), 2));
        assert!(start.elapsed() < Duration::from_secs(10));
        // The one thread of its pool is free again once the work ends.
        release.send(()).unwrap();
        assert_eq!(unless_left(Some(1), || 8, || true), Ok(Some(8)));
    }

    #[test]
    #[should_panic(expected = "from within")]
    fn panics_of_what_can_be_left_come_through() {
        let _ = unless_left(Some(1), || panic!("from within"), || true);
    }

    #[test]
    #[should_panic(expected = "from within")]
    fn panics_come_through() {
        let _ = watched(Some(1), |_| panic!("from within"), || true);
    }
}
