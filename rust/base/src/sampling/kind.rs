//! The kinds of point sets, and their batch sizes.

/// The number of consecutive samples of a pixel that form a point set: a power of two, at most 64.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BatchSize(pub(super) u8);

impl BatchSize {
    /// The logarithm to base 2 of the largest batch.
    pub const MOST_BITS: u32 = 6;

    /// Minimum number of batches for a known sample count. With two, the variance of a pixel would have one degree of
    /// freedom. In pictures with rare light, too many error estimates would be too small: 10 of 30 for caustics at 16
    /// samples, where one is to be expected.
    const LEAST_BATCHES: u32 = 4;

    /// A batch of 1, 2, 4, ... 64 samples; `None` for other numbers.
    pub fn new(samples: u32) -> Option<Self> {
        (samples.is_power_of_two() && samples.ilog2() <= Self::MOST_BITS).then(|| Self(samples.ilog2() as u8))
    }

    /// The largest batch of which the given number of samples makes four or more; the default if their number is
    /// unknown.
    ///
    /// A larger batch has a smaller error for the same number of samples, since more of them are stratified together.
    /// If the number of samples is no multiple of it, the last batch is incomplete: unbiased, but less effective.
    pub fn for_budget(samples: Option<u32>) -> Self {
        samples.map_or(Self::default(), |samples| {
            let most = (samples / Self::LEAST_BATCHES).clamp(1, 1 << Self::MOST_BITS);
            Self(most.ilog2() as u8)
        })
    }

    /// The columns of a grid with this many cells, which has as many rows or half as many.
    #[inline(always)]
    pub(super) fn halved(self) -> Self {
        Self(self.0.div_ceil(2))
    }

    /// The number of samples.
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

/// 1 sample: if the number of samples is unknown it may be small, and estimating the error takes two batches.
impl Default for BatchSize {
    fn default() -> Self {
        Self(0)
    }
}

/// The point set of the random numbers.
///
/// For every kind, each number of a sample is uniform, and those of different dimensions are independent, so the mean
/// of a picture over all seeds is the same. Kinds differ in the joint distribution of a batch's samples. Each dimension
/// uses a point set of two or three dimensions, and sets are combined at random ("padding"): Sobol points in many
/// dimensions have worse pairs, and lose more by that than they gain.
///
/// `benches/samplers.py` compares them. Lattices have the least error for most batch sizes. With 4 points, all rank-1
/// lattices lie on a diagonal, and Sobol nets are better. Blue noise over the picture is not a kind: it changes the
/// correlation of errors between pixels, and no pixel's error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerKind {
    /// Independent random numbers.
    #[default]
    Independent,
    /// A jittered grid with stratified rows and columns.
    Stratified(BatchSize),
    /// Scrambled radical inverses in prime bases.
    Halton(BatchSize),
    /// Owen-scrambled Sobol nets.
    Sobol(BatchSize),
    /// Randomly shifted rank-1 lattices.
    Lattice(BatchSize),
}

impl SamplerKind {
    /// The number of consecutive samples of a pixel in a batch. Batches are independent, so their variance is an
    /// unbiased measure of the error. The variance within a batch of a low-discrepancy set would not be.
    pub fn batch(self) -> u32 {
        self.batch_size().map_or(1, BatchSize::samples)
    }

    /// The batch size of kinds with batches.
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
