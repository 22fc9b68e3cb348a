//! A perfect mirror.

use super::{Bsdf, BsdfSample, BsdfSampleLanes, Rgb, RgbLanes};
use crate::math::{LANES, VectorLanes};
use crate::simd::{Level, loops};
use glam::DVec3;

/// Reflects into the one direction that Euclid's law of reflection says, the same share at every angle. Both sides
/// reflect.
#[derive(Clone, Copy, Debug)]
pub struct Mirror {
    /// The share of the light that is reflected, 0 to 1.
    pub reflectance: Rgb,
}

/// The mirror image of a direction about the normal.
#[inline(always)]
pub(super) fn mirrored(w: DVec3) -> DVec3 {
    DVec3::new(-w.x, -w.y, w.z)
}

impl Bsdf for Mirror {
    #[inline]
    fn evaluate(&self, _wo: DVec3, _wi: DVec3) -> (Rgb, f64) {
        (Rgb::ZERO, 0.0)
    }

    #[inline]
    fn sample(&self, wo: DVec3, _choice: impl FnOnce() -> f64, _u: [f64; 2]) -> Option<BsdfSample> {
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

loops! {
    /// Mirror images, in the lanes that ask, of which so much is left.
    fn mirror(
        wo: &VectorLanes,
        asks: &[bool; LANES],
        reflectance: &RgbLanes,
        wi: &mut VectorLanes,
        weight: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            wi.set(i, mirrored(wo.get(i)));
            weight.set(i, reflectance.get(i));
            pdf[i] = if asks[i] { f64::INFINITY } else { 0.0 };
        }
    }
}

/// What mirrors reflect, a lane each.
#[derive(Clone, Debug)]
pub struct MirrorLanes(pub(super) RgbLanes);

impl MirrorLanes {
    /// Of nothing yet.
    pub const NONE: Self = Self(RgbLanes::ZERO);

    /// Puts what is reflected into a lane.
    #[inline]
    pub fn set(&mut self, lane: usize, reflectance: Rgb) {
        self.0.set(lane, reflectance);
    }

    /// What [`Mirror`] gives as [`Bsdf::sample`], in the lanes that ask; nothing in the others.
    pub fn sample(&self, level: Level, asks: &[bool; LANES], wo: &VectorLanes, drawn: &mut BsdfSampleLanes) {
        let mirrors = |lane: usize| asks[lane] && wo.get(lane).z != 0.0 && !self.0.get(lane).is_black();
        self.sample_all(level, &std::array::from_fn(mirrors), wo, drawn);
    }

    /// The same where the lanes that ask are known to mirror.
    pub(super) fn sample_all(&self, level: Level, asks: &[bool; LANES], wo: &VectorLanes, drawn: &mut BsdfSampleLanes) {
        let BsdfSampleLanes { wi, weight, pdf, eta, is_through } = drawn;
        mirror(level, wo, asks, &self.0, wi, weight, pdf);
        (*eta, *is_through) = ([1.0; LANES], [false; LANES]);
    }
}
