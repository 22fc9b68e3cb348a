//! Reconstruction filters.
//!
//! Each pixel takes its own samples, placed by its filter: an offset from the pixel's center is sampled, and the sample
//! has a weight (Ernst, Stamminger and Greiner, "Filter Importance Sampling", 2006). Pixels share no samples, so their
//! errors are independent.

mod blackman_harris;
mod box_filter;
mod cropped;
mod gaussian;
mod lanczos;
mod mitchell;
mod separable;
mod triangle;

pub use blackman_harris::BlackmanHarris;
pub use box_filter::Box;
pub use cropped::{Cropped, FilmCropping};
pub use gaussian::Gaussian;
pub use lanczos::Lanczos;
pub use mitchell::Mitchell;
pub use separable::{FilterProfile, Separable};
pub use triangle::Triangle;

use raywright_base::math::LANES;
use raywright_base::sampling::Pairs;
use std::fmt::Debug;

/// A reconstruction filter, centered on its pixel. Lengths are in pixels.
pub trait Filter: Debug + Send + Sync {
    /// The filter is 0 where |x| or |y| exceeds this radius.
    fn radius(&self) -> f64;

    /// Value at an offset from the center. It integrates to 1 over the plane, and may be negative.
    fn evaluate(&self, x: f64, y: f64) -> f64;

    /// Samples an offset by a point of the unit square; the weight is the filter over the density, with mean 1. It is
    /// negative where the filter is.
    fn sample(&self, u: [f64; 2]) -> ([f64; 2], f64);

    /// Samples offsets for each lane.
    fn sample_lanes(&self, u: &Pairs, offsets: &mut Pairs, weights: &mut [f64; LANES]) {
        for lane in 0..LANES {
            let offset;
            (offset, weights[lane]) = self.sample([u[0][lane], u[1][lane]]);
            [offsets[0][lane], offsets[1][lane]] = offset;
        }
    }

    /// Returns whether pixels near the edge of the film use only the part within it ([`FilmCropping`]).
    fn is_cropped(&self) -> bool {
        false
    }
}

/// Checks that a length is in range; the error says why not.
fn length(name: &str, value: f64) -> Result<f64, String> {
    if LENGTHS.contains(&value) {
        Ok(value)
    } else {
        Err(format!("{name} is {value}, expected {} to {}", LENGTHS.start(), LENGTHS.end()))
    }
}

/// Beyond this range a filter makes no sense.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-6..=64.0;

#[cfg(test)]
mod tests;
