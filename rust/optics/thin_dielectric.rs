//! A pane of glass.

use super::bsdf::either;
use super::mirror::mirrored;
use super::{Bsdf, BsdfSample, BsdfSampleLanes, Rgb, RgbLanes, fresnel};
use crate::math::{LANES, VectorLanes, select};
use crate::simd::{Level, loops};
use glam::DVec3;

/// A plane-parallel dielectric plate without thickness, the same medium on both sides: light reflects and goes straight
/// through, after all reflections within the plate (Stokes, 1862): with r = F(θ) they sum to R = 2r / (1 + r).
#[derive(Clone, Copy, Debug)]
pub struct ThinDielectric {
    eta: f64,
}

impl ThinDielectric {
    /// Of an index of refraction relative to that of the surroundings.
    #[inline(always)]
    pub fn new(eta: f64) -> Self {
        Self { eta }
    }

    /// The share of light that is reflected at such a cosine to the normal, which is not negative.
    #[inline(always)]
    pub fn reflectance(&self, cosine: f64) -> f64 {
        let r = fresnel::dielectric(cosine, self.eta);
        2.0 * r / (1.0 + r)
    }
}

impl Bsdf for ThinDielectric {
    #[inline]
    fn evaluate(&self, _wo: DVec3, _wi: DVec3) -> (Rgb, f64) {
        (Rgb::ZERO, 0.0)
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, _u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let reflectance = self.reflectance(wo.z.abs());
        let is_reflected = choice() < reflectance;
        let drawn = if is_reflected {
            BsdfSample::delta(mirrored(wo), Rgb::ONE)
        } else {
            BsdfSample::delta(-wo, Rgb::ONE).through(1.0)
        };
        Some(drawn.of_lobe(either(reflectance, is_reflected)))
    }

    fn albedo(&self) -> Rgb {
        Rgb::ONE
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn transmits(&self) -> bool {
        true
    }

    fn roughness(&self) -> f64 {
        0.0
    }
}

loops! {
    /// One of two directions in each lane that asks.
    fn draw(
        etas: &[f64; LANES],
        wo: &VectorLanes,
        choice: &[f64; LANES],
        asks: &[bool; LANES],
        wi: &mut VectorLanes,
        weight: &mut RgbLanes,
        pdf: &mut [f64; LANES],
        is_through: &mut [bool; LANES],
    ) {
        for i in 0..LANES {
            let wo = wo.get(i);
            let is_reflected = choice[i] < ThinDielectric::new(etas[i]).reflectance(wo.z.abs());
            wi.set(i, select(is_reflected, mirrored(wo), -wo));
            weight.set(i, Rgb::ONE);
            pdf[i] = if asks[i] & (wo.z != 0.0) { f64::INFINITY } else { 0.0 };
            is_through[i] = !is_reflected;
        }
    }
}

/// The indices of refraction of panes, a lane each.
#[derive(Clone, Debug)]
pub struct ThinDielectricLanes([f64; LANES]);

impl ThinDielectricLanes {
    /// Of nothing yet.
    pub const NONE: Self = Self([1.0; LANES]);

    /// Puts a pane into a lane.
    #[inline]
    pub fn set(&mut self, lane: usize, pane: &ThinDielectric) {
        self.0[lane] = pane.eta;
    }

    /// What [`Bsdf::sample`] gives, in the lanes that ask; nothing in the others.
    pub fn sample(
        &self,
        level: Level,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        choice: &[f64; LANES],
        drawn: &mut BsdfSampleLanes,
    ) {
        let BsdfSampleLanes { wi, weight, pdf, eta, is_through } = drawn;
        draw(level, &self.0, wo, choice, asks, wi, weight, pdf, is_through);
        *eta = [1.0; LANES];
    }
}
