//! A constant environment.

use super::light::strength;
use super::{Light, LightContextLanes, LightLanes, LightSample, LightSampleContext, Reach};
use raywright_base::math::{DVec3, Frame, LANES, Ray, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::sampling::warp::{UNIFORM_SPHERE_PDF, cosine_hemisphere, uniform_sphere};
use raywright_base::simd::{Level, loops};
use raywright_optics::{Rgb, RgbLanes};
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

loops! {
    /// Samples directions for receivers that all have a normal.
    fn draw(
        radiance: Rgb,
        normal: &VectorLanes,
        u: &Pairs,
        direction: &mut VectorLanes,
        weight: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let normal = normal.get(i);
            let drawn = arriving(normal, [u[0][i], u[1][i]]);
            let density = arriving_pdf(normal, drawn);
            direction.set(i, drawn);
            weight.set(i, radiance / density);
            pdf[i] = density;
        }
    }
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

    fn sample_lanes(&self, level: Level, receivers: &LightContextLanes, u: &Pairs, lights: &mut LightLanes) {
        if (0..LANES).any(|lane| receivers.get(lane).is_free()) {
            return lights.draw_each(receivers, u, |receiver, u| self.sample(receiver, u));
        }
        let LightLanes { direction, weight, pdf, is_within, primitive, .. } = lights;
        draw(level, self.radiance, &receivers.normal, u, direction, weight, pdf);
        (*is_within, *primitive) = ([false; LANES], [Ray::NO_TRIANGLE; LANES]);
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
