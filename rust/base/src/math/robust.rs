//! Basic functions for robust floating-point arithmetic, and constants of error bounds.

/// Half the distance from 1 to the next f64: the largest relative error of one rounding.
pub const UNIT: f64 = f64::EPSILON / 2.0;

/// The maximum of two numbers other than NaN: one instruction, where `f64::max` takes four to handle NaN.
#[inline(always)]
pub fn greater<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// The minimum of two numbers other than NaN.
#[inline(always)]
pub fn lesser<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The power of two `s` for which `s · x` lies in [1, 2), and its inverse, for a normal number; 1 for zero.
///
/// Multiplying by either is exact, so computations on scaled numbers give scaled results.
#[inline(always)]
pub fn normalising_scale(x: f64) -> (f64, f64) {
    debug_assert!(x == 0.0 || x.is_normal());
    // The inverse has the exponent of x and no other bits: biased exponents of inverses sum to twice the bias.
    match (x.to_bits() >> 52) & 0x7ff {
        0 => (1.0, 1.0),
        // 2⁻¹⁰²³ is subnormal.
        2046 => (f64::MIN_POSITIVE / 2.0, f64::from_bits(2046 << 52)),
        biased => (f64::from_bits((2046 - biased) << 52), f64::from_bits(biased << 52)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn scaled_numbers_lie_between_one_and_two(x in prop::num::f64::NORMAL) {
            let (s, inverse) = normalising_scale(x);
            prop_assert_eq!(s * inverse, 1.0);
            let scaled = x.abs() * s;
            prop_assert!((1.0..2.0).contains(&scaled), "{x} * {s}");
        }
    }

    #[test]
    fn the_ends_of_the_range_have_a_scale_and_an_inverse() {
        let (least, greatest) = (f64::MIN_POSITIVE, 2f64.powi(1022));
        assert_eq!(normalising_scale(least), (greatest, least));
        assert_eq!(normalising_scale(f64::MAX), (least / 2.0, greatest * 2.0));
        assert_eq!(normalising_scale(0.0), (1.0, 1.0));
        assert_eq!(normalising_scale(-3.0), (0.5, 2.0));
    }
}
