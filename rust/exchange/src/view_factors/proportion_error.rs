//! The standard error of a proportion, also if all samples agree.

/// Pseudo-counts of hits and misses added to those observed (Agresti and Coull, 1998). If none of n samples is a hit,
/// the variance is 2.5 / n², and 1.96 standard errors are the rule of three: 3 / n.
const ADDED: f64 = 2.5;

/// Degrees of freedom of the variance of independent samples, when combined with that between batches.
///
/// Few batches estimate their variance poorly: with four, one error in 60 would exceed four standard errors. The
/// variance of independent samples needs no batches, but is too large for stratified samples.
const PRIOR: f64 = 16.0;

/// Weighted samples, each a hit or a miss.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// The sums of weights and of their squares, over all samples and over hits.
    pub weights: f64,
    pub squares: f64,
    pub hits: f64,
    pub hit_squares: f64,
}

impl Counts {
    /// Adds a sample.
    pub fn add(&mut self, weight: f64, is_hit: bool) {
        self.weights += weight;
        self.squares += weight * weight;
        if is_hit {
            self.hits += weight;
            self.hit_squares += weight * weight;
        }
    }

    /// The counts of `samples` samples of equal weight, a fraction `share` of them hits.
    pub fn of(share: f64, samples: f64) -> Self {
        let hits = share.clamp(0.0, 1.0) * samples;
        Self { weights: samples, squares: samples, hits, hit_squares: hits }
    }

    /// The effective sample size: the number of samples of equal weight with the same information.
    pub fn effective(&self) -> f64 {
        if self.squares > 0.0 { self.weights * self.weights / self.squares } else { 0.0 }
    }

    /// Return whether all samples are hits, or all are misses.
    pub fn agree(&self) -> bool {
        self.hits == 0.0 || self.hits == self.weights
    }

    /// The variance of the proportion of hits, given that of the mean of independent batches and their number.
    pub fn variance(&self, (between, batches): (f64, f64)) -> f64 {
        let count = self.effective();
        if count == 0.0 {
            return 1.0;
        }
        let share = (self.hits / self.weights * count + ADDED) / (count + 2.0 * ADDED);
        let spread = self.hit_squares * (1.0 - 2.0 * share) + share * share * self.squares;
        let even = share * (1.0 - share) / (count + 2.0 * ADDED + 1.0);
        let alone = even.max(spread / (self.weights * self.weights));
        let freedom = (batches - 1.0).max(0.0);
        let pooled = (PRIOR * alone + freedom * between) / (PRIOR + freedom);
        let least = ADDED / ((count + 2.0 * ADDED) * (count + 2.0 * ADDED + 1.0));
        pooled.max(least).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_hit_is_told_by_the_rule_of_three() {
        for count in [16, 100, 10_000] {
            for is_hit in [false, true] {
                let mut counts = Counts::default();
                (0..count).for_each(|_| counts.add(1.0, is_hit));
                let bound = 1.96 * counts.variance((0.0, f64::from(count) / 16.0)).sqrt();
                let rule = 3.0 / f64::from(count);
                assert!(counts.agree() && (0.7..1.1).contains(&(bound / rule)), "{count}: {bound}");
            }
        }
        assert_eq!(Counts::default().variance((0.0, 0.0)), 1.0);
    }

    #[test]
    fn many_samples_have_the_variance_of_their_weights() {
        let mut counts = Counts::default();
        for i in 0..40_000 {
            counts.add(if i % 2 == 0 { 1.0 } else { 3.0 }, i % 4 < 2);
        }
        // Half of the weight is visible; the effective sample size is 4² / (2 · 10) of the number of samples.
        let truth: f64 = 0.25 / 32_000.0;
        assert!((counts.variance((truth, 1.0)) / truth - 1.0).abs() < 0.01);
        assert!((counts.variance((0.5 * truth, 1e6)) / truth - 0.5).abs() < 0.01);
    }
}
