//! What part of the film a pixel is the mean of.
//!
//! Each pixel takes its own samples, and places them by its filter: an offset from the pixel's centre is drawn, and its
//! sample counts with the weight that this draw calls for (Ernst, Stamminger and Greiner, "Filter Importance Sampling",
//! 2006). No sample is shared by pixels, so their errors stay independent.

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
pub use cropped::{Cropped, Edges};
pub use gaussian::Gaussian;
pub use lanczos::Lanczos;
pub use mitchell::Mitchell;
pub use separable::{Profile, Separable};
pub use triangle::Triangle;

use raywright_base::math::LANES;
use raywright_base::sampling::Pairs;
use std::fmt::Debug;

/// A reconstruction filter, centred on its pixel. Lengths are in pixels.
pub trait Filter: Debug + Send + Sync {
    /// It is 0 where |x| or |y| exceeds this.
    fn radius(&self) -> f64;

    /// Its value at an offset from the centre. It integrates to 1 over the plane, and may be negative.
    fn evaluate(&self, x: f64, y: f64) -> f64;

    /// An offset for a uniform point of the unit square, and the weight of what is found there: the filter over the
    /// density of the draw, whose mean is 1. It is negative where the filter is.
    fn sample(&self, u: [f64; 2]) -> ([f64; 2], f64);

    /// The same for a point of each lane.
    fn sample_lanes(&self, u: &Pairs, offsets: &mut Pairs, weights: &mut [f64; LANES]) {
        for lane in 0..LANES {
            let offset;
            (offset, weights[lane]) = self.sample([u[0][lane], u[1][lane]]);
            [offsets[0][lane], offsets[1][lane]] = offset;
        }
    }

    /// Whether pixels near the edge of the film take only what lies on it ([`Edges`]).
    fn is_cropped(&self) -> bool {
        false
    }
}

/// A length that makes sense, or why it does not.
fn length(name: &str, value: f64) -> Result<f64, String> {
    if LENGTHS.contains(&value) {
        Ok(value)
    } else {
        Err(format!("{name} is {value}, expected {} to {}", LENGTHS.start(), LENGTHS.end()))
    }
}

/// No picture is helped by less or by more.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-6..=64.0;

#[cfg(test)]
mod tests;
