//! Owen-scrambled Sobol nets.

use super::BatchSize;
use super::permutation::permute;
use super::scramble::{scramble, scramble_short};
use super::stream::Stream;

/// A 64-bit number for a dimension.
///
/// At an even dimension it is stratified with the pair at the next dimension. Together they form a (0, m, 3)-net, so
/// the pairs for each half, quarter, ... of the choices are a net, too.
#[inline(always)]
pub(super) fn one(size: BatchSize, stream: Stream, index: u32, dimension: u32) -> u64 {
    one_at(size, stream, permute(size, index, stream.word(dimension | 1, 2)), dimension)
}

/// As [`one`], for a point given by index.
#[inline(always)]
pub(super) fn one_at(size: BatchSize, stream: Stream, index: u32, dimension: u32) -> u64 {
    // The third coordinate of the net is the index itself, most significant bit first (Niederreiter, 1992, lemma 4.22).
    let digits = if dimension.is_multiple_of(2) { index.reverse_bits().unbounded_shr(32 - size.bits()) } else { index };
    scramble(digits, [stream.word(dimension, 0), stream.word(dimension, 1)])
}

/// Two 32-bit numbers for a dimension: the first two coordinates of the Sobol sequence (1967), whose first 2ᵏ points
/// are a (0, k, 2)-net for every k.
#[inline(always)]
pub(super) fn two(size: BatchSize, stream: Stream, index: u32, dimension: u32) -> [u32; 2] {
    two_at(stream, permute(size, index, stream.word(dimension, 2)), dimension)
}

/// As [`two`], for a point given by index.
#[inline(always)]
pub(super) fn two_at(stream: Stream, index: u32, dimension: u32) -> [u32; 2] {
    [scramble_short(index, stream.word(dimension, 0)), scramble_short(pascal(index), stream.word(dimension, 1))]
}

/// The digits of the second coordinate, least significant bit first: Pascal's triangle modulo 2 times those of the
/// first, for indices below 2⁸.
#[inline(always)]
fn pascal(index: u32) -> u32 {
    let index = index ^ index >> 1 & 0x55;
    let index = index ^ index >> 2 & 0x33;
    index ^ index >> 4 & 0x0F
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Sampler, SamplerKind};

    #[test]
    fn pascals_triangle_by_its_recurrence() {
        let mut row = vec![1u32];
        let mut triangle = Vec::new();
        for _ in 0..8 {
            triangle.push(row.clone());
            let mut next = vec![1; row.len() + 1];
            for k in 1..row.len() {
                next[k] = row[k - 1] + row[k];
            }
            row = next;
        }
        for index in 0..256u32 {
            let digits: u32 =
                (0..8).map(|k| ((k..8).map(|j| triangle[j][k] * (index >> j & 1)).sum::<u32>() % 2) << k).sum();
            assert_eq!(pascal(index), digits);
        }
    }

    #[test]
    fn every_elementary_interval_holds_one_point() {
        for bits in 0..=BatchSize::MOST_BITS {
            let kind = SamplerKind::Sobol(BatchSize::new(1 << bits).unwrap());
            for (pixel, dimension) in [(0, 1), (1, 5), (2, 0), (3, 4), (4, 4_000_001)] {
                let points: Vec<Sampler> = (0..1 << bits).map(|i| kind.sampler(8, pixel, (3 << bits) + i)).collect();
                for across in 0..=bits {
                    for down in 0..=bits - across {
                        let mut seen = vec![0; 1 << bits];
                        for sampler in &points {
                            let [x, y] = sampler.clone().two(dimension);
                            // Only odd dimensions are preceded by a choice.
                            let z = if dimension % 2 == 1 { sampler.clone().one(dimension - 1) } else { 0.0 };
                            let deep = if dimension % 2 == 1 { bits - across - down } else { 0 };
                            let cell = |u: f64, bits: u32| (u * f64::from(1u32 << bits)) as usize;
                            let place = (cell(x, across) << down | cell(y, down)) << deep | cell(z, deep);
                            seen[place] += 1;
                        }
                        let cells = if dimension % 2 == 1 { 1 << bits } else { 1 << (across + down) };
                        assert!(seen[..cells].iter().all(|&n| n == (1 << bits) / cells), "{bits} {across} {down}");
                    }
                }
            }
        }
    }
}
