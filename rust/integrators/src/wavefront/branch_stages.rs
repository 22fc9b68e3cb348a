//! The stages of paths that go on in several ways, and of light that is known where they come to.

use super::bsdf_block::BsdfBlock;
use super::queues::Flags;
use super::ways::Way;
use super::worker::WavefrontWorker;
use crate::dimensions::Dimensions;
use crate::is_matt;
use crate::known_light::{Gather, Visit};
use crate::path_settings::Follow;
use raywright_base::math::LANES;
use raywright_base::sampling::SamplerLanes;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::LookupContext;

impl WavefrontWorker<'_> {
    /// The dimensions of sixteen paths, by their branches.
    pub(super) fn dimensions(&self, bounce: u32) -> [Dimensions; LANES] {
        match &self.branches {
            Some(branches) => self.block.sample.map(|sample| Dimensions::of(bounce, branches.number(sample))),
            None => [Dimensions::of(bounce, 0); LANES],
        }
    }

    /// The number of light samples after so many bounces.
    pub(super) fn light_samples(&self, bounce: u32) -> u32 {
        if bounce == 0 { self.settings.light_samples } else { 1 }
    }

    /// Stage: adds ambient and known light at sixteen surfaces, and sets the densities from which on their paths are
    /// followed.
    pub(super) fn look_up_light(&mut self, bounce: u32, radiance: &mut [Rgb]) {
        if self.is_plain {
            return;
        }
        let most = self.settings.max_depth.map(|depth| depth.saturating_sub(bounce + 1));
        for lane in 0..self.block.surfaces.count {
            let (is_known, looks_about) = (self.is_known(lane), self.looks_about(lane));
            let (splits, drawn, least_pdf) =
                (self.splits(bounce, lane), self.light_samples(bounce), self.settings.least_pdf());
            let Self { block, scene, known, samplers, .. } = self;
            let bsdf = &mut block.bsdf;
            bsdf.follows[lane] = f64::from(splits) / f64::from(drawn);
            // Known light is scattered by all lobes but delta lobes.
            bsdf.least_pdf[lane] = if is_known && !looks_about { f64::INFINITY } else { least_pdf };
            bsdf.asks[lane] &= !self.settings.gather.is_some_and(|gather| is_lit(&gather, bsdf, lane, is_known));
            let Some((ray, hit, here)) = block.bsdf.interaction(lane) else { continue };
            let sample = block.sample[lane];
            let throughput = Rgb::from_array(block.throughput.get(lane).as_dvec3().to_array());
            if !self.settings.ambient.is_black() {
                let context = LookupContext { width: block.bsdf.width[lane].into(), waves: block.spectral.waves[lane] };
                let share = here.ambient(scene, ray, hit, context, block.media.outside[lane]);
                radiance[sample as usize] += throughput * share * self.settings.ambient;
            }
            if let (Some(known), Some(samplers), true) = (known, samplers, is_known) {
                let visit = Visit {
                    number: samplers.get(sample as usize).number(),
                    looks_about,
                    has_gamut_excess: block.bsdf.has_gamut_excess(lane),
                    single: block.bsdf.flags[lane] & Flags::SINGLE != 0,
                    bounces: most,
                };
                radiance[sample as usize] += throughput * known.at_surface(&here, visit);
            }
        }
    }

    /// Return whether light at the surface of a lane is known.
    fn is_known(&self, lane: usize) -> bool {
        self.settings.gather.is_some() && is_matt(self.block.bsdf.get(lane))
    }

    /// Return whether final gather rays start at the surface of a lane.
    fn looks_about(&self, lane: usize) -> bool {
        let looks = self.settings.gather.is_some_and(|gather| gather.rays > 0);
        looks && self.block.bsdf.flags[lane] & Flags::IS_GATHERED == 0 && self.is_known(lane)
    }

    /// Return the number of paths that a path is split into; a surface with delta lobes alone splits none, as they
    /// would not differ.
    fn splits(&self, bounce: u32, lane: usize) -> u32 {
        match self.settings.gather {
            Some(gather) if self.looks_about(lane) => gather.rays.max(1),
            Some(_) => 1,
            None if bounce == 0 && !self.block.bsdf.get(lane).is_delta() => self.settings.splits,
            None => 1,
        }
    }

    /// Return whether the path of a lane follows every delta lobe. With known light it does so at glass, as one of the
    /// first surfaces: a path costs less than a look-up there, and a lamp behind two or three reflections within glass
    /// would be found by one sample in a thousand, a thousand times as bright.
    fn follows_each_lobe(&self, bounce: u32, lane: usize) -> bool {
        const SURFACES: u32 = 3;
        if self.settings.follow == Follow::DeltaLobes {
            return true;
        }
        let bsdf = self.block.bsdf.get(lane);
        let is_early = bounce < SURFACES && !self.plays(bounce) && self.block.spectral.parting[lane].is_none();
        let is_gathered = self.block.bsdf.flags[lane] & Flags::IS_GATHERED != 0;
        self.settings.gather.is_some() && bsdf.is_delta() && bsdf.transmits() && is_early && !is_gathered
    }

    /// Stage: sixteen paths go on, each by all of its continuations.
    pub(super) fn scatter_in_all_ways(&mut self, numbers: &SamplerLanes, bounce: u32, samples: u32) {
        if self.is_plain {
            return self.scatter_from_any(numbers, bounce, samples, None);
        }
        let (sample, flags) = (self.block.sample, self.block.bsdf.flags);
        let mut ways = std::mem::take(&mut self.ways);
        ways.clear();
        for lane in 0..self.block.surfaces.count {
            self.find_ways(bounce, lane, &mut ways);
        }
        for way in &ways {
            (self.block.sample, self.block.bsdf.flags) = (way.sample, flags);
            self.scatter_from_any(numbers, bounce, samples, Some(way));
        }
        self.block.sample = sample;
        self.ways = ways;
    }

    /// Finds the continuations of the path of a lane.
    fn find_ways(&mut self, bounce: u32, lane: usize, ways: &mut Vec<Way>) {
        let sample = self.block.sample;
        let before = self.branches.as_ref().map_or(0, |branches| branches.number(sample[lane]));
        if !self.follows_each_lobe(bounce, lane) {
            for number in 0..self.splits(bounce, lane) {
                let way = way(ways, number, sample);
                way.is_drawn[lane] = true;
                way.sample[lane] = if number == 0 { sample[lane] } else { self.split_off(sample[lane], number) };
            }
            return;
        }
        let (mut lobes, bsdf) = (Vec::new(), &self.block.bsdf);
        bsdf.get(lane).delta_lobes(bsdf.wo(lane), |lobe| lobes.push(lobe));
        for (number, lobe) in (0..).zip(lobes) {
            let branch = before.wrapping_mul(2).wrapping_add(number);
            let way = way(ways, number, sample);
            way.lobe[lane] = Some(lobe);
            way.sample[lane] = if number == 0 { sample[lane] } else { self.split_off(sample[lane], branch) };
        }
        if let Some(branches) = &mut self.branches {
            branches.renumber(sample[lane], before.wrapping_mul(2));
        }
    }

    /// A new sample for a branch of the path of another.
    fn split_off(&mut self, sample: u32, number: u32) -> u32 {
        let i = sample as usize;
        if let Some(samplers) = &mut self.samplers {
            samplers.repeat(i);
        }
        if let Some(&waves) = self.waves.get(i) {
            self.waves.push(waves);
        }
        if let Some(media) = &mut self.media {
            media.paths.push(media.paths[i]);
            media.further.push(media.further[i].branch(number));
        }
        self.branches.as_mut().map_or(sample, |branches| branches.split(sample, number))
    }

    /// Stage: weighs one continuation of sixteen paths by their number, and ends those with too small a contribution.
    pub(super) fn weigh_ways(&mut self, bounce: u32) {
        for lane in 0..self.block.surfaces.count {
            let (splits, is_known) = (self.splits(bounce, lane), self.is_known(lane));
            let drawn = self.light_samples(bounce);
            let (next, bsdf) = (&mut self.block.next, &self.block.bsdf);
            next.throughput.set(lane, next.throughput.get(lane) / splits as f32);
            next.pdf[lane] *= splits as f32 / drawn as f32;
            if f64::from(next.throughput.get(lane).max_element() * next.scale[lane]) < self.settings.least {
                next.pdf[lane] = 0.0;
            }
            if let Some(gather) = self.settings.gather {
                let is_gathered = next.flags[lane] & Flags::IS_GATHERED != 0;
                // A coat that is like a mirror is one, whatever lies below.
                if is_known && !bsdf.is_single(lane) {
                    next.flags[lane] = next.flags[lane] & !Flags::IS_LIT | Flags::IS_GATHERED;
                } else if is_gathered && gather.caustic {
                    next.flags[lane] |= Flags::IS_LIT;
                }
            }
        }
    }
}

/// Return whether direct light at a surface was part of the look-up that its final gather ray started from.
fn is_lit(gather: &Gather, bsdf: &BsdfBlock<'_>, lane: usize, is_known: bool) -> bool {
    gather.caustic && !is_known && bsdf.flags[lane] & Flags::IS_GATHERED != 0
}

/// A way by its number.
fn way(ways: &mut Vec<Way>, number: u32, sample: [u32; LANES]) -> &mut Way {
    let number = number as usize;
    if ways.len() <= number {
        ways.push(Way::of(sample));
    }
    &mut ways[number]
}
