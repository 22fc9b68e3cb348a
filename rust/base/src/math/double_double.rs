//! Double-double numbers of some 32 digits: the unevaluated sum of two f64 (Dekker, "A Floating-Point Technique for
//! Extending the Available Precision", 1971; bounds by Joldes, Muller and Popescu, "Tight and Rigorous Error Bounds for
//! Basic Building Blocks of Double-Word Arithmetic", 2017).

use super::double::fast_two_sum;
pub use super::double::two_sum;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `high + low`, where `low` is at most half an ulp of `high`.
///
/// With u = 2⁻⁵³, a sum errs by less than 3.1u², a product by 4u², a quotient by 10u², a root by 4u², relative to the
/// result, as long as nothing overflows and no product falls below 2⁻⁹⁶⁰.
///
/// It is for computations with a known error. [`Double`](super::Double) adds an error bound for exact predicates.
/// Products are fused here, which is correct up to the largest f64, whereas those of `Double` are limited to 2⁹⁹⁶ and
/// report it.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct DoubleDouble {
    /// The number rounded to f64.
    pub high: f64,
    /// The remainder.
    pub low: f64,
}

/// A product and its rounding error, exact in the absence of underflow.
#[inline(always)]
pub fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

impl DoubleDouble {
    /// Zero.
    pub const ZERO: Self = Self { high: 0.0, low: 0.0 };

    /// The exact difference of two f64.
    #[inline]
    pub fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        Self { high, low }
    }

    /// The exact product of two f64, in the absence of overflow and underflow.
    #[inline]
    pub fn product(a: f64, b: f64) -> Self {
        let (high, low) = two_product(a, b);
        Self { high, low }
    }

    /// The sum of several f64, with a relative error of 2⁻¹⁰⁴ despite any cancellation: they are first added exactly,
    /// as a nonoverlapping expansion (Shewchuk, 1997).
    pub fn sum<const N: usize>(terms: [f64; N]) -> Self {
        let mut expansion = [0.0; N];
        for (count, term) in terms.into_iter().enumerate() {
            let mut carry = term;
            for part in &mut expansion[..count] {
                let (sum, error) = two_sum(carry, *part);
                (carry, *part) = (sum, error);
            }
            expansion[count] = carry;
        }
        let (mut high, mut low, mut rest) = (0.0, 0.0, 0.0);
        for part in expansion.into_iter().rev() {
            let (sum, error) = two_sum(high, part);
            let (tail, error) = two_sum(low, error);
            (high, low, rest) = (sum, tail, rest + error);
        }
        let low = low + rest;
        let (high, low) = fast_two_sum(high, low);
        Self { high, low }
    }

    /// Return whether it is negative.
    #[inline]
    pub fn is_negative(self) -> bool {
        self.high < 0.0
    }

    /// Its absolute value.
    #[inline]
    pub fn abs(self) -> Self {
        if self.is_negative() { -self } else { self }
    }

    /// Its square.
    #[inline]
    pub fn squared(self) -> Self {
        self * self
    }

    /// Its square root; zero for negative numbers.
    #[inline]
    pub fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        let high = self.high.sqrt();
        let rest = (self - Self::product(high, high)).high / (2.0 * high);
        let (high, low) = fast_two_sum(high, rest);
        Self { high, low }
    }

    /// The exact product with a power of two.
    #[inline]
    pub fn scaled(self, power_of_two: f64) -> Self {
        Self { high: self.high * power_of_two, low: self.low * power_of_two }
    }

    /// The nearest f64.
    #[inline]
    pub fn to_f64(self) -> f64 {
        self.high + self.low
    }
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        let (low, rest) = two_sum(self.low, other.low);
        let (high, error) = fast_two_sum(high, error + low);
        let (high, low) = fast_two_sum(high, error + rest);
        Self { high, low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        let crossed = self.high.mul_add(other.low, self.low.mul_add(other.high, self.low * other.low));
        let (high, low) = fast_two_sum(high, error + crossed);
        Self { high, low }
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        let (high, low) = fast_two_sum(first, second);
        Self { high, low } + Self::from(rest.high / other.high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use proptest::prelude::*;

    /// `x · 2^1200` as an integer, for numbers of moderate size.
    fn integer(x: f64) -> BigInt {
        let bits = x.to_bits();
        let exponent = ((bits >> 52) & 0x7ff) as i32 - 1075 + 1200;
        if x == 0.0 {
            return BigInt::ZERO;
        }
        let mantissa = BigInt::from((bits & ((1 << 52) - 1)) | 1 << 52) << exponent as usize;
        if x < 0.0 { -mantissa } else { mantissa }
    }

    fn exact(x: DoubleDouble) -> BigInt {
        integer(x.high) + integer(x.low)
    }

    /// Return whether `found` equals `wanted` to within `units` of u², relative.
    fn near(found: &BigInt, wanted: &BigInt, units: u32) -> bool {
        let error: BigInt = (found - wanted) << 106usize;
        error.magnitude() <= &(wanted.magnitude() * units)
    }

    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            -4.0..4.0f64,
            (-100i32..100, -1.0..1.0f64).prop_map(|(e, m)| m * 2f64.powi(e)),
            (-9i32..9).prop_map(f64::from)
        ]
    }

    fn double() -> impl Strategy<Value = DoubleDouble> {
        (number(), -0.5..0.5f64).prop_map(|(high, part)| {
            let (high, low) = two_sum(high, part * high * f64::EPSILON);
            DoubleDouble { high, low }
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn operations_err_by_what_is_told(a in double(), b in double()) {
            let one = BigInt::from(1) << 1200usize;
            prop_assert!(near(&exact(a + b), &(exact(a) + exact(b)), 4));
            prop_assert!(near(&exact(a - b), &(exact(a) - exact(b)), 4));
            prop_assert!(near(&(exact(a * b) * &one), &(exact(a) * exact(b)), 4));
            if b.high != 0.0 {
                // Compared with the dividend: quotient times divisor.
                prop_assert!(near(&(exact(a / b) * exact(b)), &(exact(a) * &one), 10));
            }
            if a.high > 0.0 {
                let root = exact(a.sqrt());
                // The square errs by twice as much as the root.
                prop_assert!(near(&(&root * &root), &(exact(a) * &one), 8));
            }
        }

        #[test]
        fn sums_keep_their_digits_however_much_cancels(a in number(), b in number(), c in number(), d in number()) {
            let ((p, q), (r, s)) = (two_product(a, b), two_product(c, d));
            let terms = [p, q, -r, -s, -p, a, r, b];
            let wanted: BigInt = terms.iter().map(|&x| integer(x)).sum();
            prop_assert!(near(&exact(DoubleDouble::sum(terms)), &wanted, 4));
        }
    }

    #[test]
    fn a_third_thrice_is_one_to_32_digits() {
        let third = DoubleDouble::from(1.0) / DoubleDouble::from(3.0);
        let off = (third + third + third - DoubleDouble::from(1.0)).to_f64();
        assert!(off.abs() < 1e-31);
        assert_eq!(DoubleDouble::from(4.0).sqrt(), DoubleDouble::from(2.0));
        assert_eq!(DoubleDouble::from(-1.0).sqrt(), DoubleDouble::ZERO);
    }
}
