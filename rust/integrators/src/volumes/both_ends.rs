//! Paths that are walked from lights and from the camera through media, and are connected: one sample after the other.
//!
//! As among surfaces alone ([`crate::Bidirectional`]), with points of media among the vertices
//! ([`super::vertex`] has how these are weighed). What glows is found by the camera's paths alone.

use super::asking::at_once;
use super::course::{Course, Going, Nobody, Place};
use super::filled::Filled;
use super::light_end::LightEnd;
use super::light_walk::{Drifting, MediaLightWalk, MediaVisitor};
use super::numbers::{Numbers, depth};
use super::vertex::{Point, Vertex};
use super::weights::Weights;
use crate::dimensions::Dimensions;
use crate::light_paths::{self, Arrived, Limits, Onward, Partial, of_asked, weight};
use crate::nesting::MediumStack;
use crate::parting::Parting;
use crate::transport::widened;
use crate::{CameraSample, Job, Worker, roulette};
use raywright_base::math::{DVec3, Ray};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{EmissionSample, Emitters, Encounter, Footprint, Gaze, LightSampleContext, SurfaceInteraction};

/// What one thread works with.
pub(crate) struct BothEnds<'a> {
    job: Job<'a>,
    emitters: Option<&'a Emitters<'a>>,
    limits: Limits,
    /// The way that alone counts, by its vertices from the light and from the camera, if one does.
    alone: Option<[u32; 2]>,
    /// How many paths there are from lights to the camera for each of its samples.
    paths: f64,
    /// Whether the camera's samples are spread over time.
    moves: bool,
    /// Whether textures are looked at by how wide rays are.
    widths: bool,
    light: Option<(MediaLightWalk<'a>, LightVertices<'a>)>,
}

/// Where light has come to.
struct LightVertex<'a> {
    at: Vertex<'a>,
    flux: Rgb,
    again: Rgb,
    bounce: u32,
    single: bool,
    end: LightEnd,
}

/// Where one path of light has come to, but for what scatters in single directions alone: later ones of long paths the
/// less likely the later they are.
struct LightVertices<'a> {
    emitters: &'a Emitters<'a>,
    end: Option<LightEnd>,
    all: Vec<LightVertex<'a>>,
}

/// A path from the camera.
struct EyePath {
    going: Going,
    scale: f64,
    bounce: u32,
    gilded: bool,
    partial: Partial,
    /// The normal that lights were drawn by where it was scattered last.
    normal: DVec3,
    /// Its wavelengths; none for red, green and blue. And whether the first is all that it carries.
    waves: Option<Waves>,
    single: bool,
    /// The bundle of its neighbours where its ray starts.
    footprint: Footprint,
}

/// What a sample has besides its path.
struct Sample<'s, 'n> {
    hero: usize,
    numbers: &'s mut Numbers<'n>,
    cancel: &'s Cancel,
    /// For the camera's lens and shutter.
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
        numbers: &mut Numbers,
        dimensions: light_paths::Dimensions,
        _: &Cancel,
    ) {
        /// The first that are kept whatever the odds.
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

    /// What light that comes upon its ray would have been asked for from.
    fn receiver(&self) -> LightSampleContext {
        LightSampleContext { position: self.going.ray.origin, normal: self.normal, waves: self.waves }
    }

    /// The wavelengths at which it goes through media, or at which light goes that has come by one alone, too.
    fn waves_with(&self, single: bool) -> Option<Waves> {
        if single || self.single { self.waves.map(|waves| waves.alone()) } else { self.waves }
    }

    /// Leaves the first of its wavelengths alone, which stands for all from here on.
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
        // What is connected to another is a bounce, too.
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

    fn course(&self, waves: Option<Waves>) -> Course<'a> {
        Course::alone(self.job.scene, waves)
    }

    /// The weight of a way where one alone counts.
    fn full(&self, light: u32, camera: u32) -> f64 {
        f64::from(u8::from(self.alone == Some([light, camera])))
    }

    /// What arrives along a camera's ray.
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
        let mut numbers = Numbers::apart(&mut sample.sampler);
        // Not by the number of the wavelengths: what parts these goes by the first.
        let hero = if waves.is_some() { numbers.hero() } else { hero };
        let going = Going { ray: sample.ray, weights: Weights::START, media, passed: 0 };
        let partial = Partial::of_camera(self.paths, 0.0);
        let (normal, single) = (DVec3::ZERO, false);
        let footprint = self.job.footprint;
        let mut path =
            EyePath { going, scale: 1.0, bounce: 0, gilded: false, partial, normal, waves, single, footprint };
        let mut light = Rgb::ZERO;
        let mut sample = Sample { hero, numbers: &mut numbers, cancel, lens, time };
        while self.advance(&mut path, &mut sample, &mut light) {}
        waves.map_or(light, |waves| waves.seen(light))
    }

    /// Takes a path to where it is scattered next and on from there, and says whether it goes on.
    fn advance(&self, path: &mut EyePath, sample: &mut Sample, light: &mut Rgb) -> bool {
        sample.numbers.ray = Dimensions::of(path.bounce, 0);
        let u = sample.numbers.ray.mask();
        let way = (sample.hero, depth(sample.numbers.one(u)));
        let course = self.course(path.waves_with(false));
        let lit = None::<&Nobody>;
        let place = at_once(course.advance(&mut path.going, way, sample.numbers, sample.cancel, light, lit));
        let Going { ray, media, .. } = path.going;
        let mut parting = None;
        let at = match place {
            None => return false,
            Some(Place::Outside) => {
                *light += path.throughput() * self.outside(path);
                return false;
            }
            Some(Place::Medium { here, collision, .. }) => {
                path.footprint = path.footprint.at(collision.t);
                Vertex::of_medium(self.job.scene, here, &collision, (ray, media), path.waves.as_ref())
            }
            Some(Place::Surface { hit, outside, through }) => {
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
                let gaze = Gaze { width, waves: path.waves };
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
        let again = at.again();
        if again != Rgb::ONE {
            if path.gilded {
                path.going.weights.carried *= again;
            }
            path.gilded = true;
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

    /// Light from outside that a path has come upon.
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

    /// What a surface sends back that a path has come upon.
    fn emitted(&self, arrived: &Arrived, path: &EyePath, gaze: Gaze) -> Rgb {
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

    /// What comes of one light that is asked.
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

    /// What comes of a point that light has come to.
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
        if path.gilded {
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

    /// What of some light gets to a vertex, on a way that has an end which was drawn in a medium, or has not.
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
        let course = Course { roulette, ..self.course(waves) };
        let light = at_once(course.through(light, ray, media, sample.numbers, sample.cancel));
        if light.is_finite() { light } else { Rgb::ZERO }
    }

    /// Sends a path on, unless it ends there.
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
            // Light leaves a medium sooner or later, unless that has no end.
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
