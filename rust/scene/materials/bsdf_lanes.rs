//! How sixteen points scatter light.

use super::BsdfMix;
use crate::math::{DVec3, LANES, VectorLanes};
use crate::optics::{AnyBsdf, Bsdf, BsdfSampleLanes, Conductor, ConductorLanes, RgbLanes};
use crate::sampling::Pairs;
use crate::scene::SurfaceInteractionLanes;
use crate::simd::Level;

/// How points scatter light, a lane each; there may be fewer than lanes.
#[derive(Clone, Debug)]
pub struct BsdfLanes {
    each: Vec<BsdfMix>,
    /// Of rough metals, what lanes have of them.
    metals: ConductorLanes,
    /// Whether all are rough metals.
    are_metals: bool,
}

impl BsdfLanes {
    /// None.
    pub fn new() -> Self {
        Self { each: Vec::with_capacity(LANES), metals: ConductorLanes::NONE, are_metals: true }
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.each.clear();
        self.are_metals = true;
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

    /// Prepares that of the last lane for a direction in its shading frame ([`Bsdf::prepare`]).
    #[inline]
    pub fn prepare(&mut self, wo: DVec3) {
        let lane = self.each.len() - 1;
        self.each[lane].prepare(wo);
        self.are_metals &= match &self.each[lane] {
            BsdfMix::One(AnyBsdf::Conductor(metal)) => self.metals.set(lane, metal, wo),
            _ => false,
        };
    }

    fn metal(&self, lane: usize) -> Option<&Conductor> {
        match self.each.get(lane) {
            Some(BsdfMix::One(AnyBsdf::Conductor(metal))) => Some(metal),
            _ => None,
        }
    }

    /// What [`Bsdf::evaluate`] gives at encounters, for which all were prepared, for directions in their shading
    /// frames, in the lanes that ask.
    pub fn evaluate(
        &self,
        level: Level,
        asks: &[bool; LANES],
        encounters: &SurfaceInteractionLanes,
        wi: &VectorLanes,
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        if self.are_metals {
            return self.metals.evaluate(level, |lane| self.metal(lane), asks, wi, value, pdf);
        }
        for (lane, bsdf) in self.each.iter().enumerate().filter(|&(lane, _)| asks[lane]) {
            let (of_lane, density) = bsdf.evaluate(encounters.wo(lane), wi.get(lane));
            value.set(lane, of_lane);
            pdf[lane] = density;
        }
    }

    /// What [`Bsdf::sample`] gives for their encounters, in shading frames, in the lanes that ask; nothing in the others.
    pub fn sample(
        &self,
        level: Level,
        asks: &[bool; LANES],
        encounters: &SurfaceInteractionLanes,
        (choice, u): (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) {
        if self.are_metals {
            return self.metals.sample(level, |lane| self.metal(lane), asks, (choice, u), drawn);
        }
        drawn.pdf = [0.0; LANES];
        for (lane, bsdf) in self.each.iter().enumerate().filter(|&(lane, _)| asks[lane]) {
            let u = [u[0][lane], u[1][lane]];
            drawn.set(lane, bsdf.sample(encounters.wo(lane), || choice[lane], u));
        }
    }
}
