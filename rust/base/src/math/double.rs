//! Numbers of twice the length of an f64.

use super::number::{Number, SLACK, underflow};
use std::cmp::Ordering;

/// The unevaluated sum of two f64, the second at most half an ulp of the first, and a bound on the distance from what
/// it stands for.
///
/// Sums and products are those of Dekker ("A Floating-Point Technique for Extending the Available Precision", 1971) in
/// the forms whose errors Joldes, Muller and Popescu proved ("Tight and rigorous error bounds for basic building blocks
/// of double-word arithmetic", 2017): with u = 2⁻⁵³, at most 3u² + 13u³ of a sum and less than 8u² of a product. Twice
/// that is allowed for.
///
/// It is [`DoubleDouble`](super::DoubleDouble) with its error, for decisions: that costs about half as much again,
/// which numbers that decide nothing need not pay. No fused multiplication is asked of the processor: where a program
/// is compiled for processors that may have none, each is a call, and the hits of most shapes are made of a hundred
/// products.
#[derive(Clone, Copy, Debug)]
pub struct Double {
    /// The f64 nearest to the sum.
    pub high: f64,
    /// The rest.
    pub low: f64,
    /// At most so far from what it stands for.
    pub error: f64,
}

/// Of a sum, relative.
const SUM: f64 = ulp_fraction(103);
/// Of a product, relative.
const PRODUCT: f64 = ulp_fraction(102);
/// Of a quotient and of a root, relative.
const QUOTIENT: f64 = ulp_fraction(98);

const fn ulp_fraction(bits: u64) -> f64 {
    f64::from_bits((1023 - bits) << 52)
}

/// The sum of two f64 and what its rounding left (Knuth, 1969).
#[inline(always)]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// The same where |a| ≥ |b|.
#[inline(always)]
pub fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// The product of two f64 and what its rounding left (Veltkamp and Dekker, 1971).
///
/// NaN where a factor is above 2⁹⁹⁶, and off by some of the least f64 where the rest is subnormal.
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
        // Of large numbers the parts may be NaN; what is zero has no error.
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
            // Nothing is lost of two f64; the second sum makes NaN of what overflowed.
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
        // The unit of a line is mostly 1.
        if other.is_one() {
            return *self;
        }
        let (product, rest) = two_product(self.high, other.high);
        let (high, low) = fast_two_sum(product, rest + (self.high * other.low + self.low * other.high));
        // Nothing is lost of two f64.
        let own = if self.low == 0.0 && other.low == 0.0 { 0.0 } else { PRODUCT * high.abs() };
        let lost = if self.is_zero() || other.is_zero() { 0.0 } else { underflow(high) };
        // The low part is at most 2⁻⁵³ of the high one: SLACK has room for it.
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
        // Three digits of 53 bits by long division; the third corrects what the second left.
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
        // One step of Newton's method from the f64 root doubles its digits.
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
