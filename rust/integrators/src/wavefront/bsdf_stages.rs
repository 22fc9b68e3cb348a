//! The stages that take sixteen paths from surfaces of any kind to their next rays.

use super::matte;
use super::path_block::bits;
use super::queues::{Flags, PathLanes, own};
use super::ways::Way;
use super::worker::WavefrontWorker;
use crate::dimensions::Dimensions;
use crate::path_settings::stratum;
use crate::resampling::ResampledLanes;
use raywright_base::math::{LANES, Ray, SingleLanes, VectorLanes};
use raywright_base::sampling::{Pairs, SamplerLanes};
use raywright_base::timing::{Part, timed};
use raywright_optics::{Bsdf, Rgb, RgbLanes};
use raywright_scene::{LightBlock, ReceiverBlock};

impl WavefrontWorker<'_> {
    /// Takes sixteen paths from surfaces of any kind to their next rays.
    pub(super) fn leave_any(&mut self, numbers: &SamplerLanes, bounce: u32, samples: u32, radiance: &mut [Rgb]) {
        timed(Part::Scattering, || {
            self.evaluate_materials(numbers, bounce);
            self.correct_repeats();
        });
        if self.takes_f64 {
            self.block.bsdf.asks_each = [false; LANES];
        }
        self.look_up_light(bounce, radiance);
        if bounce < 2 && self.sharing.is_some() {
            for lane in 0..self.block.surfaces.count {
                if let Some((reflectance, normal, is_bent)) = self.block.bsdf.matte(&self.block.surfaces, lane) {
                    self.visit_lane(lane, (reflectance.as_vec3(), normal, is_bent), bounce, samples);
                }
            }
        }
        if self.extra.media {
            self.share_beyond_medium(samples, |worker, lane| {
                let (_, normal, is_bent) = worker.block.bsdf.matte(&worker.block.surfaces, lane)?;
                Some((normal, is_bent))
            });
        }
        if !self.scene.lights().is_dark() && self.block.bsdf.asks.contains(&true) {
            let count = self.light_samples(bounce);
            for number in 0..count {
                timed(Part::Light, || {
                    if self.takes_f64 {
                        self.ask_for_light_in_f64(bounce, (number, count), samples);
                    } else {
                        self.ask_for_light_of_any(numbers, bounce, (number, count));
                    }
                });
            }
        }
        if self.follows {
            timed(Part::Continuation, || self.scatter_in_all_ways(numbers, bounce, samples));
        }
    }

    /// Stage: materials are asked how sixteen surfaces scatter.
    pub(super) fn evaluate_materials(&mut self, numbers: &SamplerLanes, bounce: u32) {
        let block = &mut *self.block;
        let mut chance = [0.0; LANES];
        if self.extra.aimed && block.bsdf.guided.aimed.iter().any(|&aimed| aimed > 1.0) {
            numbers.one(self.level, &[Dimensions::of(bounce, 0).roulette(); LANES], &mut chance);
        }
        let met = (&self.paths[0].rays, &self.hits[..]);
        let throughput = &mut block.throughput;
        let around = (&block.media.outside, &mut block.spectral);
        let surfaces = &block.surfaces;
        block.bsdf.evaluate_materials(self.level, self.scene, met, surfaces, around, &chance, throughput);
        self.end_wavelengths();
    }

    /// Stage: paths that have met a reflectance above 1 have the remaining share of the next one.
    pub(super) fn correct_repeats(&mut self) {
        let block = &mut *self.block;
        for lane in 0..block.surfaces.count {
            let again = block.bsdf.get(lane).repeat_correction();
            if again != Rgb::ONE {
                if block.bsdf.has_gamut_excess(lane) {
                    block.throughput.set(lane, block.throughput.get(lane) * again.as_vec3());
                }
                block.bsdf.flags[lane] |= Flags::HAS_GAMUT_EXCESS;
            }
        }
    }

    /// Stage: directions are drawn from sixteen BSDFs.
    pub(super) fn sample_bsdfs(&mut self, (choice, u): (&mut [f64; LANES], &Pairs), way: Option<&Way>) {
        let block = &mut *self.block;
        let next = &mut block.next;
        block.bsdf.sample(self.level, &block.surfaces, &block.throughput, (choice, u), way, next);
    }

    /// Stage: draws one of several light samples for sixteen surfaces, stratified over the lights, and queues its
    /// shadow rays. Where surfaces are glossy and lights few, it draws one of each, and keeps one of these.
    fn ask_for_light_of_any(&mut self, numbers: &SamplerLanes, bounce: u32, (number, count): (u32, u32)) {
        let dimensions = self.dimensions(bounce);
        let (level, block) = (self.level, &mut *self.block);
        // Among media it is weighed when it arrives.
        let (is_found, share) = (self.follows && !self.extra.media, 1.0 / f64::from(count));
        let (lights, geometry) = (self.scene.lights(), self.scene.geometry());
        let (mut choice, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        let of = |number: u32| dimensions.map(|dimensions| dimensions.light_choice(number));
        let asks = block.bsdf.asks;
        let asks_each: [bool; LANES] = std::array::from_fn(|lane| asks[lane] && block.bsdf.asks_each[lane]);
        let asks_one: [bool; LANES] = std::array::from_fn(|lane| asks[lane] && !asks_each[lane]);
        let surfaces = &block.surfaces;
        let normal = block.bsdf.normal;
        let receivers = ReceiverBlock { surfaces, normal: &normal, waves: &block.spectral.waves };
        let mut arriving = RgbLanes::ZERO;
        if asks_one.contains(&true) {
            numbers.choices_and_pairs(level, &of(number), &mut choice, &mut u);
            let choice = choice.map(|choice| stratum(choice, (number, count)));
            lights.draw_block(level, geometry, &receivers, &choice, &u, &mut block.lights);
            let asks = (&asks_one, is_found, share);
            block.bsdf.reflect(level, surfaces, &block.lights, &block.throughput, asks, &mut arriving);
            for lane in (0..LANES).filter(|&lane| asks_one[lane]) {
                block.media.ratio[lane] = block.bsdf.ratio(lane, block.bsdf.pdf[lane], block.lights.pdf[lane]);
            }
        }
        if asks_each.contains(&true) {
            let first = number.wrapping_mul(lights.few());
            numbers.choices_and_pairs(level, &of(first), &mut choice, &mut u);
            let mut all = ResampledLanes::new(choice.map(|choice| stratum(choice, (number, count))));
            self.each.resize(lights.few() as usize, LightBlock::NONE);
            self.each_pdf.resize(self.each.len(), [0.0; LANES]);
            for (one, drawn) in (0u32..).zip(&mut self.each) {
                let mut of_one = RgbLanes::ZERO;
                numbers.choices_and_pairs(level, &of(first.wrapping_add(one)), &mut choice, &mut u);
                lights.draw_one_block(one, level, geometry, &receivers, &choice, &u, drawn);
                let asks = (&asks_each, is_found, share);
                block.bsdf.reflect(level, surfaces, drawn, &block.throughput, asks, &mut of_one);
                all.add(level, one.into(), &of_one);
                self.each_pdf[one as usize] = block.bsdf.pdf;
            }
            for lane in 0..surfaces.count {
                if let Some((one, brings)) = all.kept(lane) {
                    block.lights.copy(lane, &self.each[one]);
                    arriving.set(lane, brings);
                    let (pdf, drawn) = (self.each_pdf[one][lane], self.each[one].pdf[lane]);
                    block.media.ratio[lane] = block.bsdf.ratio(lane, pdf, drawn);
                }
            }
        }
        if !self.follows {
            block.media.ratio = [0.0; LANES];
        }
        let (mut origin, mut brings, mut lit) = (VectorLanes::ZERO, SingleLanes::ZERO, 0u32);
        for lane in 0..surfaces.count {
            let towards = block.lights.direction.get(lane).dot(surfaces.normal.get(lane));
            let is_behind = towards < 0.0;
            let side = if is_behind { surfaces.origin_behind(lane) } else { surfaces.origin.get(lane) };
            let (here, through) = (block.media.here[lane], block.media.through[lane]);
            block.media.of_shadows[lane] = if is_behind { through } else { here };
            origin.set(lane, side);
            brings.set(lane, arriving.get(lane).as_vec3());
            lit |= u32::from(!arriving.get(lane).is_black()) << lane;
        }
        self.block.queue_shadows(level, lit, (&origin, &brings), &mut self.shadows);
    }

    /// Stage: sixteen paths go on from surfaces of any kind, in one of several ways if there are any, unless roulette
    /// ends them.
    pub(super) fn scatter_from_any(&mut self, numbers: &SamplerLanes, bounce: u32, samples: u32, way: Option<&Way>) {
        let dimensions = self.dimensions(bounce).map(Dimensions::scattering_choice);
        let (mut choice, mut single) = ([0.0; LANES], [[0.0; LANES]; 2]);
        numbers.choices_and_pairs(self.level, &dimensions, &mut choice, &mut single);
        self.sample_bsdfs((&mut choice, &single.map(|u| u.map(f64::from))), way);
        self.go_on_from_any(numbers, bounce, samples, way);
    }

    /// Stage: sixteen paths go on in directions that were drawn, unless roulette ends them.
    pub(super) fn go_on_from_any(&mut self, numbers: &SamplerLanes, bounce: u32, samples: u32, way: Option<&Way>) {
        let (plays, dimensions, level) = (self.plays(bounce), self.dimensions(bounce), self.level);
        self.part_wavelengths();
        if way.is_some() {
            self.weigh_ways(bounce);
        }
        let block = &mut *self.block;
        if let Some(media) = &mut self.media {
            for lane in (0..block.surfaces.count).filter(|&lane| block.bsdf.is_through(lane)) {
                media.paths[own(block.sample[lane], samples) as usize].media = block.media.through[lane];
            }
        }
        let (guided, next) = (&block.bsdf.guided, &mut block.next);
        if plays {
            let mut chance = [0.0; LANES];
            numbers.one(level, &dimensions.map(Dimensions::roulette), &mut chance);
            let before = next.throughput;
            // No light is lost where it is small only because of the index of refraction, or because paths were aimed.
            let scale = std::array::from_fn(|lane| next.scale[lane] * guided.aimed[lane]);
            matte::play(level, &chance.map(|chance| chance as f32), &scale, &mut next.throughput);
            for lane in (0..LANES).filter(|&lane| guided.has_played[lane]) {
                next.throughput.set(lane, before.get(lane));
            }
        }
        // Roulette at a second point would change the density of paths that share there.
        if bounce == 0 && self.sharing.is_some() {
            block.bsdf.guided.aimed = [1.0; LANES];
        }
        let (guided, next) = (&block.bsdf.guided, &mut block.next);
        let mut goes_on = [0; LANES];
        matte::survive(level, &next.throughput, &next.pdf, &mut goes_on);
        let misses = std::array::from_fn(|lane| [block.surfaces.primitive[lane], Ray::NO_TRIANGLE]);
        let paths = PathLanes {
            origin: &next.origin,
            direction: &next.direction,
            misses: &misses,
            throughput: &next.throughput,
            pdf: &next.pdf,
            normal: &block.bsdf.normal,
            sample: &block.sample,
            scale: &next.scale,
            flags: &next.flags,
            aimed: &guided.aimed,
            width: &block.bsdf.width,
            spread: &next.spread,
            time: &block.time,
        };
        self.paths[1].push(level, bits(&goes_on, block.surfaces.count), &paths);
    }
}
