//! The same light from everywhere.

use super::light::strength;
use super::{Light, LightSample, LightSampleContext, Reach};
use crate::math::{DVec3, Frame};
use crate::optics::{Rgb, is_radiance};
use crate::sampling::warp::{UNIFORM_SPHERE_PDF, cosine_hemisphere, uniform_sphere};
use std::f64::consts::PI;

/// The same radiance from every direction that the scene leaves open. It is best drawn by the cosine of its arrival.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantEnvironment {
    /// Its radiance, W·sr⁻¹·m⁻².
    pub radiance: Rgb,
}

impl Light for ConstantEnvironment {
    fn validate(&self) -> Result<(), String> {
        if is_radiance(self.radiance) { Ok(()) } else { Err("an environment must be finite and not negative".into()) }
    }

    fn reach(&self) -> Reach {
        Reach::Outside { flux: 4.0 * PI * strength(self.radiance), spread: 1.0 }
    }

    #[inline]
    fn sample(&self, receiver: &LightSampleContext, u: [f64; 2]) -> Option<LightSample> {
        let direction = if receiver.is_free() {
            uniform_sphere(u)
        } else {
            Frame::new(receiver.normal).to_world(cosine_hemisphere(u))
        };
        let pdf = self.outside_pdf(receiver, direction);
        // Rounding may turn a direction in the plane to below it.
        (pdf > 0.0).then(|| LightSample::of_outside(direction, self.radiance / pdf, pdf))
    }

    #[inline]
    fn outside(&self, _: DVec3) -> Rgb {
        self.radiance
    }

    #[inline]
    fn outside_pdf(&self, receiver: &LightSampleContext, direction: DVec3) -> f64 {
        if receiver.is_free() { UNIFORM_SPHERE_PDF } else { receiver.normal.dot(direction).max(0.0) / PI }
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}
