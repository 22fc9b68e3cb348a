//! What fills space: one interface over all media.

mod coefficients;
mod grid;
mod homogeneous;
mod stretches;
mod values;

pub use coefficients::Coefficients;
pub use grid::GridMedium;
pub use homogeneous::Homogeneous;
pub use stretches::{Content, Stretch, Stretches};
pub use values::{At, Values};

use crate::math::{DVec3, Ray};
use crate::optics::Phase;
use std::fmt::Debug;

/// What fills space, and dims and scatters light on its way.
///
/// Coefficients are per unit of length in the world. Where a medium differs from place to place, places are those of
/// the space that its shape is described in, which is not the world's in an instance.
pub trait Medium: Debug + Send + Sync {
    /// How it scatters.
    fn phase(&self) -> Phase;

    /// Whether it scatters anything anywhere.
    fn scatters(&self) -> bool;

    /// Whether it is the same everywhere.
    fn is_even(&self) -> bool {
        false
    }

    /// What lies on a ray, one stretch after the other, between two `t` of it.
    fn stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_>;

    /// What there is at a point.
    fn at(&self, point: DVec3) -> Coefficients;

    /// The memory held.
    fn bytes(&self) -> usize;
}
