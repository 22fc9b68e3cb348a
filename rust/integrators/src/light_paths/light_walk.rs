//! Tracing of light paths: all of a batch take each ray together.

use super::adjoint::Onward;
use super::dimensions::{Dimensions, EmissionDimensions};
use super::vertex::{Point, Vertex};
use crate::media::current_medium::Filled;
use crate::media::medium_traversal::{LeftDepth, MediumTraversal, RaySegmentState, SegmentEnd, TraversalEnd};
use crate::media::path_numbers::{FurtherNumbers, PathNumbers, depth};
use crate::media::spectral_mis::Weights;
use crate::nesting::MediumStack;
use crate::terminate_wavelengths::Parting;
use crate::{is_matt, roulette};
use raywright_base::math::{Hit, Ray, RayQueue};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Camera, EmissionSample, Emitters, Scene};

/// Path termination.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Maximum number of bounces.
    pub max_depth: Option<u32>,
    /// Number of bounces after which Russian roulette starts.
    pub roulette_depth: u32,
}

/// Per-thread state for tracing light paths.
pub(crate) struct LightWalk<'a> {
    scene: &'a Scene,
    emitters: &'a Emitters<'a>,
    limits: Limits,
    /// Camera whose shutter interval paths fall into; without one, any scene time.
    camera: Option<&'a dyn Camera>,
    /// True if anything moves, the camera included.
    moves: bool,
    times: Times,
    /// Wavelengths of the paths; `None` for RGB.
    waves: Vec<Waves>,
    now: Queue,
    next: Queue,
    hits: Vec<Hit>,
    /// Further random numbers of each path.
    further: Vec<FurtherNumbers>,
}

/// Times of the paths.
#[derive(Clone, Debug)]
pub(crate) enum Times {
    /// Sampled for each path.
    Drawn,
    /// Common to all, as a fraction of the shutter interval.
    All(f64),
    /// One scene time per path.
    Each(Vec<f64>),
}

impl Times {
    /// Return a path's time as a fraction of the shutter interval, and as scene time.
    pub fn of(&self, number: usize, moves: bool, camera: Option<&dyn Camera>, sampler: &mut Sampler) -> (f64, f64) {
        let time = match self {
            _ if !moves => 0.0,
            Self::Drawn => sampler.one(EmissionDimensions::TIME),
            Self::All(time) => *time,
            // The camera's pose is not needed in this case.
            Self::Each(_) => 0.0,
        };
        match self {
            Self::Each(times) => (time, times[number]),
            _ => (time, camera.map_or(time, |camera| camera.body().scene_time(time))),
        }
    }
}

/// Receives the vertices of light paths.
pub(crate) trait Visitor<'a> {
    /// A path starts.
    fn set_out(&mut self, _path: &LightPath, _light: &EmissionSample) {}

    /// A path arrives at a surface or a scattering event in a medium.
    fn meet(
        &mut self,
        at: &Vertex<'a>,
        path: &LightPath,
        numbers: &mut PathNumbers,
        dimensions: Dimensions,
        cancel: &Cancel,
    );

    /// A path continues, unless roulette terminates it.
    fn go_on(&mut self, _at: &Vertex<'a>, _path: &LightPath, _next: &Onward) {}

    /// Media have absorbed flux.
    fn absorb(&mut self, _flux: Rgb) {}

    /// A path leaves the scene.
    fn leave(&mut self, _path: &LightPath) {}

    /// All paths of the batch have advanced by one ray.
    fn pause(&mut self) {}
}

/// The state of a light path.
#[derive(Clone, Copy)]
pub(crate) struct LightPath {
    /// Index within the batch.
    pub number: u32,
    pub going: RaySegmentState,
    left: LeftDepth,
    /// Flux at the start of its ray.
    before: Rgb,
    /// Largest channel of the initial flux.
    start: f64,
    /// Time as a fraction of the shutter interval.
    pub time: f64,
    /// Number of scattering events.
    pub bounce: u32,
    /// Remaining share after the last surface, for a reflectance above 1 met again ([`Bsdf::repeat_correction`]). It
    /// applies once the path reaches another surface: of all such surfaces of a path, the one nearest to the viewer
    /// has none.
    pub again: Rgb,
    /// True if the last bounce was specular or nearly so; and true if a medium scattered it.
    pub is_sharp: bool,
    pub is_adrift: bool,
    /// Number of consecutive specular reflections at transmissive surfaces ([`roulette::held`]).
    held: u32,
    /// Wavelengths, `None` for RGB; and true if only the first is left.
    waves: Option<Waves>,
    pub single: bool,
}

/// Active paths and their next rays.
#[derive(Default)]
struct Queue {
    rays: RayQueue,
    paths: Vec<LightPath>,
}

impl Queue {
    fn clear(&mut self) {
        self.rays.clear();
        self.paths.clear();
    }

    fn push(&mut self, course: &MediumTraversal<'_>, path: &LightPath) {
        self.rays.push(&course.next_ray(&path.going, &path.left, false));
        self.paths.push(*path);
    }
}

impl LightPath {
    /// Return the flux; at a scattering event in a medium, the scattered flux.
    pub fn flux(&self) -> Rgb {
        self.going.weights.throughput()
    }

    /// Return the wavelengths for traversing media.
    pub fn waves(&self) -> Option<Waves> {
        if self.single { self.waves.map(|waves| waves.alone()) } else { self.waves }
    }

    /// Terminate all wavelengths but the first, which then stands for all.
    fn end_all_but_first(&mut self) {
        if !self.single {
            self.going.weights.end_all_but_first();
            self.single = true;
        }
    }
}

impl<'a> LightWalk<'a> {
    pub fn new(scene: &'a Scene, emitters: &'a Emitters<'a>, limits: Limits, camera: Option<&'a dyn Camera>) -> Self {
        Self {
            scene,
            emitters,
            limits,
            camera,
            moves: scene.geometry().moves() || camera.is_some_and(|camera| camera.uses_time()),
            times: Times::Drawn,
            waves: Vec::new(),
            now: Queue::default(),
            next: Queue::default(),
            hits: Vec::new(),
            further: Vec::new(),
        }
    }

    /// Set the times of the next paths.
    pub fn set_times(&mut self, times: Times) {
        self.times = times;
    }

    /// Set the wavelengths of the next paths.
    pub fn set_waves(&mut self, waves: impl Iterator<Item = Waves>) {
        self.waves.clear();
        self.waves.extend(waves);
    }

    fn course(&self, path: &LightPath) -> MediumTraversal<'a> {
        MediumTraversal::alone(self.scene, path.waves())
    }

    /// Trace one path per sampler to its end.
    pub fn follow(&mut self, samplers: &mut [Sampler], cancel: &Cancel, visitor: &mut impl Visitor<'a>) {
        self.start(samplers, cancel, visitor);
        while !self.now.paths.is_empty() && !cancel.is_raised() {
            self.hits.clear();
            self.hits.resize(self.now.paths.len(), Hit::MISS);
            self.scene.intersect_queue(&mut self.now.rays, &mut self.hits);
            self.step(samplers, cancel, visitor);
            visitor.pause();
        }
    }

    /// Start the paths.
    fn start(&mut self, samplers: &mut [Sampler], cancel: &Cancel, visitor: &mut impl Visitor<'a>) {
        self.next.clear();
        self.further.clear();
        let mut started = Vec::with_capacity(samplers.len());
        for (number, sampler) in (0u32..).zip(samplers.iter_mut()) {
            self.further.push(FurtherNumbers::new(sampler.apart()));
            let numbers = EmissionDimensions::numbers(sampler);
            let Some(light) = self.emitters.sample(&numbers, self.waves.get(number as usize)) else { continue };
            let (time, of_scene) = self.times.of(number as usize, self.moves, self.camera, sampler);
            started.push((number, light, time, Ray { time: of_scene, ..light.ray }));
        }
        let mut media = Vec::new();
        let needs = self.scene.plan().needs();
        if needs.media || needs.nested {
            let rays: Vec<Ray> = started.iter().map(|(.., ray)| *ray).collect();
            MediumStack::<Filled>::at(self.scene, &rays, &mut media);
        } else {
            media.resize(started.len(), MediumStack::NONE);
        }
        for ((number, light, time, ray), media) in started.into_iter().zip(media) {
            let (sampler, further) = (&mut samplers[number as usize], &mut self.further[number as usize]);
            let waves = self.waves.get(number as usize).copied();
            // The choice must be independent of the wavelengths' own: dispersion keeps the first.
            let hero = match waves {
                Some(_) => further.hero(),
                None => ((sampler.one(EmissionDimensions::HERO) * 3.0) as usize).min(2),
            };
            let weights = Weights { carried: light.weight, ..Weights::START };
            let mut path = LightPath {
                number,
                going: RaySegmentState { ray, weights, media },
                left: LeftDepth { hero, way: f64::INFINITY, start: 0.0 },
                before: Rgb::ZERO,
                start: light.weight.max(),
                time,
                bounce: 0,
                again: Rgb::ONE,
                is_sharp: false,
                is_adrift: false,
                held: 0,
                waves,
                single: false,
            };
            visitor.set_out(&path, &light);
            let mut numbers = PathNumbers::new(sampler, further);
            if light.is_infinite && self.scene.surrounding().is_some() {
                come_from_afar(&MediumTraversal::alone(self.scene, waves), &mut path, &mut numbers, cancel, visitor);
            }
            if !path.going.weights.carried.is_black() {
                self.take_off(&mut path, samplers);
            }
        }
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// Queue a path that starts along its ray.
    fn take_off(&mut self, path: &mut LightPath, samplers: &mut [Sampler]) {
        let way = depth(samplers[path.number as usize].one(Dimensions::of(path.bounce).mask()));
        path.left = LeftDepth { way, start: path.going.ray.t_min, ..path.left };
        path.before = path.flux();
        let course = self.course(path);
        self.next.push(&course, path);
    }

    /// Take all paths to their hits, and those that scatter there to their next rays.
    fn step(&mut self, samplers: &mut [Sampler], cancel: &Cancel, visitor: &mut impl Visitor<'a>) {
        self.next.clear();
        for i in 0..self.now.paths.len() {
            let (hit, mut path) = (self.hits[i], self.now.paths[i]);
            let (course, number) = (self.course(&path), path.number as usize);
            let numbers = &mut PathNumbers::new(&mut samplers[number], &mut self.further[number]);
            let mut glow = Rgb::ZERO;
            let step = course.step(&mut path.going, &mut path.left, &hit, numbers, cancel, &mut glow, None);
            let end = match step {
                SegmentEnd::Passes => {
                    self.next.push(&course, &path);
                    continue;
                }
                SegmentEnd::Absorbed => {
                    visitor.absorb(path.before);
                    continue;
                }
                SegmentEnd::Ends(end) => end,
            };
            visitor.absorb(path.before - path.flux());
            let RaySegmentState { ray, media, .. } = path.going;
            let mut waiting = None;
            let at = match end {
                TraversalEnd::Outside => {
                    visitor.leave(&path);
                    continue;
                }
                TraversalEnd::Medium { here, collision, .. } => {
                    Vertex::of_medium(self.scene, here, &collision, (ray, media), path.waves.as_ref())
                }
                TraversalEnd::Surface { hit, outside, through } => {
                    let (scene, waves) = (self.scene, path.waves);
                    let at = Vertex::of_surface(scene, (ray, hit), outside, (media, through), waves, &mut waiting);
                    if waiting.is_some_and(|parting| !at.waits(&parting)) {
                        waiting = None;
                        path.end_all_but_first();
                    }
                    at
                }
            };
            let again = at.repeat_correction();
            if again != Rgb::ONE {
                path.going.weights.carried *= path.again;
                path.again = again;
            }
            let dimensions = Dimensions::of(path.bounce);
            path.bounce += 1;
            visitor.meet(&at, &path, numbers, dimensions, cancel);
            if self.limits.go_on(self.scene, &at, &mut path, waiting, numbers, dimensions, visitor) {
                self.take_off(&mut path, samplers);
            }
        }
        std::mem::swap(&mut self.now, &mut self.next);
    }
}

/// Attenuate light from outside by the infinite medium.
fn come_from_afar<'a>(
    course: &MediumTraversal<'a>,
    path: &mut LightPath,
    numbers: &mut PathNumbers,
    cancel: &Cancel,
    visitor: &mut impl Visitor<'a>,
) {
    let Ray { origin, direction, time, .. } = path.going.ray;
    let back = Ray { time, ..Ray::new(origin, -direction) };
    let before = path.flux();
    let left = course.through(before, back, MediumStack::NONE, numbers, cancel);
    visitor.absorb(before - left);
    path.going.weights.carried = left;
}

impl Limits {
    /// Scatter a path and return whether it continues.
    #[allow(clippy::too_many_arguments)]
    fn go_on<'a>(
        &self,
        scene: &Scene,
        at: &Vertex<'a>,
        path: &mut LightPath,
        parting: Option<Parting>,
        numbers: &mut PathNumbers,
        dimensions: Dimensions,
        visitor: &mut impl Visitor<'a>,
    ) -> bool {
        if self.max_depth.is_some_and(|most| path.bounce >= most) {
            return false;
        }
        let u = numbers.two(dimensions.direction());
        let choice = dimensions.scattering_choice();
        let Some(next) = at.onward(&mut || numbers.one(choice), u) else { return false };
        visitor.go_on(at, path, &next);
        match (&at.point, parting) {
            (_, Some(_)) if next.is_through => path.end_all_but_first(),
            (Point::Surface { arrived, .. }, Some(parting)) if !path.single => {
                path.going.weights.carried *= parting.mirrored(arrived.here.wo());
            }
            _ => {}
        }
        path.going.weights.carried *= next.weight;
        let flux = path.flux();
        let bsdf = match &at.point {
            Point::Surface { arrived, .. } => Some(arrived.here.bsdf()),
            Point::Medium { .. } => None,
        };
        if path.bounce >= self.roulette_depth.min(roulette::AT_LATEST) {
            // Light leaves a finite medium eventually.
            let survival = if bsdf.is_some() || scene.surrounding().is_some() {
                roulette::survival(flux / path.start, 1.0).min(roulette::held(path.held))
            } else {
                (flux.max() / path.start).sqrt().min(1.0)
            };
            if numbers.one(dimensions.roulette()) >= survival {
                return false;
            }
            path.going.weights.carried /= survival;
        }
        if flux.is_black() || !flux.is_finite() {
            return false;
        }
        let is_held = bsdf.is_some_and(|bsdf| roulette::is_held(bsdf.transmits(), next.is_single, next.is_through));
        path.held = if is_held { path.held.saturating_add(1) } else { 0 };
        path.is_sharp = bsdf.is_some_and(|bsdf| next.is_single || !is_matt(bsdf));
        path.is_adrift = bsdf.is_none();
        path.going.media = at.media_after(next.is_through);
        path.going.ray = at.leaving(at.origin().ray(next.direction), Ray::NO_TRIANGLE);
        true
    }
}
