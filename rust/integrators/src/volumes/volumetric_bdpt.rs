//! Volumetric bidirectional path tracing, one sample at a time.
//!
//! It works as among surfaces alone ([`crate::Bidirectional`]), with points of media as additional vertices, whose MIS
//! weights are in [`super::vertex`]. Emission of media is found by camera paths alone.

use super::light_partials::LightEnd;
use super::light_walk::{Drifting, MediaLightWalk, MediaVisitor};
use super::medium_traversal::{MediumTraversal, RaySegmentState, TraversalEnd};
use super::vertex::{Point, Vertex};
use crate::dimensions::Dimensions;
use crate::light_paths::{self, Arrived, Limits, Onward, Partial, of_asked, weight};
use crate::media::current_medium::Filled;
use crate::media::path_numbers::{PathNumbers, depth};
use crate::media::spectral_mis::Weights;
use crate::nesting::MediumStack;
use crate::terminate_wavelengths::Parting;
use crate::widths::widened;
use crate::{CameraSample, Job, Worker, roulette};
use raywright_base::math::{DVec3, Ray};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{
    EmissionSample, Emitters, Footprint, Interaction, LightSampleContext, LookupContext, SurfaceInteraction,
};

/// Per-thread state.
pub(crate) struct BothEnds<'a> {
    job: Job<'a>,
    emitters: Option<&'a Emitters<'a>>,
    limits: Limits,
    /// The one strategy to show, if any: its vertex counts from the light and from the camera.
    alone: Option<[u32; 2]>,
    /// Number of light paths per camera sample of the whole picture.
    paths: f64,
    /// True if samples are spread over time.
    moves: bool,
    /// True if texture lookups use ray widths.
    widths: bool,
    light: Option<(MediaLightWalk<'a>, LightVertices<'a>)>,
}

/// A vertex of a light path.
struct LightVertex<'a> {
    at: Vertex<'a>,
    flux: Rgb,
    again: Rgb,
    bounce: u32,
    single: bool,
    end: LightEnd,
}

/// The vertices of one light path, except delta ones. Later vertices of long paths are stored with decreasing
/// probability.
struct LightVertices<'a> {
    emitters: &'a Emitters<'a>,
    end: Option<LightEnd>,
    all: Vec<LightVertex<'a>>,
}

/// A camera path.
struct EyePath {
    going: RaySegmentState,
    scale: f64,
    bounce: u32,
    has_gamut_excess: bool,
    partial: Partial,
    /// Normal for light sampling at the last scattering event.
    normal: DVec3,
    /// Wavelengths, `None` for RGB; and true if only the first is left.
    waves: Option<Waves>,
    single: bool,
    /// Footprint at the ray's origin.
    footprint: Footprint,
}

/// Data of a sample besides its path.
struct Sample<'s, 'n> {
    hero: usize,
    numbers: &'s mut PathNumbers<'n>,
    cancel: &'s Cancel,
    /// Random numbers for the camera's lens and shutter.
    lens: [f64; 2],
    time: f64,
}

impl<'a> MediaVisitor<'a> for LightVertices<'a> {
    fn set_out(&mut self, _: &Drifting, light: &EmissionSample) {
        self.end = Some(LightEnd::of(self.emitters, light));
    }

    fn meet(
        &mut self,
        at: &Vertex<'a>,
        path: &Drifting,
        numbers: &mut PathNumbers,
        dimensions: light_paths::Dimensions,
        _: &Cancel,
    ) {
        /// Number of vertices that are always stored.
        const ALL: f64 = 32.0;
        let Some(end) = &mut self.end else { return };
        end.arrive(at);
        let odds = ALL / f64::from(path.bounce);
        if at.is_single() || odds < 1.0 && numbers.one(dimensions.keeping()) >= odds {
            return;
        }
        let flux = path.flux() / odds.min(1.0);
        let (again, bounce, single) = (path.again, path.bounce, path.single);
        self.all.push(LightVertex { at: at.clone(), flux, again, bounce, single, end: *end });
    }

    fn go_on(&mut self, at: &Vertex<'a>, _: &Drifting, next: &Onward) {
        if let Some(end) = &mut self.end {
            end.go_on(self.emitters, at, next);
        }
    }
}

impl EyePath {
    fn throughput(&self) -> Rgb {
        self.going.weights.throughput()
    }

    /// Return the context of light sampling at the ray's origin, for MIS with lights that the ray hits.
    fn receiver(&self) -> LightSampleContext {
        LightSampleContext { position: self.going.ray.origin, normal: self.normal, waves: self.waves }
    }

    /// Return the wavelengths for traversing media; one alone if the light carries only one.
    fn waves_with(&self, single: bool) -> Option<Waves> {
        if single || self.single { self.waves.map(|waves| waves.alone()) } else { self.waves }
    }

    /// Terminate all wavelengths but the first, which then stands for all.
    fn end_all_but_first(&mut self) {
        if !self.single {
            self.going.weights.end_all_but_first();
            self.single = true;
        }
    }
}

impl<'a> BothEnds<'a> {
    pub fn new(job: Job<'a>, emitters: Option<&'a Emitters<'a>>, limits: Limits, alone: Option<[u32; 2]>) -> Self {
        let Job { scene, camera, .. } = job;
        // A connection counts as a scattering event, too.
        let within = Limits { max_depth: limits.max_depth.map(|depth| depth.saturating_sub(1)), ..limits };
        let light = |emitters: &'a Emitters<'a>| {
            let walk = MediaLightWalk::new(scene, emitters, within, Some(camera));
            (walk, LightVertices { emitters, end: None, all: Vec::new() })
        };
        Self {
            job,
            emitters,
            limits,
            alone,
            paths: f64::from(camera.width()) * f64::from(camera.height()),
            moves: scene.geometry().moves() || camera.uses_time(),
            widths: scene.plan().needs().points.width,
            light: emitters.filter(|_| limits.max_depth.is_none_or(|depth| depth > 1)).map(light),
        }
    }

    fn course(&self, waves: Option<Waves>) -> MediumTraversal<'a> {
        MediumTraversal::alone(self.job.scene, waves)
    }

    /// Return the weight of a strategy if only one is shown: 1 or 0.
    fn full(&self, light: u32, camera: u32) -> f64 {
        f64::from(u8::from(self.alone == Some([light, camera])))
    }

    /// Return the radiance along a camera ray.
    fn follow(&mut self, sample: &mut CameraSample, media: MediumStack<Filled>, cancel: &Cancel) -> Rgb {
        let u = sample.sampler.one(Dimensions::WAVES);
        let waves = self.job.scene.plan().needs().waves.then(|| Waves::of(u));
        if let Some((walk, vertices)) = &mut self.light {
            walk.set_waves(waves.into_iter());
            vertices.all.clear();
            walk.set_times(light_paths::Times::Each(vec![sample.ray.time]));
            walk.follow(&mut [sample.sampler.paired()], cancel, vertices);
        }
        let camera = self.job.camera;
        let hero = ((u * 3.0) as usize).min(2);
        let lens = if camera.uses_lens() { sample.sampler.two(1) } else { [0.5; 2] };
        let time = if self.moves { sample.sampler.one(3) } else { 0.0 };
        let mut numbers = PathNumbers::apart(&mut sample.sampler);
        // This choice must be independent of the wavelengths' own: dispersion keeps the first.
        let hero = if waves.is_some() { numbers.more.hero() } else { hero };
        let going = RaySegmentState { ray: sample.ray, weights: Weights::START, media };
        let partial = Partial::of_camera(self.paths, 0.0);
        let (normal, single) = (DVec3::ZERO, false);
        let footprint = self.job.footprint;
        let mut path = EyePath {
            going,
            scale: 1.0,
            bounce: 0,
            has_gamut_excess: false,
            partial,
            normal,
            waves,
            single,
            footprint,
        };
        let mut light = Rgb::ZERO;
        let mut sample = Sample { hero, numbers: &mut numbers, cancel, lens, time };
        while self.advance(&mut path, &mut sample, &mut light) {}
        waves.map_or(light, |waves| waves.seen(light))
    }

    /// Advance a path to its next scattering event, scatter it, and return whether it continues.
    fn advance(&self, path: &mut EyePath, sample: &mut Sample, light: &mut Rgb) -> bool {
        sample.numbers.ray = Dimensions::of(path.bounce, 0);
        let u = sample.numbers.ray.mask();
        let way = (sample.hero, depth(sample.numbers.one(u)));
        let course = self.course(path.waves_with(false));
        let place = course.advance(&mut path.going, way, sample.numbers, sample.cancel, light, None);
        let RaySegmentState { ray, media, .. } = path.going;
        let mut parting = None;
        let at = match place {
            None => return false,
            Some(TraversalEnd::Outside) => {
                *light += path.throughput() * self.outside(path);
                return false;
            }
            Some(TraversalEnd::Medium { here, collision, .. }) => {
                path.footprint = path.footprint.at(collision.t);
                Vertex::of_medium(self.job.scene, here, &collision, (ray, media), path.waves.as_ref())
            }
            Some(TraversalEnd::Surface { hit, outside, through }) => {
                let arrived;
                (arrived, parting) = match path.waves {
                    None => (Arrived::new(self.job.scene, ray, hit, outside), None),
                    Some(waves) => {
                        let around = [&media, &through].map(MediumStack::dispersion);
                        Arrived::by_waves(self.job.scene, (ray, hit), (outside, around), waves)
                    }
                };
                path.footprint = path.footprint.at(hit.t);
                let width = if self.widths { path.footprint.width } else { 0.0 };
                let gaze = LookupContext { width, waves: path.waves };
                let seen = (width > 0.0).then(|| {
                    let surface = *arrived.here.surface();
                    SurfaceInteraction::new(self.job.scene, &ray, &hit, surface, gaze, arrived.outside)
                });
                *light += path.throughput() * self.emitted(&arrived, path, gaze);
                if parting.is_some_and(|parting| !parting.waits(arrived.here.bsdf())) {
                    path.end_all_but_first();
                }
                Vertex::of_surface(arrived, through, media).seen(seen)
            }
        };
        if self.limits.max_depth.is_some_and(|most| path.bounce >= most) {
            return false;
        }
        let cosine = at.cosine(at.back());
        path.partial = if path.bounce == 0 {
            let seen = self.job.camera.connect(at.position(), sample.lens, sample.time);
            Partial::of_camera(self.paths, seen.map_or(0.0, |seen| seen.density) * cosine)
        } else {
            path.partial.arrived(at.t, cosine)
        };
        let again = at.repeat_correction();
        if again != Rgb::ONE {
            if path.has_gamut_excess {
                path.going.weights.carried *= again;
            }
            path.has_gamut_excess = true;
        }
        if let Some(emitters) = self.emitters.filter(|_| !at.is_single()) {
            *light += self.ask(emitters, &at, path, sample);
            let most = self.limits.max_depth.map(|depth| depth - path.bounce - 1);
            for vertex in self.light.iter().flat_map(|(_, vertices)| &vertices.all) {
                if most.is_none_or(|most| vertex.bounce <= most) {
                    *light += self.connect(emitters, &at, path, vertex, sample);
                }
            }
        }
        self.go_on(&at, path, parting, sample)
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

    /// Return the contribution of one light sample.
    fn ask(&self, emitters: &Emitters, at: &Vertex, path: &EyePath, sample: &mut Sample) -> Rgb {
        let choice = sample.numbers.ray.light_choice(0);
        let (choice, u) = (sample.numbers.one(choice), sample.numbers.two(choice + 1));
        let receiver = LightSampleContext { waves: path.waves, ..at.receiver() };
        let Some((light, departure, asked)) = emitters.sample_direct(&receiver, choice, u) else {
            return Rgb::ZERO;
        };
        let (scattered, pdf) = at.evaluate(light.direction);
        let arriving = path.throughput() * scattered * light.weight;
        if arriving.is_black() {
            return Rgb::ZERO;
        }
        let weight = match self.alone {
            Some(_) => self.full(1, path.bounce + 2),
            None => {
                let reverse = at.light_back_pdf(light.direction);
                of_asked(&path.partial, (asked, &departure), pdf, at.cosine(light.direction), reverse)
            }
        };
        let ray = match &light.source {
            Some(source) => at.origin().segment(source),
            None => at.origin().ray(light.direction),
        };
        let ray = at.leaving(ray, light.primitive);
        self.arriving(arriving * weight, ray, (at, path.waves_with(false)), at.is_in_medium(), sample)
    }

    /// Return the contribution of a connection to a light vertex.
    fn connect(
        &self,
        emitters: &Emitters,
        at: &Vertex,
        path: &EyePath,
        light: &LightVertex<'a>,
        sample: &mut Sample,
    ) -> Rgb {
        let there = &light.at;
        let way = there.position() - at.position();
        let square = way.length_squared();
        let distance = square.sqrt();
        let direction = way / distance;
        if !direction.is_finite() || at.is_hidden_from(direction) || there.is_hidden_from(-direction) {
            return Rgb::ZERO;
        }
        let (scattered, pdf) = at.evaluate(direction);
        if scattered.is_black() {
            return Rgb::ZERO;
        }
        let met = there.met_from(-direction, distance);
        let mut arriving = path.throughput() * scattered * light.flux * met.sent / square;
        if path.has_gamut_excess {
            arriving *= light.again;
        }
        if path.single && light.single {
            arriving = Waves::joined(arriving);
        }
        if arriving.is_black() || !arriving.is_finite() {
            return Rgb::ZERO;
        }
        let weight = match self.alone {
            Some(_) => self.full(light.bounce + 1, path.bounce + 2),
            None => {
                let onward = there.light_pdf(-direction);
                let one = light.end.others(emitters, there, &met, pdf * there.cosine(direction) / square);
                let reverse = at.light_back_pdf(direction);
                weight(one, path.partial.others(onward * at.cosine(direction) / square, reverse))
            }
        };
        let segment = at.leaving(at.origin().segment(&there.origin()), there.primitive());
        let roulette = at.is_in_medium() || there.is_in_medium();
        self.arriving(arriving * weight, segment, (at, path.waves_with(light.single)), roulette, sample)
    }

    /// Return the share of light that reaches a vertex. `roulette` applies if an end of the segment was sampled in a
    /// medium.
    fn arriving(
        &self,
        light: Rgb,
        ray: Ray,
        (at, waves): (&Vertex, Option<Waves>),
        roulette: bool,
        sample: &mut Sample,
    ) -> Rgb {
        if light.is_black() || !light.is_finite() {
            return Rgb::ZERO;
        }
        let media = at.media(ray.direction);
        let course = MediumTraversal { roulette, ..self.course(waves) };
        let light = course.through(light, ray, media, sample.numbers, sample.cancel);
        if light.is_finite() { light } else { Rgb::ZERO }
    }

    /// Continue a path unless it ends here.
    fn go_on(&self, at: &Vertex, path: &mut EyePath, parting: Option<Parting>, sample: &mut Sample) -> bool {
        let ray = sample.numbers.ray;
        let (u, choice) = (sample.numbers.two(ray.direction()), ray.scattering_choice());
        let next = match &at.point {
            Point::Surface { arrived, wide, .. } => {
                let here = wide.as_deref().unwrap_or(&arrived.here);
                here.sample(&mut || sample.numbers.one(choice), u)
            }
            Point::Medium { here, .. } => here.sample(&mut || 0.0, u),
        };
        let Some(next) = next else { return false };
        match (&at.point, parting) {
            (_, Some(_)) if next.is_through => path.end_all_but_first(),
            (Point::Surface { arrived, .. }, Some(parting)) if !path.single => {
                path.going.weights.carried *= parting.mirrored(arrived.here.wo());
            }
            _ => {}
        }
        path.going.weights.carried *= next.weight;
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
            if sample.numbers.one(ray.roulette()) >= survival {
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

impl Worker for BothEnds<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        assert_eq!(samples.len(), radiance.len());
        let rays: Vec<Ray> = samples.iter().map(|sample| sample.ray).collect();
        let mut media = Vec::new();
        MediumStack::at(self.job.scene, &rays, &mut media);
        for ((sample, media), radiance) in samples.iter_mut().zip(media).zip(radiance) {
            if cancel.is_raised() {
                return;
            }
            *radiance = self.follow(sample, media, cancel);
        }
    }
}
