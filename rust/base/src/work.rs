//! Progress and cancellation of long work.
//!
//! Workers check for cancellation at coarse steps of some milliseconds, and report progress at the same time. Both are
//! atomic numbers, so nobody waits.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering::Relaxed};

use crate::parallel::{self, Blocks};

/// The shared state of workers and watchers.
#[derive(Debug, Default)]
pub struct Watch {
    stopped: AtomicBool,
    /// The bits of the completed fraction. For nonnegative floats they are ordered like the numbers.
    share: AtomicU32,
}

impl Watch {
    /// Request cancellation; the result will be discarded.
    pub fn stop(&self) {
        self.stopped.store(true, Relaxed);
    }

    /// Return whether cancellation was requested.
    #[inline]
    pub fn is_stopped(&self) -> bool {
        self.stopped.load(Relaxed)
    }

    /// The completed fraction of the work, from 0 to 1. It never decreases.
    pub fn share(&self) -> f32 {
        f32::from_bits(self.share.load(Relaxed))
    }
}

/// The error of canceled work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped;

/// Some work, or one of its sequential parts, given by its interval of the whole.
#[derive(Clone, Copy, Debug)]
pub struct Work<'a> {
    watch: Option<&'a Watch>,
    from: f32,
    to: f32,
}

impl<'a> Work<'a> {
    /// Work without a watcher, which is never canceled.
    pub const UNWATCHED: Self = Self { watch: None, from: 0.0, to: 1.0 };

    /// Items per thread in a round of parallel work, which takes some milliseconds.
    const ROUND: usize = if cfg!(miri) { 1 << 8 } else { 1 << 16 };

    /// All of the watched work.
    pub fn of(watch: &'a Watch) -> Self {
        Self { watch: Some(watch), ..Self::UNWATCHED }
    }

    /// Return whether it is canceled.
    #[inline]
    pub fn is_stopped(self) -> bool {
        self.watch.is_some_and(Watch::is_stopped)
    }

    /// Return an error if it is canceled.
    #[inline]
    pub fn goes_on(self) -> Result<(), Stopped> {
        if self.is_stopped() { Err(Stopped) } else { Ok(()) }
    }

    /// Split into sequential parts with durations proportional to the weights.
    pub fn parts<const K: usize>(self, weights: [f32; K]) -> [Self; K] {
        let each = (self.to - self.from) / weights.iter().sum::<f32>();
        let mut from = self.from;
        weights.map(|weight| {
            let part = Self { from, to: (from + weight * each).min(self.to), ..self };
            from = part.to;
            part
        })
    }

    /// The work as a number of steps, which threads may share.
    pub fn steps(self, all: usize) -> Steps<'a> {
        Steps { work: self, all: all.max(1), done: AtomicUsize::new(0) }
    }

    /// Divide `count` items into rounds, for loops that can be canceled. Requesting the next round reports the last one
    /// as done.
    pub fn rounds(self, count: usize) -> impl Iterator<Item = Result<Range<usize>, Stopped>> {
        let (steps, round) = (self.steps(count), Self::ROUND * parallel::threads());
        (0..count).step_by(round).map(move |start| {
            steps.did(if start == 0 { 0 } else { round })?;
            Ok(start..(start + round).min(count))
        })
    }

    /// The results of `make` for each number below `count`, in order, computed in parallel.
    pub fn collect<T: Send>(self, count: usize, make: impl Fn(usize) -> T + Sync) -> Result<Vec<T>, Stopped> {
        let mut blocks = Blocks::new(count);
        for round in self.rounds(count) {
            blocks.extend(round?, &make);
        }
        let made = blocks.finish(&make);
        self.done();
        Ok(made)
    }

    /// Report that all of it is done.
    pub fn done(self) {
        self.reaches(1.0);
    }

    fn reaches(self, share: f32) {
        if let Some(watch) = self.watch {
            let share = (self.from + (self.to - self.from) * share.min(1.0)).clamp(0.0, 1.0);
            watch.share.fetch_max(share.to_bits(), Relaxed);
        }
    }
}

/// Steps of some work, done in any order and by any thread.
#[derive(Debug)]
pub struct Steps<'a> {
    work: Work<'a>,
    all: usize,
    done: AtomicUsize,
}

impl Steps<'_> {
    /// Report `count` completed steps, and return an error if canceled. Call it every few milliseconds.
    pub fn did(&self, count: usize) -> Result<(), Stopped> {
        if self.work.watch.is_some() {
            let done = self.done.fetch_add(count, Relaxed) + count;
            self.work.reaches((done as f64 / self.all as f64) as f32);
        }
        self.work.goes_on()
    }

    /// Return whether the work is canceled.
    #[inline]
    pub fn is_stopped(&self) -> bool {
        self.work.is_stopped()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_follow_upon_each_other_up_to_the_whole() {
        let watch = Watch::default();
        let [first, second, last] = Work::of(&watch).parts([1.0, 2.0, 1.0]);
        let mut seen = vec![watch.share()];
        for part in [first, second, last] {
            let steps = part.steps(4);
            for _ in 0..4 {
                steps.did(1).unwrap();
                seen.push(watch.share());
            }
        }
        let wanted = [0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0, 13.0, 14.0, 15.0, 16.0].map(|x| x / 16.0);
        assert_eq!(seen, wanted);
    }

    #[test]
    fn the_share_never_falls_nor_passes_one() {
        let watch = Watch::default();
        let [first, last] = Work::of(&watch).parts([1.0, 1.0]);
        last.steps(1).did(5).unwrap();
        assert_eq!(watch.share(), 1.0);
        first.steps(2).did(1).unwrap();
        assert_eq!(watch.share(), 1.0);
    }

    #[test]
    fn what_is_collected_is_in_order_and_ends_when_it_is_stopped() {
        let count = 5 * Work::ROUND * parallel::threads() + 7;
        let watch = Watch::default();
        assert_eq!(Work::of(&watch).collect(count, |i| i).unwrap(), (0..count).collect::<Vec<_>>());
        assert_eq!(watch.share(), 1.0);
        let made = AtomicUsize::new(0);
        let stopped = Work::of(&watch).collect(count, |_| {
            watch.stop();
            made.fetch_add(1, Relaxed)
        });
        assert_eq!(stopped, Err(Stopped));
        assert!(made.into_inner() < count / 2);
        assert_eq!(Work::UNWATCHED.collect(3, |i| i), Ok(vec![0, 1, 2]));
    }
}
