//! The Blinn-Phong BRDF.

use super::bsdf_columns::LaneBsdf;
use super::lobes::{Lobes, diffuse, power_cosine};
use super::scalar_lanes::Looped;
use super::{Bsdf, BsdfSample, Rgb};
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// Diffuse reflection and Blinn's form of Phong's lobe ("Models of Light Reflection for Computer Synthesized Pictures",
/// 1977): kd / π + ks N cosⁿ θh, with θh the half vector's angle. N = (n + 2)(n + 4) / (8π (2^(−n/2) + n)) normalizes
/// the lobe: a specular share of 1 reflects exactly all light at normal incidence (Giesen, "Phong and Blinn-Phong
/// normalization factors", 2009), and less at every other angle. Both sides reflect.
#[derive(Clone, Copy, Debug)]
pub struct BlinnPhong {
    lobes: Lobes,
    exponent: f64,
    scale: f64,
}

impl BlinnPhong {
    /// Creates the BRDF from diffuse and specular reflectance, whose sum should be at most 1, and the exponent n ≥ 0.
    pub fn new(diffuse: Rgb, specular: Rgb, exponent: f64) -> Self {
        let n = exponent;
        let scale = (n + 2.0) * (n + 4.0) / (8.0 * PI * ((-0.5 * n).exp2() + n));
        Self { lobes: Lobes::new(diffuse, specular), exponent, scale }
    }

    /// cosⁿ θh and the cosine between half vector and `wo`; `None` if the half vector is undefined.
    #[inline(always)]
    fn lobe(&self, wo: DVec3, wi: DVec3) -> Option<(f64, f64)> {
        let h = (wo + wi).try_normalize()?;
        Some((h.z.abs().min(1.0).powf(self.exponent), wo.dot(h)))
    }
}

impl Bsdf for BlinnPhong {
    #[inline(always)]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        if wo.z * wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let (power, cosine) = self.lobe(wo, wi).unwrap_or((0.0, 0.0));
        let density = if cosine > 0.0 { power * (self.exponent + 1.0) / (4.0 * TAU * cosine) } else { 0.0 };
        let value = (self.lobes.diffuse * FRAC_1_PI + self.lobes.specular * (power * self.scale)) * wi.z.abs();
        (value, self.lobes.mixed(wi.z.abs() * FRAC_1_PI, density))
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 || self.lobes.black() {
            return None;
        }
        let is_specular = self.lobes.is_specular(choice);
        let wi = if is_specular {
            let h = power_cosine(DVec3::new(0.0, 0.0, 1f64.copysign(wo.z)), self.exponent, u);
            h * (2.0 * wo.dot(h)) - wo
        } else {
            diffuse(wo, u)
        };
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

impl LaneBsdf for BlinnPhong {
    type Lanes = Looped;
}
