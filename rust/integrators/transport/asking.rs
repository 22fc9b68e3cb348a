//! Light that is asked for where a path has come to.

use super::aiming::density;
use super::features::Features;
use super::resampling::resampled;
use super::weights::power_heuristic;
use super::worker::{TransportWorker, Vertex};
use crate::math::Ray;
use crate::optics::Rgb;
use crate::sampling::Sampler;
use crate::scene::{Interaction, LightSample, Scatters};

impl<N: Features> TransportWorker<'_, N> {
    /// Next-event estimation: draws light and queues the shadow ray.
    #[inline]
    pub(super) fn ask_a_light<S: Scatters>(
        &mut self,
        vertex: &Vertex<'_, S>,
        (number, asked): (u32, u32),
        splits: u32,
        sampler: &mut Sampler,
    ) {
        let (here, dimensions) = (&vertex.here, vertex.dimensions);
        if self.asks_each(here) {
            if let Some((light, arriving)) = self.ask_each_light(vertex, (number, asked), splits, sampler) {
                self.cast(vertex, &light, arriving);
            }
            return;
        }
        let choice = share(sampler.one(dimensions.light_choice(number)), (number, asked));
        let u = sampler.two(dimensions.light_point(number));
        let lights = self.scene.lights();
        let Some(light) = lights.sample(self.scene.geometry(), &here.receiver(), choice, u) else { return };
        let arriving = self.arriving(vertex, &light, asked, splits);
        if arriving != Rgb::ZERO {
            self.cast(vertex, &light, arriving);
        }
    }

    /// Draws light of each of few lights, and of it one draw to stand for all.
    #[inline(never)]
    fn ask_each_light<S: Scatters>(
        &self,
        vertex: &Vertex<'_, S>,
        (number, asked): (u32, u32),
        splits: u32,
        sampler: &mut Sampler,
    ) -> Option<(LightSample, Rgb)> {
        let (lights, receiver, dimensions) = (self.scene.lights(), vertex.here.receiver(), vertex.dimensions);
        let first = number.wrapping_mul(lights.few());
        let choice = share(sampler.one(dimensions.light_choice(first)), (number, asked));
        let draw = |one: u32| {
            let number = first.wrapping_add(one);
            let u = sampler.two(dimensions.light_point(number));
            let choice = || sampler.one(dimensions.light_choice(number));
            let light = lights.sample_one(one, self.scene.geometry(), &receiver, choice, u)?;
            Some((light, self.arriving(vertex, &light, asked, splits)))
        };
        resampled(choice, (0..lights.few()).filter_map(draw))
    }

    /// Whether each of few lights is asked at a point.
    #[inline]
    pub(super) fn asks_each<S: Scatters>(&self, here: &Interaction<S>) -> bool {
        !N::PLAIN && self.scene.plan().asks_each(|| here.scattering().roughness())
    }

    /// Queues the shadow ray of light that was drawn.
    #[inline]
    fn cast<S: Scatters>(&mut self, vertex: &Vertex<'_, S>, light: &LightSample, arriving: Rgb) {
        let from = vertex.here.departure();
        let ray = match &light.source {
            Some(source) => from.segment(source),
            None => from.ray(light.direction),
        };
        self.shadows.push(Ray { time: vertex.time, ..ray }, vertex.path.sample, arriving);
        if N::BAGGAGE && self.nested {
            let is_through = vertex.here.is_through(light.direction);
            self.shadows.set_inside(if is_through { *vertex.through } else { vertex.baggage.inside });
        }
    }

    /// What light that was drawn adds to the sample, one of so many draws, if nothing is in its way.
    #[inline]
    fn arriving<S: Scatters>(&self, vertex: &Vertex<'_, S>, light: &LightSample, asked: u32, splits: u32) -> Rgb {
        let (scattered, mut pdf) = vertex.here.evaluate(light.direction);
        if let Some(aim) = &vertex.aim {
            pdf = density(aim, pdf, light.direction);
        }
        let mut weight = if self.is_followed(pdf) {
            power_heuristic(light.pdf * f64::from(asked), pdf * f64::from(splits))
        } else {
            1.0
        };
        if N::BAGGAGE {
            weight /= f64::from(asked);
        }
        vertex.path.throughput * scattered * light.weight * weight
    }
}

/// The choice of one of several draws: each makes its own in a share of all.
#[inline]
fn share(choice: f64, (number, asked): (u32, u32)) -> f64 {
    if asked == 1 { choice } else { ((choice + f64::from(number)) / f64::from(asked)).min(1f64.next_down()) }
}
