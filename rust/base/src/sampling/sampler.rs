//! The random numbers of one sample of a pixel, by dimension.

use super::bits::{number, step};
use super::stream::Stream;
use super::{SamplerKind, halton, lattice, philox4x32, sobol, stratified};

/// Dimensions before those of the first bounce: film position, lens, one spare, and time.
pub const CAMERA_DIMENSIONS: u32 = 4;

/// The random numbers of one sample of a pixel. Each is identified by its dimension, so none depends on earlier calls.
///
/// A dimension holds 64 random bits, used either as one number of 53 bits or as a pair of 32 bits each. A discrete
/// choice needs many bits: a light of a billionth of the power must be chosen with its exact probability. A point on a
/// surface does not: 2⁻³² of a light's width in each of two directions is invisible.
///
/// A picture uses a dimension for one of the two, not for both. If a choice leads to a point, as in light sampling, the
/// choice takes an even dimension and the point the next, odd one. Some kinds stratify the three together.
#[derive(Clone, Debug)]
pub struct Sampler {
    pub(super) kind: SamplerKind,
    pub(super) key: [u32; 2],
    pub(super) pixel: u32,
    /// Its number among the pixel's samples.
    number: u32,
    /// The same, or its number within the batch.
    pub(super) sample: u32,
    /// The index of the last Philox block, which holds two dimensions that are usually used consecutively.
    block: u32,
    /// That block, or the start of the batch's stream.
    pub(super) words: [u32; 4],
}

impl SamplerKind {
    /// The random numbers of sample `sample` of a pixel.
    #[inline]
    pub fn sampler(self, seed: u64, pixel: u32, sample: u32) -> Sampler {
        let mut sampler = Sampler::new(seed, pixel, sample);
        if let Some(size) = self.batch_size() {
            sampler.kind = self;
            sampler.words = Stream::words(sampler.key, pixel, sample >> size.bits());
            sampler.sample = sample & (size.samples() - 1);
        }
        sampler
    }
}

impl Sampler {
    /// Independent random numbers of sample `sample` of a pixel, for a seed of the whole picture.
    #[inline]
    pub fn new(seed: u64, pixel: u32, sample: u32) -> Self {
        Self::of(SamplerKind::Independent, [seed as u32, (seed >> 32) as u32], pixel, sample)
    }

    /// Before its position in a batch is known.
    #[inline]
    pub(super) fn of(kind: SamplerKind, key: [u32; 2], pixel: u32, number: u32) -> Self {
        Self { kind, key, pixel, number, sample: number, block: u32::MAX, words: [0; 4] }
    }

    /// Independent numbers for the same sample, to pair with these.
    pub fn paired(&self) -> Self {
        /// An arbitrary number that is unlikely to be used as a seed.
        const PAIRED: u64 = 0x9e37_79b9_7f4a_7c15;
        self.of_seed_with(PAIRED)
    }

    /// Numbers for the same sample that are independent of these, and of those paired with either.
    pub fn apart(&self) -> Self {
        const APART: u64 = 0xd1b5_4a32_d192_ed03;
        self.of_seed_with(APART)
    }

    fn of_seed_with(&self, other: u64) -> Self {
        let seed = u64::from(self.key[1]) << 32 | u64::from(self.key[0]);
        self.kind.sampler(seed ^ other, self.pixel, self.number)
    }

    /// The pixel of the sample.
    pub fn pixel(&self) -> u32 {
        self.pixel
    }

    /// Its number among the samples of its pixel, from 0.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// A number in [0, 1) with 53 bits.
    #[inline]
    pub fn one(&mut self, dimension: u32) -> f64 {
        let (stream, index) = (Stream::new(self.words), self.sample);
        let bits = match self.kind {
            SamplerKind::Independent => {
                let [low, high] = self.bits(dimension);
                u64::from(high) << 32 | u64::from(low)
            }
            SamplerKind::Stratified(size) => stratified::one(size, stream, index, dimension),
            SamplerKind::Halton(size) => halton::one(size, stream, index, dimension),
            SamplerKind::Sobol(size) => sobol::one(size, stream, index, dimension),
            SamplerKind::Lattice(size) => lattice::one(size, stream, index, dimension),
        };
        number(bits)
    }

    /// Two numbers in (0, 1), each the midpoint of one of 2³² equal steps. They are never 0 or 1, so warps need not
    /// handle their borders.
    #[inline]
    pub fn two(&mut self, dimension: u32) -> [f64; 2] {
        let (stream, index) = (Stream::new(self.words), self.sample);
        let bits = match self.kind {
            SamplerKind::Independent => self.bits(dimension),
            SamplerKind::Stratified(size) => stratified::two(size, stream, index, dimension),
            SamplerKind::Halton(size) => halton::two(size, stream, index, dimension),
            SamplerKind::Sobol(size) => sobol::two(size, stream, index, dimension),
            SamplerKind::Lattice(size) => lattice::two(size, stream, index, dimension),
        };
        [step(bits[0]), step(bits[1])]
    }

    /// The 64 bits of a dimension of independent numbers.
    #[inline]
    fn bits(&mut self, dimension: u32) -> [u32; 2] {
        let block = dimension / 2;
        if block != self.block {
            self.words = philox4x32([block, self.sample, self.pixel, 0], self.key);
            self.block = block;
        }
        if dimension.is_multiple_of(2) { [self.words[0], self.words[1]] } else { [self.words[2], self.words[3]] }
    }
}

#[cfg(test)]
mod tests {
    use super::super::BatchSize;
    use super::super::chi_square::assert_frequencies;
    use super::*;

    #[test]
    fn a_number_depends_on_its_name_only() {
        let mut forwards = Sampler::new(7, 3, 5);
        let ones: Vec<f64> = (0..20).map(|d| forwards.one(d)).collect();
        let twos: Vec<[f64; 2]> = (0..20).map(|d| forwards.two(d)).collect();
        for d in (0..20).rev() {
            let mut fresh = Sampler::new(7, 3, 5);
            assert_eq!(fresh.one(d), ones[d as usize]);
            assert_eq!(forwards.two(d), twos[d as usize]);
        }
    }

    #[test]
    fn a_sample_keeps_its_number_in_batches() {
        let size = BatchSize::new(8).unwrap();
        for kind in [SamplerKind::Independent, SamplerKind::Sobol(size), SamplerKind::Halton(size)] {
            for sample in [0, 7, 8, 1000] {
                assert_eq!(kind.sampler(7, 3, sample).number(), sample);
            }
        }
    }

    #[test]
    fn every_part_of_the_name_counts() {
        let value = |seed, pixel, sample, dimension| Sampler::new(seed, pixel, sample).one(dimension);
        let mut all: Vec<f64> = Vec::new();
        for bit in 0..32 {
            all.extend([value(1 << bit, 0, 0, 0), value(1 << (bit + 32), 0, 0, 0), value(0, 1 << bit, 0, 0)]);
            all.push(value(0, 0, 1 << bit, 0));
            all.push(value(0, 0, 0, 1 << bit));
        }
        let count = all.len();
        all.sort_unstable_by(f64::total_cmp);
        all.dedup();
        assert_eq!(all.len(), count);
    }

    #[test]
    fn uniform_in_square_over_pixels_samples_and_dimensions() {
        const SIDE: usize = 16;
        let cell = |u: f64| (u * SIDE as f64) as usize;
        for axis in 0..3 {
            let mut pairs = vec![0; SIDE * SIDE];
            let mut neighbours = vec![0; SIDE * SIDE];
            for i in 0..100_000u32 {
                let name = |i: u32| match axis {
                    0 => (i, 0, 0),
                    1 => (0, i, 0),
                    _ => (0, 0, i),
                };
                let draw = |i: u32| {
                    let (pixel, sample, dimension) = name(i);
                    let mut sampler = Sampler::new(11, pixel, sample);
                    (sampler.two(dimension), sampler.one(dimension + 1))
                };
                let ([x, y], z) = draw(i);
                pairs[cell(x) * SIDE + cell(y)] += 1;
                neighbours[cell(z) * SIDE + cell(draw(i + 200_000).1)] += 1;
            }
            let expected = vec![1.0 / (SIDE * SIDE) as f64; SIDE * SIDE];
            assert_frequencies(&pairs, &expected);
            assert_frequencies(&neighbours, &expected);
        }
    }

    #[test]
    fn borders_are_never_reached() {
        let mut sampler = Sampler::new(0, 0, 0);
        sampler.block = 0;
        sampler.words = [0, 0, u32::MAX, u32::MAX];
        assert_eq!(sampler.one(0), 0.0);
        assert_eq!(sampler.one(1), 1.0 - 2f64.powi(-53));
        assert!(sampler.two(0)[0] > 0.0 && sampler.two(1)[1] < 1.0);
    }
}
