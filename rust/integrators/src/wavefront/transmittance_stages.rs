//! The stage that takes shadow rays through media.

use super::direct_light::power_heuristic;
use super::flights::{Flight, Flights, Passage, Stop, Traveller, shares_stopped};
use super::media::Media;
use super::medium_stacks::MediumStacks;
use super::queues::{ShadowQueue, own};
use super::waves::PathWaves;
use super::worker::WavefrontWorker;
use crate::media::distance_sampling::MediumSegment;
use crate::media::spectral_mis::Weights;
use raywright_base::math::{PathRays, Ray};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::Scene;

/// Shadow rays on their flights.
struct ShadowFlights<'w, 'a> {
    scene: &'a Scene,
    samples: u32,
    cancel: &'w Cancel,
    shadows: &'w ShadowQueue,
    waves: &'w [PathWaves],
    media: &'w mut Media<'a>,
    /// True if they join the subpaths of two ends.
    joins: bool,
    /// The light that arrives, by place.
    arriving: &'w mut [(u32, Rgb)],
}

impl ShadowFlights<'_, '_> {
    /// Dims the light of a flight by the medium on its ray.
    fn dim(&mut self, flight: &mut Flight, stacks: &MediumStacks<'_>, ray: &Ray, end: f64) {
        let place = own(flight.sample, self.samples) as usize;
        let waves = self.waves.get(place).map(|waves| waves.now);
        let Some(segment) = flight.segment(stacks, (self.scene, waves), ray, end) else { return };
        // Those that were queued on the ways of paths start in a medium, as do those of scattering events.
        let leaves = self.shadows.rays.misses[..self.shadows.rays.len].get(flight.place as usize);
        let roulette = leaves.is_none_or(|misses| misses[0] == Ray::NO_TRIANGLE);
        // Both ends may have been sampled by different colors: the mean of a product is that of independent factors.
        let mut hero = (!self.joins).then_some(self.media.paths[place].hero);
        let further = &mut self.media.further[place];
        MediumSegment { roulette, ..segment }.fade(&mut flight.weights, &mut hero, further, self.cancel);
    }
}

impl Traveller for ShadowFlights<'_, '_> {
    /// A surface may block it, which costs less to find.
    fn travel(&mut self, _: &mut Flight, _: &MediumStacks<'_>, _: &Ray, _: f64) -> bool {
        true
    }

    fn leave(&mut self, flight: &mut Flight, stacks: &MediumStacks<'_>, ray: &Ray) {
        self.dim(flight, stacks, ray, flight.way / ray.direction.length());
        let Weights { carried, drawn, asked } = flight.weights;
        let weight = power_heuristic(asked.mean() as f32, drawn.mean() as f32);
        self.arriving[flight.place as usize].1 = carried * f64::from(weight) / asked.mean();
    }

    fn arrive(&mut self, flight: &mut Flight, flights: &Flights<'_>, at: &Stop<'_>) -> Passage {
        let (mut passes, mut passage) = (1.0, Passage::Through);
        if let Some(outside) = at.interface.outside {
            if !at.interface.may_pass {
                return Passage::Ends;
            }
            let (ray, hit) = flights.hit_of(self.scene, at);
            let [opacity, straight] = shares_stopped(self.scene, (&ray, &hit), outside);
            passes -= opacity * (1.0 - straight);
            if straight <= 0.0 {
                passage = Passage::Along;
            }
        }
        if passes <= 0.0 {
            return Passage::Ends;
        }
        self.dim(flight, &flights.stacks, at.ray, at.t);
        flight.weights.carried *= passes;
        flight.way -= (at.position - at.ray.origin).length();
        if flight.weights.carried.is_black() {
            return Passage::Ends;
        }
        if flight.way <= 0.0 {
            // The rest is within rounding.
            flight.way = 0.0;
            self.leave(flight, &flights.stacks, at.ray);
            return Passage::Ends;
        }
        passage
    }

    fn reach(&self, flight: &Flight, _: &MediumStacks<'_>) -> f64 {
        PathRays::END * flight.way
    }
}

impl WavefrontWorker<'_> {
    /// Stage: shadow rays are followed through media, and their transmitted light is added. Only then the weight beside
    /// scattering is known.
    pub(super) fn follow_shadows_through_media(&mut self, samples: u32, cancel: &Cancel, radiance: &mut [Rgb]) {
        let (Some(media), Some(flights)) = (&mut self.media, &mut self.flights) else { return };
        let (queue, joins) = (&self.shadows, self.end.is_some());
        std::mem::swap(&mut flights.now, &mut media.on_the_way);
        let count = queue.rays.len as u32;
        for (flight, place) in flights.now.all.iter_mut().zip(count..) {
            flight.place = place;
        }
        let [r, g, b] = &queue.arriving;
        for i in 0..queue.rays.len {
            let drawn = if joins { Rgb::ONE } else { media.paths[own(queue.sample[i], samples) as usize].drawn };
            let carried = Rgb::new(r[i].into(), g[i].into(), b[i].into());
            let weights = Weights { carried, drawn: drawn * f64::from(queue.ratio[i]), asked: drawn };
            let (place, sample, way) = (i as u32, queue.sample[i], queue.rays.t_max[i] / PathRays::END);
            let flight = Flight { place, sample, media: queue.media[i], passed: 0, weights, depth: 0.0, way };
            let (rays, t_max) = (&queue.rays, queue.rays.t_max[i]);
            flights.now.push(flight, rays, i, rays.origin(i), t_max, rays.misses[i]);
        }
        self.arriving.clear();
        self.arriving.resize(flights.now.all.len(), (0, Rgb::ZERO));
        for flight in &flights.now.all {
            self.arriving[flight.place as usize].0 = flight.sample;
        }
        let (scene, waves, arriving) = (self.scene, &self.waves[..], &mut self.arriving[..]);
        let mut shadows = ShadowFlights { scene, samples, cancel, shadows: queue, waves, media, joins, arriving };
        while flights.now.rays.len > 0 && !cancel.is_raised() {
            flights.step(scene, self.level, &mut shadows);
        }
        for (i, &(sample, arriving)) in self.arriving.iter().enumerate() {
            radiance[if joins { i } else { sample as usize }] += arriving * self.light_of(i);
        }
    }
}
