//! Batches of camera paths, each with a light path.

use super::camera_paths::{EyePath, EyeQueue, EyeVertex};
use super::light_vertices::LightVertices;
use super::vertex_merging::{MergeMap, Merging};
use super::{Bidirection, PathStrategy};
use crate::dimensions::Dimensions;
use crate::light_paths::{Arrived, LightWalk, Limits, Partial, Partials, Times};
use crate::nesting::MediumStack;
use crate::roulette;
use crate::shadows::Shadows;
use crate::skip_intersections::{Met, Passing};
use crate::widths::widened;
use crate::{CameraSample, Job, Worker, is_matt};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Dispersive, Rgb};
use raywright_scene::{Emitters, Interaction, LookupContext, SurfaceInteraction};
use std::sync::Arc;

/// Per-thread state.
pub(super) struct BidirectionalWorker<'a> {
    job: Job<'a>,
    emitters: Option<&'a Emitters<'a>>,
    limits: Limits,
    pub(super) alone: Option<PathStrategy>,
    /// Number of light paths per camera sample of the whole picture.
    paths: f64,
    /// True if samples are spread over time.
    moves: bool,
    /// True if materials need ray widths.
    widths: bool,
    /// Wavelengths of samples; `None` for RGB.
    waves: Vec<Waves>,
    pub(super) passing: Passing,
    now: EyeQueue,
    next: EyeQueue,
    hits: Vec<Hit>,
    pub(super) shadows: Shadows,
    /// Light paths, if any light can be sampled.
    light: Option<(LightWalk<'a>, LightVertices<'a>)>,
    /// Vertex merging if enabled, and the maps of the current samples.
    merging: Option<&'a Merging<'a>>,
    maps: Vec<(u32, Arc<MergeMap>)>,
    samplers: Vec<Sampler>,
}

impl<'a> BidirectionalWorker<'a> {
    /// Samples per batch. Their light vertices are stored at half a kilobyte each.
    const TOGETHER: usize = 512;

    pub fn new(shared: &'a Bidirection<'a>) -> Self {
        let (job, limits, emitters) = (shared.job, shared.limits, shared.emitters.as_ref());
        let (scene, camera, needs) = (job.scene, job.camera, job.scene.plan().needs());
        // A connection of two surfaces counts as a bounce, too.
        let within = Limits { max_depth: limits.max_depth.map(|depth| depth.saturating_sub(1)), ..limits };
        let light = |emitters: &'a Emitters<'a>| {
            let walk = LightWalk::new(scene, emitters, within, Some(camera));
            (walk, LightVertices::new(Partials::new(emitters)))
        };
        Self {
            job,
            emitters,
            limits,
            alone: shared.alone,
            paths: f64::from(camera.width()) * f64::from(camera.height()),
            moves: scene.geometry().moves() || camera.uses_time(),
            widths: needs.points.width,
            waves: Vec::new(),
            passing: Passing::new(needs.masks, needs.nested),
            now: EyeQueue::default(),
            next: EyeQueue::default(),
            hits: Vec::new(),
            shadows: Shadows::default(),
            light: emitters.filter(|_| limits.max_depth.is_none_or(|depth| depth > 1)).map(light),
            merging: shared.merging.as_ref(),
            maps: Vec::new(),
            samplers: Vec::new(),
        }
    }

    /// Trace the paths of samples to their ends and add their contributions.
    fn follow(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        self.draw_waves(samples);
        let mut light = self.light.take();
        if let Some((walk, vertices)) = &mut light {
            self.samplers.clear();
            self.samplers.extend(samples.iter().map(|sample| sample.sampler.paired()));
            let disks = self.merging.map(|merging| samples.iter().map(|sample| merging.disk(sample.sampler.number())));
            vertices.begin(samples.len(), disks.into_iter().flatten());
            walk.set_times(Times::Each(samples.iter().map(|sample| sample.ray.time).collect()));
            walk.set_waves(self.waves.iter().copied());
            walk.follow(&mut self.samplers, cancel, vertices);
        }
        self.begin_merging(samples);
        self.start(samples);
        while !self.now.rays.is_empty() && !cancel.is_raised() {
            self.hits.resize(self.now.rays.len(), Hit::MISS);
            self.job.scene.intersect_queue(&mut self.now.rays, &mut self.hits);
            self.bounce(samples, light.as_ref().map(|(_, vertices)| vertices), radiance);
            if self.passing.is_needed() {
                self.shadows.add_through(self.job.scene, self.passing.is_nested(), radiance);
            } else {
                self.shadows.add_unblocked(self.job.scene, radiance);
            }
            self.shadows.clear();
        }
        self.light = light;
        for (light, waves) in radiance.iter_mut().zip(&self.waves) {
            *light = waves.seen(*light);
        }
    }

    /// Sample the wavelengths, common to both paths of a sample, in scenes that need them.
    fn draw_waves(&mut self, samples: &mut [CameraSample]) {
        if self.job.scene.plan().needs().waves {
            self.waves.clear();
            let merging = self.merging;
            self.waves.extend(samples.iter_mut().map(|sample| {
                let of_merging = merging.and_then(|merging| merging.waves(sample.sampler.number()));
                of_merging.unwrap_or_else(|| Waves::of(sample.sampler.one(Dimensions::WAVES)))
            }));
        }
    }

    /// Look up the maps of the current samples.
    fn begin_merging(&mut self, samples: &[CameraSample]) {
        self.maps.clear();
        let Some(merging) = self.merging else { return };
        for number in samples.iter().map(|sample| sample.sampler.number()) {
            if !self.maps.iter().any(|(other, _)| *other == number) {
                self.maps.extend(merging.map(number).map(|map| (number, map)));
            }
        }
    }

    /// Return the light merged at a camera vertex.
    fn merge(&self, at: &EyeVertex<'a>, path: &EyePath, number: u32, most: Option<u32>) -> Rgb {
        let Some(merging) = self.merging.filter(|_| is_matt(at.arrived.here.bsdf())) else { return Rgb::ZERO };
        let Some((_, map)) = self.maps.iter().find(|(other, _)| *other == number) else { return Rgb::ZERO };
        let alone = match self.alone {
            None => None,
            // The merged vertex belongs to both subpaths. The light and this surface are not bounces of the photon.
            Some(PathStrategy { vertices: [light, camera], merges: true })
                if camera == path.bounce + 2 && light > 2 =>
            {
                Some(light - 2)
            }
            Some(_) => return Rgb::ZERO,
        };
        path.throughput * merging.found(map, (at, path), most, alone)
    }

    /// Queue the camera rays.
    fn start(&mut self, samples: &[CameraSample]) {
        self.now.clear();
        for (number, sample) in (0u32..).zip(samples) {
            let path = EyePath {
                sample: number,
                throughput: Rgb::ONE,
                scale: 1.0,
                bounce: 0,
                media: MediumStack::NONE,
                chance: -1.0,
                footprint: self.job.footprint,
                has_gamut_excess: false,
                partial: Partial::of_camera(self.paths, 0.0),
                disk: self.merging.map_or(0.0, |merging| merging.disk(sample.sampler.number())),
                normal: DVec3::ZERO,
                waves: self.waves.get(number as usize).copied(),
                single: false,
            };
            self.now.push(&sample.ray, path);
        }
        if self.passing.is_nested() {
            let mut media = Vec::new();
            MediumStack::at(self.job.scene, self.now.rays.rows(), &mut media);
            for (path, media) in self.now.paths.iter_mut().zip(media) {
                path.media = media;
            }
        }
    }

    /// Advance all paths by one ray.
    fn bounce(&mut self, samples: &mut [CameraSample], light: Option<&LightVertices<'a>>, radiance: &mut [Rgb]) {
        self.next.clear();
        self.passing.begin(self.job.scene, &self.now.rays, &self.hits);
        for i in 0..self.now.rays.len() {
            let (ray, hit, mut path) = (self.now.rays.get(i), self.hits[i], self.now.paths[i]);
            if !hit.is_hit() {
                radiance[path.sample as usize] += path.throughput * self.outside(&ray, &path);
                continue;
            }
            let sampler = &mut samples[path.sample as usize].sampler;
            let number = || sampler.one(Dimensions::of(path.bounce, 0).mask());
            match self.passing.meet(self.job.scene, i, (&ray, &hit), &path.media, &mut path.chance, number) {
                Met::Nothing(ray, media) => self.next.push(&ray, EyePath { media, ..path }),
                Met::Surface { hit, outside, through } => {
                    let (arrived, parting) = match path.waves {
                        None => (Arrived::new(self.job.scene, ray, hit, outside), None),
                        Some(waves) => {
                            let around = match self.passing.is_nested() {
                                true => [&path.media, &through].map(MediumStack::dispersion),
                                false => [Dispersive::NONE; 2],
                            };
                            Arrived::by_waves(self.job.scene, (ray, hit), (outside, around), waves)
                        }
                    };
                    let width = if self.widths { path.footprint.at(hit.t).width } else { 0.0 };
                    let wide = (width > 0.0).then(|| {
                        let surface = *arrived.here.surface();
                        let gaze = LookupContext { width, waves: path.waves };
                        SurfaceInteraction::new(self.job.scene, &ray, &hit, surface, gaze, arrived.outside)
                    });
                    let at = EyeVertex { arrived, wide, through, parting };
                    self.arrive(&at, path, width, sampler, light, &mut radiance[path.sample as usize]);
                }
            }
        }
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// Advance a path from a surface to its next ray, given the ray's width there.
    fn arrive(
        &mut self,
        at: &EyeVertex<'a>,
        mut path: EyePath,
        width: f64,
        sampler: &mut Sampler,
        light: Option<&LightVertices<'a>>,
        radiance: &mut Rgb,
    ) {
        *radiance += path.throughput * self.emitted(at, &path, width);
        if self.limits.max_depth.is_some_and(|most| path.bounce >= most) {
            return;
        }
        let here = at.here();
        if at.parting.is_some_and(|parting| !parting.waits(here.bsdf())) {
            path.end_all_but_hero();
        }
        let cosine = at.arrived.cosine(at.arrived.back());
        path.partial = if path.bounce == 0 {
            Partial::of_camera(self.paths, self.seen(at, sampler) * cosine)
        } else {
            path.partial.arrived(at.arrived.hit.t, cosine)
        };
        if path.disk > 0.0 && is_matt(at.arrived.here.bsdf()) {
            path.partial = path.partial.merging(path.disk);
        }
        let again = here.bsdf().repeat_correction();
        if again != Rgb::ONE {
            if path.has_gamut_excess {
                path.throughput *= again;
            }
            path.has_gamut_excess = true;
        }
        let dimensions = Dimensions::of(path.bounce, 0);
        if let Some(emitters) = self.emitters.filter(|_| !here.bsdf().is_delta()) {
            let choice = dimensions.light_choice(0);
            self.ask(emitters, at, &path, (sampler.one(choice), sampler.two(choice + 1)));
            let most = self.limits.max_depth.map(|depth| depth - path.bounce - 1);
            for vertex in light.into_iter().flat_map(|light| light.of(path.sample)) {
                if most.is_none_or(|most| vertex.bounce <= most) {
                    self.connect(emitters, at, &path, vertex);
                }
            }
            *radiance += self.merge(at, &path, sampler.number(), most);
        }
        self.go_on(at, path, width, sampler, dimensions);
    }

    /// Return the density of camera rays at the first hit, per area perpendicular to them, in pixels.
    fn seen(&self, at: &EyeVertex, sampler: &mut Sampler) -> f64 {
        let camera = self.job.camera;
        let lens = if camera.uses_lens() { sampler.two(1) } else { [0.5; 2] };
        let time = if self.moves { sampler.one(3) } else { 0.0 };
        camera.connect(at.arrived.here.position(), lens, time).map_or(0.0, |seen| seen.density)
    }

    /// Return the weighted light of infinite lights that a path hits.
    fn outside(&self, ray: &Ray, path: &EyePath) -> Rgb {
        let lights = self.job.scene.lights();
        let arriving = lights.infinite_radiance_at(ray.direction, path.waves.as_ref());
        if arriving.is_black() || path.bounce == 0 && self.alone.is_none() {
            return arriving;
        }
        arriving
            * match (self.alone, self.emitters) {
                (Some(_), _) => self.full(0, path.bounce + 2),
                (None, Some(emitters)) => {
                    let asked = lights.infinite_pdf(&path.receiver(ray), ray.direction);
                    path.partial.of_found(asked, &emitters.of_environment(ray.direction))
                }
                (None, None) => 1.0,
            }
    }

    /// Return the weighted emission of a surface that a path hits.
    fn emitted(&self, at: &EyeVertex, path: &EyePath, width: f64) -> Rgb {
        let (scene, Arrived { ray, hit, .. }) = (self.job.scene, &at.arrived);
        let (geometry, surface) = (scene.geometry(), at.arrived.here.surface());
        let emission = scene.emission_at(surface);
        if emission.is_dark() {
            return Rgb::ZERO;
        }
        let sent = emission.sent(geometry, ray, hit, surface, || LookupContext { width, waves: path.waves });
        if sent.is_black() || path.bounce == 0 && self.alone.is_none() {
            return sent;
        }
        sent * match (self.alone, self.emitters.and_then(|emitters| emitters.of_hit(ray, hit, surface))) {
            (Some(_), _) => self.full(0, path.bounce + 2),
            (None, Some(departure)) => {
                let cosine = -ray.direction.dot(surface.normal);
                let asked = scene.lights().surface_pdf(geometry, &path.receiver(ray), ray, hit, cosine);
                path.partial.of_found(asked, &departure)
            }
            (None, None) => 1.0,
        }
    }

    /// Continue a path from a surface, unless it ends there.
    fn go_on(&mut self, at: &EyeVertex, mut path: EyePath, width: f64, sampler: &mut Sampler, dimensions: Dimensions) {
        let here = at.here();
        let u = sampler.two(dimensions.direction());
        let Some(next) = here.sample(&mut || sampler.one(dimensions.scattering_choice()), u) else { return };
        path.throughput *= next.weight;
        path.part(at.parting.as_ref(), here.wo(), &next);
        path.scale *= next.eta * next.eta;
        path.bounce += 1;
        if path.bounce >= self.limits.roulette_depth.min(roulette::AT_LATEST) {
            let survival = roulette::survival(path.throughput, path.scale);
            let survives = sampler.one(dimensions.roulette()) < survival;
            if !survives {
                return;
            }
            path.throughput /= survival;
        }
        if path.throughput.is_black() || !path.throughput.is_finite() {
            return;
        }
        let cosine = at.arrived.cosine(next.wi);
        path.partial = if next.is_delta() {
            path.partial.scattered_singly(cosine)
        } else {
            let forward = if at.wide.is_some() { at.arrived.here.evaluate(next.wi).1 } else { next.pdf };
            path.partial.scattered(cosine, forward, at.onward_pdf(next.wi))
        };
        path.normal = at.arrived.here.light_context().normal;
        if self.widths {
            path.footprint = widened(&path.footprint, width, here.curvature(), &next);
        }
        if next.is_through {
            path.media = at.through;
        }
        path.chance = -1.0;
        self.next.push(&at.leaving(here.ray_origin().ray(next.wi), Ray::NO_TRIANGLE), path);
    }
}

impl Worker for BidirectionalWorker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        assert_eq!(samples.len(), radiance.len());
        radiance.fill(Rgb::ZERO);
        for (samples, radiance) in samples.chunks_mut(Self::TOGETHER).zip(radiance.chunks_mut(Self::TOGETHER)) {
            self.follow(samples, cancel, radiance);
        }
    }
}
