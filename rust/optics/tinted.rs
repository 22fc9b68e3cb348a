//! What is clear, with a colour at its surface.

use super::{Bsdf, BsdfSample, Rgb};
use glam::DVec3;

/// Scatters as another kind does, of which a share is left: one of what stays on its side, one of what goes through.
#[derive(Clone, Copy, Debug)]
pub struct Tinted<B: Bsdf> {
    /// What it is without its colour.
    pub inner: B,
    /// The share that is left of what is reflected, 0 to 1.
    pub reflectance: Rgb,
    /// The share that is left of what goes through, 0 to 1.
    pub transmittance: Rgb,
}

impl<B: Bsdf> Tinted<B> {
    #[inline]
    fn share(&self, is_through: bool) -> Rgb {
        if is_through { self.transmittance } else { self.reflectance }
    }
}

impl<B: Bsdf> Bsdf for Tinted<B> {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        let (value, pdf) = self.inner.evaluate(wo, wi);
        (value * self.share(wo.z * wi.z < 0.0), pdf)
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        let drawn = self.inner.sample(wo, choice, u)?;
        Some(BsdfSample { weight: drawn.weight * self.share(drawn.is_through), ..drawn })
    }

    #[inline]
    fn prepare(&mut self, wo: DVec3) {
        self.inner.prepare(wo);
    }

    fn albedo(&self) -> Rgb {
        self.inner.albedo() * (self.reflectance + self.transmittance) * 0.5
    }

    #[inline]
    fn is_delta(&self) -> bool {
        self.inner.is_delta()
    }

    #[inline]
    fn transmits(&self) -> bool {
        self.inner.transmits()
    }

    #[inline]
    fn roughness(&self) -> f64 {
        self.inner.roughness()
    }
}
