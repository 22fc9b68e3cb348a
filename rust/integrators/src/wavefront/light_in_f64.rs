//! Light samples one by one, in f64, where f32 does not hold radiances or products of lengths.

use super::media::MediumScattering;
use super::queues::own;
use super::worker::WavefrontWorker;
use crate::dimensions::Dimensions;
use crate::media::scattering::Scattering;
use crate::path_settings::stratum;
use raywright_base::math::Ray;
use raywright_optics::Rgb;
use raywright_scene::{Interaction, LightSample, LightSampleContext};

/// A light sample with the density of scattering over that of its draw, or 0 if paths do not follow its direction.
struct WeighedLight {
    ray: Ray,
    /// Light that arrives if nothing blocks it, without the weight beside scattering.
    arriving: Rgb,
    ratio: f64,
    light: LightSample,
}

impl WavefrontWorker<'_> {
    /// Stage: draws one of several light samples for each of sixteen surfaces, and queues its shadow ray.
    pub(super) fn ask_for_light_in_f64(&mut self, bounce: u32, (number, count): (u32, u32), samples: u32) {
        let dimensions = self.dimensions(bounce);
        let asks = self.block.bsdf.asks;
        for lane in (0..self.block.surfaces.count).filter(|&lane| asks[lane]) {
            let bsdf = &self.block.bsdf;
            let (Some((.., here)), least_pdf) = (bsdf.interaction(lane), bsdf.least_pdf[lane]) else { continue };
            let follows = |pdf: f64| if self.follows && pdf >= least_pdf { bsdf.follows[lane] } else { 0.0 };
            let draw = (dimensions[lane].light_choice(number), (number, count));
            let Some(drawn) = self.draw_in_f64(&here, lane, draw, samples, follows) else { continue };
            let (is_behind, media) = (here.is_through(drawn.light.direction), &self.block.media);
            let media = if is_behind { media.through[lane] } else { media.here[lane] };
            self.push_in_f64(lane, drawn, media);
        }
    }

    /// Stage: draws light for each of sixteen scattering events in media, from a number on, and queues its shadow ray.
    pub(super) fn ask_for_light_in_medium_in_f64(
        &mut self,
        (some, number): (&[MediumScattering], usize),
        bounce: u32,
        samples: u32,
    ) {
        for (lane, at) in some.iter().enumerate() {
            let here = Scattering { position: at.position, before: at.before, phase: at.phase };
            let follows = |_: f64| if self.follows { 1.0 } else { 0.0 };
            let draw = (Dimensions::of(bounce, 0).light_choice(0), (0, 1));
            let Some(mut drawn) = self.draw_in_f64(&here, lane, draw, samples, follows) else { continue };
            let span = self.media.as_ref().and_then(|media| Some((media, media.spans.get(number + lane)?)));
            if let (Some((media, span)), Some(source)) = (span, &drawn.light.source)
                && drawn.light.pdf == f64::INFINITY
            {
                drawn.arriving *= media.points.weight(span, source.position());
            }
            self.push_in_f64(lane, drawn, self.block.media.here[lane]);
        }
    }

    /// Draw light at the vertex of a lane. `follows` tells how many paths follow a direction of some density.
    fn draw_in_f64(
        &self,
        here: &impl Interaction,
        lane: usize,
        (dimension, draw): (u32, (u32, u32)),
        samples: u32,
        follows: impl Fn(f64) -> f64,
    ) -> Option<WeighedLight> {
        let (block, scene) = (&*self.block, self.scene);
        let mut sampler = self.samplers.as_ref()?.get(own(block.sample[lane], samples) as usize);
        let (choice, u) = (stratum(sampler.one(dimension), draw), sampler.two(dimension + 1));
        let receiver = LightSampleContext { waves: block.spectral.waves[lane], ..here.light_context() };
        let light = scene.lights().sample(scene.geometry(), &receiver, choice, u)?;
        let (scattered, pdf) = here.evaluate(light.direction);
        let throughput = Rgb::from_array(block.throughput.get(lane).as_dvec3().to_array());
        let arriving = throughput * scattered * light.weight / f64::from(draw.1);
        let from = here.ray_origin();
        let ray = match &light.source {
            Some(source) => from.segment(source),
            None => from.ray(light.direction),
        };
        let misses = [block.surfaces.primitive[lane], light.primitive];
        let ray = Ray { time: block.time[lane], misses, ..ray };
        let ratio = follows(pdf) * pdf / light.pdf;
        (!arriving.is_black() && arriving.is_finite()).then_some(WeighedLight { ray, arriving, ratio, light })
    }

    /// Queue the shadow ray of a light sample.
    fn push_in_f64(&mut self, lane: usize, drawn: WeighedLight, media: u32) {
        let WeighedLight { ray, arriving, ratio, .. } = drawn;
        // Among media it is weighed when it arrives.
        let weight = if self.extra.media { 1.0 } else { 1.0 / (1.0 + ratio * ratio) };
        self.shadows.push_ray(&ray, self.block.sample[lane], media, ratio as f32);
        self.in_f64.push(arriving * weight);
    }
}
