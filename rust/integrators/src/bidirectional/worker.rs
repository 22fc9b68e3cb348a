//! Batches of camera paths, each with a light path.

use super::camera_paths::{EyePath, EyeQueue};
use super::light_vertices::LightVertices;
use super::vertex_merging::{MergeMap, Merging};
use super::{Bidirection, PathStrategy};
use crate::dimensions::Dimensions;
use crate::light_paths::{Arrived, LightEnds, LightWalk, Limits, Partial, Point, Times, Vertex};
use crate::media::current_medium::Filled;
use crate::media::medium_traversal::{LeftDepth, MediumTraversal, RaySegmentState, SegmentEnd, TraversalEnd};
use crate::media::path_numbers::{FurtherNumbers, PathNumbers, depth};
use crate::media::spectral_mis::Weights;
use crate::nesting::MediumStack;
use crate::roulette;
use crate::shadows::Shadows;
use crate::terminate_wavelengths::Parting;
use crate::widths::widened;
use crate::{CameraSample, Job, Worker};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{Emitters, Interaction, LookupContext, SurfaceInteraction};
use std::sync::Arc;

/// Per-thread state.
pub(super) struct BidirectionalWorker<'a> {
    pub(super) job: Job<'a>,
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
    now: EyeQueue,
    next: EyeQueue,
    hits: Vec<Hit>,
    /// True if every hit of a shadow ray occludes; then these are traced together.
    pub(super) is_plain: bool,
    pub(super) shadows: Shadows,
    /// Light paths, if any light can be sampled.
    light: Option<(LightWalk<'a>, LightVertices<'a>)>,
    /// Vertex merging if enabled, and the maps of the current samples.
    merging: Option<&'a Merging<'a>>,
    maps: Vec<(u32, Arc<MergeMap>)>,
    samplers: Vec<Sampler>,
    /// Further random numbers of each sample.
    further: Vec<FurtherNumbers>,
}

impl<'a> BidirectionalWorker<'a> {
    /// Samples per batch. Their light vertices are stored at half a kilobyte each.
    const TOGETHER: usize = 512;

    pub fn new(shared: &'a Bidirection<'a>) -> Self {
        let (job, limits, emitters) = (shared.job, shared.limits, shared.emitters.as_ref());
        let (scene, camera, needs) = (job.scene, job.camera, job.scene.plan().needs());
        // A connection counts as a scattering event, too.
        let within = Limits { max_depth: limits.max_depth.map(|depth| depth.saturating_sub(1)), ..limits };
        let light = |emitters: &'a Emitters<'a>| {
            let walk = LightWalk::new(scene, emitters, within, Some(camera));
            (walk, LightVertices::new(LightEnds::new(emitters)))
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
            now: EyeQueue::default(),
            next: EyeQueue::default(),
            hits: Vec::new(),
            is_plain: Shadows::are_plain(scene),
            shadows: Shadows::default(),
            light: emitters.filter(|_| limits.max_depth.is_none_or(|depth| depth > 1)).map(light),
            merging: shared.merging.as_ref(),
            maps: Vec::new(),
            samplers: Vec::new(),
            further: Vec::new(),
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
        while !self.now.paths.is_empty() && !cancel.is_raised() {
            self.hits.clear();
            self.hits.resize(self.now.paths.len(), Hit::MISS);
            self.job.scene.intersect_queue(&mut self.now.rays, &mut self.hits);
            self.step(samples, light.as_ref().map(|(_, vertices)| vertices), cancel, radiance);
            self.shadows.add_unblocked(self.job.scene, radiance);
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
    fn merge(&self, at: &Vertex, path: &EyePath, number: u32, most: Option<u32>) -> Rgb {
        let (Some(merging), Some(arrived)) = (self.merging, at.matte()) else { return Rgb::ZERO };
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
        path.throughput() * merging.found(map, (at, arrived, path), most, alone)
    }

    /// Queue the camera rays.
    fn start(&mut self, samples: &mut [CameraSample]) {
        self.next.clear();
        self.further.clear();
        let mut media = Vec::new();
        let needs = self.job.scene.plan().needs();
        if needs.media || needs.nested {
            let rays: Vec<Ray> = samples.iter().map(|sample| sample.ray).collect();
            MediumStack::<Filled>::at(self.job.scene, &rays, &mut media);
        } else {
            media.resize(samples.len(), MediumStack::NONE);
        }
        for ((number, sample), media) in (0u32..).zip(samples).zip(media) {
            let mut further = FurtherNumbers::new(sample.sampler.apart());
            let waves = self.waves.get(number as usize).copied();
            // The choice must be independent of the wavelengths' own: dispersion keeps the first.
            let hero = match waves {
                Some(_) => further.hero(),
                None => ((sample.sampler.one(Dimensions::WAVES) * 3.0) as usize).min(2),
            };
            self.further.push(further);
            let mut path = EyePath {
                sample: number,
                going: RaySegmentState { ray: sample.ray, weights: Weights::START, media },
                left: LeftDepth { hero, way: f64::INFINITY, start: 0.0 },
                scale: 1.0,
                bounce: 0,
                footprint: self.job.footprint,
                has_gamut_excess: false,
                partial: Partial::of_camera(self.paths, 0.0),
                disk: self.merging.map_or(0.0, |merging| merging.disk(sample.sampler.number())),
                normal: DVec3::ZERO,
                waves,
                single: false,
            };
            self.take_off(&mut path, &mut sample.sampler);
        }
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// Queue a path that starts along its ray.
    fn take_off(&mut self, path: &mut EyePath, sampler: &mut Sampler) {
        let way = depth(sampler.one(Dimensions::of(path.bounce, 0).mask()));
        path.left = LeftDepth { way, start: path.going.ray.t_min, ..path.left };
        self.next.push(&MediumTraversal::alone(self.job.scene, path.waves_with(false)), path);
    }

    /// Take all paths to their hits, and those that scatter there to their next rays.
    fn step(
        &mut self,
        samples: &mut [CameraSample],
        light: Option<&LightVertices<'a>>,
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        self.next.clear();
        let mut further = std::mem::take(&mut self.further);
        for i in 0..self.now.paths.len() {
            let (hit, mut path) = (self.hits[i], self.now.paths[i]);
            let course = MediumTraversal::alone(self.job.scene, path.waves_with(false));
            let sample = path.sample as usize;
            let (sampler, light_here) = (&mut samples[sample].sampler, &mut radiance[sample]);
            let number = sampler.number();
            let mut numbers = PathNumbers::new(sampler, &mut further[sample]);
            numbers.ray = Dimensions::of(path.bounce, 0);
            let (going, left) = (&mut path.going, &mut path.left);
            let end = match course.step(going, left, &hit, &mut numbers, cancel, light_here, None) {
                SegmentEnd::Passes => {
                    self.next.push(&course, &path);
                    continue;
                }
                SegmentEnd::Absorbed => continue,
                SegmentEnd::Ends(end) => end,
            };
            let mut parting = None;
            let Some(at) = self.vertex(end, &mut path, &mut parting, light_here) else { continue };
            let numbers = (&mut numbers, cancel);
            if self.arrive(&at, &mut path, parting, number, numbers, light, light_here) {
                self.take_off(&mut path, &mut samples[sample].sampler);
            }
        }
        self.further = further;
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// Return the vertex at the end of a path's ray, after adding emission there, and the dispersion that splits its
    /// wavelengths.
    #[inline(always)]
    fn vertex(
        &self,
        end: TraversalEnd,
        path: &mut EyePath,
        parting: &mut Option<Parting>,
        light: &mut Rgb,
    ) -> Option<Vertex<'a>> {
        let RaySegmentState { ray, media, .. } = path.going;
        let scene = self.job.scene;
        match end {
            TraversalEnd::Outside => {
                *light += path.throughput() * self.outside(path);
                None
            }
            TraversalEnd::Medium { here, collision, .. } => {
                path.footprint = path.footprint.at(collision.t);
                Some(Vertex::of_medium(scene, here, &collision, (ray, media), path.waves.as_ref()))
            }
            TraversalEnd::Surface { hit, outside, through } => {
                let mut at = Vertex::of_surface(scene, (ray, hit), outside, (media, through), path.waves, parting);
                path.footprint = path.footprint.at(hit.t);
                let width = if self.widths { path.footprint.width } else { 0.0 };
                let gaze = LookupContext { width, waves: path.waves };
                if let Point::Surface { arrived, .. } = &at.point {
                    *light += path.throughput() * self.emitted(arrived, path, gaze);
                    if width > 0.0 {
                        let surface = *arrived.here.surface();
                        let wide = SurfaceInteraction::new(scene, &ray, &hit, surface, gaze, arrived.outside);
                        at.set_wide(wide);
                    }
                }
                if parting.is_some_and(|parting| !at.waits(&parting)) {
                    path.end_all_but_first();
                }
                Some(at)
            }
        }
    }

    /// Connect a path from a vertex, scatter it, and return whether it continues.
    #[allow(clippy::too_many_arguments)]
    fn arrive(
        &mut self,
        at: &Vertex<'a>,
        path: &mut EyePath,
        parting: Option<Parting>,
        number: u32,
        (numbers, cancel): (&mut PathNumbers, &Cancel),
        light: Option<&LightVertices<'a>>,
        radiance: &mut Rgb,
    ) -> bool {
        if self.limits.max_depth.is_some_and(|most| path.bounce >= most) {
            return false;
        }
        let cosine = at.cosine(at.back());
        path.partial = if path.bounce == 0 {
            Partial::of_camera(self.paths, self.seen(at, numbers) * cosine)
        } else {
            path.partial.arrived(at.t, cosine)
        };
        if path.disk > 0.0 && at.matte().is_some() {
            path.partial = path.partial.merging(path.disk);
        }
        let again = at.repeat_correction();
        if again != Rgb::ONE {
            if path.has_gamut_excess {
                path.going.weights.carried *= again;
            }
            path.has_gamut_excess = true;
        }
        if let Some(emitters) = self.emitters.filter(|_| !at.is_single()) {
            self.ask(emitters, at, path, (numbers, cancel), radiance);
            let most = self.limits.max_depth.map(|depth| depth - path.bounce - 1);
            for vertex in light.into_iter().flat_map(|light| light.of(path.sample)) {
                if most.is_none_or(|most| vertex.bounce <= most) {
                    self.connect(emitters, at, path, vertex, (numbers, cancel), radiance);
                }
            }
            *radiance += self.merge(at, path, number, most);
        }
        self.go_on(at, path, parting, numbers)
    }

    /// Return the density of camera rays at the first vertex, per area perpendicular to them, in pixels.
    fn seen(&self, at: &Vertex, numbers: &mut PathNumbers) -> f64 {
        let camera = self.job.camera;
        let lens = if camera.uses_lens() { numbers.two(1) } else { [0.5; 2] };
        let time = if self.moves { numbers.one(3) } else { 0.0 };
        camera.connect(at.position(), lens, time).map_or(0.0, |seen| seen.density)
    }

    /// Return the weighted light of infinite lights that a path hits.
    fn outside(&self, path: &EyePath) -> Rgb {
        let (lights, direction) = (self.job.scene.lights(), path.going.ray.direction);
        let arriving = lights.infinite_radiance_at(direction, path.waves.as_ref());
        if arriving.is_black() || path.bounce == 0 && self.alone.is_none() {
            return arriving;
        }
        arriving
            * match (self.alone, self.emitters) {
                (Some(_), _) => self.full(0, path.bounce + 2),
                (None, Some(emitters)) => {
                    let asked = lights.infinite_pdf(&path.receiver(), direction);
                    path.partial.of_found(asked, &emitters.of_environment(direction))
                }
                (None, None) => 1.0,
            }
    }

    /// Return the weighted emission of a surface that a path hits.
    fn emitted(&self, arrived: &Arrived, path: &EyePath, gaze: LookupContext) -> Rgb {
        let (scene, Arrived { ray, hit, .. }) = (self.job.scene, arrived);
        let (geometry, surface) = (scene.geometry(), arrived.here.surface());
        let emission = scene.emission_at(surface);
        if emission.is_dark() {
            return Rgb::ZERO;
        }
        let sent = emission.sent(geometry, ray, hit, surface, || gaze);
        if sent.is_black() || path.bounce == 0 && self.alone.is_none() {
            return sent;
        }
        sent * match (self.alone, self.emitters.and_then(|emitters| emitters.of_hit(ray, hit, surface))) {
            (Some(_), _) => self.full(0, path.bounce + 2),
            (None, Some(departure)) => {
                let cosine = -ray.direction.dot(surface.normal);
                let asked = scene.lights().surface_pdf(geometry, &path.receiver(), ray, hit, cosine);
                path.partial.of_found(asked, &departure)
            }
            (None, None) => 1.0,
        }
    }

    /// Scatter a path and return whether it continues.
    fn go_on(&self, at: &Vertex, path: &mut EyePath, parting: Option<Parting>, numbers: &mut PathNumbers) -> bool {
        let ray = numbers.ray;
        let (u, choice) = (numbers.two(ray.direction()), ray.scattering_choice());
        let next = match &at.point {
            Point::Surface { arrived, wide, .. } => {
                let here = wide.as_deref().unwrap_or(&arrived.here);
                here.sample(&mut || numbers.one(choice), u)
            }
            Point::Medium { here, .. } => here.sample(&mut || 0.0, u),
        };
        let Some(next) = next else { return false };
        path.going.weights.carried *= next.weight;
        match (&at.point, parting) {
            (_, Some(_)) if next.is_through => path.end_all_but_first(),
            (Point::Surface { arrived, wide, .. }, Some(parting)) if !path.single => {
                let here = wide.as_deref().unwrap_or(&arrived.here);
                path.going.weights.carried *= parting.mirrored(here.wo());
            }
            _ => {}
        }
        path.scale *= next.eta * next.eta;
        path.bounce += 1;
        let throughput = path.throughput();
        if path.bounce >= self.limits.roulette_depth.min(roulette::AT_LATEST) {
            // Light leaves a finite medium eventually.
            let may_never_end = matches!(at.point, Point::Surface { .. }) || self.job.scene.surrounding().is_some();
            let survival = if may_never_end {
                roulette::survival(throughput, path.scale)
            } else {
                (throughput.max() * path.scale).sqrt().min(1.0)
            };
            if numbers.one(ray.roulette()) >= survival {
                return false;
            }
            path.going.weights.carried /= survival;
        }
        if throughput.is_black() || !throughput.is_finite() {
            return false;
        }
        let cosine = at.cosine(next.wi);
        path.partial = if next.is_delta() {
            path.partial.scattered_singly(cosine)
        } else {
            let forward = if at.is_wide() { at.evaluate(next.wi).1 } else { next.pdf };
            path.partial.scattered(cosine, forward, at.light_back_pdf(next.wi))
        };
        if self.widths {
            path.footprint = widened(&path.footprint, path.footprint.width, at.curvature(), &next);
        }
        path.normal = at.receiver().normal;
        path.going.media = at.media_after(next.is_through);
        path.going.ray = at.leaving(at.origin().ray(next.wi), Ray::NO_TRIANGLE);
        true
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
