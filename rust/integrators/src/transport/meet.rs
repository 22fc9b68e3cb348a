//! How surfaces scatter that paths have come to.

use super::block::Block;
use super::guided::Arrival;
use super::worker::TransportWorker;
use crate::CameraSample;
use crate::dimensions::Dimensions;
use crate::nesting::MediumStack;
use raywright_base::math::{LANES, Ray, VectorLanes};
use raywright_base::simd::loops;
use raywright_optics::{Bsdf, Diffuse, Rgb};
use raywright_scene::{
    Interaction, LightContextLanes, LightSampleContext, SurfaceInteraction, SurfaceInteractionLanes,
};
use std::borrow::Cow;

loops! {
    /// From rays that meet surfaces to what is known of the encounters, where nothing is asked of a material but how it
    /// scatters, and it lets no light through.
    fn meet(
        directions: &VectorLanes,
        encounters: &mut SurfaceInteractionLanes,
        receivers: &mut LightContextLanes,
    ) {
        for i in 0..LANES {
            let surface = encounters.surface(i);
            let ray = Ray::new(surface.position, directions.get(i));
            let normal = (surface.shading_normal, None);
            let here = SurfaceInteraction::with(&ray, surface, normal, Diffuse { reflectance: Rgb::ZERO });
            encounters.set(i, &here);
            receivers.set(i, &here.light_context());
        }
    }
}

impl<'a> TransportWorker<'a> {
    /// Finds out how surfaces scatter.
    pub(super) fn meet(&mut self, block: &mut Block<'a>, samples: &mut [CameraSample], radiance: &mut [Rgb]) {
        let mut directions = VectorLanes::ZERO;
        for lane in 0..LANES {
            directions.set(lane, block.rays[lane].direction);
        }
        block.encounters.set_surfaces(&block.surfaces);
        meet(self.level, &directions, &mut block.encounters, &mut block.receivers);
        self.set_waves(block);
        for lane in 0..LANES {
            let path = &block.paths[lane];
            block.numbers.set(lane, &samples[path.sample as usize].sampler);
            block.dimensions[lane] = Dimensions::of(path.bounce, self.carried(block, lane).branch);
        }
        if block.is_diffuse {
            for lane in 0..LANES {
                let (surface, ray) = (block.surfaces.get(lane), block.rays[lane]);
                let constant = self.scene.plan().diffuse(surface.shape).filter(|_| block.width[lane] == 0.0);
                let reflectance = match constant {
                    Some([front, back]) => {
                        if surface.is_front(&ray) {
                            front
                        } else {
                            back
                        }
                    }
                    None => self.textured(block, lane),
                };
                block.reflectance.set(lane, reflectance);
            }
        } else {
            self.meet_others(block, samples, radiance);
        }
        for lane in 0..LANES {
            block.throughput.set(lane, block.paths[lane].throughput);
        }
    }

    /// What a diffuse surface reflects that is not alike everywhere, or is seen by a ray that has a width. A padded
    /// lane is left as it is.
    fn textured(&self, block: &mut Block, lane: usize) -> Rgb {
        if lane >= block.count {
            return Rgb::ZERO;
        }
        let (ray, hit, surface) = (&block.rays[lane], &block.hits[lane], block.surfaces.get(lane));
        let here = SurfaceInteraction::new(self.scene, ray, hit, surface, self.gaze(block, lane), 1.0);
        block.encounters.set(lane, &here);
        block.receivers.set(lane, &here.light_context());
        here.bsdf().diffuse().unwrap_or(Rgb::ZERO)
    }

    /// Asks materials how they scatter, and all that follows from that.
    fn meet_others(&mut self, block: &mut Block<'a>, samples: &mut [CameraSample], radiance: &mut [Rgb]) {
        block.bsdf.clear();
        for lane in 0..block.count {
            let (surface, width) = (block.surfaces.get(lane), block.width[lane]);
            let outside = if self.passing.is_nested() { self.boundary(block, lane).0 } else { 1.0 };
            let (ray, hit) = (block.rays[lane], block.hits[lane]);
            let (gaze, (outside, parting)) = (self.gaze(block, lane), self.parting(block, lane, &surface, outside));
            let bsdf = match self.scene.plan().constant(surface.shape, surface.is_front(&ray)) {
                Some(bsdf) if outside == 1.0 && width == 0.0 => Cow::Borrowed(bsdf),
                _ => {
                    let here = SurfaceInteraction::new(self.scene, &ray, &hit, surface, gaze, outside);
                    block.encounters.set(lane, &here);
                    block.receivers.set(lane, &here.light_context());
                    Cow::Owned(here.into_bsdf())
                }
            };
            block.parting[lane] = parting.filter(|parting| parting.waits(&*bsdf));
            if parting.is_some() && block.parting[lane].is_none() {
                block.paths[lane].end_all_but_hero();
            }
            if bsdf.transmits() {
                block.receivers.set(lane, &LightSampleContext::free(surface.position));
            }
            block.bsdf.push(bsdf);
            if !block.goes_on[lane] {
                continue;
            }
            let mut path = block.paths[lane];
            let wo = block.encounters.get(lane, block.bsdf.get(lane)).wo();
            block.bsdf.prepare(wo);
            let here = block.encounters.get(lane, block.bsdf.get(lane));
            path.meet(here.bsdf().repeat_correction());
            if self.guide.is_some() {
                let sampler = &mut samples[path.sample as usize].sampler;
                let number = || sampler.one(block.dimensions[lane].roulette());
                (block.guides[lane], block.arrivals[lane]) = self.guided(&mut path, &here, number);
            }
            block.goes_on[lane] = block.arrivals[lane] != Arrival::Ends;
            if block.goes_on[lane] {
                let light = &mut radiance[path.sample as usize];
                self.add_ambient(&here, (&ray, &hit), (gaze, outside), path.throughput, light);
            }
            block.paths[lane] = path;
            if block.goes_on[lane] {
                let number = samples[path.sample as usize].sampler.number();
                radiance[path.sample as usize] += self.known_light(block, lane, number);
            }
        }
    }

    /// In a scene of nested media, the index of refraction on the other side of what the surface of a lane encloses,
    /// and what a ray that goes through is in.
    #[inline]
    pub(super) fn boundary(&self, block: &Block, lane: usize) -> &(f64, MediumStack) {
        &self.arrivals.boundaries[block.index[lane] as usize]
    }
}
