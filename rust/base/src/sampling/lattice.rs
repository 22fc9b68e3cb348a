//! Randomly shifted rank-1 lattices.

use super::BatchSize;
use super::permutation::permute;
use super::stream::Stream;

/// Generators (1, a, b) of the lattices of 1, 2, 4, ... points. They minimize P₂ summed over the pair (1, a) and the
/// triple (Sloan and Joe, "Lattice Methods for Multiple Integration", 1994), by exhaustive search.
const GENERATORS: [[u32; 2]; BatchSize::MOST_BITS as usize + 1] =
    [[1, 1], [1, 1], [1, 1], [3, 1], [7, 3], [5, 15], [19, 29]];

/// A 64-bit number for a dimension. At an even dimension it is the third coordinate of the pair at the next dimension.
#[inline(always)]
pub(super) fn one(size: BatchSize, stream: Stream, index: u32, dimension: u32) -> u64 {
    one_at(size, stream, permute(size, index, stream.word(dimension | 1, 2)), dimension)
}

/// As [`one`], for a point given by index.
#[inline(always)]
pub(super) fn one_at(size: BatchSize, stream: Stream, index: u32, dimension: u32) -> u64 {
    let factor = if dimension.is_multiple_of(2) { GENERATORS[size.bits() as usize][1] } else { 1 };
    u64::from(index * factor).unbounded_shl(64 - size.bits()).wrapping_add(stream.word(dimension, 0))
}

/// Two 32-bit numbers for a dimension: a lattice point, shifted modulo 1 (Cranley and Patterson, "Randomization of
/// Number Theoretic Methods for Multiple Integration", 1976).
#[inline(always)]
pub(super) fn two(size: BatchSize, stream: Stream, index: u32, dimension: u32) -> [u32; 2] {
    two_at(size, stream, permute(size, index, stream.word(dimension, 2)), dimension)
}

/// As [`two`], for a point given by index.
#[inline(always)]
pub(super) fn two_at(size: BatchSize, stream: Stream, index: u32, dimension: u32) -> [u32; 2] {
    let shift = stream.word(dimension, 0);
    let at = |factor: u32| (index * factor).unbounded_shl(32 - size.bits());
    [at(1).wrapping_add(shift as u32), at(GENERATORS[size.bits() as usize][0]).wrapping_add((shift >> 32) as u32)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::SamplerKind;
    use std::f64::consts::PI;

    /// P₂ of a lattice: the sum over its dual has a closed form with the Bernoulli polynomial of degree 2.
    fn p2(count: u32, generator: &[u32]) -> f64 {
        let term = |i: u32| {
            generator.iter().fold(1.0, |product, g| {
                let x = f64::from(i * g % count) / f64::from(count);
                product * (1.0 + 2.0 * PI * PI * (x * x - x + 1.0 / 6.0))
            })
        };
        (0..count).map(term).sum::<f64>() / f64::from(count) - 1.0
    }

    #[test]
    fn generators_are_the_best_there_are() {
        for bits in 0..=BatchSize::MOST_BITS {
            let count = 1 << bits;
            let merit = |a: u32, b: u32| p2(count, &[1, a]) + p2(count, &[1, a, b]);
            let [a, b] = GENERATORS[bits as usize];
            let odd = || (1..count.max(2)).step_by(2);
            let least = odd().flat_map(|a| odd().map(move |b| (a, b))).map(|(a, b)| merit(a, b));
            assert!(merit(a, b) <= least.fold(f64::INFINITY, f64::min) + 1e-9);
        }
    }

    #[test]
    fn points_of_a_batch_are_a_shifted_lattice() {
        for bits in 0..=BatchSize::MOST_BITS {
            let (count, kind) = (1u64 << bits, SamplerKind::Lattice(BatchSize::new(1 << bits).unwrap()));
            let mut found: Vec<[u64; 3]> = (0..1 << bits)
                .map(|i| {
                    let mut sampler = kind.sampler(4, 2, i);
                    let [x, y] = sampler.two(7).map(|u| (u * 2f64.powi(32)) as u64);
                    [x, y, (sampler.one(6) * 2f64.powi(53)) as u64]
                })
                .collect();
            // Relative to the point of least x, all points are multiples of the generator.
            found.sort_unstable();
            let origin = found[0];
            let [a, b] = GENERATORS[bits as usize].map(u64::from);
            for (i, point) in (0u64..).zip(&found) {
                let step = |digits: u32, k: u64| (k % count) << (digits - bits);
                assert_eq!(point[0], origin[0] + step(32, i));
                assert_eq!(point[1], (origin[1] + step(32, a * i)) % (1 << 32));
                assert_eq!(point[2], (origin[2] + step(53, b * i)) % (1 << 53));
            }
        }
    }
}
