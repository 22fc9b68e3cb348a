//! The stages of subpaths from lights or from the camera, whose vertices go to a sink. They share all others with path
//! tracing. In place of light samples, sinks connect vertices to lights, to the camera, and to each other.

use super::subpaths::{Arrival, Connection, Subpath, SubpathSink, VertexContext};
use super::waves::{self, PathWaves};
use super::worker::WavefrontWorker;
use crate::dimensions::{Dimensions, EmissionDimensions};
use crate::media::distance_sampling::MediumSegment;
use crate::media::path_numbers::FurtherNumbers;
use crate::media::scattering::Scattering;
use crate::media::spectral_mis::Weights;
use crate::path_settings::PathSettings;
use crate::path_vertices::{Onward, Point, Vertex};
use crate::{CameraSample, CameraSamples, Job, is_matt, roulette};
use raywright_base::math::{LANES, Ray, Vec3};
use raywright_base::sampling::{Sampler, SamplerColumns, SamplerLanes};
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Camera, Emitters, LookupContext, RayOrigin, Scene, SurfaceInteraction};

/// Path termination.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Maximum number of bounces.
    pub max_depth: Option<u32>,
    /// Number of bounces after which Russian roulette starts.
    pub roulette_depth: u32,
}

/// Times of light subpaths.
#[derive(Clone, Debug)]
pub(crate) enum Times {
    /// Sampled for each.
    Drawn,
    /// Common to all, as a fraction of the shutter interval.
    All(f64),
    /// One scene time each.
    Each(Vec<f64>),
}

/// Per-thread state of subpaths from one end.
pub(crate) struct SubpathWavefront<'a> {
    worker: WavefrontWorker<'a>,
    limits: Limits,
    /// Wavelengths of the next subpaths; `None` for RGB.
    waves: Vec<Waves>,
    paths: Vec<Subpath>,
    connections: Vec<Connection>,
    /// Transmitted share of each connection.
    transmitted: Vec<Rgb>,
    /// By subpath, light of media along its ray.
    glow: Vec<Rgb>,
    /// By place in the queue, flux before the ray.
    before: Vec<Rgb>,
}

/// Emission of light subpaths.
pub(crate) struct SubpathEmission<'e, 'a> {
    pub emitters: &'e Emitters<'a>,
    /// Camera whose shutter interval they fall into; without one, any scene time.
    pub camera: Option<&'a dyn Camera>,
    pub times: &'e Times,
}

fn rgb(v: Vec3) -> Rgb {
    Rgb::from_array(v.as_dvec3().to_array())
}

/// Return flux from infinity that the surrounding medium leaves along a ray back to its light.
fn come_from_afar(
    scene: &Scene,
    flux: Rgb,
    back: Ray,
    waves: Option<Waves>,
    sampler: &Sampler,
    cancel: &Cancel,
) -> Rgb {
    let Some(medium) = scene.surrounding() else { return flux };
    let (span, length) = ([0.0, f64::INFINITY], 1.0);
    let segment = MediumSegment { medium, ray: back, span, length, scatters: true, roulette: false, waves };
    let mut weights = Weights { carried: flux, ..Weights::START };
    segment.fade(&mut weights, &mut None, &mut FurtherNumbers::new(sampler.apart()), cancel);
    weights.carried / weights.asked.mean()
}

impl SubpathEmission<'_, '_> {
    /// Return a time as a fraction of the shutter interval, and as scene time.
    fn time(&self, scene: &Scene, number: usize, sampler: &mut Sampler) -> (f64, f64) {
        let moves = scene.geometry().moves() || self.camera.is_some_and(|camera| camera.uses_time());
        let time = match self.times {
            _ if !moves => 0.0,
            Times::Drawn => sampler.one(EmissionDimensions::TIME),
            Times::All(time) => *time,
            // The camera's pose is not needed in this case.
            Times::Each(_) => 0.0,
        };
        match &self.times {
            Times::Each(times) => (time, times[number]),
            _ => (time, self.camera.map_or(time, |camera| camera.body().scene_time(time))),
        }
    }
}

impl<'a> SubpathWavefront<'a> {
    /// Subpaths from lights.
    pub fn of_lights(scene: &'a Scene, limits: Limits) -> Self {
        // Emission counts as the first bounce.
        let settings = PathSettings::path(None, limits.roulette_depth.saturating_add(1));
        Self::new(WavefrontWorker::of_lights(scene, settings), limits)
    }

    /// Subpaths from the camera.
    pub fn of_camera(job: &Job<'a>, limits: Limits) -> Self {
        let settings = PathSettings::path(None, limits.roulette_depth);
        Self::new(WavefrontWorker::of_camera(job, settings), limits)
    }

    fn new(worker: WavefrontWorker<'a>, limits: Limits) -> Self {
        Self {
            worker,
            limits,
            waves: Vec::new(),
            paths: Vec::new(),
            connections: Vec::new(),
            transmitted: Vec::new(),
            glow: Vec::new(),
            before: Vec::new(),
        }
    }

    /// Set the wavelengths of the next subpaths.
    pub fn set_waves(&mut self, waves: impl Iterator<Item = Waves>) {
        self.waves.clear();
        self.waves.extend(waves);
    }

    /// Follow one light subpath per sampler to its end.
    pub fn follow_light(
        &mut self,
        samplers: &mut [Sampler],
        emission: &SubpathEmission<'_, 'a>,
        cancel: &Cancel,
        sink: &mut dyn SubpathSink<'a>,
    ) {
        let Some(first) = samplers.first() else { return };
        let columns = self.worker.samplers.get_or_insert_with(|| SamplerColumns::new(first));
        columns.take(samplers.iter());
        let numbers = columns.lanes();
        self.begin(samplers.len());
        self.emit(samplers, emission, cancel, sink);
        self.follow(numbers, 1, cancel, sink);
    }

    /// Follow the camera subpaths of some samples to their ends.
    pub fn follow_camera(&mut self, samples: &[CameraSample], cancel: &Cancel, sink: &mut dyn SubpathSink<'a>) {
        self.begin(samples.len());
        self.worker.start(&CameraSamples::of(samples), 0..samples.len());
        let path = |number: u32| Subpath::new(number, Rgb::ONE, 1.0, 0.0, self.waves.get(number as usize).copied());
        self.paths.extend((0..samples.len() as u32).map(path));
        let Some(numbers) = self.worker.samplers.as_ref().map(SamplerColumns::lanes) else { return };
        self.follow(numbers, 0, cancel, sink);
    }

    fn begin(&mut self, samples: usize) {
        self.paths.clear();
        self.glow.clear();
        self.glow.resize(samples, Rgb::ZERO);
        self.worker.waves.clear();
        self.worker.waves.extend(self.waves.iter().map(|&waves| PathWaves::new(waves)));
    }

    fn follow(&mut self, mut numbers: SamplerLanes, first: u32, cancel: &Cancel, sink: &mut dyn SubpathSink<'a>) {
        self.worker.start_in_media(self.paths.len());
        for bounce in first.. {
            if self.worker.paths[0].rays.len == 0 || cancel.is_raised() {
                break;
            }
            self.bounce(&mut numbers, bounce, cancel, sink);
        }
    }

    /// Stage: lights emit subpaths.
    fn emit(
        &mut self,
        samplers: &mut [Sampler],
        emission: &SubpathEmission<'_, 'a>,
        cancel: &Cancel,
        sink: &mut dyn SubpathSink<'a>,
    ) {
        let scene = self.worker.scene;
        let queue = &mut self.worker.paths[0];
        queue.make_room(samplers.len());
        queue.rays.len = 0;
        for (number, sampler) in (0u32..).zip(samplers.iter_mut()) {
            let waves = self.waves.get(number as usize).copied();
            let light = emission.emitters.sample(&EmissionDimensions::numbers(sampler), waves.as_ref());
            let (time, of_scene) = emission.time(scene, number as usize, sampler);
            let flux = light.as_ref().map_or(Rgb::ZERO, |light| light.weight);
            let path = Subpath::new(number, flux, flux.max(), time, waves);
            self.paths.push(path);
            let Some(light) = light.filter(|_| path.power > 0.0 && path.power.is_finite()) else { continue };
            let mut ray = Ray { time: of_scene, ..light.ray };
            ray.origin = ray.at(ray.t_min);
            sink.set_out(&path, &light);
            let mut left = flux;
            if light.is_infinite && scene.surrounding().is_some() {
                let back = Ray { time: of_scene, ..Ray::new(ray.origin, -ray.direction) };
                left = come_from_afar(scene, flux, back, waves, sampler, cancel);
                sink.absorb(flux - left);
            }
            if !left.is_black() {
                queue.start(number, &ray, (left / path.power).as_vec3());
            }
        }
    }

    /// Take all subpaths to their next vertices, and scatter them there.
    fn bounce(&mut self, numbers: &mut SamplerLanes, bounce: u32, cancel: &Cancel, sink: &mut dyn SubpathSink<'a>) {
        let samples = self.paths.len() as u32;
        self.fly(numbers, bounce, cancel, sink);
        let queue = &self.worker.paths[0];
        for &i in &self.worker.outside {
            let (i, sample) = (i as usize, queue.sample[i as usize]);
            let path = &mut self.paths[sample as usize];
            let (flags, waves) = (queue.flags.get(i).copied().unwrap_or(0), waves::at(&self.worker.waves, sample));
            path.arrive(path.bounce, [queue.throughput_of(i); 2], flags, waves);
            path.bounce = bounce;
            sink.leave(path, &queue.rays.get(i));
        }
        for kind in 0..self.worker.met.len() {
            let met = std::mem::take(&mut self.worker.met[kind]);
            for some in met.chunks(LANES) {
                self.meet_surfaces(some, numbers, bounce, sink);
            }
            self.worker.met[kind] = met;
        }
        self.meet_media(numbers, bounce, sink);
        self.transmitted.clear();
        self.transmitted.resize(self.connections.len(), Rgb::ZERO);
        self.worker.follow_shadows(samples, cancel, &mut self.transmitted);
        for (connection, &share) in self.connections.iter().zip(&self.transmitted) {
            let light = connection.light * share;
            if light != Rgb::ZERO && light.is_finite() {
                sink.receive(connection, light);
            }
        }
        self.connections.clear();
        self.worker.paths.swap(0, 1);
    }

    /// Take all subpaths through media to their next vertices.
    fn fly(&mut self, numbers: &mut SamplerLanes, bounce: u32, cancel: &Cancel, sink: &mut dyn SubpathSink<'a>) {
        self.before.clear();
        if self.worker.media.is_some() {
            let (queue, paths) = (&self.worker.paths[0], &self.paths);
            let flux = |i: usize| queue.throughput_of(i) * paths[queue.sample[i] as usize].power;
            self.before.extend((0..queue.rays.len).map(flux));
        }
        self.worker.find_vertices(numbers, bounce, self.paths.len() as u32, cancel, &mut self.glow);
        let queue = &self.worker.paths[0];
        for (i, &before) in self.before.iter().enumerate() {
            let sample = queue.sample[i];
            sink.absorb(before - queue.throughput_of(i) * self.paths[sample as usize].power);
            let glow = std::mem::replace(&mut self.glow[sample as usize], Rgb::ZERO);
            if glow != Rgb::ZERO {
                sink.glow(sample, glow);
            }
        }
    }

    /// Return whether subpaths go on after so many bounces.
    fn goes_on(&self, bounce: u32) -> bool {
        self.limits.max_depth.is_none_or(|most| bounce < most)
    }

    /// Take sixteen subpaths to the surfaces that they have met, and scatter them there.
    fn meet_surfaces(&mut self, some: &[u32], numbers: &mut SamplerLanes, bounce: u32, sink: &mut dyn SubpathSink<'a>) {
        let (samples, goes_on, is_light) = (self.paths.len() as u32, self.goes_on(bounce), self.worker.is_light());
        self.worker.meet_surfaces(some);
        self.worker.gather_media(samples);
        self.worker.gather_waves();
        self.worker.gather_numbers(samples, numbers);
        self.worker.evaluate_materials(numbers, bounce);
        if is_light {
            self.multiply_repeat_corrections();
        } else {
            self.worker.correct_repeats();
        }
        let (mut choice, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        let dimensions = Dimensions::of(bounce, 0);
        if goes_on {
            let mut single = [[0.0; LANES]; 2];
            numbers.choice_and_pair(self.worker.level, dimensions.scattering_choice(), &mut choice, &mut single);
            u = single.map(|u| u.map(f64::from));
            self.worker.sample_bsdfs((&mut choice, &u), None);
        }
        let mut shadows = std::mem::take(&mut self.worker.shadows);
        let (worker, mut onward) = (&self.worker, [None; LANES]);
        let (block, queue) = (&*worker.block, &worker.paths[0]);
        for lane in 0..block.surfaces.count {
            let (i, sample) = (block.surfaces.index[lane] as usize, block.sample[lane]);
            let path = &mut self.paths[sample as usize];
            let waves = waves::at(&worker.waves, sample);
            let betas = [queue.throughput_of(i), rgb(block.throughput.get(lane))];
            path.arrive(bounce, betas, block.bsdf.flags[lane], waves);
            let make = || worker.vertex(lane, waves);
            let (origin, direction) = (block.surfaces.ray_origin(lane), block.surfaces.direction.get(lane).as_dvec3());
            let surface = (block.surfaces.normal.get(lane), block.surfaces.primitive[lane]);
            let at = Arrival::new(origin, direction.normalize(), queue.rays.time(i), &make).on_surface(
                surface,
                block.bsdf.width[lane].into(),
                block.bsdf.diffuse_and_flat(lane),
            );
            let mut context = VertexContext {
                samplers: worker.samplers.as_ref(),
                dimensions,
                shadows: &mut shadows,
                connections: &mut self.connections,
                sample,
                media: [block.media.here[lane], block.media.through[lane]],
            };
            sink.meet(&at, path, &mut context);
            if !goes_on {
                continue;
            }
            let next = if is_light {
                let own = || at.vertex().onward(&mut || choice[lane], [u[0][lane], u[1][lane]]);
                block.bsdf.onward(&block.next, lane).unwrap_or_else(own)
            } else {
                block.bsdf.continuation(&block.next, lane)
            };
            if let Some(next) = &next {
                sink.go_on(&at, path, next);
                let bsdf = block.bsdf.get(lane);
                let is_held = roulette::is_held(bsdf.transmits(), next.is_single, next.is_through);
                path.held = if is_held { path.held.saturating_add(1) } else { 0 };
                (path.is_sharp, path.is_adrift) = (next.is_single || !is_matt(bsdf), false);
            }
            onward[lane] = next;
        }
        self.worker.shadows = shadows;
        if goes_on {
            if is_light {
                let most = self.worker.block.sample.map(|sample| roulette::held(self.paths[sample as usize].held));
                self.worker.scatter_flux(&onward, &most);
            }
            self.worker.go_on_from_any(numbers, bounce, samples, None);
        }
    }

    /// Stage: light subpaths that have met a reflectance above 1 have the remaining share of the surface before, once
    /// they meet another.
    fn multiply_repeat_corrections(&mut self) {
        let block = &mut *self.worker.block;
        for lane in 0..block.surfaces.count {
            let again = block.bsdf.get(lane).repeat_correction();
            if again != Rgb::ONE {
                let path = &mut self.paths[block.sample[lane] as usize];
                let before = std::mem::replace(&mut path.again, again);
                block.throughput.set(lane, block.throughput.get(lane) * before.as_vec3());
            }
        }
    }

    /// Take all subpaths to where media scatter them, and scatter them there.
    fn meet_media(&mut self, numbers: &mut SamplerLanes, bounce: u32, sink: &mut dyn SubpathSink<'a>) {
        let (samples, goes_on, dimensions) = (self.paths.len() as u32, self.goes_on(bounce), Dimensions::of(bounce, 0));
        let Some(scattered) = self.worker.media.as_mut().map(|media| std::mem::take(&mut media.scattered)) else {
            return;
        };
        for some in scattered.chunks(LANES) {
            self.worker.meet_medium(some);
            self.worker.gather_media(samples);
            self.worker.gather_numbers(samples, numbers);
            let (direction, pdf) = self.worker.sample_phases((some, 0), numbers, bounce, samples);
            let mut shadows = std::mem::take(&mut self.worker.shadows);
            let worker = &self.worker;
            let (block, queue) = (&*worker.block, &worker.paths[0]);
            for (lane, event) in some.iter().enumerate() {
                let (i, sample, here) = (event.path as usize, block.sample[lane], block.media.here[lane]);
                let path = &mut self.paths[sample as usize];
                let waves = waves::at(&worker.waves, sample);
                path.arrive(bounce, [rgb(block.throughput.get(lane)); 2], block.bsdf.flags[lane], waves);
                let collision = event.collision.times(path.power);
                let make = || {
                    let (ray, stack, position) = (queue.rays.get(i), worker.stack(here), event.position);
                    let scattering = Scattering { position, before: event.before, phase: event.phase };
                    let at = Vertex::of_medium(worker.scene, scattering, &collision, (ray, stack), waves.as_ref());
                    let vertex = queue.vertex(i);
                    let ray = Ray { origin: vertex, direction: event.before, ..ray };
                    Vertex { ray, t: (position - vertex).length(), ..at }
                };
                let origin = RayOrigin::free(event.position);
                let at = Arrival::new(origin, event.before, queue.rays.time(i), &make);
                let mut context = VertexContext {
                    samplers: worker.samplers.as_ref(),
                    dimensions,
                    shadows: &mut shadows,
                    connections: &mut self.connections,
                    sample,
                    media: [here; 2],
                };
                sink.meet(&at, path, &mut context);
                if goes_on {
                    let (direction, pdf) = (direction.get(lane).as_dvec3().normalize(), pdf[lane].into());
                    let next = Onward { direction, weight: Rgb::ONE, pdf, is_through: false, is_single: false };
                    sink.go_on(&at, path, &next);
                    (path.held, path.is_sharp, path.is_adrift) = (0, false, true);
                }
            }
            self.worker.shadows = shadows;
            if goes_on {
                self.worker.scatter_in_medium((some, 0), (&direction, &pdf), numbers, bounce);
            }
        }
        if let Some(media) = &mut self.worker.media {
            media.scattered = scattered;
        }
    }
}

impl<'a> WavefrontWorker<'a> {
    /// Return the vertex of a lane at a surface, at the wavelengths of its subpath.
    fn vertex(&self, lane: usize, waves: Option<Waves>) -> Vertex<'a> {
        let (block, queue) = (&*self.block, &self.paths[0]);
        let (ray, hit) = self.scene.geometry().hit_of_lane((&queue.rays, &self.hits), &block.surfaces, lane);
        let media = [block.media.here[lane], block.media.through[lane]].map(|number| self.stack(number));
        let outside = block.media.outside[lane];
        let mut at = Vertex::of_surface(self.scene, (ray, hit), outside, media.into(), waves);
        let context = LookupContext { width: block.bsdf.width[lane].into(), waves };
        if let Point::Surface { arrived, wide, .. } = &mut at.point
            && context.width > 0.0
        {
            let surface = *arrived.here.surface();
            *wide = Some(Box::new(SurfaceInteraction::new(self.scene, &ray, &hit, surface, context, arrived.outside)));
        }
        let vertex = queue.vertex(block.surfaces.index[lane] as usize);
        at.come_from(vertex, (block.surfaces.position.get(lane) - vertex).length());
        at
    }
}
