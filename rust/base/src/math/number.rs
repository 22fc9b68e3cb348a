//! Numbers that know how wrong they are: one formula, computed as roughly as its sign allows.
//!
//! A decision is a sign of a polynomial in the numbers that were given. It is asked of [`Bounded`] first, an f64 with a
//! bound on its error; where that leaves it open, of [`Double`](super::Double), twice as long; and last of
//! [`Dyadic`](super::Dyadic), which has no error at all.

use super::DVec3;
use super::robust::UNIT;
use std::cmp::Ordering;

/// A number with a bound on its error.
pub trait Number: Clone {
    /// A finite f64, as it is.
    fn of(x: f64) -> Self;

    /// A number within `error` of the sum of two f64, the second at most half an ulp of the first; none if this type
    /// cannot hold it.
    fn of_sum(high: f64, low: f64, error: f64) -> Option<Self>;

    /// The sum.
    fn plus(&self, other: &Self) -> Self;

    /// The difference.
    fn minus(&self, other: &Self) -> Self;

    /// The product.
    fn times(&self, other: &Self) -> Self;

    /// The quotient, to the type's own precision: to about 2⁻⁹⁸ where all else is exact.
    fn over(&self, other: &Self) -> Self;

    /// The square root of what is not negative, to the type's own precision as [`Number::over`].
    fn sqrt(&self) -> Self;

    /// How it compares with zero; none if the error leaves that open.
    fn sign(&self) -> Option<Ordering>;

    /// The f64 next to it or, at a tie within the error, one of the two; none if the error is larger than that.
    fn rounded(&self) -> Option<f64>;

    /// Whether it seems negative. It may be wrong where [`Number::sign`] is none.
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

/// An f64 and a bound on its distance from what it stands for, kept as it is computed (Wilkinson's running error
/// analysis, 1986).
///
/// Each operation adds its own rounding, at most [`UNIT`] of what came out. The bound is itself computed with
/// roundings, a few a step, each of a relative [`UNIT`]: 2⁻⁴⁰ of it, added when a sign is asked for, is room for
/// thousands of steps.
#[derive(Clone, Copy, Debug)]
pub struct Bounded {
    /// About the number.
    pub value: f64,
    /// At most so far from it.
    pub error: f64,
}

/// Where no product loses digits to underflow.
const SAFE: f64 = f64::MIN_POSITIVE * (1u64 << 60) as f64 * (1u64 << 60) as f64;

/// What the products in a [`Double`](super::Double) product, and its bound, lose to underflow: less than 16 halves of
/// the least f64, four times over.
const UNDERFLOW: f64 = f64::from_bits(32);

/// What is added to the bound of a product for underflow.
pub(super) fn underflow(product: f64) -> f64 {
    if product.abs() > SAFE { 0.0 } else { UNDERFLOW }
}

/// Room for the roundings of a bound.
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
        // Zero that is known as such makes a product that is known to be zero.
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
    /// Three by the same rule. Written out, since closures over arrays are not always compiled away.
    #[inline(always)]
    fn by(mut rule: impl FnMut(usize) -> N) -> Self {
        let (x, y, z) = (rule(0), rule(1), rule(2));
        Self([x, y, z])
    }

    /// A finite vector, as it is.
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

    /// All three times a number.
    #[inline(always)]
    pub fn times(&self, by: &N) -> Self {
        Self::by(|i| self.0[i].times(by))
    }

    /// The inner product.
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

    /// Sums and products of six numbers, with whatever cancels.
    fn formula<N: Number>(x: [f64; 6]) -> N {
        let [a, b, c, d, e, f] = x.map(N::of);
        let (p, q) = (a.times(&b).minus(&c.times(&d)), a.plus(&e).times(&f.minus(&b)));
        p.squared().minus(&q.times(&c.plus(&d))).times(&e.minus(&a))
    }

    /// The same in integers: every number times 2^1074, of a product of degree 5 times 2^(5 · 1074).
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
            // To 2^-90 of what is divided, or rooted.
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
