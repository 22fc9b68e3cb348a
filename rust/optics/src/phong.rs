//! The Phong BRDF.

use super::bsdf_columns::LaneBsdf;
use super::lobes::{Lobes, diffuse};
use super::mirror::mirrored;
use super::scalar_lanes::Looped;
use super::{Bsdf, BsdfSample, Rgb};
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, TAU};

/// Diffuse reflection and Phong's lobe (1975), in the modified form that is reciprocal and conserves energy (Lafortune
/// and Willems, "Using the Modified Phong Reflectance Model for Physically Based Rendering", 1994): kd / π + ks (n + 2)
/// / 2π cosⁿ α, with α the angle to the mirror direction. Both sides reflect.
#[derive(Clone, Copy, Debug)]
pub struct Phong {
    lobes: Lobes,
    exponent: f64,
}

impl Phong {
    /// Creates the BRDF from diffuse and specular reflectance, whose sum should be at most 1, and the exponent n ≥ 0.
    pub fn new(diffuse: Rgb, specular: Rgb, exponent: f64) -> Self {
        Self { lobes: Lobes::new(diffuse, specular), exponent }
    }
}

impl Bsdf for Phong {
    #[inline(always)]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        if wo.z * wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let power = mirrored(wo).dot(wi).clamp(0.0, 1.0).powf(self.exponent);
        let (lobe, density) = (power * (self.exponent + 2.0) / TAU, power * (self.exponent + 1.0) / TAU);
        let value = (self.lobes.diffuse * FRAC_1_PI + self.lobes.specular * lobe) * wi.z.abs();
        (value, self.lobes.mixed(wi.z.abs() * FRAC_1_PI, density))
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 || self.lobes.black() {
            return None;
        }
        let is_specular = self.lobes.is_specular(choice);
        let wi = if is_specular { super::lobes::power_cosine(mirrored(wo), self.exponent, u) } else { diffuse(wo, u) };
        let (value, pdf) = self.evaluate(wo, wi);
        (pdf > 0.0).then(|| BsdfSample::new(wi, value / pdf, pdf).of_lobe(self.lobes.choices(is_specular)))
    }

    fn albedo(&self) -> Rgb {
        self.lobes.diffuse + self.lobes.specular
    }

    fn roughness(&self) -> f64 {
        self.lobes.roughness(self.exponent)
    }
}

impl LaneBsdf for Phong {
    type Lanes = Looped;
}
