//! A constant environment.

use super::light::strength;
use super::{Light, LightSample, LightSampleContext, Reach};
use raywright_base::math::{DVec3, Frame};
use raywright_base::sampling::warp::{UNIFORM_SPHERE_PDF, cosine_hemisphere, uniform_sphere};
use raywright_optics::Rgb;
use std::f64::consts::PI;

/// The same radiance from all directions. It is sampled by the cosine at the receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantEnvironment {
    /// Radiance, W·sr⁻¹·m⁻².
    pub radiance: Rgb,
}

/// Samples a direction in proportion to the cosine at a receiver with this normal.
#[inline(always)]
fn arriving(normal: DVec3, u: [f64; 2]) -> DVec3 {
    Frame::new(normal).to_world(cosine_hemisphere(u))
}

/// Density of that direction.
#[inline(always)]
fn arriving_pdf(normal: DVec3, direction: DVec3) -> f64 {
    normal.dot(direction).max(0.0) / PI
}

impl Light for ConstantEnvironment {
    fn validate(&self) -> Result<(), String> {
        if self.radiance.is_radiance() { Ok(()) } else { Err("an environment must be finite and not negative".into()) }
    }

    fn reach(&self) -> Reach {
        Reach::Infinite { flux: 4.0 * PI * strength(self.radiance), spread: 1.0 }
    }

    #[inline]
    fn sample(&self, receiver: &LightSampleContext, u: [f64; 2]) -> Option<LightSample> {
        let direction = if receiver.is_free() { uniform_sphere(u) } else { arriving(receiver.normal, u) };
        let pdf = self.infinite_pdf(receiver, direction);
        // Rounding may move a direction in the tangent plane below it.
        (pdf > 0.0).then(|| LightSample::of_infinite(direction, self.radiance / pdf, pdf))
    }

    #[inline]
    fn infinite_radiance(&self, _: DVec3) -> Rgb {
        self.radiance
    }

    fn constant_radiance(&self) -> Option<Rgb> {
        Some(self.radiance)
    }

    #[inline]
    fn infinite_pdf(&self, receiver: &LightSampleContext, direction: DVec3) -> f64 {
        if receiver.is_free() { UNIFORM_SPHERE_PDF } else { arriving_pdf(receiver.normal, direction) }
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}
