//! What fills space: one interface over all media.

mod homogeneous;
mod phase;

pub use homogeneous::Homogeneous;
pub use phase::HenyeyGreenstein;

use crate::math::Ray;
use crate::optics::Rgb;
use std::fmt::Debug;

/// What fills space, and dims and scatters light on its way. Distances are those along a ray of unit direction.
pub trait Medium: Debug + Send + Sync {
    /// The share of light that gets along a ray from its `t_min` to its `t_max`, or an estimate of it that is right in
    /// the mean; `u` is for that, uniform in [0, 1).
    fn transmittance(&self, ray: &Ray, u: f64) -> Rgb;

    /// Draws how far a ray gets, from its `t_min` to its `t_max` at most: `choice` is for the colour that the draw is
    /// made for, `u` for the distance, both uniform in [0, 1).
    fn sample_distance(&self, ray: &Ray, choice: f64, u: f64) -> MediumSample;

    /// How it scatters.
    fn phase(&self) -> HenyeyGreenstein;
}

/// How far a ray has come in a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MediumSample {
    /// Where it was scattered; `None` if it got to its end.
    pub t: Option<f64>,
    /// What its throughput is multiplied by: transmittance, times the scattering there if it was scattered, over the
    /// density of the draw.
    pub weight: Rgb,
}
