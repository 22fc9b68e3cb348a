//! The error function and its inverse, for the slopes of Gaussian surfaces.

use super::exponential::exp;
use std::f64::consts::FRAC_2_SQRT_PI;

/// 1 / √π.
pub const FRAC_1_SQRT_PI: f64 = 0.5 * FRAC_2_SQRT_PI;

/// (1 + 2x) times [`scaled_complement`] as a polynomial in (x − 3) / (x + 3), in which it is smooth from 0 to infinity
/// (Shepherd and Laframboise, "Chebyshev Approximation of (1 + 2x) exp(x²) erfc x", 1981). Interpolated at Chebyshev
/// nodes.
const COMPLEMENT: [f64; 17] = [
    1.2530080582697298,
    -0.13562110604544592,
    -0.04756229434409753,
    0.12964515488980083,
    -0.11927366386852226,
    0.06830808121953556,
    -0.023770508437679236,
    0.0025290477164885707,
    0.0018886481151165182,
    -0.0007786553640321469,
    -0.00010501056754012327,
    0.00012277869444154649,
    4.639666178605614e-6,
    -1.741223527965378e-5,
    -3.404559117572817e-7,
    1.6946761765539414e-6,
    5.5170860854608995e-8,
];

/// erf⁻¹(s) / s as a function of w = −ln(1 − s²) from 0 to [`MIDDLE`], as a polynomial in w mapped to [−1, 1].
/// Interpolated likewise.
const INVERSE_MIDDLE: [f64; 13] = [
    1.6536545626831138,
    0.7504943076479603,
    -0.05892256867460646,
    -0.022604096452116758,
    0.017808404971116038,
    -0.004140180720689403,
    -0.0012720206265499088,
    0.0012426903092659575,
    -0.0002633802157501674,
    -0.00013508115513912722,
    9.204977115230713e-5,
    1.578797297689218e-6,
    -1.0903445003376967e-5,
];

/// erf⁻¹(s) / (s √w) as a function of 1 / √w from 1 / [`FAREST`] to 1 / √[`MIDDLE`], likewise.
const INVERSE_TAIL: [f64; 11] = [
    0.9553345741837332,
    -0.02446856618014872,
    0.0019139100738650681,
    0.0011207157533580103,
    0.0001065121981627799,
    0.0003660645210561927,
    0.00014539751453169225,
    -8.012391086316516e-5,
    -9.074411316781119e-5,
    9.807980132639483e-6,
    2.060517842465777e-5,
];

const MIDDLE: f64 = 6.25;
const FAREST: f64 = 6.8;

#[inline(always)]
fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// exp(x²) erfc(x) for x ≥ 0, with a relative error below 10⁻¹¹.
#[inline(always)]
pub fn scaled_complement(x: f64) -> f64 {
    polynomial(&COMPLEMENT, (x - 3.0) / (x + 3.0)) / (1.0 + 2.0 * x)
}

/// The integral of erfc from x ≥ 0 to infinity, exp(−x²) / √π − x erfc(x), to within 10⁻¹¹.
#[inline(always)]
pub fn complement_integral(x: f64) -> f64 {
    // Less than 10⁻²² beyond this.
    if x > 7.0 { 0.0 } else { exp(-x * x) * (FRAC_1_SQRT_PI - x * scaled_complement(x)) }
}

/// erf⁻¹(1 − 2u) for 0 < u < 1: the slope that is exceeded on a fraction u of a Gaussian surface. The relative error is
/// below 10⁻⁸ for u ≥ 10⁻²⁰, and likewise at the other end.
#[inline(always)]
pub fn exceeded(u: f64) -> f64 {
    let product = 4.0 * u * (1.0 - u);
    let w = -product.ln();
    let s = 1.0 - 2.0 * u;
    if w < MIDDLE {
        return s * polynomial(&INVERSE_MIDDLE, w * (2.0 / MIDDLE) - 1.0);
    }
    let (root, low, high) = (w.sqrt(), 1.0 / FAREST, 0.4);
    s * root * polynomial(&INVERSE_TAIL, (2.0 / root - low - high) / (high - low))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_complement_is_that_of_the_tables() {
        // erfc(x) exp(x²) to 20 digits, by its continued fraction and series.
        let truths = [
            (0.0, 1.0),
            (1e-9, 0.999_999_998_871_620_8),
            (0.1, 0.896_456_979_969_126_6),
            (0.5, 0.615_690_344_192_925_9),
            (1.0, 0.427_583_576_155_807),
            (2.0, 0.255_395_676_310_505_74),
            (3.5, 0.155_293_655_608_894_3),
            (7.0, 0.079_800_054_329_152_93),
            (30.0, 0.018_795_888_861_416_75),
        ];
        for (x, truth) in truths {
            assert!((scaled_complement(x) / truth - 1.0).abs() < 1e-11, "{x} {}", scaled_complement(x));
        }
        // 1 / (x √π) at infinity.
        assert!((scaled_complement(1e9) * 1e9 / FRAC_1_SQRT_PI - 1.0).abs() < 1e-11);
    }

    #[test]
    fn its_integral_is_that_of_simpsons_rule() {
        let erfc = |x: f64| (-x * x).exp() * scaled_complement(x);
        for x in [0.0, 0.03, 0.4, 1.3, 3.0, 6.9, 7.1] {
            let (steps, top) = (2000, 9.0);
            let h = (top - x) / f64::from(steps);
            let sum: f64 = (0..=steps)
                .map(|i| {
                    let weight = if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
                    weight * erfc(x + f64::from(i) * h) * h / 3.0
                })
                .sum();
            assert!((complement_integral(x) - sum).abs() < 2e-11, "{x} {}", complement_integral(x));
        }
        assert_eq!(complement_integral(f64::INFINITY), 0.0);
    }

    #[test]
    fn what_is_exceeded_is_the_inverse() {
        for k in 1..2000 {
            for u in [f64::from(k) / 4000.0, 0.5 * (-f64::from(k) * 0.022).exp()] {
                let x = exceeded(u);
                // Half of erfc, whose relative change is about 2 x² that of x.
                let back = 0.5 * (-x * x).exp() * scaled_complement(x);
                assert!((back / u - 1.0).abs() < 3e-8 * (0.5 + x * x), "{u:e} {x} {back:e}");
                assert!(u < 1e-9 || (exceeded(1.0 - u) + x).abs() < 1e-7, "{u}");
            }
        }
        assert!(exceeded(0.5).abs() < 1e-300);
    }
}
