//! Thread pools by size, and work that the calling thread watches and can cancel.

use rayon::ThreadPoolBuilder;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// How often the waiting thread calls its watcher.
const WATCH: Duration = Duration::from_millis(20);

/// A cancellation flag.
#[derive(Debug, Default)]
pub struct Cancel(AtomicBool);

impl Cancel {
    /// Request cancellation.
    #[inline]
    pub fn raise(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Return whether cancellation was requested.
    #[inline]
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A pool of waiting threads.
#[derive(Debug)]
pub struct Pool(rayon::ThreadPool);

impl Pool {
    /// Return the number of threads.
    pub fn threads(&self) -> usize {
        self.0.current_num_threads()
    }

    /// Return the result of `work`, which runs on the pool, as does all its parallel work.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        let (mut work, mut result) = (Some(work), None);
        self.install_once(&mut || result = work.take().map(|work| work()));
        result.expect("work that does not panic leaves a result")
    }

    /// [`Pool::install`], compiled once for all types of work.
    fn install_once(&self, work: &mut (dyn FnMut() + Send)) {
        self.0.install(work);
    }

    /// Return whether this thread is one of the pool's.
    fn is_here(&self) -> bool {
        self.0.current_thread_index().is_some()
    }
}

/// The most threads of a pool of one a core.
static MOST_CORES: AtomicUsize = AtomicUsize::new(usize::MAX);

/// Bounds the threads of pools of one a core that are made from now on.
pub fn limit_cores(most: usize) {
    MOST_CORES.store(most.max(1), Ordering::Relaxed);
}

/// Return how many threads a pool of one a core has that is made now: as many as the environment variable
/// `RAYON_NUM_THREADS` says; without it one for each core that the process may use, by its affinity and by the quota of
/// its control group, at most the limit.
pub fn cores() -> usize {
    let told = std::env::var("RAYON_NUM_THREADS").ok().and_then(|told| told.parse().ok()).filter(|&told| told > 0);
    told.unwrap_or_else(|| {
        let available = std::thread::available_parallelism().map_or(1, usize::from);
        available.min(MOST_CORES.load(Ordering::Relaxed))
    })
}

/// The pool of so many threads, or of one a core. Made when it is first used and kept: the latter for ever, others as
/// long as those used since have no more than 64 threads in all.
///
/// A forked process has none of its parent's threads and would wait for them forever, so pools are kept per process.
/// This is also why the global pool is never used.
pub fn pool(threads: Option<usize>) -> Result<Arc<Pool>, String> {
    kept(threads, false)
}

/// A pool with one thread per core for work that must not wait for the main pools.
pub fn onlookers() -> Result<Arc<Pool>, String> {
    kept(None, true)
}

/// Maximum number of threads in all kept pools, except in the most recent one. Few for Miri, whose threads take turns.
const MOST_KEPT: usize = if cfg!(miri) { 12 } else { 64 };

/// The process id, the requested number of threads, and whether it is a separate pool for onlookers.
type Key = (u32, Option<usize>, bool);

fn kept(threads: Option<usize>, looks: bool) -> Result<Arc<Pool>, String> {
    static POOLS: Mutex<Pools> = Mutex::new(Pools(Vec::new()));
    POOLS.lock().unwrap_or_else(PoisonError::into_inner).get((std::process::id(), threads, looks))
}

/// The kept pools, most recently used last.
struct Pools(Vec<(Key, Arc<Pool>)>);

impl Pools {
    /// The pool of a key, created if missing.
    fn get(&mut self, key: Key) -> Result<Arc<Pool>, String> {
        if let Some(at) = self.0.iter().position(|(of, _)| *of == key) {
            self.0[at..].rotate_left(1);
            return Ok(Arc::clone(&self.0[self.0.len() - 1].1));
        }
        let (_, threads, _) = key;
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads.unwrap_or_else(cores))
            .thread_name(|i| format!("raywright-{i}"))
            .build()
            .map_err(|e| format!("cannot start {threads:?} threads: {e}"))?;
        let pool = Arc::new(Pool(pool));
        self.0.push((key, Arc::clone(&pool)));
        self.forget_old();
        Ok(pool)
    }

    /// Drop the least recently used pools of this process while there are too many threads. They end once their work is
    /// done. Pools of a parent process are left alone.
    fn forget_old(&mut self) {
        let (own, mut left) = (std::process::id(), MOST_KEPT);
        for at in (0..self.0.len()).rev() {
            let ((process, threads, _), pool) = &self.0[at];
            if *process != own || threads.is_none() {
                continue;
            }
            let (count, is_last) = (pool.threads(), at + 1 == self.0.len());
            if count <= left || is_last {
                left = left.saturating_sub(count);
            } else {
                left = 0;
                self.0.remove(at);
            }
        }
    }
}

/// Run `work` on a pool while the calling thread calls `watch` 50 times per second. If that returns false, the work's
/// [`Cancel`] is raised, and it should end soon.
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

/// [`watched`], compiled once for all types of work. `work` is called once.
fn watched_once(
    threads: Option<usize>,
    work: &mut (dyn FnMut(&Cancel) + Send),
    watch: &mut dyn FnMut() -> bool,
) -> Result<(), String> {
    let pool = pool(threads)?;
    let cancel = Cancel::default();
    if pool.is_here() {
        // On one of the pool's own threads, which must not wait for the others: all may be here. The outer call is
        // watched.
        work(&cancel);
        return Ok(());
    }
    let (done, ended) = (Mutex::new(false), Condvar::new());
    /// Notifies the watcher even if the work panics; the scope then propagates the panic.
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
                // Watching may take time, and the work must be able to end meanwhile.
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

/// Run `work` on a pool while the calling thread calls `watch` 50 times per second. If that returns false, return None
/// without waiting any longer. The abandoned work ends by itself, and should be canceled.
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
        // An abandoned result is dropped here.
        let _ = send.send(catch_unwind(AssertUnwindSafe(work)));
    });
    loop {
        match receive.recv_timeout(WATCH) {
            Ok(done) => return done.map_or_else(|panic| resume_unwind(panic), |value| Ok(Some(value))),
            Err(RecvTimeoutError::Timeout) if watch() => {}
            Err(RecvTimeoutError::Timeout) => return Ok(None),
            Err(RecvTimeoutError::Disconnected) => return Err("a worker ended without a result".into()),
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
        assert_eq!(pool(None).unwrap().threads(), cores());
    }

    #[test]
    fn pools_that_were_not_used_for_long_are_dropped() {
        let mut pools = Pools(Vec::new());
        let weak = |pools: &mut Pools, threads: Option<usize>| {
            let pool = pools.get((std::process::id(), threads, false)).unwrap();
            (pool.threads(), Arc::downgrade(&pool))
        };
        let whole = weak(&mut pools, None);
        // A pool of a parent process.
        pools.get((0, Some(3), false)).unwrap();
        let largest = if cfg!(miri) { 7 } else { 40 };
        let all: Vec<_> = (2..=largest).chain([5]).map(|threads| weak(&mut pools, Some(threads))).collect();
        let alive = |all: &[(usize, std::sync::Weak<Pool>)]| -> usize {
            all.iter().filter(|(_, pool)| pool.strong_count() > 0).map(|(threads, _)| threads).sum()
        };
        assert!((5..=MOST_KEPT).contains(&alive(&all)));
        assert!(all.last().unwrap().1.strong_count() == 1);
        // A dropped pool finishes its current work.
        let ((release, held), (done, ended)) = (channel::<()>(), channel());
        let three = pools.get((std::process::id(), Some(3), false)).unwrap();
        three.0.spawn(move || {
            held.recv().unwrap();
            done.send(crate::parallel::threads()).unwrap();
        });
        drop(three);
        weak(&mut pools, Some(MOST_KEPT + 1));
        assert_eq!(alive(&all), 0);
        release.send(()).unwrap();
        assert_eq!(ended.recv(), Ok(3));
        assert_eq!(pools.0.len(), 3);
        assert!(whole.1.strong_count() == 1);
    }

    #[test]
    fn work_runs_on_the_pool_and_gives_its_result() {
        let sum = watched(Some(2), |_| (0..1000u64).into_par_iter().sum::<u64>(), || true);
        assert_eq!(sum, Ok(499_500));
    }

    #[test]
    fn work_within_work_does_not_wait_for_its_own_threads() {
        let within = |i: u64| watched(Some(2), |_| (0..=i).into_par_iter().sum::<u64>(), || true).unwrap();
        let count = if cfg!(miri) { 10 } else { 100 };
        let sums = watched(Some(2), |_| (0..count).into_par_iter().map(within).sum::<u64>(), || true);
        assert_eq!(sums, Ok((0..count).map(|i| i * (i + 1) / 2).sum()));
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
        // The only thread of the pool is free again once the work ends.
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
