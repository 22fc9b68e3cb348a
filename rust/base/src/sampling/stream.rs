//! The random words that randomize the point set of a batch.

use super::philox4x32;

/// Random words for one batch of samples of one pixel, the same for each of its samples.
///
/// They are the SplitMix64 sequence (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014;
/// constants of Stafford's thirteenth variant) with a random start and a random key in the mixing, so that no two
/// batches share a part of it. With three multiplications per word, numbers from a net cost no more than independent
/// ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stream {
    start: u64,
    key: u64,
}

impl Stream {
    /// The Philox block that starts a stream, which no dimension of independent numbers uses.
    #[inline(always)]
    pub fn words(key: [u32; 2], pixel: u32, batch: u32) -> [u32; 4] {
        philox4x32([0, batch, pixel, 1], key)
    }

    /// The stream with the given start.
    #[inline(always)]
    pub fn new(words: [u32; 4]) -> Self {
        let [a, b, c, d] = words.map(u64::from);
        Self { start: a << 32 | b, key: c << 32 | d }
    }

    /// Word 0 to 3 of a dimension.
    #[inline(always)]
    pub fn word(self, dimension: u32, number: u32) -> u64 {
        self.mixed(u64::from(dimension) << 2 | u64::from(number))
    }

    /// Word 0 to 3 of a dimension, for one sample of the batch or any other number below 2²⁸.
    #[inline(always)]
    pub fn word_of(self, sample: u32, dimension: u32, number: u32) -> u64 {
        self.mixed(u64::from(sample + 1) << 34 | u64::from(dimension) << 2 | u64::from(number))
    }

    #[inline(always)]
    fn mixed(self, number: u64) -> u64 {
        let mut z = self.start.wrapping_add(number.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9) ^ self.key;
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }
}

#[cfg(test)]
mod tests {
    use super::super::chi_square::assert_frequencies;
    use super::*;

    #[test]
    fn words_are_uniform_and_neighbours_independent() {
        // Neighbors in each component: batch, dimension, number, sample.
        let word = |i: u32, axis: u32| {
            let stream = Stream::new(Stream::words([9, 0], 4, if axis == 0 { i } else { 0 }));
            match axis {
                0 | 1 => stream.word(if axis == 1 { i } else { 0 }, 2),
                2 => stream.word(i / 4, i % 4),
                _ => stream.word_of(i, 3, 0),
            }
        };
        for axis in 0..4 {
            for (first, second) in [(60, 60), (0, 0), (30, 30), (0, 60)] {
                let mut pairs = vec![0; 256];
                for i in 0..100_000 {
                    let [a, b] = [(i, first), (i + 1, second)].map(|(i, low)| (word(i, axis) >> low & 15) as usize);
                    pairs[a * 16 + b] += 1;
                }
                assert_frequencies(&pairs, &[1.0 / 256.0; 256]);
            }
        }
    }
}
