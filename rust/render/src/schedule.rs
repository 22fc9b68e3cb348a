//! When a render ends, and how many samples the next pass takes.

use super::ErrorEstimate;

/// When to end: the first that is met does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Until {
    /// Samples of each pixel, or of all on average.
    pub samples: Option<u32>,
    /// relMSE of the picture: met when the whole 95 % interval of its estimate is at or below, and can be trusted; or
    /// when the estimate has been below, without being trusted, since so many samples that more will hardly help.
    pub error: Option<f64>,
    /// Wall-clock time.
    pub seconds: Option<f64>,
}

impl Until {
    /// Samples below which an estimated error ends nothing: what has not been found yet is not in the estimate.
    const LEAST_FOR_ERROR: u32 = 16;

    /// How many times the samples may become, while an estimate that is not trusted stays below an error, before that
    /// ends a render all the same: what is found once in as many samples has come many times by then, and what is
    /// rarer may never come.
    const PATIENCE: u32 = 64;

    /// Samples of a pass, once there are enough.
    const PASS: u32 = 16;

    /// How many samples the next pass takes, after `done` in `elapsed` seconds, the last ones at `rate` seconds each; 0
    /// to end. `batch` of them belong together. When there were `above`, the error was larger than is wanted for the
    /// last time.
    ///
    /// Passes double (1, 1, 2, 4, 8) so that there is soon something to see, then keep to 16, or to a batch if that is
    /// more. Their sizes do not depend on time unless that is limited, so that an error ends a render at the same
    /// picture anywhere.
    pub(super) fn next_pass(
        &self,
        done: u32,
        batch: u32,
        elapsed: f64,
        rate: f64,
        error: Option<&ErrorEstimate>,
        above: u32,
    ) -> u32 {
        let enough = above.max(Self::LEAST_FOR_ERROR).saturating_mul(Self::PATIENCE);
        let met = |target| {
            error.is_some_and(|e| if e.is_trusted() { e.high <= target } else { e.value <= target && done >= enough })
        };
        if done >= Self::LEAST_FOR_ERROR && self.error.is_some_and(met) {
            return 0;
        }
        let most = Self::PASS.max(batch);
        // A render that ended within a pass and goes on is back in step after the next.
        let mut next = done.clamp(1, most - done % most);
        if let Some(samples) = self.samples {
            next = next.min(samples.saturating_sub(done));
        }
        if let Some(seconds) = self.seconds
            && done > 0
        {
            // To the nearest sample: one that would end a little late is as good as one that would end a little early.
            let affordable = (seconds - elapsed) / rate + 0.5;
            next = next.min(affordable.max(0.0) as u32);
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The passes of a render whose samples take `rate` seconds and whose error is `1 / samples`.
    fn passes(until: Until, rate: f64) -> Vec<u32> {
        let (mut all, mut done) = (Vec::new(), 0);
        loop {
            let value = 1.0 / f64::from(done);
            let error = ErrorEstimate { value, low: 0.5 * value, high: 2.0 * value, carried: None };
            let next = until.next_pass(done, 1, f64::from(done) * rate, rate, (done > 1).then_some(&error), 0);
            if next == 0 {
                return all;
            }
            all.push(next);
            done += next;
        }
    }

    #[test]
    fn ends_at_samples() {
        let until = |samples| Until { samples: Some(samples), ..Until::default() };
        assert_eq!(passes(until(0), 1.0), Vec::<u32>::new());
        assert_eq!(passes(until(1), 1.0), [1]);
        assert_eq!(passes(until(50), 1.0), [1, 1, 2, 4, 8, 16, 16, 2]);
    }

    #[test]
    fn ends_at_seconds_to_the_nearest_sample() {
        let until = Until { seconds: Some(10.0), ..Until::default() };
        assert_eq!(passes(until, 1.0), [1, 1, 2, 4, 2]);
        assert_eq!(passes(until, 6.0), [1, 1]);
        assert_eq!(passes(until, 7.0), [1]);
        assert_eq!(passes(until, 100.0), [1]);
    }

    #[test]
    fn ends_at_an_error_that_is_sure() {
        let until = |error| Until { error: Some(error), ..Until::default() };
        // The upper end of the interval is 2 / samples.
        assert_eq!(passes(until(0.05), 1.0).iter().sum::<u32>(), 48);
        assert_eq!(passes(until(100.0), 1.0).iter().sum::<u32>(), 16);
    }

    #[test]
    fn an_error_that_is_not_trusted_takes_patience() {
        let until = Until { error: Some(0.05), ..Until::default() };
        let few = ErrorEstimate {
            value: 0.01,
            low: 0.005,
            high: 0.02,
            carried: Some(super::super::Carried { samples: 1, share: 0.9 }),
        };
        let wide = ErrorEstimate { low: 1e-4, high: 0.04, carried: None, ..few };
        for error in [few, wide] {
            let next = |done, above| until.next_pass(done, 1, 0.0, 0.0, Some(&error), above);
            assert_eq!([1008, 1024].map(|done| next(done, 0)), [16, 0]);
            // Found anew, light takes as many times what it took to be found.
            assert_eq!([1024, 6384, 6400].map(|done| next(done, 100)), [16, 16, 0]);
            let limited = Until { samples: Some(20), ..until };
            assert_eq!(limited.next_pass(20, 1, 0.0, 0.0, Some(&error), 0), 0);
            let limited = Until { seconds: Some(1.0), ..until };
            assert_eq!(limited.next_pass(16, 1, 1.0, 0.1, Some(&error), 0), 0);
            let above = ErrorEstimate { value: 0.06, ..error };
            assert_eq!(until.next_pass(1 << 20, 1, 0.0, 0.0, Some(&above), 0), 16);
        }
        let sure = ErrorEstimate { carried: None, ..few };
        assert_eq!(until.next_pass(16, 1, 0.0, 0.0, Some(&sure), 0), 0);
    }

    #[test]
    fn passes_grow_to_whole_batches() {
        let until = Until { samples: Some(200), ..Until::default() };
        let (mut all, mut done) = (Vec::new(), 0);
        while done < 200 {
            all.push(until.next_pass(done, 64, 0.0, 0.0, None, 0));
            done += all[all.len() - 1];
        }
        assert_eq!(all, [1, 1, 2, 4, 8, 16, 32, 64, 64, 8]);
    }

    #[test]
    fn falls_in_step_again() {
        let next = |done| Until::default().next_pass(done, 1, 0.0, 0.0, None, 0);
        assert_eq!([1, 3, 5, 9, 16, 19, 31, 100].map(next), [1, 3, 5, 7, 16, 13, 1, 12]);
    }

    #[test]
    fn ends_at_what_comes_first() {
        let all = Until { samples: Some(100), error: Some(0.05), seconds: Some(20.0) };
        assert_eq!(passes(all, 1.0).iter().sum::<u32>(), 20);
        assert_eq!(passes(all, 0.1).iter().sum::<u32>(), 48);
        assert_eq!(passes(Until { samples: Some(30), ..all }, 0.1).iter().sum::<u32>(), 30);
    }
}
