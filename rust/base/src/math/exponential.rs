//! The exponential function, in arithmetic that vectorizes.

/// ln 2 in two parts, the first with so few digits that its multiples are exact.
const LN_2: [f64; 2] = [f64::from_bits(0x3FE6_2E42_FEE0_0000), 1.908_214_929_270_587_7e-10];

/// 1/2!, 1/3! and so on: the coefficients of the series after 1 + x. The first omitted term is 4·10⁻¹⁸ at ln 2 / 2.
const TERMS: [f64; 12] = [
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// e to a power from −700 to 700, to a relative error of 2⁻⁵². Beyond that range the result is arbitrary.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    /// Adding this rounds to an integer in the last bits of the mantissa.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    let shifted = x * std::f64::consts::LOG2_E + WHOLE;
    let twos = shifted - WHOLE;
    let rest = (x - twos * LN_2[0]) - twos * LN_2[1];
    // In pairs, for instruction-level parallelism (Estrin, 1960).
    let (r2, r4) = (rest * rest, (rest * rest) * (rest * rest));
    let c = &TERMS;
    let low = (c[0] + c[1] * rest) + (c[2] + c[3] * rest) * r2;
    let middle = (c[4] + c[5] * rest) + (c[6] + c[7] * rest) * r2;
    let high = (c[8] + c[9] * rest) + (c[10] + c[11] * rest) * r2;
    let part = 1.0 + (rest + r2 * (low + (middle + high * r4) * r4));
    part * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn exact_where_the_truth_is() {
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(-0.0), 1.0);
        assert!((exp(1.0) / std::f64::consts::E - 1.0).abs() <= f64::EPSILON);
        assert!(exp(-700.0) > 0.0 && exp(700.0).is_finite());
    }

    proptest! {
        #[test]
        fn as_libm_has_it(x in prop_oneof![-700.0..700.0f64, -1.0..1.0f64, -1e-9..1e-9f64]) {
            prop_assert!((exp(x) / x.exp() - 1.0).abs() <= 2.0 * f64::EPSILON, "{x}: {} {}", exp(x), x.exp());
        }
    }
}
