//! Interface of path vertices for direct lighting and scattering.

use super::{LightSampleContext, RayOrigin};
use raywright_base::math::DVec3;
use raywright_optics::{BsdfSample, Rgb};

/// A path vertex: a point of a surface or of a medium. It has all that direct lighting and path continuation need.
pub trait Interaction {
    /// Position.
    fn position(&self) -> DVec3;

    /// Origin of rays that leave the vertex.
    fn ray_origin(&self) -> RayOrigin;

    /// Reference point for light sampling.
    fn light_context(&self) -> LightSampleContext;

    /// Evaluates scattering from a direction back along the path, including the cosine at surfaces. Also returns the
    /// density of [`Interaction::sample`] for that direction.
    fn evaluate(&self, direction: DVec3) -> (Rgb, f64);

    /// Samples a continuation direction in world space. `choice` and `u` are as in [`raywright_optics::Bsdf::sample`].
    fn sample(&self, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample>;
}
