//! The random numbers of sixteen samples at a time.

use super::bits::{number, step};
use super::permutation::permute;
use super::sampler::Sampler;
use super::stream::Stream;
use super::{BatchSize, SamplerKind, halton, lattice, philox4x32, sobol, stratified};
use crate::math::LANES;
use crate::simd::{Level, loops};
use crate::timing::{Part, timed};

/// Samples of one picture, one per lane.
#[derive(Clone, Debug)]
pub struct SamplerLanes {
    pub(super) kind: SamplerKind,
    pub(super) key: [u32; 2],
    pub(super) pixel: [u32; LANES],
    pub(super) sample: [u32; LANES],
    /// The start of each batch's stream; zero for independent numbers.
    pub(super) words: [[u32; 4]; LANES],
}

/// A pair per lane, in SoA layout.
pub type Pairs = [[f64; LANES]; 2];

impl SamplerLanes {
    /// Fill all lanes with one sample.
    pub fn new(sampler: &Sampler) -> Self {
        let Sampler { kind, key, pixel, sample, words, .. } = *sampler;
        Self { kind, key, pixel: [pixel; LANES], sample: [sample; LANES], words: [words; LANES] }
    }

    /// Sample `number` of a pixel per lane, as in [`SamplerKind::sampler`].
    pub fn of(kind: SamplerKind, level: Level, seed: u64, pixel: &[u32; LANES], number: &[u32; LANES]) -> Self {
        let first = kind.sampler(seed, 0, 0);
        let mut lanes = Self { pixel: *pixel, sample: *number, ..Self::new(&first) };
        if let Some(size) = kind.batch_size() {
            lanes.sample = number.map(|number| number & (size.samples() - 1));
            let batch = number.map(|number| number >> size.bits());
            let [mut a, mut b, mut c, mut d] = [[0; LANES]; 4];
            starts(level, first.key, pixel, &batch, &mut a, &mut b, &mut c, &mut d);
            lanes.words = std::array::from_fn(|i| [a[i], b[i], c[i], d[i]]);
        }
        lanes
    }

    /// The sample of a lane, whose number among the samples of its pixel is `number`.
    #[inline]
    pub fn get(&self, lane: usize, number: u32) -> Sampler {
        let mut sampler = Sampler::of(self.kind, self.key, self.pixel[lane], number);
        (sampler.sample, sampler.words) = (self.sample[lane], self.words[lane]);
        sampler
    }

    /// Store a sample of the same picture in a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, sampler: &Sampler) {
        self.pixel[lane] = sampler.pixel;
        self.sample[lane] = sampler.sample;
        if self.kind != SamplerKind::Independent {
            self.words[lane] = sampler.words;
        }
    }

    /// The number of [`Sampler::one`] for an even dimension of each lane, and those of [`Sampler::two`] for the next.
    #[inline]
    pub fn one_and_two(&self, level: Level, dimensions: &[u32; LANES], one: &mut [f64; LANES], two: &mut Pairs) {
        timed(Part::Numbers, || match self.kind {
            SamplerKind::Independent => independent(level, self, dimensions, one, two),
            SamplerKind::Sobol(size) | SamplerKind::Lattice(size) => {
                triples(level, self, size, dimensions, one, two);
            }
            SamplerKind::Stratified(_) | SamplerKind::Halton(_) => {
                self.one(level, dimensions, one);
                self.two(level, &dimensions.map(|dimension| dimension + 1), two);
            }
        });
    }

    /// The number of [`Sampler::one`] for a dimension of each lane.
    #[inline]
    pub fn one(&self, level: Level, dimensions: &[u32; LANES], to: &mut [f64; LANES]) {
        timed(Part::Numbers, || ones(level, self, dimensions, to));
    }

    /// The numbers of [`Sampler::two`] for a dimension of each lane.
    #[inline]
    pub fn two(&self, level: Level, dimensions: &[u32; LANES], to: &mut Pairs) {
        timed(Part::Numbers, || twos(level, self, dimensions, to));
    }

    #[inline(always)]
    pub(super) fn block(&self, lane: usize, dimension: u32) -> [u32; 4] {
        philox4x32([dimension / 2, self.sample[lane], self.pixel[lane], 0], self.key)
    }

    /// The index of each sample's point in its batch, for a pair of numbers. Table lookups do not vectorize, so they
    /// have a loop of their own.
    #[inline(always)]
    fn points_of_pairs(&self, size: BatchSize, dimensions: &[u32; LANES]) -> [u32; LANES] {
        let (mut random, mut points) = ([0; LANES], [0; LANES]);
        for i in 0..LANES {
            random[i] = Stream::new(self.words[i]).word(dimensions[i], 2);
        }
        for i in 0..LANES {
            points[i] = permute(size, self.sample[i], random[i]);
        }
        points
    }

    /// The same for one number, which at an even dimension belongs to the pair that follows.
    #[inline(always)]
    fn points(&self, size: BatchSize, dimensions: &[u32; LANES]) -> [u32; LANES] {
        self.points_of_pairs(size, &dimensions.map(|dimension| dimension | 1))
    }
}

loops! {
    /// The starts of the streams of batches.
    fn starts(
        key: [u32; 2],
        pixel: &[u32; LANES],
        batch: &[u32; LANES],
        a: &mut [u32; LANES],
        b: &mut [u32; LANES],
        c: &mut [u32; LANES],
        d: &mut [u32; LANES],
    ) {
        for i in 0..LANES {
            [a[i], b[i], c[i], d[i]] = Stream::words(key, pixel[i], batch[i]);
        }
    }
}

#[inline(always)]
pub(super) fn joined(low: u32, high: u32) -> u64 {
    u64::from(high) << 32 | u64::from(low)
}

loops! {
    /// Both halves of a block of independent numbers.
    fn independent(
        lanes: &SamplerLanes,
        dimensions: &[u32; LANES],
        one: &mut [f64; LANES],
        two: &mut Pairs,
    ) {
        for i in 0..LANES {
            let [a, b, c, d] = lanes.block(i, dimensions[i]);
            one[i] = number(joined(a, b));
            two[0][i] = step(c);
            two[1][i] = step(d);
        }
    }
}

loops! {
    /// A choice and the pair that follows, which are three coordinates of one point.
    fn triples(
        lanes: &SamplerLanes,
        size: BatchSize,
        dimensions: &[u32; LANES],
        one: &mut [f64; LANES],
        two: &mut Pairs,
    ) {
        let points = lanes.points(size, dimensions);
        macro_rules! each {
            ($i:ident, $one:expr, $two:expr) => {
                for $i in 0..LANES {
                    one[$i] = number($one);
                    let [a, b] = $two;
                    (two[0][$i], two[1][$i]) = (step(a), step(b));
                }
            };
        }
        let stream = |i: usize| Stream::new(lanes.words[i]);
        if matches!(lanes.kind, SamplerKind::Lattice(_)) {
            each!(
                i,
                lattice::one_at(size, stream(i), points[i], dimensions[i]),
                lattice::two_at(size, stream(i), points[i], dimensions[i] + 1)
            );
        } else {
            each!(
                i,
                sobol::one_at(size, stream(i), points[i], dimensions[i]),
                sobol::two_at(stream(i), points[i], dimensions[i] + 1)
            );
        }
    }
}

loops! {
    /// One number per lane.
    fn ones(lanes: &SamplerLanes, dimensions: &[u32; LANES], to: &mut [f64; LANES]) {
        macro_rules! each {
            ($i:ident, $one:expr) => {
                for $i in 0..LANES {
                    to[$i] = number($one);
                }
            };
        }
        let stream = |i: usize| Stream::new(lanes.words[i]);
        match lanes.kind {
            SamplerKind::Independent => each!(i, {
                let [a, b, c, d] = lanes.block(i, dimensions[i]);
                let is_even = dimensions[i].is_multiple_of(2);
                if is_even { joined(a, b) } else { joined(c, d) }
            }),
            SamplerKind::Stratified(size) => {
                each!(i, stratified::one(size, stream(i), lanes.sample[i], dimensions[i]));
            }
            SamplerKind::Halton(size) => each!(i, halton::one(size, stream(i), lanes.sample[i], dimensions[i])),
            SamplerKind::Sobol(size) => {
                let points = lanes.points(size, dimensions);
                each!(i, sobol::one_at(size, stream(i), points[i], dimensions[i]));
            }
            SamplerKind::Lattice(size) => {
                let points = lanes.points(size, dimensions);
                each!(i, lattice::one_at(size, stream(i), points[i], dimensions[i]));
            }
        }
    }
}

loops! {
    /// Two numbers per lane.
    fn twos(lanes: &SamplerLanes, dimensions: &[u32; LANES], to: &mut Pairs) {
        macro_rules! each {
            ($i:ident, $two:expr) => {
                for $i in 0..LANES {
                    let [a, b] = $two;
                    (to[0][$i], to[1][$i]) = (step(a), step(b));
                }
            };
        }
        let stream = |i: usize| Stream::new(lanes.words[i]);
        match lanes.kind {
            SamplerKind::Independent => each!(i, {
                let [a, b, c, d] = lanes.block(i, dimensions[i]);
                let is_even = dimensions[i].is_multiple_of(2);
                if is_even { [a, b] } else { [c, d] }
            }),
            SamplerKind::Stratified(size) => {
                each!(i, stratified::two(size, stream(i), lanes.sample[i], dimensions[i]));
            }
            SamplerKind::Halton(size) => each!(i, halton::two(size, stream(i), lanes.sample[i], dimensions[i])),
            SamplerKind::Sobol(size) => {
                let points = lanes.points_of_pairs(size, dimensions);
                each!(i, sobol::two_at(stream(i), points[i], dimensions[i]));
            }
            SamplerKind::Lattice(size) => {
                let points = lanes.points_of_pairs(size, dimensions);
                each!(i, lattice::two_at(size, stream(i), points[i], dimensions[i]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::BatchSize;
    use super::*;

    #[test]
    fn lanes_have_the_numbers_of_their_samples_at_every_level() {
        let size = BatchSize::new(16).unwrap();
        let kinds = [
            SamplerKind::Independent,
            SamplerKind::Stratified(size),
            SamplerKind::Halton(size),
            SamplerKind::Sobol(size),
            SamplerKind::Lattice(size),
        ];
        for kind in kinds {
            let mut samplers: [Sampler; LANES] =
                std::array::from_fn(|i| kind.sampler(0x1234_5678_9abc, 1000 * i as u32, 7 * i as u32));
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                let [pixels, numbers] = [1000, 7].map(|step| std::array::from_fn(|i| step * i as u32));
                let lanes = SamplerLanes::of(kind, level, 0x1234_5678_9abc, &pixels, &numbers);
                for (lane, sampler) in samplers.iter_mut().enumerate() {
                    let mut same = lanes.get(lane, numbers[lane]);
                    assert_eq!((same.pixel(), same.number()), (sampler.pixel(), sampler.number()));
                    assert_eq!((same.one(4), same.two(5)), (sampler.one(4), sampler.two(5)), "{kind:?} {level:?}");
                }
            }
            let mut lanes = SamplerLanes::new(&samplers[0]);
            for (lane, sampler) in samplers.iter().enumerate() {
                lanes.set(lane, sampler);
            }
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                for first in [0, 4, 1 << 31] {
                    let dimensions = std::array::from_fn(|i| first + 2 * (i as u32 % 5));
                    let (mut one, mut two) = ([0.0; LANES], [[0.0; LANES]; 2]);
                    lanes.one_and_two(level, &dimensions, &mut one, &mut two);
                    for (lane, sampler) in samplers.iter_mut().enumerate() {
                        assert_eq!(one[lane], sampler.one(dimensions[lane]), "{kind:?} {level:?}");
                        assert_eq!([two[0][lane], two[1][lane]], sampler.two(dimensions[lane] + 1));
                    }
                    for odd in [0, 1] {
                        let dimensions = dimensions.map(|dimension| dimension + odd);
                        lanes.one(level, &dimensions, &mut one);
                        lanes.two(level, &dimensions, &mut two);
                        for (lane, sampler) in samplers.iter_mut().enumerate() {
                            assert_eq!(one[lane], sampler.one(dimensions[lane]));
                            assert_eq!([two[0][lane], two[1][lane]], sampler.two(dimensions[lane]));
                        }
                    }
                }
            }
        }
    }
}
