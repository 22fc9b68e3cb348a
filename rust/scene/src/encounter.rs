//! What a path asks of where it has come to.

use super::{LightSampleContext, RayOrigin};
use raywright_base::math::DVec3;
use raywright_optics::{BsdfSample, Rgb};

/// Where a path has come to, whatever that is, a point of a surface or of a medium: all that direct light and
/// continuation ask.
pub trait Encounter {
    /// The point.
    fn position(&self) -> DVec3;

    /// Where rays leave from.
    fn ray_origin(&self) -> RayOrigin;

    /// What light is drawn for.
    fn light_context(&self) -> LightSampleContext;

    /// How much of the light from a direction is scattered back along the path, with the cosine where there is one, and
    /// the density of [`Encounter::sample`] there.
    fn evaluate(&self, direction: DVec3) -> (Rgb, f64);

    /// Samples the direction of the path, in the world: `choice` and `u` as [`raywright_optics::Bsdf::sample`] takes
    /// them.
    fn sample(&self, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample>;
}
