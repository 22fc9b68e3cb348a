//! Diffuse reflection plus one lobe, as in the classic models.

use super::Rgb;
use super::bsdf::either;
use glam::DVec3;
use raywright_base::math::trig::sin_cos_turn;
use raywright_base::math::{Frame, in_lanes};
use raywright_base::sampling::warp;
use std::f64::consts::FRAC_1_PI;

/// Reflectances of both parts, and the sampling probability.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lobes {
    pub diffuse: Rgb,
    pub specular: Rgb,
    /// Sampling probability of the specular part.
    share: f64,
}

impl Lobes {
    pub fn new(diffuse: Rgb, specular: Rgb) -> Self {
        let (d, s) = (diffuse.max(), specular.max());
        Self { diffuse, specular, share: if s > 0.0 { s / (d + s) } else { 0.0 } }
    }

    #[inline(always)]
    pub fn black(&self) -> bool {
        self.diffuse.is_black() && self.specular.is_black()
    }

    #[inline(always)]
    pub fn is_specular(&self, choice: &mut dyn FnMut() -> f64) -> bool {
        self.share == 1.0 || (self.share > 0.0 && choice() < self.share)
    }

    /// Choice numbers of the specular part, or of the diffuse one.
    #[inline(always)]
    pub fn choices(&self, is_specular: bool) -> [f64; 2] {
        either(self.share, is_specular)
    }

    /// Density of the mixture.
    #[inline(always)]
    pub fn mixed(&self, diffuse: f64, specular: f64) -> f64 {
        (1.0 - self.share) * diffuse + self.share * specular
    }

    /// The microfacet α of an exponent, √(2 / (n + 2)) (Walter et al., 2007).
    pub fn roughness(&self, exponent: f64) -> f64 {
        if self.specular.is_black() { 1.0 } else { (2.0 / (exponent + 2.0)).sqrt() }
    }
}

/// A cosine-distributed direction on the side of `wo`.
#[inline(always)]
pub(super) fn diffuse(wo: DVec3, u: [f64; 2]) -> DVec3 {
    let mut wi = warp::cosine_hemisphere(u);
    wi.z = wi.z.copysign(wo.z);
    wi
}

/// A direction about `axis` with density (n + 1) / 2π cosⁿ.
#[inline(always)]
pub(super) fn power_cosine(axis: DVec3, exponent: f64, u: [f64; 2]) -> DVec3 {
    // 1 − cos by expm1, so that the width of a sharp lobe is not rounded away.
    let depth = -(u[1].ln() / (exponent + 1.0)).exp_m1();
    let radius = (depth * (2.0 - depth)).max(0.0).sqrt();
    let [sin, cos] = sin_cos_turn(u[0]);
    Frame::new(axis).to_world(DVec3::new(radius * cos, radius * sin, 1.0 - depth))
}

/// A distribution of grazing directions. Energy lost by facets concentrates at cosines near their roughness and falls
/// off with the inverse square. This density follows it: μ / (μ² + κ²) over the cosine μ with scale κ. At κ = 1 it is
/// nearly cosine-distributed.
#[derive(Clone, Copy, Debug)]
pub struct Grazing {
    /// κ².
    square: f64,
    /// ln(1 + 1 / κ²).
    log: f64,
}

in_lanes! {
    /// Such distributions, one per lane.
    GrazingLanes of Grazing { square: f64, log: f64 }
}

impl Grazing {
    #[inline]
    pub fn new(scale: f64) -> Self {
        let square = scale * scale;
        Self { square, log: square.recip().ln_1p() }
    }

    /// Samples a direction.
    #[inline(always)]
    pub fn sample(&self, u: [f64; 2]) -> DVec3 {
        let square = (self.square * (u[1] * self.log).exp_m1()).min(1.0);
        let [sin, cos] = sin_cos_turn(u[0]);
        let radius = (1.0 - square).sqrt();
        DVec3::new(radius * cos, radius * sin, square.sqrt())
    }

    /// Density by solid angle of a direction with this cosine.
    #[inline(always)]
    pub fn pdf(&self, cosine: f64) -> f64 {
        FRAC_1_PI * cosine / ((cosine * cosine + self.square) * self.log)
    }
}
