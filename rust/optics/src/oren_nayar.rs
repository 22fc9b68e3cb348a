//! The Oren-Nayar BRDF.

use super::bsdf_columns::LaneBsdf;
use super::soa_lanes::Straight;
use super::{Bsdf, BsdfSample, Rgb};
use raywright_base::math::trig::upper_angle;
use raywright_base::math::{DVec3, in_lanes};
use raywright_base::sampling::warp;
use std::f64::consts::{FRAC_1_PI, PI};

/// A surface of Lambertian facets (Oren and Nayar, "Generalization of Lambert's Reflectance Model", 1994) in Fujii's
/// form with compensation of interreflection (Portsmouth, Kutz and Hill, "EON: A practical energy-preserving rough
/// diffuse BRDF", 2024): reciprocal, and white at reflectance 1 for every roughness. Both sides reflect.
#[derive(Clone, Copy, Debug)]
pub struct OrenNayar {
    reflectance: Rgb,
    /// 1 / (1 + c₁ r): scale of single scattering.
    scale: f64,
    /// Roughness.
    r: f64,
    /// Multiple scattering, over π and the mean loss of single scattering.
    multiple: Rgb,
}

impl OrenNayar {
    /// Creates the BRDF from the reflectance of single facets, 0 to 1, and a roughness from 0 (Lambertian) to 1.
    pub fn new(reflectance: Rgb, roughness: f64) -> Self {
        let r = roughness.clamp(0.0, 1.0);
        let scale = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * r);
        let average = scale * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * r);
        let lost = 1.0 - average;
        // At a roughness of 10⁻¹² the loss is below f64 precision.
        let multiple = if lost > 1e-12 {
            let colour = reflectance * reflectance * average / (Rgb::ONE - reflectance * lost);
            colour * (FRAC_1_PI / lost)
        } else {
            Rgb::ZERO
        };
        Self { reflectance, scale, r, multiple }
    }

    /// Single-scattering albedo of white facets for a direction.
    #[inline(always)]
    fn single(&self, cosine: f64) -> f64 {
        let c = cosine.clamp(0.0, 1.0);
        let s = ((1.0 - c) * (1.0 + c)).sqrt();
        // (1 − sin³) / cos without cancellation at the horizon.
        let g = s * (upper_angle(s, c) - s * c) + 2.0 / 3.0 * s * (c * (1.0 + s + s * s) / (1.0 + s) - 1.0);
        self.scale * (1.0 + self.r * FRAC_1_PI * g)
    }
}

impl Bsdf for OrenNayar {
    #[inline(always)]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        if wo.z * wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let (o, i) = (wo.z.abs(), wi.z.abs());
        let s = wo.x * wi.x + wo.y * wi.y;
        let retro = if s > 0.0 { s / o.max(i) } else { s };
        let single = (self.scale * (1.0 + self.r * retro)).max(0.0) * FRAC_1_PI;
        let lost = (1.0 - self.single(o)) * (1.0 - self.single(i));
        ((self.reflectance * single + self.multiple * lost.max(0.0)) * i, i * FRAC_1_PI)
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, _choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 || self.reflectance.is_black() {
            return None;
        }
        let mut wi = warp::cosine_hemisphere(u);
        let pdf = warp::cosine_hemisphere_pdf(wi);
        wi.z = wi.z.copysign(wo.z);
        Some(BsdfSample::new(wi, self.evaluate(wo, wi).0 / pdf, pdf))
    }

    fn albedo(&self) -> Rgb {
        let average = self.scale * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * self.r);
        let lost = 1.0 - average;
        self.reflectance * average + self.multiple * (PI * lost * lost)
    }
}

in_lanes! {
    /// Such BRDFs, one per lane.
    OrenNayarLanes of OrenNayar { reflectance: Rgb, scale: f64, r: f64, multiple: Rgb }
}

impl LaneBsdf for OrenNayar {
    type Lanes = Straight<Self>;
}
