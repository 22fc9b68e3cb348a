//! The stage that takes paths through media: to where these scatter them, to surfaces, or out of the scene.

use super::flights::{Flight, Flights, Passage, Stop, Traveller, shares_stopped};
use super::media::{Media, MediumScattering, PathMedia};
use super::medium_stacks::MediumStacks;
use super::queues::{PathQueue, own};
use super::waves::PathWaves;
use super::worker::{End, WavefrontWorker};
use crate::dimensions::{Dimensions, EmissionDimensions};
use crate::media::current_medium::Filled;
use crate::media::equiangular::ScatteringSpan;
use crate::media::path_numbers::{FurtherNumbers, depth};
use crate::media::spectral_mis::Weights;
use crate::nesting::MediumStack;
use raywright_base::math::{Hit, LANES, Ray};
use raywright_base::sampling::{Sampler, SamplerColumns, SamplerLanes};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::Scene;

/// Paths on their flights, and the columns that these write.
struct PathFlights<'w, 'a> {
    scene: &'a Scene,
    samples: u32,
    bounce: u32,
    cancel: &'w Cancel,
    queue: &'w mut PathQueue,
    primitives: &'w mut [u32],
    hits: &'w mut [Hit],
    radiance: &'w mut [Rgb],
    samplers: &'w SamplerColumns,
    waves: &'w [PathWaves],
    media: &'w mut Media<'a>,
    /// True if point lights are sampled along the ways of paths.
    is_lit: bool,
}

impl PathFlights<'_, '_> {
    /// The path of a flight has come to where a medium scatters it, or has ended.
    fn end_within(&mut self, flight: &Flight, ray: &Ray) {
        let (path, place) = (flight.place as usize, own(flight.sample, self.samples) as usize);
        (self.media.is_within[path], self.primitives[path]) = (true, Ray::NO_TRIANGLE);
        self.media.paths[place].come(flight.media, self.queue.arrive(path, ray.origin, &flight.weights));
    }
}

impl Traveller for PathFlights<'_, '_> {
    fn travel(&mut self, flight: &mut Flight, stacks: &MediumStacks<'_>, ray: &Ray, end: f64) -> bool {
        let place = own(flight.sample, self.samples) as usize;
        let waves = self.waves.get(place).map(|waves| waves.now);
        let Some(segment) = flight.segment(stacks, (self.scene, waves), ray, end) else { return true };
        if let (true, Some(here)) = (self.is_lit, stacks.get(flight.media).even(waves.as_ref())) {
            let mut sampler = self.samplers.get(place);
            let choice = Dimensions::of(self.bounce, 0).light_choice(1);
            let u = [sampler.one(choice), sampler.two(choice + 1)[0]];
            self.media.light_on_the_way(flight, (ray, &segment), &here, u);
        }
        let (path, further) = (&mut self.media.paths[place], &mut self.media.further[place]);
        let mut light = Rgb::ZERO;
        let of_hero = (path.hero, &mut flight.depth);
        let collision = segment.fly(&mut flight.weights, of_hero, further, self.cancel, &mut light);
        self.radiance[flight.sample as usize] += light;
        if let Some(collision) = collision {
            if self.is_lit {
                let density = collision.density.unwrap_or(f64::INFINITY);
                self.media.spans.push(ScatteringSpan { ray: *ray, span: segment.span, t: collision.t, density });
            }
            self.media.scattered.push(MediumScattering {
                path: flight.place,
                position: ray.at(collision.t),
                before: ray.direction / segment.length,
                phase: segment.medium.phase(),
                collision: collision.times(1.0 / flight.weights.drawn.mean()),
                // Only the medium lies between.
                is_second: std::mem::take(&mut path.is_first) && flight.passed == 0,
            });
        }
        let goes_on = collision.is_none() && !flight.weights.carried.is_black();
        if !goes_on {
            self.end_within(flight, ray);
        }
        goes_on
    }

    fn leave(&mut self, flight: &mut Flight, _: &MediumStacks<'_>, ray: &Ray) {
        let (path, place) = (flight.place as usize, own(flight.sample, self.samples) as usize);
        self.primitives[path] = Ray::NO_TRIANGLE;
        self.media.paths[place].come(flight.media, self.queue.arrive(path, ray.origin, &flight.weights));
    }

    fn arrive(&mut self, flight: &mut Flight, flights: &Flights<'_>, at: &Stop<'_>) -> Passage {
        let place = own(flight.sample, self.samples) as usize;
        let Some(outside) = at.interface.outside else { return Passage::Through };
        if at.interface.may_pass {
            let (ray, hit) = flights.hit_of(self.scene, at);
            let [opacity, straight] = shares_stopped(self.scene, (&ray, &hit), outside);
            let further = &mut self.media.further[place];
            if opacity < 1.0 && further.next() >= opacity {
                return Passage::Along;
            }
            if straight > 0.0 && further.next() < straight {
                return Passage::Through;
            }
        }
        let i = flight.place as usize;
        self.primitives[i] = at.primitive;
        if let Some(to) = self.hits.get_mut(i) {
            *to = flights.hit_of(self.scene, at).1;
        }
        let is_outside = flights.stacks.get(flight.media).media.depth() == 0 && self.scene.surrounding().is_none();
        let path = &mut self.media.paths[place];
        (path.through, path.outside) = (at.interface.through, outside);
        let may_share = std::mem::take(&mut path.is_first);
        let sharing = self.media.sharing.as_ref().filter(|_| may_share);
        let shares = sharing.is_some_and(|all| all.is_within_reach(place as u32, flight.passed, is_outside));
        let (start, within) = (self.queue.vertex(i), at.ray.origin);
        let inside =
            || if flight.passed > 0 { (within - start).length() / (at.position - start).length() } else { 1.0 };
        path.shares = shares.then(inside);
        path.come(flight.media, self.queue.arrive(i, at.ray.origin, &flight.weights));
        Passage::Ends
    }

    fn reach(&self, flight: &Flight, stacks: &MediumStacks<'_>) -> f64 {
        let place = own(flight.sample, self.samples) as usize;
        let even = stacks.get(flight.media).even(self.waves.get(place).map(|waves| &waves.now));
        // Hits beyond the scattering event are not needed.
        let Some(here) = even.filter(|here| !self.is_lit && here.emission.is_black()) else { return f64::INFINITY };
        let way = flight.depth / here.extinction[self.media.paths[place].hero];
        (way * (1.0 + 1e-6)).next_up()
    }
}

impl WavefrontWorker<'_> {
    /// Stage: paths of so many samples start in the media around the camera or their lights.
    pub(super) fn start_in_media(&mut self, samples: usize) {
        let shares_waves = self.shares_waves();
        let (Some(media), Some(flights)) = (&mut self.media, &mut self.flights) else { return };
        let Some(samplers) = &self.samplers else { return };
        let queue = &self.paths[0];
        let rays: Vec<Ray> = (0..queue.rays.len).map(|i| queue.rays.get(i)).collect();
        let mut stacks = Vec::new();
        MediumStack::at(self.scene, &rays, &mut stacks);
        flights.begin();
        media.paths.clear();
        media.paths.resize(samples, PathMedia::new(0, 0));
        media.further.clear();
        // Light subpaths have the paired numbers of their camera subpaths.
        let apart = |sampler: &Sampler| if self.end.is_some() { sampler.apart() } else { sampler.paired() };
        media.further.extend((0..samples).map(|i| FurtherNumbers::new(apart(&samplers.get(i)))));
        let dimension =
            if matches!(self.end, Some(End::Light)) { EmissionDimensions::WAVES } else { Dimensions::WAVES };
        let mut last: Option<(&MediumStack<Filled>, u32)> = None;
        for (&i, stack) in queue.sample.iter().zip(&stacks) {
            let i = i as usize;
            let mut sampler = samplers.get(i);
            let same = last.filter(|(before, _)| before.interiors() == stack.interiors());
            let number = same.map_or_else(|| flights.stacks.number(stack), |(_, number)| number);
            last = Some((stack, number));
            // The first wavelength is the hero: dispersion ends all but that. Of red, green and blue it is any, and of
            // wavelengths that paths share.
            let hero = match (self.waves.is_empty(), shares_waves) {
                (true, _) => ((sampler.one(dimension) * 3.0) as usize).min(2),
                (false, true) => media.further[i].hero(),
                (false, false) => 0,
            };
            media.paths[i] = PathMedia::new(number, hero);
        }
    }

    /// Stage: paths follow their rays through media, past boundaries that are no surfaces and masks.
    pub(super) fn fly(
        &mut self,
        numbers: &mut SamplerLanes,
        bounce: u32,
        samples: u32,
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        let (Some(media), Some(flights), Some(samplers)) = (&mut self.media, &mut self.flights, &self.samplers) else {
            return;
        };
        let is_lit = !media.points.is_empty() && self.settings.max_depth.is_none_or(|depth| bounce < depth);
        media.begin(self.paths[0].rays.len);
        let mut paths = PathFlights {
            scene: self.scene,
            samples,
            bounce,
            cancel,
            queue: &mut self.paths[0],
            primitives: &mut self.primitives,
            hits: &mut self.hits,
            radiance,
            samplers,
            waves: &self.waves,
            media,
            is_lit,
        };
        paths.take_off(self.level, numbers, flights);
        while flights.now.rays.len > 0 && !cancel.is_raised() {
            flights.step(self.scene, self.level, &mut paths);
        }
    }
}

impl PathFlights<'_, '_> {
    /// Begins the flights of all paths, each with an optical depth before it scatters, once for all media on its ray.
    fn take_off(&mut self, level: raywright_base::simd::Level, numbers: &mut SamplerLanes, flights: &mut Flights<'_>) {
        flights.now.clear();
        self.queue.set_vertices();
        for start in (0..self.queue.rays.len).step_by(LANES) {
            let some = start..self.queue.rays.len.min(start + LANES);
            let (mut which, mut chance) = ([0; LANES], [0.0; LANES]);
            for (to, sample) in which.iter_mut().zip(&self.queue.sample[some.clone()]) {
                *to = own(*sample, self.samples);
            }
            self.samplers.gather(&which, numbers);
            numbers.one(level, &[Dimensions::of(self.bounce, 0).mask(); LANES], &mut chance);
            for (lane, i) in some.enumerate() {
                let PathMedia { media, drawn, .. } = self.media.paths[which[lane] as usize];
                let [r, g, b] = self.queue.throughput.each_ref().map(|column| f64::from(column[i]));
                let weights = Weights { carried: Rgb::new(r, g, b), drawn, asked: drawn };
                let (place, sample, depth) = (i as u32, self.queue.sample[i], depth(chance[lane]));
                let flight = Flight { place, sample, media, passed: 0, weights, depth, way: f64::INFINITY };
                let (rays, t_max) = (&self.queue.rays, self.reach(&flight, &flights.stacks));
                flights.now.push(flight, rays, i, rays.origin(i), t_max, rays.misses[i]);
            }
        }
    }
}
