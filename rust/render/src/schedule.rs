//! Stopping criteria and pass sizes.

use super::ErrorEstimate;

/// Stopping criteria; the first one met ends the render.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Until {
    /// Samples per pixel, or on average.
    pub samples: Option<u32>,
    /// relMSE of the picture. Met when the whole 95 % interval of a reliable estimate is at or below. Also met when an
    /// unreliable estimate has been below for so many samples that more will hardly help.
    pub error: Option<f64>,
    /// Wall-clock time.
    pub seconds: Option<f64>,
}

impl Until {
    /// Minimum samples for ending at an estimated error, which does not include light not found yet.
    const LEAST_FOR_ERROR: u32 = 16;

    /// Factor by which samples may grow, while an unreliable estimate stays below the target error, before the render
    /// ends anyway. Light found once in the initial samples has been found many times by then, and rarer light may
    /// never be found.
    const PATIENCE: u32 = 64;

    /// Samples per pass, after the first passes.
    const PASS: u32 = 16;

    /// Number of samples of the next pass, after `done` in `elapsed` seconds with the last ones at `rate` seconds each;
    /// 0 to end. Batches have `batch` samples. `above` is the number of samples when the error last exceeded the
    /// target.
    ///
    /// Passes double (1, 1, 2, 4, 8) so that there is soon a picture, and then stay at 16, or at a batch if that is
    /// larger. Their sizes depend on time only if time is limited, so that a target error gives the same picture on
    /// every machine.
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
        // A render that ended within a pass realigns with the schedule after the next.
        let mut next = done.clamp(1, most - done % most);
        if let Some(samples) = self.samples {
            next = next.min(samples.saturating_sub(done));
        }
        if let Some(seconds) = self.seconds
            && done > 0
        {
            // Rounded to nearest: ending slightly late is as good as ending slightly early.
            let affordable = (seconds - elapsed) / rate + 0.5;
            next = next.min(affordable.max(0.0) as u32);
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Passes of a render with `rate` seconds per sample and an error of `1 / samples`.
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
            carried: Some(super::super::DominantSamples { samples: 1, share: 0.9 }),
        };
        let wide = ErrorEstimate { low: 1e-4, high: 0.04, carried: None, ..few };
        for error in [few, wide] {
            let next = |done, above| until.next_pass(done, 1, 0.0, 0.0, Some(&error), above);
            assert_eq!([1008, 1024].map(|done| next(done, 0)), [16, 0]);
            // If light is found again, the patience starts anew.
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
