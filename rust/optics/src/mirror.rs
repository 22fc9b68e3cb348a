//! A perfect mirror.

use super::bsdf_columns::LaneBsdf;
use super::soa_lanes::Straight;
use super::{Bsdf, BsdfSample, Rgb};
use glam::DVec3;
use raywright_base::math::in_lanes;

/// A perfect specular reflector with the same reflectance at every angle. Both sides reflect.
#[derive(Clone, Copy, Debug)]
pub struct Mirror {
    /// Reflectance, 0 to 1.
    pub reflectance: Rgb,
}

/// Mirrors a direction about the normal.
#[inline(always)]
pub(super) fn mirrored(w: DVec3) -> DVec3 {
    DVec3::new(-w.x, -w.y, w.z)
}

impl Bsdf for Mirror {
    #[inline(always)]
    fn evaluate(&self, _wo: DVec3, _wi: DVec3) -> (Rgb, f64) {
        (Rgb::ZERO, 0.0)
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, _choice: &mut dyn FnMut() -> f64, _u: [f64; 2]) -> Option<BsdfSample> {
        (wo.z != 0.0 && !self.reflectance.is_black()).then(|| BsdfSample::delta(mirrored(wo), self.reflectance))
    }

    fn albedo(&self) -> Rgb {
        self.reflectance
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn roughness(&self) -> f64 {
        0.0
    }
}

in_lanes! {
    /// Reflectances, one per lane.
    MirrorLanes of Mirror { reflectance: Rgb }
}

impl LaneBsdf for Mirror {
    type Lanes = Straight<Self>;
}
