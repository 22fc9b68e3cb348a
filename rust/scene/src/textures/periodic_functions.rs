//! Periodic functions of period 1 with closed-form means over an interval.

use std::f64::consts::{PI, TAU};

/// Share of the interval with this width around `x` that lies in the first `fraction` of the periods [n, n + 1).
#[inline]
pub(super) fn pulse(x: f64, width: f64, fraction: f64) -> f64 {
    let (low, high) = (x - 0.5 * width, x + 0.5 * width);
    // The width after rounding, so that the result is exact if the interval ends within a piece.
    let width = high - low;
    let first = x - x.floor();
    if width.is_nan() || width <= 0.0 {
        return if first < fraction { 1.0 } else { 0.0 };
    }
    let whole = (high.floor() - low.floor()) * fraction;
    let rest = |x: f64| (x - x.floor()).min(fraction);
    ((whole + rest(high) - rest(low)) / width).clamp(0.0, 1.0)
}

/// Mean over the interval with this width around `x` of a triangle wave. It rises linearly from 0 to 1 in the first
/// `rise` of each period and falls in the rest; `rise` is between 0 and 1.
#[inline]
pub(super) fn ramp(x: f64, width: f64, rise: f64) -> f64 {
    let at = |f: f64| if f < rise { f / rise } else { (1.0 - f) / (1.0 - rise) };
    // Below this width, the mean differs from the center's value by less than 1e-6 / min(rise, 1 − rise), and its
    // quotient loses digits.
    if width.is_nan() || width <= 1e-6 {
        return at(x - x.floor());
    }
    let (low, high) = (x - 0.5 * width, x + 0.5 * width);
    let integral = |f: f64| {
        if f < rise { 0.5 * f * f / rise } else { 0.5 - 0.5 * (1.0 - f) * (1.0 - f) / (1.0 - rise) }
    };
    let rest = |x: f64| integral(x - x.floor());
    ((0.5 * (high.floor() - low.floor()) + rest(high) - rest(low)) / width).clamp(0.0, 1.0)
}

/// Mean of sin 2πx over the interval with this width around `x`.
#[inline]
pub(super) fn sine(x: f64, width: f64) -> f64 {
    let half = PI * width;
    let share = if half.abs() > 1e-8 { half.sin() / half } else { 1.0 };
    (TAU * (x - x.floor())).sin() * share
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The mean of a function over an interval, by the midpoint rule.
    fn quadrature(f: impl Fn(f64) -> f64, x: f64, width: f64) -> f64 {
        let steps = 20_000;
        let step = width / f64::from(steps);
        (0..steps).map(|i| f(x - 0.5 * width + (f64::from(i) + 0.5) * step)).sum::<f64>() / f64::from(steps)
    }

    proptest! {
        #[test]
        fn means_are_what_quadrature_finds(x in -9.0..9.0f64, width in 0.001..5.0f64, part in 0.05..0.95f64) {
            // Error of the midpoint rule: a jump of the function costs at most one of its steps.
            let error = 15.0 / 20_000.0;
            prop_assert!((pulse(x, width, part) - quadrature(|x| pulse(x, 0.0, part), x, width)).abs() < error);
            prop_assert!((ramp(x, width, part) - quadrature(|x| ramp(x, 0.0, part), x, width)).abs() < 1e-6);
            prop_assert!((sine(x, width) - quadrature(|x| sine(x, 0.0), x, width)).abs() < 1e-6);
        }

        #[test]
        fn narrow_means_are_the_value(x in -1e6..1e6f64, width in 1e-14..1e-10f64, part in 0.05..0.95f64) {
            let far = |edge: f64| (x - x.floor() - edge).abs() > 1e-9;
            prop_assume!(far(0.0) && far(part) && far(1.0));
            prop_assert_eq!(pulse(x, width, part), pulse(x, 0.0, part));
            prop_assert!((ramp(x, width, part) - ramp(x, 0.0, part)).abs() < 1e-8);
        }
    }

    #[test]
    fn wide_means_are_the_mean() {
        for width in [1.0, 4.0, 1e6] {
            assert!((pulse(0.37, width, 0.25) - 0.25).abs() < 1e-9);
            assert!((ramp(0.37, width, 0.8) - 0.5).abs() < 1e-9);
            assert!(sine(0.37, width).abs() < 1e-9);
        }
    }
}
