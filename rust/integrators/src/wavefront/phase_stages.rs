//! The stages that take sixteen paths from scattering events in media to their next rays.

use super::matte;
use super::media::MediumScattering;
use super::path_block::bits;
use super::queues::{Flags, PathLanes, own};
use super::worker::WavefrontWorker;
use crate::dimensions::Dimensions;
use crate::known_light::Visit;
use crate::media::path_reuse::SecondVertex;
use crate::media::scattering::Scattering;
use crate::roulette;
use crate::widths::widened;
use raywright_base::math::{LANES, PathRays, Ray, SingleLanes, Vec3};
use raywright_base::sampling::SamplerLanes;
use raywright_base::timing::{Part, timed};
use raywright_optics::{BsdfSample, Rgb};
use raywright_scene::{Footprint, ReceiverBlock};

impl WavefrontWorker<'_> {
    /// Takes all paths from scattering events in media to their next rays.
    pub(super) fn leave_media(&mut self, numbers: &mut SamplerLanes, bounce: u32, samples: u32, radiance: &mut [Rgb]) {
        if self.known.is_some() {
            return self.look_up_light_in_media(bounce, radiance);
        }
        let Some(scattered) = self.media.as_mut().map(|media| std::mem::take(&mut media.scattered)) else { return };
        for (some, number) in scattered.chunks(LANES).zip((0..).step_by(LANES)) {
            self.meet_medium(some);
            let [firsts, seconds] = self.share_in_medium(some, bounce, samples);
            self.gather_media(samples);
            self.gather_waves();
            self.gather_numbers(samples, numbers);
            if !self.scene.lights().is_dark() {
                timed(Part::Light, || {
                    if self.takes_f64 {
                        self.ask_for_light_in_medium_in_f64((some, number), bounce, samples);
                    } else {
                        self.ask_for_light_in_medium((some, number, seconds), numbers, bounce, samples);
                    }
                });
            }
            if self.follows {
                timed(Part::Continuation, || {
                    let (direction, pdf) = self.sample_phases((some, seconds), numbers, bounce, samples);
                    self.scatter_in_medium((some, firsts), (&direction, &pdf), numbers, bounce);
                });
            }
        }
        if let Some(media) = &mut self.media {
            media.scattered = scattered;
        }
    }

    /// Stage: paths that a medium scatters end where light is known.
    fn look_up_light_in_media(&mut self, bounce: u32, radiance: &mut [Rgb]) {
        let (Some(media), Some(flights), Some(samplers), Some(known)) =
            (&self.media, &self.flights, &self.samplers, self.known)
        else {
            return;
        };
        let bounces = self.settings.max_depth.map(|depth| depth.saturating_sub(bounce + 1));
        let queue = &self.paths[0];
        for &MediumScattering { path, position, before, phase, .. } in &media.scattered {
            let (i, sample) = (path as usize, queue.sample[path as usize] as usize);
            let flags = queue.flags[i];
            let visit = Visit {
                number: samplers.get(sample).number(),
                looks_about: false,
                has_gamut_excess: flags & Flags::HAS_GAMUT_EXCESS != 0,
                single: flags & Flags::SINGLE != 0,
                bounces,
            };
            let stack = &flights.stacks.get(media.paths[sample].media).media;
            let throughput = queue.throughput_of(i);
            let here = Scattering { position, before, phase };
            radiance[sample] += throughput * known.among(&here, stack, queue.rays.time(i), visit);
        }
    }

    /// Stage: what is known of sixteen scattering events.
    pub(super) fn meet_medium(&mut self, some: &[MediumScattering]) {
        let (queue, block) = (&self.paths[0], &mut *self.block);
        let surfaces = &mut block.surfaces;
        surfaces.count = some.len();
        for lane in 0..LANES {
            let at = &some[lane.min(some.len() - 1)];
            surfaces.index[lane] = at.path;
            surfaces.position.set(lane, at.position);
            surfaces.origin.set(lane, at.position);
            surfaces.normal.set(lane, Vec3::ZERO);
            surfaces.primitive[lane] = Ray::NO_TRIANGLE;
        }
        block.gather(queue, self.extra);
    }

    /// Stage: light is drawn for sixteen scattering events, and its shadow rays are queued. At second vertices, each
    /// path that takes a share of it weighs it by its own direction.
    fn ask_for_light_in_medium(
        &mut self,
        (some, number, seconds): (&[MediumScattering], usize, u32),
        numbers: &SamplerLanes,
        bounce: u32,
        samples: u32,
    ) {
        let (level, block) = (self.level, &mut *self.block);
        let (mut choice, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        numbers.choice_and_pair(level, Dimensions::of(bounce, 0).light_choice(0), &mut choice, &mut u);
        let (lights, geometry) = (self.scene.lights(), self.scene.geometry());
        let normal = &SingleLanes::ZERO;
        let receivers = ReceiverBlock { surfaces: &block.surfaces, normal, waves: &block.spectral.waves };
        lights.draw_block(level, geometry, &receivers, &choice, &u, &mut block.lights);
        let (mut arriving, mut lit) = (SingleLanes::ZERO, 0u32);
        for (lane, at) in some.iter().enumerate() {
            let drawn = block.lights.pdf[lane];
            if drawn <= 0.0 {
                continue;
            }
            let direction = block.lights.direction.get(lane).as_dvec3();
            let light = block.throughput.get(lane) * block.lights.weight.get(lane);
            let (pdf, light) = if seconds >> lane & 1 == 1 {
                (SecondVertex::PDF as f32, light)
            } else {
                let pdf = at.phase.pdf(at.before, direction) as f32;
                (pdf, light * pdf)
            };
            let span = self.media.as_ref().and_then(|media| Some((media, media.spans.get(number + lane)?)));
            let light = match span {
                Some((media, span)) if drawn == f32::INFINITY => {
                    let way = block.lights.t_max[lane] / PathRays::END;
                    light * media.points.weight(span, at.position + direction * way) as f32
                }
                _ => light,
            };
            arriving.set(lane, light);
            block.media.ratio[lane] = if self.follows { pdf / drawn } else { 0.0 };
            lit |= u32::from(light.max_element() > 0.0) << lane;
        }
        block.media.of_shadows = block.media.here;
        let found = block.sample;
        for lane in (0..some.len()).filter(|lane| seconds >> lane & 1 == 1) {
            let sharing = self.media.as_mut().and_then(|media| media.sharing.as_mut());
            if let (Some(second), 1) = (sharing.and_then(|all| all.second(own(found[lane], samples))), lit >> lane & 1)
            {
                second.to_light = block.lights.direction.get(lane).as_dvec3();
            }
            block.sample[lane] += samples;
        }
        block.queue_shadows(level, lit, (&block.surfaces.origin, &arriving), &mut self.shadows);
        block.sample = found;
    }

    /// Stage: directions are drawn from sixteen phase functions. Returns them with their densities.
    pub(super) fn sample_phases(
        &mut self,
        (some, seconds): (&[MediumScattering], u32),
        numbers: &SamplerLanes,
        bounce: u32,
        samples: u32,
    ) -> (SingleLanes, [f32; LANES]) {
        let (level, block) = (self.level, &mut *self.block);
        let (mut one, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        numbers.choice_and_pair(level, Dimensions::of(bounce, 0).scattering_choice(), &mut one, &mut u);
        let (mut direction, mut pdf) = (SingleLanes::ZERO, [0.0; LANES]);
        for (lane, at) in some.iter().enumerate() {
            let next = at.phase.sample(at.before, [u[0][lane].into(), u[1][lane].into()]);
            let is_second = seconds >> lane & 1 == 1;
            let density = if is_second { SecondVertex::PDF } else { at.phase.pdf(at.before, next) };
            let sharing = self.media.as_mut().and_then(|media| media.sharing.as_mut());
            if let (Some(sharing), true) = (sharing, is_second)
                && let Some(second) = sharing.second(own(block.sample[lane], samples))
            {
                second.onward = next;
            }
            direction.set(lane, next.as_vec3());
            pdf[lane] = density as f32;
            if self.extra.width {
                let before = Footprint { width: block.bsdf.width[lane].into(), spread: block.bsdf.spread[lane].into() };
                let after = widened(&before, before.width, 0.0, &BsdfSample::new(next, Rgb::ONE, density));
                block.bsdf.spread[lane] = after.spread as f32;
            }
        }
        (direction, pdf)
    }

    /// Stage: sixteen paths go on in directions of such densities, unless roulette ends them.
    pub(super) fn scatter_in_medium(
        &mut self,
        (some, firsts): (&[MediumScattering], u32),
        (direction, pdf): (&SingleLanes, &[f32; LANES]),
        numbers: &SamplerLanes,
        bounce: u32,
    ) {
        let plays = self.plays(bounce);
        let (level, block) = (self.level, &mut *self.block);
        if plays {
            let mut chance = [0.0; LANES];
            numbers.one(level, &[Dimensions::of(bounce, 0).roulette(); LANES], &mut chance);
            let before = block.throughput;
            if self.scene.surrounding().is_some() {
                let chance = chance.map(|chance| chance as f32);
                matte::play(level, &chance, &block.bsdf.scale, &mut block.throughput);
            } else {
                for lane in 0..some.len() {
                    let throughput = block.throughput.get(lane);
                    let all = Rgb::from_array(throughput.as_dvec3().to_array());
                    let survival = roulette::survival_among(all, block.bsdf.scale[lane].into());
                    let kept = if chance[lane] < survival { throughput / survival as f32 } else { Vec3::ZERO };
                    block.throughput.set(lane, kept);
                }
            }
            // Only the densities of sampling decide on the path up to its second vertex.
            for lane in (0..some.len()).filter(|lane| firsts >> lane & 1 == 1) {
                block.throughput.set(lane, before.get(lane));
            }
        }
        let mut goes_on = [0; LANES];
        matte::survive(level, &block.throughput, pdf, &mut goes_on);
        let paths = PathLanes {
            origin: &block.surfaces.origin,
            direction,
            misses: &[[Ray::NO_TRIANGLE; 2]; LANES],
            throughput: &block.throughput,
            pdf,
            normal: &SingleLanes::ZERO,
            sample: &block.sample,
            scale: &block.bsdf.scale,
            flags: &block.bsdf.flags.map(|flags| flags & !Flags::ASKED_EACH),
            aimed: &block.bsdf.guided.aimed,
            width: &block.bsdf.width,
            spread: &block.bsdf.spread,
            time: &block.time,
        };
        self.paths[1].push(level, bits(&goes_on, block.surfaces.count), &paths);
    }
}
