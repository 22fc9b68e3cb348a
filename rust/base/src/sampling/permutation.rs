//! Random permutations of the samples of a batch.

use super::BatchSize;

/// A finite field of 2ᵐ elements: the powers of its generator, repeated once, and their logarithms.
struct Field {
    powers: [u8; 2 * Field::MOST],
    logarithms: [u8; Field::MOST],
}

impl Field {
    const MOST: usize = 1 << BatchSize::MOST_BITS;

    /// Primitive polynomials over GF(2) of degree 0, 1, ...; bit k is the coefficient of xᵏ.
    const POLYNOMIALS: [usize; BatchSize::MOST_BITS as usize + 1] =
        [0b1, 0b11, 0b111, 0b1011, 0b1_0011, 0b10_0101, 0b100_0011];

    const ALL: [Self; Self::POLYNOMIALS.len()] = {
        let mut all =
            [const { Self { powers: [0; 2 * Self::MOST], logarithms: [0; Self::MOST] } }; Self::POLYNOMIALS.len()];
        let mut bits = 1;
        while bits < all.len() {
            let (order, mut exponent, mut power) = ((1 << bits) - 1, 0, 1);
            while exponent < 2 * order {
                all[bits].powers[exponent] = power as u8;
                all[bits].logarithms[power] = (exponent % order) as u8;
                power <<= 1;
                if power >> bits & 1 == 1 {
                    power ^= Self::POLYNOMIALS[bits];
                }
                exponent += 1;
            }
            bits += 1;
        }
        all
    };
}

static FIELDS: [Field; Field::POLYNOMIALS.len()] = Field::ALL;

/// The image of `index` under a permutation of a batch that `random` selects.
///
/// It is i ↦ a·i + b in the field with as many elements, a ≠ 0, which takes any two elements to any two positions with
/// equal probability. That suffices: the variance of a mean depends on pairs of samples only, so it is the same as for
/// uniformly random permutations. Owen scrambling of the index (Burley, "Practical Hash-Based Owen Scrambling", 2020)
/// preserves neighbors in all dimensions, which increases the error.
#[inline(always)]
pub(super) fn permute(size: BatchSize, index: u32, random: u64) -> u32 {
    let field = &FIELDS[size.bits() as usize];
    let others = size.samples() - 1;
    if index == 0 {
        return (random >> 32) as u32 & others;
    }
    // All factors are equally likely to within 2⁻³².
    let factor = (((random & 0xFFFF_FFFF) * u64::from(others)) >> 32) as usize;
    let exponent = usize::from(field.logarithms[index as usize % Field::MOST]) + factor;
    u32::from(field.powers[exponent % (2 * Field::MOST)]) ^ (random >> 32) as u32 & others
}

#[cfg(test)]
mod tests {
    use super::super::chi_square::assert_frequencies;
    use super::super::philox4x32;
    use super::*;

    fn random(i: u32) -> u64 {
        let words = philox4x32([i, 0, 0, 0], [31, 7]);
        u64::from(words[0]) << 32 | u64::from(words[1])
    }

    #[test]
    fn every_element_has_one_place() {
        for bits in 0..=BatchSize::MOST_BITS {
            let size = BatchSize::new(1 << bits).unwrap();
            for pick in 0..200 {
                let mut places: Vec<u32> = (0..size.samples()).map(|i| permute(size, i, random(pick))).collect();
                places.sort_unstable();
                assert!(places.into_iter().eq(0..size.samples()));
            }
        }
    }

    #[test]
    fn two_elements_go_to_any_two_places_equally_often() {
        for (samples, i, j) in [(4, 0, 1), (8, 1, 6), (16, 3, 2), (64, 0, 63), (64, 17, 48)] {
            let size = BatchSize::new(samples).unwrap();
            let mut counts = vec![0; (samples * samples) as usize];
            for pick in 0..300_000 {
                let [a, b] = [i, j].map(|i| permute(size, i, random(pick)));
                counts[(a * samples + b) as usize] += 1;
            }
            let each = 1.0 / f64::from(samples * (samples - 1));
            let expected: Vec<f64> =
                (0..samples * samples).map(|c| if c / samples == c % samples { 0.0 } else { each }).collect();
            assert_frequencies(&counts, &expected);
        }
    }
}
