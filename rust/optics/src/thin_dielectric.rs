//! A thin dielectric pane.

use super::bsdf::either;
use super::bsdf_columns::LaneBsdf;
use super::mirror::mirrored;
use super::soa_lanes::Straight;
use super::{Bsdf, BsdfSample, Rgb, fresnel};
use glam::DVec3;
use raywright_base::math::{in_lanes, select};

/// A plane-parallel dielectric plate without thickness, with the same medium on both sides. Light reflects or goes
/// straight through, after all internal reflections (Stokes, 1862): with r = F(θ) they sum to R = 2r / (1 + r).
#[derive(Clone, Copy, Debug)]
pub struct ThinDielectric {
    eta: f64,
}

impl ThinDielectric {
    /// Creates a pane with an index of refraction relative to its surroundings.
    #[inline(always)]
    pub fn new(eta: f64) -> Self {
        Self { eta: fresnel::bounded(eta) }
    }

    /// Reflectance at a non-negative cosine to the normal.
    #[inline(always)]
    pub fn reflectance(&self, cosine: f64) -> f64 {
        let r = fresnel::dielectric(cosine, self.eta);
        2.0 * r / (1.0 + r)
    }
}

impl Bsdf for ThinDielectric {
    #[inline(always)]
    fn evaluate(&self, _wo: DVec3, _wi: DVec3) -> (Rgb, f64) {
        (Rgb::ZERO, 0.0)
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, _u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let reflectance = self.reflectance(wo.z.abs());
        let is_reflected = choice() < reflectance;
        let drawn = BsdfSample::delta(select(is_reflected, mirrored(wo), -wo), Rgb::ONE);
        let choices = either(reflectance, is_reflected);
        Some(BsdfSample { is_through: !is_reflected, choices, ..drawn })
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

in_lanes! {
    /// Indices of refraction, one per lane.
    ThinDielectricLanes of ThinDielectric { eta: f64 }
}

impl LaneBsdf for ThinDielectric {
    type Lanes = Straight<Self>;
}
