//! Random numbers common to all pixels: for each sample number, or each photon map.

use raywright_base::sampling::Sampler;

/// Dimension of the time.
pub(crate) const COMMON_TIME: u32 = 0;

/// Dimension of the wavelengths.
pub(crate) const COMMON_WAVES: u32 = 1;

/// Return a number in [0, 1) for an index and a dimension: a golden-ratio sequence with a random start, so that
/// consecutive indices of a seed are evenly spread.
pub(crate) fn spread(seed: u64, index: u32, dimension: u32) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let start = Sampler::new(seed, u32::MAX, u32::MAX).one(dimension);
    (start + f64::from(index) * GOLDEN).fract()
}
