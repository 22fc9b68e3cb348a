//! Exact dyadic numbers.

use super::Double;
use super::number::Number;
use std::cmp::Ordering;

/// An integer of any length times a power of two of any size. Sums and products of f64 are exact, without overflow or
/// underflow.
///
/// It is needed only where shorter numbers leave a sign open, so it is kept simple: schoolbook products of 64-bit
/// words.
#[derive(Clone, Debug)]
pub struct Dyadic {
    negative: bool,
    /// The integer's words, least significant first; the last is not zero. Empty for zero.
    words: Vec<u64>,
    exponent: i64,
}

impl Dyadic {
    const ZERO: Self = Self { negative: false, words: Vec::new(), exponent: 0 };

    /// Remove zero words at both ends.
    fn trimmed(negative: bool, mut words: Vec<u64>, mut exponent: i64) -> Self {
        while words.last() == Some(&0) {
            words.pop();
        }
        let zeros = words.iter().take_while(|&&w| w == 0).count();
        words.drain(..zeros);
        exponent += 64 * zeros as i64;
        if words.is_empty() { Self::ZERO } else { Self { negative, words, exponent } }
    }

    /// The words of the integer times 2^shift.
    fn shifted(&self, shift: u64) -> Vec<u64> {
        let (words, bits) = ((shift / 64) as usize, shift % 64);
        let mut result = vec![0; words];
        let mut carry = 0;
        for &w in &self.words {
            result.push(if bits == 0 { w } else { w << bits | carry });
            carry = if bits == 0 { 0 } else { w >> (64 - bits) };
        }
        result.push(carry);
        result
    }

    /// The sum or the difference.
    fn sum(&self, other: &Self, subtract: bool) -> Self {
        let other_negative = other.negative != subtract;
        if other.words.is_empty() {
            return self.clone();
        }
        if self.words.is_empty() {
            return Self { negative: other_negative, ..other.clone() };
        }
        let exponent = self.exponent.min(other.exponent);
        let mut a = self.shifted((self.exponent - exponent) as u64);
        let mut b = other.shifted((other.exponent - exponent) as u64);
        let length = a.len().max(b.len()) + 1;
        a.resize(length, 0);
        b.resize(length, 0);
        if self.negative == other_negative {
            let mut carry = false;
            for (x, y) in a.iter_mut().zip(&b) {
                let (sum, c0) = x.overflowing_add(*y);
                let (sum, c1) = sum.overflowing_add(u64::from(carry));
                (*x, carry) = (sum, c0 | c1);
            }
            return Self::trimmed(self.negative, a, exponent);
        }
        let less = a.iter().rev().lt(b.iter().rev());
        let (mut large, small) = if less { (b, a) } else { (a, b) };
        let mut borrow = false;
        for (x, y) in large.iter_mut().zip(&small) {
            let (difference, b0) = x.overflowing_sub(*y);
            let (difference, b1) = difference.overflowing_sub(u64::from(borrow));
            (*x, borrow) = (difference, b0 | b1);
        }
        Self::trimmed(if less { other_negative } else { self.negative }, large, exponent)
    }

    /// Its leading 106 bits or more as a magnitude in [1/2, 1], and a power of two; not for zero.
    fn leading(&self) -> (Double, i64) {
        let top = self.words.len() - 1;
        let zeros = self.words[top].leading_zeros();
        let word = |i: usize| {
            let of = |i: usize| top.checked_sub(i).map_or(0, |i| self.words[i]);
            of(i) << zeros | if zeros > 0 { of(i + 1) >> (64 - zeros) } else { 0 }
        };
        let part = |bits: u64, below: i32| Double::of(bits as f64 * 2f64.powi(below));
        // Halves of words are exact in f64.
        let sum = (0..2)
            .flat_map(|i| [(word(i) >> 32, 2 * i), (word(i) & 0xffff_ffff, 2 * i + 1)])
            .fold(Double::of(0.0), |sum, (half, place)| sum.plus(&part(half, -32 * (place as i32 + 1))));
        let sum = Double { error: 0.0, ..sum };
        (sum, self.exponent + 64 * (top as i64 + 1) - i64::from(zeros))
    }

    fn from_leading(x: &Double, exponent: i64, negative: bool) -> Self {
        let mut result = Self::of(x.high).plus(&Self::of(x.low));
        result.negative ^= negative && !result.words.is_empty();
        result.exponent += exponent;
        result
    }
}

impl Number for Dyadic {
    fn of(x: f64) -> Self {
        let bits = x.to_bits();
        let fraction = bits & ((1 << 52) - 1);
        let biased = ((bits >> 52) & 0x7ff) as i64;
        let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
        if mantissa == 0 {
            return Self::ZERO;
        }
        // Exponents that are multiples of 64 avoid most shifts in sums.
        let exact = Self { negative: x < 0.0, words: vec![mantissa], exponent };
        let down = exponent.rem_euclid(64);
        Self::trimmed(x < 0.0, exact.shifted(down as u64), exponent - down)
    }

    fn of_sum(high: f64, low: f64, error: f64) -> Option<Self> {
        let known = error == 0.0 && high.is_finite() && low.is_finite();
        known.then(|| Self::of(high).plus(&Self::of(low)))
    }

    fn plus(&self, other: &Self) -> Self {
        self.sum(other, false)
    }

    fn minus(&self, other: &Self) -> Self {
        self.sum(other, true)
    }

    fn times(&self, other: &Self) -> Self {
        let mut words = vec![0u64; self.words.len() + other.words.len()];
        for (i, &x) in self.words.iter().enumerate() {
            let mut carry = 0u64;
            for (j, &y) in other.words.iter().enumerate() {
                let sum = u128::from(x) * u128::from(y) + u128::from(words[i + j]) + u128::from(carry);
                (words[i + j], carry) = (sum as u64, (sum >> 64) as u64);
            }
            words[i + other.words.len()] = carry;
        }
        Self::trimmed(self.negative != other.negative, words, self.exponent + other.exponent)
    }

    fn over(&self, other: &Self) -> Self {
        if self.words.is_empty() || other.words.is_empty() {
            return Self::ZERO;
        }
        let ((a, i), (b, j)) = (self.leading(), other.leading());
        Self::from_leading(&a.over(&b), i - j, self.negative != other.negative)
    }

    fn sqrt(&self) -> Self {
        if self.words.is_empty() || self.negative {
            return Self::ZERO;
        }
        let (x, exponent) = self.leading();
        let odd = exponent.rem_euclid(2);
        let x = if odd == 1 { x.plus(&x) } else { x };
        Self::from_leading(&Double { error: 0.0, ..x }.sqrt(), (exponent - odd) / 2, false)
    }

    fn sign(&self) -> Option<Ordering> {
        Some(match (self.words.is_empty(), self.negative) {
            (true, _) => Ordering::Equal,
            (_, true) => Ordering::Less,
            _ => Ordering::Greater,
        })
    }

    /// Always known; infinite or zero if out of the range of f64.
    fn rounded(&self) -> Option<f64> {
        if self.words.is_empty() {
            return Some(0.0);
        }
        let (x, exponent) = self.leading();
        // Three factors: a single power of two may overflow where the product does not.
        let exponent = exponent.clamp(-3000, 3000) as i32;
        let part = exponent / 3;
        let mut magnitude = x.high * 2f64.powi(part) * 2f64.powi(exponent - 2 * part) * 2f64.powi(part);
        // Not zero, to preserve the sign.
        magnitude = magnitude.max(f64::from_bits(1));
        Some(if self.negative { -magnitude } else { magnitude })
    }

    fn seems_negative(&self) -> bool {
        self.negative
    }
}
