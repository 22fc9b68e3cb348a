//! A perfectly black surface.

use super::bsdf_columns::LaneBsdf;
use super::scalar_lanes::Looped;
use super::{Bsdf, BsdfSample, Rgb};
use glam::DVec3;

/// Absorbs all light: a black surface, or a pure emitter. For surfaces that light passes unchanged, see
/// [`super::Transparent`].
#[derive(Clone, Copy, Debug)]
pub struct Null;

impl Bsdf for Null {
    #[inline(always)]
    fn evaluate(&self, _wo: DVec3, _wi: DVec3) -> (Rgb, f64) {
        (Rgb::ZERO, 0.0)
    }

    #[inline(always)]
    fn sample(&self, _wo: DVec3, _choice: &mut dyn FnMut() -> f64, _u: [f64; 2]) -> Option<BsdfSample> {
        None
    }

    fn albedo(&self) -> Rgb {
        Rgb::ZERO
    }

    fn is_delta(&self) -> bool {
        true
    }
}

impl LaneBsdf for Null {
    type Lanes = Looped;
}
