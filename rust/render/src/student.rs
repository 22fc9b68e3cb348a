//! Student's t distribution, and the gamma functions it needs.

use std::f64::consts::TAU;

/// Derivative of ln Γ, for x > 0.
pub(super) fn digamma(mut x: f64) -> f64 {
    let mut sum = 0.0;
    while x < 10.0 {
        sum -= 1.0 / x;
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    // Stirling's series; the remainder is below 1e-13.
    sum + x.ln() - 0.5 / x - y * (1.0 / 12.0 - y * (1.0 / 120.0 - y * (1.0 / 252.0 - y * (1.0 / 240.0 - y / 132.0))))
}

/// Derivative of [`digamma`], for x > 0.
pub(super) fn trigamma(mut x: f64) -> f64 {
    let mut sum = 0.0;
    while x < 10.0 {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    let series = 1.0 / 6.0 - y * (1.0 / 30.0 - y * (1.0 / 42.0 - y * (1.0 / 30.0 - y * 5.0 / 66.0)));
    sum + 1.0 / x + y / 2.0 + y / x * series
}

/// The x > 0 where [`trigamma`] is y; infinite if y is not positive.
pub(super) fn trigamma_inverse(y: f64) -> f64 {
    if y <= 0.0 {
        return f64::INFINITY;
    }
    // The larger of 1/x and 1/x² is a lower bound, and their sum an upper bound.
    let root = 1.0 / y.sqrt();
    halved([(1.0 / y).max(root) / 2.0, 2.0 * (1.0 / y).max(root)], |x| trigamma(x) > y)
}

/// Half width, in standard errors, of a confidence interval of `level`, if the variance has these degrees of freedom:
/// the quantile of Student's t at (1 + level) / 2.
pub fn quantile(level: f64, degrees: f64) -> f64 {
    // For at least one degree (Cauchy), t is below 1/(1 - level).
    halved([1e-12, 1.0 / (1.0 - level) + 1.0], |t| outside(t, degrees.max(1.0)) > 1.0 - level)
}

/// Bisection between two positive points, for the end of the range where a predicate holds.
fn halved([mut low, mut high]: [f64; 2], is_below: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..100 {
        let middle = (low * high).sqrt();
        if is_below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Probability that |t| exceeds `t`: a regularized incomplete beta function, by its continued fraction (Didonato and
/// Morris, 1992).
fn outside(t: f64, degrees: f64) -> f64 {
    let x = degrees / (degrees + t * t);
    let (a, b) = (degrees / 2.0, 0.5);
    let front = a * x.ln() + b * (t * t / (degrees + t * t)).ln() - ln_gamma(a) - ln_gamma(b) + ln_gamma(a + b);
    // The fraction converges where x is below the distribution's mean; elsewhere its mirror image does.
    if x < (a + 1.0) / (a + b + 2.0) {
        front.exp() * fraction(a, b, x) / a
    } else {
        1.0 - front.exp() * fraction(b, a, 1.0 - x) / b
    }
}

fn fraction(a: f64, b: f64, x: f64) -> f64 {
    // From the far end, where terms are below 1e-15.
    (1..=400)
        .rev()
        .fold(1.0, |rest, m| {
            let half = f64::from(m / 2);
            let term = if m % 2 == 0 {
                half * (b - half) * x / ((a + f64::from(m) - 1.0) * (a + f64::from(m)))
            } else {
                -(a + half) * (a + b + half) * x / ((a + f64::from(m) - 1.0) * (a + f64::from(m)))
            };
            1.0 + term / rest
        })
        .recip()
}

/// ln Γ, for x > 0.
fn ln_gamma(mut x: f64) -> f64 {
    let mut product = 1.0;
    while x < 10.0 {
        product *= x;
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    let series = 1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y * (1.0 / 1680.0 - y / 1188.0)));
    (x - 0.5) * x.ln() - x + TAU.ln() / 2.0 + series / x - f64::ln(product)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn close(a: f64, b: f64) -> bool {
        (a / b - 1.0).abs() < 1e-11
    }

    #[test]
    fn at_one_and_a_half_they_are_what_they_are() {
        const EULER: f64 = 0.577_215_664_901_532_9;
        assert!(close(digamma(1.0), -EULER) && close(digamma(0.5), -EULER - 2.0 * f64::ln(2.0)));
        assert!(close(trigamma(1.0), PI * PI / 6.0) && close(trigamma(0.5), PI * PI / 2.0));
        assert!(close(ln_gamma(0.5), PI.ln() / 2.0) && close(ln_gamma(11.0), f64::ln(3_628_800.0)));
        assert_eq!(trigamma_inverse(0.0), f64::INFINITY);
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // For one degree tan(π level / 2), for two √2 level / √(1 - level²), and in the limit those of a normal
        // deviate.
        for level in [0.1, 0.5, 0.9, 0.95, 0.999] {
            assert!(close(quantile(level, 1.0), (PI * level / 2.0).tan()), "{level}");
            let two = 2f64.sqrt() * level / (1.0 - level * level).sqrt();
            assert!(close(quantile(level, 2.0), two), "{level}: {}", quantile(level, 2.0));
        }
        for (degrees, t) in [(3.0, 3.182_446), (7.0, 2.364_624), (30.0, 2.042_272), (1e9, 1.959_964)] {
            assert!((quantile(0.95, degrees) / t - 1.0).abs() < 1e-6, "{degrees}: {}", quantile(0.95, degrees));
        }
    }

    proptest! {
        #[test]
        fn trigamma_comes_back(x in -6.0..6.0f64) {
            let x = 10f64.powf(x);
            prop_assert!((trigamma_inverse(trigamma(x)) / x - 1.0).abs() < 1e-8);
        }

        #[test]
        fn more_degrees_are_worth_more(level in 0.01..0.999f64, degrees in 1.0..1e4f64) {
            prop_assert!(quantile(level, 1.5 * degrees) < quantile(level, degrees));
        }
    }
}
