//! Which point set the numbers of a picture come from, and how large its batches are.

/// How many consecutive samples of a pixel are placed with regard to each other: a power of two, at most 64.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BatchSize(pub(super) u8);

impl BatchSize {
    /// Of the largest batch, the logarithm to base 2.
    pub const MOST_BITS: u32 = 6;

    /// Batches that a picture has at least, where it is known how many samples it takes. Of two, the spread of a pixel
    /// would be known by one degree of freedom, and of pictures whose light is rare, too many would tell too small an
    /// error: 10 of 30 of caustics at 16 samples, where one is to be expected.
    const LEAST_BATCHES: u32 = 4;

    /// A batch of so many samples: 1, 2, 4, ... 64; `None` for another number.
    pub fn new(samples: u32) -> Option<Self> {
        (samples.is_power_of_two() && samples.ilog2() <= Self::MOST_BITS).then(|| Self(samples.ilog2() as u8))
    }

    /// The largest batch of which so many samples make four or more; the default where their number is not known.
    ///
    /// The larger it is, the smaller the error of the same number of samples, as each is placed with regard to more
    /// others. Samples that are no multiple of it end in part of a batch, which is unbiased too, but not worth as much.
    pub fn for_budget(samples: Option<u32>) -> Self {
        samples.map_or(Self::default(), |samples| {
            let most = (samples / Self::LEAST_BATCHES).clamp(1, 1 << Self::MOST_BITS);
            Self(most.ilog2() as u8)
        })
    }

    /// The columns of a grid of as many cells, which has as many rows or half as many.
    #[inline(always)]
    pub(super) fn halved(self) -> Self {
        Self(self.0.div_ceil(2))
    }

    /// How many samples.
    #[inline(always)]
    pub fn samples(self) -> u32 {
        1 << self.0
    }

    /// The logarithm of the number of samples to base 2.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        u32::from(self.0)
    }
}

/// 1 sample: where it is not known how many there will be, there may be few, and it takes two batches to tell their
/// error.
impl Default for BatchSize {
    fn default() -> Self {
        Self(0)
    }
}

/// Which point set the numbers come from.
///
/// Every number of every sample is uniform by itself, and those of different dimensions are independent, whatever the
/// kind: the mean of a picture over all seeds is the same. Kinds differ in how the samples of a batch lie relative to
/// each other. A dimension takes its numbers from a set of two or three dimensions, and sets are put together at random
/// ("padding"): Sobol's own points of many dimensions have worse pairs, and lose more by that than they gain.
///
/// `benches/samplers.py` compares them. Lattices leave the least error in most batches; of 4 points, those of rank 1
/// all lie on a diagonal, and Sobol's nets are better. Blue noise over the picture is no kind: it changes how errors
/// lie beside each other, and no pixel's error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerKind {
    /// Independent random numbers.
    #[default]
    Independent,
    /// A jittered grid whose rows and columns are stratified too.
    Stratified(BatchSize),
    /// Radical inverses in prime bases, scrambled.
    Halton(BatchSize),
    /// Sobol's nets, scrambled as Owen does.
    Sobol(BatchSize),
    /// Rank-1 lattices, shifted.
    Lattice(BatchSize),
}

impl SamplerKind {
    /// How many consecutive samples of a pixel belong together. Batches are independent of each other, so the spread
    /// between them is an honest measure of the error; within a batch of a low-discrepancy set it would not be.
    pub fn batch(self) -> u32 {
        self.batch_size().map_or(1, BatchSize::samples)
    }

    /// The same, of kinds that place samples with regard to each other.
    #[inline]
    pub(super) fn batch_size(self) -> Option<BatchSize> {
        match self {
            Self::Independent => None,
            Self::Stratified(size) | Self::Halton(size) | Self::Sobol(size) | Self::Lattice(size) => Some(size),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_follow_from_the_samples_asked() {
        let of = |samples| BatchSize::for_budget(Some(samples)).samples();
        for (samples, batch) in
            [(0, 1), (1, 1), (7, 1), (8, 2), (64, 16), (100, 16), (128, 32), (256, 64), (u32::MAX, 64)]
        {
            assert_eq!(of(samples), batch, "{samples}");
        }
        assert!((4..2000u32).all(|samples| samples / of(samples) >= 4));
        assert_eq!((BatchSize::for_budget(None).samples(), SamplerKind::Independent.batch()), (1, 1));
        assert_eq!(BatchSize::new(64).map(BatchSize::samples), Some(64));
        assert_eq!((BatchSize::new(0), BatchSize::new(12), BatchSize::new(128)), (None, None, None));
    }
}
