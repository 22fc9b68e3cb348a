//! Halton points: radical inverses in prime bases.

use super::BatchSize;
use super::permutation::permute;
use super::stream::Stream;

/// The bases of pairs of dimensions. Higher bases would be no better than random numbers: with more than 64 strata, a
/// batch has one point in some and none in others. So further dimensions reuse these, with the samples in another
/// order.
const BASES: [[u32; 2]; 8] = [[2, 3], [5, 7], [11, 13], [17, 19], [23, 29], [31, 37], [41, 43], [47, 53]];

/// A 64-bit number for a dimension: the first coordinate of its pair.
#[inline(always)]
pub(super) fn one(size: BatchSize, stream: Stream, index: u32, dimension: u32) -> u64 {
    coordinate(size, stream, index, dimension, 0)
}

/// Two 32-bit numbers for a dimension (Halton, "On the Efficiency of Certain Quasi-Random Sequences of Points in
/// Evaluating Multi-Dimensional Integrals", 1960), with Owen scrambling of its digits (1995).
#[inline(always)]
pub(super) fn two(size: BatchSize, stream: Stream, index: u32, dimension: u32) -> [u32; 2] {
    [0, 1].map(|axis| (coordinate(size, stream, index, dimension, axis) >> 32) as u32)
}

fn coordinate(size: BatchSize, stream: Stream, index: u32, dimension: u32, axis: u32) -> u64 {
    let each = BASES.len() as u32;
    // The dimensions that share an order take their random word from the first of them.
    let index = permute(size, index, stream.word(dimension / each * each, 3));
    let base = BASES[(dimension % each) as usize][axis as usize];
    let scrambled = |place: u32, before: u32, digit: u32| {
        // Each digit's permutation depends on the digits before it: a·d + b modulo the base. It takes any two digits to
        // any two with equal probability, as a random permutation does.
        let random = stream.word_of(1 << 8 | place << 6 | before, dimension, axis);
        let factor = 1 + (((random & 0xFFFF_FFFF) * u64::from(base - 1)) >> 32) as u32;
        let shift = (((random >> 32) * u64::from(base)) >> 32) as u32;
        (digit * factor + shift) % base
    };
    let rest = stream.word_of(index, dimension, axis);
    inverse(base, size.samples(), index, rest, scrambled)
}

/// The first 64 binary digits of the radical inverse of an index below `count`. A function of its position, the
/// preceding digits and itself changes each digit. `rest` supplies the digits beyond those of `count`.
fn inverse(base: u32, count: u32, mut index: u32, rest: u64, changed: impl Fn(u32, u32, u32) -> u32) -> u64 {
    let (mut before, mut unit, mut digits, mut place) = (0, 1, 0, 0);
    while unit < count {
        let digit = index % base;
        digits = digits * base + changed(place, before, digit);
        before += digit * unit;
        (index, unit, place) = (index / base, unit * base, place + 1);
    }
    ((u128::from(digits) << 64 | u128::from(rest)) / u128::from(unit)) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::SamplerKind;
    use num_bigint::BigUint;

    #[test]
    fn inverses_are_those_of_exact_fractions() {
        for &base in BASES.as_flattened() {
            for index in 0..64u32 {
                // The sum of dₖ / bᵏ⁺¹ over the digits, as one fraction.
                let (mut above, mut below, mut left) = (BigUint::ZERO, BigUint::from(1u32), index);
                while left > 0 {
                    above = above * base + left % base;
                    below *= base;
                    left /= base;
                }
                let expected = (above << 64) / below;
                assert_eq!(BigUint::from(inverse(base, 64, index, 0, |_, _, digit| digit)), expected);
            }
        }
    }

    #[test]
    fn boxes_of_both_bases_hold_one_point_each() {
        // For the first 2ᵃ·3ᵇ points of the first dimension, and 5, 7, 35 of the second. With batches of 64, samples
        // are permuted, so the first points are found by inverting that order.
        let size = BatchSize::new(64).unwrap();
        for pixel in 0..20 {
            let stream = Stream::new(Stream::words([3, 0], pixel, 0));
            let mut points = vec![[[0u32; 2]; 2]; 64];
            for index in 0..64 {
                let place = permute(size, index, stream.word(0, 3)) as usize;
                points[place] = [0, 1].map(|dimension| two(size, stream, index, dimension));
            }
            for (dimension, boxes) in
                [(0, [4, 9]), (0, [2, 27]), (0, [32, 1]), (0, [16, 3]), (1, [5, 1]), (1, [1, 49]), (1, [5, 7])]
            {
                let count = (boxes[0] * boxes[1]) as usize;
                let mut seen = vec![0; count];
                for point in &points[..count] {
                    let cell = |axis: usize| ((u64::from(point[dimension][axis]) * boxes[axis]) >> 32) as usize;
                    seen[cell(0) * boxes[1] as usize + cell(1)] += 1;
                }
                assert!(seen.iter().all(|&n| n == 1), "{boxes:?}");
            }
        }
        assert_eq!(SamplerKind::Halton(size).sampler(3, 7, 5).two(0), {
            let stream = Stream::new(Stream::words([3, 0], 7, 0));
            two(size, stream, 5, 0).map(|word| (f64::from(word) + 0.5) * 2f64.powi(-32))
        });
    }
}
