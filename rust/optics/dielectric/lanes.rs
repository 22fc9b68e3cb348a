//! Smooth glass by lane.

use super::{Dielectric, Single, beyond};
use crate::math::{LANES, VectorLanes};
use crate::optics::{BsdfSampleLanes, Facets, Ggx, Rgb, RgbLanes, fresnel};
use crate::simd::{Level, loops};

/// What is known of smooth dielectric interfaces, a lane each: the index below over the index above.
#[derive(Clone, Debug)]
pub struct DielectricLanes([f64; LANES]);

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
        eta: &mut [f64; LANES],
        is_through: &mut [bool; LANES],
    ) {
        for i in 0..LANES {
            let wo = wo.get(i);
            let over = beyond(etas[i], wo);
            let drawn = Single::new(wo, over, fresnel::dielectric(wo.z.abs(), over), choice[i]);
            wi.set(i, drawn.wi);
            weight.set(i, Rgb::splat(drawn.weight));
            pdf[i] = if asks[i] & Ggx::sees(wo) & drawn.is_any { f64::INFINITY } else { 0.0 };
            eta[i] = if drawn.is_through { over } else { 1.0 };
            is_through[i] = drawn.is_through;
        }
    }
}

impl DielectricLanes {
    /// Of nothing yet.
    pub const NONE: Self = Self([1.0; LANES]);

    /// Puts an interface into a lane; says whether it could, which is not the case if it is rough.
    #[inline]
    pub fn set(&mut self, lane: usize, interface: &Dielectric) -> bool {
        self.0[lane] = interface.eta;
        interface.rough.is_none()
    }

    /// What [`crate::optics::Bsdf::sample`] gives, in the lanes that ask; nothing in the others.
    pub fn sample(
        &self,
        level: Level,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        choice: &[f64; LANES],
        drawn: &mut BsdfSampleLanes,
    ) {
        let BsdfSampleLanes { wi, weight, pdf, eta, is_through } = drawn;
        draw(level, &self.0, wo, choice, asks, wi, weight, pdf, eta, is_through);
    }
}
