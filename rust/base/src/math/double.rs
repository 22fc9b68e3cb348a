//! Double-double numbers with an error bound.

use super::number::{Number, SLACK, underflow};
use std::cmp::Ordering;

/// The unevaluated sum of two f64, the second at most half an ulp of the first, and a bound on its error.
///
/// Sums and products are those of Dekker ("A Floating-Point Technique for Extending the Available Precision", 1971) in
/// the forms whose errors Joldes, Muller and Popescu proved ("Tight and rigorous error bounds for basic building blocks
/// of double-word arithmetic", 2017): with u = 2⁻⁵³, at most 3u² + 13u³ of a sum and less than 8u² of a product. Twice
/// that is allowed for.
///
/// It is [`DoubleDouble`](super::DoubleDouble) with an error bound, for exact predicates. The bound costs about half as
/// much again, which other numbers need not pay. It does not use fused multiplication: code compiled for processors
/// without it would call a function for each, and the hits of most shapes take a hundred products.
#[derive(Clone, Copy, Debug)]
pub struct Double {
    /// The f64 nearest to the sum.
    pub high: f64,
    /// The remainder.
    pub low: f64,
    /// Bound on the absolute error.
    pub error: f64,
}

/// Relative error of a sum.
const SUM: f64 = ulp_fraction(103);
/// Relative error of a product.
const PRODUCT: f64 = ulp_fraction(102);
/// Relative error of a quotient and of a root.
const QUOTIENT: f64 = ulp_fraction(98);

const fn ulp_fraction(bits: u64) -> f64 {
    f64::from_bits((1023 - bits) << 52)
}

/// The sum of two f64 and its rounding error (Knuth, 1969).
#[inline(always)]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// The same for |a| ≥ |b|.
#[inline(always)]
pub fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// The product of two f64 and its rounding error (Veltkamp and Dekker, 1971).
///
/// NaN if a factor exceeds 2⁹⁹⁶. The error is off by some of the least f64 if it is subnormal.
#[inline(always)]
pub fn two_product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let product = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    (product, al * bl - (((product - ah * bh) - al * bh) - ah * bl))
}

impl Double {
    /// The difference of two f64, exactly.
    #[inline(always)]
    pub fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        Self { high, low, error: 0.0 }
    }

    /// The product of two f64, exactly but for underflow.
    #[inline(always)]
    pub fn product(a: f64, b: f64) -> Self {
        let (high, low) = two_product(a, b);
        // The parts of large numbers may be NaN; zero has no error.
        let error = if a == 0.0 || b == 0.0 { 0.0 } else { underflow(high) };
        Self { high, low, error }
    }

    #[inline]
    fn is_zero(&self) -> bool {
        self.high == 0.0 && self.error == 0.0
    }

    #[inline]
    fn is_one(&self) -> bool {
        self.high == 1.0 && self.is_exact_f64()
    }

    #[inline]
    fn is_exact_f64(&self) -> bool {
        self.low == 0.0 && self.error == 0.0
    }
}

impl Number for Double {
    #[inline]
    fn of(x: f64) -> Self {
        Self { high: x, low: 0.0, error: 0.0 }
    }

    #[inline]
    fn of_sum(high: f64, low: f64, error: f64) -> Option<Self> {
        Some(Self { high, low, error })
    }

    #[inline]
    fn plus(&self, other: &Self) -> Self {
        let (sum, rest) = two_sum(self.high, other.high);
        if self.low == 0.0 && other.low == 0.0 {
            // The sum of two f64 is exact; the second sum makes NaN of an overflow.
            let (high, low) = fast_two_sum(sum, rest);
            return Self { high, low, error: self.error + other.error };
        }
        let (low, lost) = two_sum(self.low, other.low);
        let (sum, rest) = fast_two_sum(sum, rest + low);
        let (high, low) = fast_two_sum(sum, rest + lost);
        Self { high, low, error: self.error + other.error + SUM * high.abs() }
    }

    #[inline]
    fn minus(&self, other: &Self) -> Self {
        self.plus(&Self { high: -other.high, low: -other.low, error: other.error })
    }

    #[inline]
    fn times(&self, other: &Self) -> Self {
        // The unit of a line is usually 1.
        if other.is_one() {
            return *self;
        }
        let (product, rest) = two_product(self.high, other.high);
        let (high, low) = fast_two_sum(product, rest + (self.high * other.low + self.low * other.high));
        // The product of two f64 is exact.
        let own = if self.low == 0.0 && other.low == 0.0 { 0.0 } else { PRODUCT * high.abs() };
        let lost = if self.is_zero() || other.is_zero() { 0.0 } else { underflow(high) };
        // The low part is at most 2⁻⁵³ of the high one, which SLACK covers.
        let carried = self.high.abs() * other.error + (other.high.abs() + other.error) * self.error;
        Self { high, low, error: carried * SLACK + own + lost }
    }

    #[inline]
    fn over(&self, other: &Self) -> Self {
        if other.is_one() {
            return *self;
        }
        if self.is_zero() && !other.is_zero() {
            return Self::of(0.0);
        }
        // Long division with three digits of 53 bits; the third corrects the remainder of the second.
        let bare = Self { error: 0.0, ..*other };
        let digit = |rest: &Self| Self::of(rest.high / other.high);
        let first = digit(self);
        let rest = self.minus(&bare.times(&first));
        let second = digit(&rest);
        let rest = rest.minus(&bare.times(&second));
        let quotient = first.plus(&second).plus(&digit(&rest));
        let (high, low) = (quotient.high, quotient.low);
        let least = other.high.abs() * (1.0 - f64::EPSILON) - other.error * SLACK;
        let carried = if least > 0.0 { (self.error + high.abs() * SLACK * other.error) / least } else { f64::INFINITY };
        Self { high, low, error: carried * SLACK + QUOTIENT * high.abs() + underflow(high) }
    }

    #[inline]
    fn sqrt(&self) -> Self {
        if self.high <= 0.0 {
            return Self { high: 0.0, low: 0.0, error: (self.error * 4.0).sqrt() };
        }
        // One Newton step from the f64 root doubles its digits.
        let first = Self::of(self.high.sqrt());
        let rest = Self { error: 0.0, ..*self }.minus(&first.squared());
        let root = first.plus(&Self::of(rest.high / (2.0 * first.high)));
        let (high, low) = (root.high, root.low);
        Self { high, low, error: (self.error / high) * SLACK + QUOTIENT * high + underflow(self.high).sqrt() }
    }

    #[inline]
    fn sign(&self) -> Option<Ordering> {
        if self.high.abs() * (1.0 - f64::EPSILON) > self.error * SLACK {
            self.high.partial_cmp(&0.0)
        } else {
            (self.high == 0.0 && self.error == 0.0).then_some(Ordering::Equal)
        }
    }

    #[inline]
    fn rounded(&self) -> Option<f64> {
        (self.error * SLACK <= ulp_fraction(60) * self.high.abs()).then_some(self.high)
    }

    #[inline]
    fn seems_negative(&self) -> bool {
        self.high < 0.0
    }
}
