//! Geometry in integers, exact for the given numbers.

use num_bigint::{BigInt, Sign};
use raywright::math::DVec3;

/// Scale that makes every coordinate an integer, as a power of two.
pub const SHIFT: usize = 1074;

/// A point times 2¹⁰⁷⁴.
pub type Exact = [BigInt; 3];

/// A finite number times 2¹⁰⁷⁴.
pub fn integer(x: f64) -> BigInt {
    let bits = x.abs().to_bits();
    let (fraction, biased) = (bits & ((1 << 52) - 1), bits >> 52);
    let magnitude = match biased {
        0 => BigInt::from(fraction),
        _ => BigInt::from(fraction | 1 << 52) << (biased - 1),
    };
    if x < 0.0 { -magnitude } else { magnitude }
}

/// A point.
pub fn exact(p: DVec3) -> Exact {
    p.to_array().map(integer)
}

/// `p − q`.
pub fn minus(p: &Exact, q: &Exact) -> Exact {
    std::array::from_fn(|i| &p[i] - &q[i])
}

/// `p · q`.
pub fn dot(p: &Exact, q: &Exact) -> BigInt {
    (0..3).map(|i| &p[i] * &q[i]).sum()
}

/// `p × q`.
pub fn cross(p: &Exact, q: &Exact) -> Exact {
    [(1, 2), (2, 0), (0, 1)].map(|(j, k)| &p[j] * &q[k] - &p[k] * &q[j])
}

/// The sign: −1, 0 or 1.
pub fn sign(x: &BigInt) -> i32 {
    match x.sign() {
        Sign::Minus => -1,
        Sign::NoSign => 0,
        Sign::Plus => 1,
    }
}

/// The weights of three corners, relative to the ray's origin, for a direction.
pub fn weights(direction: &Exact, [a, b, c]: &[Exact; 3]) -> [BigInt; 3] {
    [(b, c), (c, a), (a, b)].map(|(v, w)| dot(direction, &cross(v, w)))
}

/// True if the line meets the triangle with these weights: not from the side, and not if it has no area.
pub fn is_met(weights: &[BigInt; 3]) -> bool {
    let has = |s| weights.iter().any(|w| sign(w) == s);
    has(1) != has(-1)
}
