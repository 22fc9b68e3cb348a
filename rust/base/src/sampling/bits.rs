//! Conversion of random bits to numbers.

/// 53 of 64 bits as a number in [0, 1).
#[inline(always)]
pub(super) fn number(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// 32 bits as the midpoint of one of 2³² equal steps in (0, 1).
#[inline(always)]
pub(super) fn step(word: u32) -> f64 {
    (f64::from(word) + 0.5) * (1.0 / (1u64 << 32) as f64)
}
