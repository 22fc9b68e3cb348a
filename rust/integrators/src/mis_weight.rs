//! How draws count beside those of another technique.

/// The weight of a draw of one technique, of density `pdf`, beside another of density `other` (Veach and Guibas, 1995,
/// with the exponent 2). Written by the ratio, so that no square overflows and an infinite density gets the weight 1.
#[inline]
pub(crate) fn power_heuristic(pdf: f64, other: f64) -> f64 {
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heuristic_weights_add_up_and_survive_extremes() {
        for (a, b) in [(1.0, 3.0), (1e-200, 1e200), (1e300, 1e300)] {
            assert!((power_heuristic(a, b) + power_heuristic(b, a) - 1.0).abs() < 1e-15);
        }
        assert_eq!(power_heuristic(f64::INFINITY, 5.0), 1.0);
        assert_eq!(power_heuristic(5.0, f64::INFINITY), 0.0);
    }
}
