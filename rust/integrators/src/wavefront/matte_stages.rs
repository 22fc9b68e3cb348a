//! The stages that take sixteen paths from matte surfaces to their next rays.

use super::path_block::bits;
use super::queues::{Flags, PathLanes};
use super::worker::WavefrontWorker;
use super::{direct_light, matte};
use crate::dimensions::Dimensions;
use raywright_base::math::{LANES, Ray, SingleLanes};
use raywright_base::sampling::SamplerLanes;
use raywright_base::timing::{Part, timed};
use raywright_scene::ReceiverBlock;

impl WavefrontWorker<'_> {
    /// Takes sixteen paths from matte surfaces to their next rays.
    pub(super) fn leave_matte(&mut self, numbers: &SamplerLanes, bounce: u32, samples: u32) {
        timed(Part::Scattering, || self.reflectances.gather(&self.block.surfaces, &mut self.block.reflectance));
        if bounce < 2 && self.sharing.is_some() {
            self.visit(bounce, samples);
        }
        if self.extra.media {
            self.share_beyond_medium(samples, |worker, lane| Some((worker.block.surfaces.normal.get(lane), false)));
        }
        if !self.scene.lights().is_dark() {
            timed(Part::Light, || self.ask_for_light(numbers, bounce));
        }
        if self.follows {
            timed(Part::Continuation, || self.scatter(numbers, bounce));
        }
    }

    /// Stage: light is drawn for sixteen surfaces, and its shadow rays are queued.
    fn ask_for_light(&mut self, numbers: &SamplerLanes, bounce: u32) {
        let block = &mut *self.block;
        let (mut choice, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        let dimension = Dimensions::of(bounce, 0).light_choice(0);
        let (lights, geometry) = (self.scene.lights(), self.scene.geometry());
        if lights.choices_are_even() {
            let mut chance = [0.0; LANES];
            numbers.chance_and_pair(self.level, dimension, &mut chance, &mut u);
            choice = chance.map(f64::from);
        } else {
            numbers.choice_and_pair(self.level, dimension, &mut choice, &mut u);
        }
        let receivers =
            ReceiverBlock { surfaces: &block.surfaces, normal: &block.surfaces.normal, waves: &block.spectral.waves };
        lights.draw_block(self.level, geometry, &receivers, &choice, &u, &mut block.lights);
        let (mut arriving, mut is_lit) = (SingleLanes::ZERO, [0; LANES]);
        let mut follows = if self.follows { 1.0 } else { 0.0 };
        if self.extra.media {
            // Weighed when it arrives.
            direct_light::compare(&block.surfaces, &block.lights, follows, &mut block.media.ratio);
            (block.media.of_shadows, follows) = (block.media.here, 0.0);
        }
        direct_light::reflect(
            self.level,
            &block.surfaces,
            &block.lights,
            &block.reflectance,
            &block.throughput,
            follows,
            &mut arriving,
            &mut is_lit,
        );
        let mask = bits(&is_lit, block.surfaces.count);
        self.block.queue_shadows(self.level, mask, (&self.block.surfaces.origin, &arriving), &mut self.shadows);
    }

    /// Stage: sixteen paths go on from matte surfaces, unless roulette ends them.
    fn scatter(&mut self, numbers: &SamplerLanes, bounce: u32) {
        let plays = self.plays(bounce);
        let block = &mut *self.block;
        let (mut chance, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        // A matte surface scatters in one way: what would choose among several plays roulette.
        numbers.chance_and_pair(self.level, Dimensions::of(bounce, 0).scattering_choice(), &mut chance, &mut u);
        let (mut direction, mut pdf) = (SingleLanes::ZERO, [0.0; LANES]);
        let normal = &block.surfaces.normal;
        matte::sample(self.level, normal, &u, &block.reflectance, &mut block.throughput, &mut direction, &mut pdf);
        if plays {
            matte::play(self.level, &chance, &block.bsdf.scale, &mut block.throughput);
        }
        let mut goes_on = [0; LANES];
        matte::survive(self.level, &block.throughput, &pdf, &mut goes_on);
        let misses = std::array::from_fn(|lane| [block.surfaces.primitive[lane], Ray::NO_TRIANGLE]);
        let paths = PathLanes {
            origin: &block.surfaces.origin,
            direction: &direction,
            misses: &misses,
            throughput: &block.throughput,
            pdf: &pdf,
            normal,
            sample: &block.sample,
            scale: &block.bsdf.scale,
            flags: &block.bsdf.flags.map(|flags| flags & !Flags::ASKED_EACH),
            aimed: &block.bsdf.guided.aimed,
            width: &block.bsdf.width,
            spread: &block.bsdf.spread,
            time: &block.time,
        };
        self.paths[1].push(self.level, bits(&goes_on, block.surfaces.count), &paths);
    }
}
