//! Exact predicates for lines and edges.
//!
//! Every decision of a ray tracer about a triangle depends on one number: the volume spanned by the ray's direction and
//! the two ends of an edge relative to the ray's origin, `d · ((v − o) × (w − o))`. It is a sum of eighteen products of
//! three coordinates. A product of three f64 is an integer of 159 bits times a power of two, so the sum fits a
//! fixed-point number of at most 6,400 bits. Usually a few words suffice, since only the span between the smallest and
//! the largest term is used (Kulisch's long accumulator, 1971). That is simpler than expansions (Shewchuk 1997) and
//! cannot underflow or overflow. It is needed only for rays that pass an edge within rounding. `cargo bench --bench
//! exact` measures its cost.

use glam::DVec3;

/// The three edge volumes of a triangle and a ray, `d · (b × c)`, `d · (c × a)`, `d · (a × b)` with corners relative to
/// the origin. They are correctly rounded except for ties, and scaled by a common power of two so that the largest lies
/// in [1/2, 1]. A value is zero only if it is exactly zero, and its sign is always correct.
///
/// All coordinates must be finite.
#[cold]
#[inline(never)]
pub fn exact_edges(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let volumes = [(b, c), (c, a), (a, b)].map(|(v, w)| Volume::new(origin, direction, v, w));
    let top = volumes.iter().filter(|v| v.mantissa != 0.0).map(|v| v.exponent).max().unwrap_or(0);
    volumes.map(|v| v.scaled(top))
}

/// The sign of the first coordinate of `d × (w − v)` that is not exactly zero, or zero if all are: −1, 0 or 1.
///
/// It decides on which side of the edge from `v` to `w` a line along `d` passes that touches it, under symbolic
/// perturbation: the line is moved by an infinitesimal amount along x, by a still smaller one along y, and again along
/// z.
///
/// All coordinates must be finite.
#[cold]
#[inline(never)]
pub fn exact_turn(direction: DVec3, v: DVec3, w: DVec3) -> i32 {
    let [d, v, w] = [direction, v, w].map(|x| x.to_array().map(Float::new));
    for (j, k) in [(1, 2), (2, 0), (0, 1)] {
        let mut terms = Terms::new();
        for (x, y, negative) in [(d[j], w[k], false), (d[j], v[k], true), (d[k], w[j], true), (d[k], v[j], false)] {
            terms.push([x, y, Float::ONE], negative);
        }
        let (mantissa, _) = terms.sum();
        if mantissa != 0.0 {
            return if mantissa > 0.0 { 1 } else { -1 };
        }
    }
    0
}

/// A number of some 128 bits, `(high + low) · 2^exponent` with |high| in [1/2, 1]; or zero.
#[derive(Clone, Copy, Debug, Default)]
pub struct Long {
    high: f64,
    low: f64,
    /// The exponent of both parts.
    pub exponent: i32,
}

impl Long {
    /// The mantissa as an f64 and a remainder.
    pub fn parts(&self) -> (f64, f64) {
        (self.high, self.low)
    }
}

/// The numerator and denominator of `t` where a line intersects a triangle's plane: `n · (a − o)` and `n · d` with `n =
/// (b − a) × (c − a)`. They are zero only if exactly so.
///
/// All coordinates must be finite.
#[cold]
#[inline(never)]
pub fn exact_depth(origin: DVec3, direction: DVec3, corners: [DVec3; 3]) -> [Long; 2] {
    let [o, d, a, b, c] = [origin, direction, corners[0], corners[1], corners[2]].map(|x| x.to_array().map(Float::new));
    let (mut over, mut under) = (Terms::new(), Terms::new());
    // In the determinant of three differences, terms with the origin twice vanish: four of eight remain.
    for (x, y, z) in [(a, b, c), (b, a, o), (c, b, o), (a, c, o)] {
        over.push_product(x, y, z);
    }
    for (y, z) in [(b, c), (c, a), (a, b)] {
        under.push_product(d, y, z);
    }
    [over.long_sum(), under.long_sum()]
}

/// Products of three numbers, to be summed exactly.
struct Terms {
    factors: [([Float; 3], bool); 24],
    count: usize,
}

impl Terms {
    fn new() -> Self {
        Self { factors: [([Float::ZERO; 3], false); 24], count: 0 }
    }

    fn push(&mut self, factors: [Float; 3], negative: bool) {
        if factors.iter().all(|f| f.mantissa != 0) {
            self.factors[self.count] = (factors, negative);
            self.count += 1;
        }
    }

    /// `x · (y × z)`.
    fn push_product(&mut self, x: [Float; 3], y: [Float; 3], z: [Float; 3]) {
        for (i, &along) in x.iter().enumerate() {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            self.push([along, y[j], z[k]], false);
            self.push([along, y[k], z[j]], true);
        }
    }

    /// The sum as a mantissa, zero or in [1/2, 1] in magnitude, and an exponent.
    fn sum(&self) -> (f64, i32) {
        let Some((sum, low)) = self.accumulated() else { return (0.0, 0) };
        let (mantissa, exponent) = sum.value();
        (mantissa, exponent + low)
    }

    /// The same to some 128 bits.
    fn long_sum(&self) -> Long {
        let Some((sum, low)) = self.accumulated() else { return Long::default() };
        let long = sum.long_value();
        Long { exponent: long.exponent + low, ..long }
    }

    /// The sum over a power of two; None without terms.
    fn accumulated(&self) -> Option<(Accumulator, i32)> {
        let terms = &self.factors[..self.count];
        let exponent = |f: &[Float; 3]| f[0].exponent + f[1].exponent + f[2].exponent;
        let low = terms.iter().map(|(f, _)| exponent(f)).min()?;
        let high = terms.iter().map(|(f, _)| exponent(f)).max().unwrap_or(low);
        let mut sum = Accumulator::new((high - low) as u32);
        for (f, negative) in terms {
            let negative = f.iter().fold(*negative, |n, f| n ^ f.negative);
            sum.add(f.map(|f| f.mantissa), (exponent(f) - low) as u32, negative);
        }
        Some((sum, low))
    }
}

/// A number `mantissa · 2^exponent` with |mantissa| in [1/2, 1], or zero.
struct Volume {
    mantissa: f64,
    exponent: i32,
}

impl Volume {
    fn new(o: DVec3, d: DVec3, v: DVec3, w: DVec3) -> Self {
        let [o, d, v, w] = [o, d, v, w].map(|x| x.to_array().map(Float::new));
        // (v − o) × (w − o) = v × w + w × o + o × v.
        let mut terms = Terms::new();
        for (x, y) in [(v, w), (w, o), (o, v)] {
            terms.push_product(d, x, y);
        }
        let (mantissa, exponent) = terms.sum();
        Self { mantissa, exponent }
    }

    /// The value over 2^top, prevented from underflowing to zero.
    fn scaled(&self, top: i32) -> f64 {
        if self.mantissa == 0.0 {
            return 0.0;
        }
        let shift = self.exponent - top;
        if shift > -1000 { self.mantissa * 2f64.powi(shift) } else { f64::MIN_POSITIVE.copysign(self.mantissa) }
    }
}

/// A finite f64 as `± mantissa · 2^exponent` with an integer mantissa below 2^53.
#[derive(Clone, Copy)]
struct Float {
    mantissa: u64,
    exponent: i32,
    negative: bool,
}

impl Float {
    const ZERO: Self = Self { mantissa: 0, exponent: 0, negative: false };
    const ONE: Self = Self { mantissa: 1, exponent: 0, negative: false };

    fn new(x: f64) -> Self {
        let bits = x.to_bits();
        let fraction = bits & ((1 << 52) - 1);
        let biased = ((bits >> 52) & 0x7ff) as i32;
        let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
        if mantissa == 0 {
            return Self::ZERO;
        }
        // Removing trailing zeros shortens the span of the terms for round numbers, the usual case of exact ties.
        let zeros = mantissa.trailing_zeros();
        Self { mantissa: mantissa >> zeros, exponent: exponent + zeros as i32, negative: bits >> 63 == 1 }
    }
}

/// A two's-complement integer of as many 64-bit words as the terms span.
struct Accumulator {
    words: [u64; Self::WORDS],
    used: usize,
}

impl Accumulator {
    /// Three exponents span at most 3 · (1023 + 1074) bits, a product has 159 bits, and 24 terms carry into 5 more.
    const WORDS: usize = (3 * 2097 + 159 + 5 + 1) / 64 + 2;

    /// An accumulator for terms whose exponents differ by up to `span`.
    fn new(span: u32) -> Self {
        Self { words: [0; Self::WORDS], used: (span as usize + 159 + 5 + 1) / 64 + 1 }
    }

    /// Add or subtract `m₀ · m₁ · m₂ · 2^shift`.
    fn add(&mut self, m: [u64; 3], shift: u32, negative: bool) {
        let two = u128::from(m[0]) * u128::from(m[1]);
        let low = u128::from(two as u64) * u128::from(m[2]);
        let high = (two >> 64) * u128::from(m[2]) + (low >> 64);
        let product = [low as u64, high as u64, (high >> 64) as u64];
        let (word, bit) = ((shift / 64) as usize, shift % 64);
        let shifted = |i: usize| {
            let here = if i < 3 { product[i] << bit } else { 0 };
            let below = if i > 0 && bit > 0 { product[i - 1] >> (64 - bit) } else { 0 };
            here | below
        };
        let mut carry = false;
        for i in word..self.used {
            let term = if i - word < 4 { shifted(i - word) } else { 0 };
            if term == 0 && !carry && i - word >= 4 {
                break;
            }
            (self.words[i], carry) = if negative {
                let (x, c0) = self.words[i].overflowing_sub(term);
                let (x, c1) = x.overflowing_sub(u64::from(carry));
                (x, c0 | c1)
            } else {
                let (x, c0) = self.words[i].overflowing_add(term);
                let (x, c1) = x.overflowing_add(u64::from(carry));
                (x, c0 | c1)
            };
        }
    }

    /// The sum as a mantissa in [1/2, 1] and an exponent.
    fn value(self) -> (f64, i32) {
        let Some((negative, bits, exponent)) = self.leading() else { return (0.0, 0) };
        // A sticky bit for all lower bits: without it, rounding could err in case of an exact tie.
        let bits = (bits >> 64) as u64 | u64::from(bits as u64 != 0);
        let mantissa = bits as f64 / 2f64.powi(64);
        (if negative { -mantissa } else { mantissa }, exponent)
    }

    /// The sum to some 128 bits.
    fn long_value(self) -> Long {
        let Some((negative, bits, exponent)) = self.leading() else { return Long::default() };
        let high = (bits >> 75) as f64 / 2f64.powi(53);
        let low = (bits & ((1 << 75) - 1)) as f64 / 2f64.powi(128);
        if negative { Long { high: -high, low: -low, exponent } } else { Long { high, low, exponent } }
    }

    /// The sign, the first 128 bits with a sticky last bit, and the exponent of the bit above them; None if the sum is
    /// zero.
    fn leading(mut self) -> Option<(bool, u128, i32)> {
        let words = &mut self.words[..self.used];
        let negative = words[words.len() - 1] >> 63 == 1;
        if negative {
            let mut carry = true;
            for w in words.iter_mut() {
                (*w, carry) = (!*w).overflowing_add(u64::from(carry));
            }
        }
        let top = words.iter().rposition(|&w| w != 0)?;
        let zeros = words[top].leading_zeros();
        let word = |below: usize| if below > top { 0 } else { words[top - below] };
        let next = if zeros > 0 { word(2) >> (64 - zeros) } else { 0 };
        let bits = (u128::from(word(0)) << 64 | u128::from(word(1))) << zeros | u128::from(next);
        let is_cut = words[..top.saturating_sub(1)].iter().any(|&w| w != 0);
        Some((negative, bits | u128::from(is_cut), 64 * (top as i32 + 1) - zeros as i32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use proptest::prelude::*;

    /// `x · 2^1074` as an integer.
    fn integer(x: f64) -> BigInt {
        let f = Float::new(x);
        let m = BigInt::from(f.mantissa) << (f.exponent + 1074) as u32;
        if f.negative { -m } else { m }
    }

    /// The edge volume times 2^(3 · 1074), in integer arithmetic.
    fn oracle(o: DVec3, d: DVec3, v: DVec3, w: DVec3) -> BigInt {
        let [o, d, v, w] = [o, d, v, w].map(|x| x.to_array().map(integer));
        let v: Vec<_> = (0..3).map(|i| &v[i] - &o[i]).collect();
        let w: Vec<_> = (0..3).map(|i| &w[i] - &o[i]).collect();
        (0..3).map(|i| &d[i] * (&v[(i + 1) % 3] * &w[(i + 2) % 3] - &v[(i + 2) % 3] * &w[(i + 1) % 3])).sum()
    }

    fn check(o: DVec3, d: DVec3, corners: [DVec3; 3]) -> Result<(), TestCaseError> {
        let [a, b, c] = corners;
        let found = exact_edges(o, d, corners);
        let wanted = [(b, c), (c, a), (a, b)].map(|(v, w)| oracle(o, d, v, w));
        let largest = wanted.iter().map(BigInt::bits).max().unwrap_or(0);
        for (f, w) in found.iter().zip(&wanted) {
            prop_assert_eq!(f.partial_cmp(&0.0).map(|x| x as i32), Some(w.cmp(&BigInt::ZERO) as i32));
            if w.bits() + 900 > largest && w.bits() > 0 {
                // |f| · 2^largest compared with |w|, to within one rounding.
                let scaled = integer(f.abs()) << largest as usize;
                let exact = (w.magnitude().clone() << 1074usize).into();
                let difference: BigInt = &scaled - &exact;
                prop_assert!(difference.magnitude() << 52usize <= *BigInt::magnitude(&exact));
            }
        }
        Ok(())
    }

    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![
            (-4i32..=4).prop_map(f64::from),
            any::<f32>().prop_filter("finite", |x| x.is_finite()).prop_map(f64::from),
            -1.0..1.0f64,
            prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
        ]
    }

    fn point() -> impl Strategy<Value = DVec3> {
        [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]
        #[test]
        fn signs_and_values_are_those_of_big_integers(
            o in point(), d in point(), a in point(), b in point(), c in point(),
        ) {
            check(o, d, [a, b, c])?;
        }

        #[test]
        fn aimed_rays_give_exact_zeros(
            a in prop::array::uniform3(-8i32..8), b in prop::array::uniform3(-8i32..8),
            o in prop::array::uniform3(-8i32..8), k in 0i32..=16,
        ) {
            let [a, b, o] = [a, b, o].map(|p| DVec3::from_array(p.map(f64::from)));
            // A target exactly on the edge from a to b: sixteenths of small integers.
            let target = a + (b - a) * (f64::from(k) / 16.0);
            let e = exact_edges(o, target - o, [a, b, DVec3::new(3.0, 5.0, -7.0)]);
            prop_assert_eq!(e[2], 0.0);
        }
    }

    #[test]
    fn the_ends_of_the_range_neither_overflow_nor_vanish() {
        let (big, tiny) = (f64::MAX, f64::from_bits(1));
        let e = exact_edges(
            DVec3::new(-big, tiny, big),
            DVec3::new(tiny, big, -tiny),
            [DVec3::new(big, -big, tiny), DVec3::new(tiny, tiny, -big), DVec3::splat(big)],
        );
        assert!(e.iter().all(|x| x.is_finite() && *x != 0.0));
        let all = DVec3::splat(tiny);
        assert_eq!(exact_edges(all, all, [all; 3]), [0.0; 3]);
    }
}
