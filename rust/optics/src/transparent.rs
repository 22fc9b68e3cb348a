//! Straight transmission.

use super::bsdf_columns::LaneBsdf;
use super::soa_lanes::Straight;
use super::{Bsdf, BsdfSample, Rgb};
use glam::DVec3;
use raywright_base::math::in_lanes;

/// Transmits light straight, entirely or partly: the holes of a mask.
#[derive(Clone, Copy, Debug)]
pub struct Transparent {
    /// Transmittance, 0 to 1.
    pub transmittance: Rgb,
}

impl Bsdf for Transparent {
    #[inline(always)]
    fn evaluate(&self, _wo: DVec3, _wi: DVec3) -> (Rgb, f64) {
        (Rgb::ZERO, 0.0)
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, _choice: &mut dyn FnMut() -> f64, _u: [f64; 2]) -> Option<BsdfSample> {
        (!self.transmittance.is_black()).then(|| BsdfSample::delta(-wo, self.transmittance).through(1.0))
    }

    fn albedo(&self) -> Rgb {
        self.transmittance
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
    /// Transmittances, one per lane.
    TransparentLanes of Transparent { transmittance: Rgb }
}

impl LaneBsdf for Transparent {
    type Lanes = Straight<Self>;
}
