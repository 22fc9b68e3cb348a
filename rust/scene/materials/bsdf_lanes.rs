//! How sixteen points scatter light.

use super::BsdfMix;
use crate::math::{LANES, VectorLanes};
use crate::optics::{Bsdf, RgbLanes};
use crate::scene::SurfaceInteractionLanes;
use crate::simd::Level;

/// How points scatter light, a lane each; there may be fewer than lanes.
#[derive(Clone, Debug, Default)]
pub struct BsdfLanes {
    each: Vec<BsdfMix>,
}

impl BsdfLanes {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.each.clear();
    }

    /// Puts one into the next lane.
    #[inline]
    pub fn push(&mut self, bsdf: BsdfMix) {
        self.each.push(bsdf);
    }

    /// That of a lane.
    #[inline]
    pub fn get(&self, lane: usize) -> &BsdfMix {
        &self.each[lane]
    }

    /// That of a lane.
    #[inline]
    pub fn get_mut(&mut self, lane: usize) -> &mut BsdfMix {
        &mut self.each[lane]
    }

    /// What [`Bsdf::evaluate`] gives at encounters for directions in their shading frames, in the lanes that ask.
    pub fn evaluate(
        &self,
        _level: Level,
        asks: &[bool; LANES],
        encounters: &SurfaceInteractionLanes,
        wi: &VectorLanes,
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for (lane, bsdf) in self.each.iter().enumerate().filter(|&(lane, _)| asks[lane]) {
            let (of_lane, density) = bsdf.evaluate(encounters.wo(lane), wi.get(lane));
            value.set(lane, of_lane);
            pdf[lane] = density;
        }
    }
}
