//! Pearson's chi-square test, for tests.

/// Assert that counts are consistent with probabilities, with a false alarm rate of 10⁻⁴ per call.
///
/// `probabilities` need not add up to 1: the remainder is a class of its own, which must not occur if it is 0. Classes
/// with an expectation below 5 are pooled, as Pearson's approximation requires.
pub fn assert_frequencies(counts: &[u64], probabilities: &[f64]) {
    assert_eq!(counts.len(), probabilities.len());
    let total: u64 = counts.iter().sum();
    let (mut statistic, mut classes) = (0.0, 0);
    let (mut pooled_count, mut pooled_expected) = (0.0, 0.0);
    for (&count, &probability) in counts.iter().zip(probabilities) {
        let expected = probability * total as f64;
        assert!(expected > 0.0 || count == 0, "drew what has probability 0");
        if expected < 5.0 {
            pooled_count += count as f64;
            pooled_expected += expected;
        } else {
            statistic += (count as f64 - expected).powi(2) / expected;
            classes += 1;
        }
    }
    if pooled_expected >= 5.0 {
        statistic += (pooled_count - pooled_expected).powi(2) / pooled_expected;
        classes += 1;
    }
    assert!(classes > 1, "too few samples for this test");
    let limit = quantile(f64::from(classes - 1));
    assert!(statistic < limit, "chi-square {statistic} of {classes} classes, at most {limit}");
}

/// The chi-square value exceeded with probability 10⁻⁴ (Wilson and Hilferty, 1931).
fn quantile(degrees: f64) -> f64 {
    const NORMAL: f64 = 3.719_016_485;
    let spread = 2.0 / (9.0 * degrees);
    degrees * (1.0 - spread + NORMAL * spread.sqrt()).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_agree_with_tables() {
        assert!((quantile(10.0) / 35.564 - 1.0).abs() < 0.02);
        assert!((quantile(100.0) / 161.319 - 1.0).abs() < 0.002);
    }

    #[test]
    #[should_panic(expected = "chi-square")]
    fn notices_a_loaded_die() {
        assert_frequencies(&[1000, 1000, 1000, 1000, 1000, 1300], &[1.0 / 6.0; 6]);
    }
}
