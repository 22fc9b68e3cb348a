//! Number types with error bounds, for predicates computed only as precisely as their sign requires.
//!
//! A predicate is the sign of a polynomial in the given numbers. It is evaluated first in [`Bounded`], an f64 with an
//! error bound; if that leaves it open, in [`Double`](super::Double), with twice the precision; and last in
//! [`Dyadic`](super::Dyadic), which is exact.

use super::DVec3;
use super::robust::UNIT;
use std::cmp::Ordering;

/// A number with an error bound.
pub trait Number: Clone {
    /// A finite f64, exactly.
    fn of(x: f64) -> Self;

    /// A number within `error` of the sum of two f64, the second at most half an ulp of the first; None if this type
    /// cannot represent it.
    fn of_sum(high: f64, low: f64, error: f64) -> Option<Self>;

    /// The sum.
    fn plus(&self, other: &Self) -> Self;

    /// The difference.
    fn minus(&self, other: &Self) -> Self;

    /// The product.
    fn times(&self, other: &Self) -> Self;

    /// The quotient, to the type's own precision: about 2⁻⁹⁸ for exact types.
    fn over(&self, other: &Self) -> Self;

    /// The square root of a nonnegative number, to the type's own precision as for [`Number::over`].
    fn sqrt(&self) -> Self;

    /// The sign; None if the error leaves it open.
    fn sign(&self) -> Option<Ordering>;

    /// The nearest f64 or, at a tie within the error, one of the two; None if the error is larger.
    fn rounded(&self) -> Option<f64>;

    /// Return whether it appears negative. This may be wrong if [`Number::sign`] is None.
    fn seems_negative(&self) -> bool;

    /// Its square.
    fn squared(&self) -> Self {
        self.times(self)
    }

    /// Its negative.
    fn negated(&self) -> Self {
        Self::of(0.0).minus(self)
    }
}

/// An f64 and a running error bound (Wilkinson's running error analysis, 1986).
///
/// Each operation adds its own rounding, at most [`UNIT`] of its result. The bound itself has a few roundings per
/// operation, each of a relative [`UNIT`]. Adding 2⁻⁴⁰ of the bound, when a sign is requested, covers thousands of
/// operations.
#[derive(Clone, Copy, Debug)]
pub struct Bounded {
    /// The approximate value.
    pub value: f64,
    /// Bound on its absolute error.
    pub error: f64,
}

/// Above this, products lose no digits to underflow.
const SAFE: f64 = f64::MIN_POSITIVE * (1u64 << 60) as f64 * (1u64 << 60) as f64;

/// The loss to underflow of the products in a [`Double`](super::Double) product and its bound: less than 16 halves of
/// the least f64, times four.
const UNDERFLOW: f64 = f64::from_bits(32);

/// The allowance for underflow in the bound of a product.
pub(super) fn underflow(product: f64) -> f64 {
    if product.abs() > SAFE { 0.0 } else { UNDERFLOW }
}

/// Allowance for the roundings of a bound.
pub(super) const SLACK: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;

impl Number for Bounded {
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self { value: x, error: 0.0 }
    }

    #[inline(always)]
    fn of_sum(high: f64, low: f64, error: f64) -> Option<Self> {
        Some(Self { value: high, error: low.abs() + error })
    }

    #[inline(always)]
    fn plus(&self, other: &Self) -> Self {
        let value = self.value + other.value;
        Self { value, error: self.error + other.error + UNIT * value.abs() }
    }

    #[inline(always)]
    fn minus(&self, other: &Self) -> Self {
        let value = self.value - other.value;
        Self { value, error: self.error + other.error + UNIT * value.abs() }
    }

    #[inline(always)]
    fn times(&self, other: &Self) -> Self {
        let value = self.value * other.value;
        let (own, others) = (self.value.abs() + self.error, other.value.abs() + other.error);
        // An exact zero factor makes the product exactly zero.
        let lost = if value.abs() > SAFE || own == 0.0 || others == 0.0 { 0.0 } else { UNDERFLOW };
        let carried = self.value.abs() * other.error + others * self.error;
        Self { value, error: carried + UNIT * value.abs() + lost }
    }

    #[inline(always)]
    fn over(&self, other: &Self) -> Self {
        let value = self.value / other.value;
        let least = other.value.abs() - other.error * SLACK;
        // |a/b − â/b̂| ≤ (|δa| + |â/b̂| |δb|) / |b|.
        let carried = if least > 0.0 { (self.error + value.abs() * other.error) / least } else { f64::INFINITY };
        Self { value, error: carried * SLACK + 2.0 * UNIT * value.abs() + underflow(value) }
    }

    #[inline(always)]
    fn sqrt(&self) -> Self {
        let value = self.value.max(0.0).sqrt();
        // |√x − √x̂| = |x − x̂| / (√x + √x̂).
        let carried = if self.error == 0.0 { 0.0 } else { (self.error / value).min(self.error.sqrt() * 2.0) };
        Self { value, error: carried + UNIT * value }
    }

    #[inline(always)]
    fn sign(&self) -> Option<Ordering> {
        if self.value.abs() > self.error * SLACK {
            self.value.partial_cmp(&0.0)
        } else {
            (self.value == 0.0 && self.error == 0.0).then_some(Ordering::Equal)
        }
    }

    #[inline(always)]
    fn rounded(&self) -> Option<f64> {
        (self.error * SLACK <= UNIT / 4.0 * self.value.abs()).then_some(self.value)
    }

    #[inline(always)]
    fn seems_negative(&self) -> bool {
        self.value < 0.0
    }
}

/// Three numbers: a point or a vector.
#[derive(Clone, Debug)]
pub struct Triple<N>(pub [N; 3]);

impl<N: Number> Triple<N> {
    /// Three numbers by the same rule. Written out, since closures over arrays are not always optimized away.
    #[inline(always)]
    fn by(mut rule: impl FnMut(usize) -> N) -> Self {
        let (x, y, z) = (rule(0), rule(1), rule(2));
        Self([x, y, z])
    }

    /// A finite vector, exactly.
    #[inline(always)]
    pub fn of(v: DVec3) -> Self {
        Self::by(|i| N::of(v[i]))
    }

    /// The vector from one point to another.
    #[inline(always)]
    pub fn between(a: DVec3, b: DVec3) -> Self {
        Self::of(b).minus(&Self::of(a))
    }

    /// The difference.
    #[inline(always)]
    pub fn minus(&self, other: &Self) -> Self {
        Self::by(|i| self.0[i].minus(&other.0[i]))
    }

    /// The sum.
    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        Self::by(|i| self.0[i].plus(&other.0[i]))
    }

    /// The product with a scalar.
    #[inline(always)]
    pub fn times(&self, by: &N) -> Self {
        Self::by(|i| self.0[i].times(by))
    }

    /// The dot product.
    #[inline(always)]
    pub fn dot(&self, other: &Self) -> N {
        let product = |i: usize| self.0[i].times(&other.0[i]);
        product(0).plus(&product(1)).plus(&product(2))
    }

    /// The cross product.
    #[inline(always)]
    pub fn cross(&self, other: &Self) -> Self {
        let (a, b) = (&self.0, &other.0);
        let minor = |j: usize, k: usize| a[j].times(&b[k]).minus(&a[k].times(&b[j]));
        Self([minor(1, 2), minor(2, 0), minor(0, 1)])
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Double, Dyadic};
    use super::*;
    use num_bigint::BigInt;
    use proptest::prelude::*;

    /// A polynomial with cancellation in six numbers.
    fn formula<N: Number>(x: [f64; 6]) -> N {
        let [a, b, c, d, e, f] = x.map(N::of);
        let (p, q) = (a.times(&b).minus(&c.times(&d)), a.plus(&e).times(&f.minus(&b)));
        p.squared().minus(&q.times(&c.plus(&d))).times(&e.minus(&a))
    }

    /// The same in integers: numbers are scaled by 2^1074, so the product of degree 5 by 2^(5 · 1074).
    fn integer(x: [f64; 6]) -> BigInt {
        let scaled = x.map(|x| {
            let bits = x.to_bits();
            let (m, e) = (bits & ((1 << 52) - 1), bits >> 52 & 0x7ff);
            let m = if e == 0 { BigInt::from(m) } else { BigInt::from(m | 1 << 52) << (e - 1) };
            if x < 0.0 { -m } else { m }
        });
        let one = BigInt::from(1) << 1074u32;
        let [a, b, c, d, e, f] = scaled;
        let (p, q) = (&a * &b - &c * &d, (&a + &e) * (&f - &b));
        (&p * &p - &q * (&c + &d) * one) * (&e - &a)
    }

    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            (-4i32..=4).prop_map(f64::from),
            -1.0..1.0f64,
            (0..3i32, -2i32..3).prop_map(|(i, j)| 1.0 + f64::from(i) * f64::EPSILON * f64::from(j)),
            prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
            (-500..500i32, -1.0..1.0f64).prop_map(|(e, m)| m * 2f64.powi(e)),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn signs_are_those_of_integers_or_not_told(x in prop::array::uniform6(number())) {
            let wanted = integer(x).cmp(&BigInt::ZERO);
            prop_assert_eq!(formula::<Dyadic>(x).sign(), Some(wanted));
            for told in [formula::<Bounded>(x).sign(), formula::<Double>(x).sign()] {
                prop_assert!(told.is_none_or(|told| told == wanted), "{told:?} {wanted:?}");
            }
        }

        #[test]
        fn values_are_within_their_error(x in prop::array::uniform6(-3.0..3.0f64)) {
            let exact = formula::<Dyadic>(x);
            let (rough, fine) = (formula::<Bounded>(x), formula::<Double>(x));
            let off = exact.minus(&Dyadic::of(rough.value)).rounded().unwrap();
            prop_assert!(off.abs() <= rough.error * SLACK);
            let off = exact.minus(&Dyadic::of(fine.high)).minus(&Dyadic::of(fine.low)).rounded().unwrap();
            prop_assert!(off.abs() <= fine.error * SLACK);
            prop_assert!(fine.error <= 1e-25);
        }

        #[test]
        fn quotients_and_roots_multiply_back(a in number(), b in number(), c in number()) {
            let b = if b == 0.0 { 1.0 } else { b };
            let (x, y) = (Dyadic::of(a).times(&Dyadic::of(c)), Dyadic::of(b));
            // To within 2^-90 of the dividend or radicand.
            let close = |back: &Dyadic, x: &Dyadic| {
                let off = back.minus(x);
                let limit = x.times(&Dyadic::of(2f64.powi(-90)));
                off.squared().minus(&limit.squared()).sign() != Some(Ordering::Greater)
            };
            prop_assert!(close(&x.over(&y).times(&y), &x));
            let square = x.squared();
            let root = x.squared().plus(&y.squared()).sqrt();
            prop_assert!(close(&root.squared(), &square.plus(&y.squared())));
            // Within the range of a Double's products.
            if [a, b, c].iter().all(|x| (1e-100..1e100).contains(&x.abs())) {
                let (x, y) = (Double::of(a).times(&Double::of(c)), Double::of(b));
                let (short, long) = (x.over(&y), Dyadic::of(a).times(&Dyadic::of(c)).over(&Dyadic::of(b)));
                let off = long.minus(&Dyadic::of(short.high)).minus(&Dyadic::of(short.low)).rounded().unwrap();
                prop_assert!(off.abs() <= short.error * SLACK + 1e-28 * short.high.abs());
                prop_assert_eq!(short.rounded().map(f64::to_bits), long.rounded().map(f64::to_bits));
            }
        }
    }

    #[test]
    fn the_ends_of_the_range_keep_their_sign() {
        let (least, most) = (Dyadic::of(f64::from_bits(1)), Dyadic::of(f64::MAX));
        assert_eq!(least.squared().rounded(), Some(f64::from_bits(1)));
        assert_eq!(most.squared().rounded(), Some(f64::INFINITY));
        assert_eq!(most.squared().over(&most).rounded(), Some(f64::MAX));
        assert_eq!(least.squared().squared().sqrt().sqrt().rounded(), Some(f64::from_bits(1)));
        assert_eq!(Double::of(f64::MAX).squared().sign(), None);
        assert_eq!(Bounded::of(f64::from_bits(1)).squared().sign(), None);
    }
}
