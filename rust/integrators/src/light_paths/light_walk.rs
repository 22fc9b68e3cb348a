//! Tracing of light paths, bounce by bounce.

use super::adjoint::{Arrived, Onward};
use super::dimensions::{Dimensions, EmissionDimensions};
use crate::nesting::MediumStack;
use crate::skip_intersections::{Met, Passing};
use crate::terminate_wavelengths::Parting;
use crate::{is_matt, roulette};
use raywright_base::math::{Hit, Ray, RayQueue};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Dispersive, Rgb};
use raywright_scene::{Camera, EmissionSample, Emitters, Interaction, Scene};

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
    passing: Passing,
    now: Queue,
    next: Queue,
    hits: Vec<Hit>,
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
    fn set_out(&mut self, _path: &Flying, _light: &EmissionSample) {}

    /// A path arrives at a surface; `through` are the media of a transmitted ray.
    fn meet(
        &mut self,
        arrived: &Arrived<'a>,
        path: &Flying,
        through: &MediumStack,
        numbers: (&mut Sampler, Dimensions),
    );

    /// A path leaves a surface, unless roulette terminates it.
    fn go_on(&mut self, _arrived: &Arrived<'a>, _path: &Flying, _next: &Onward) {}

    /// A path leaves the scene.
    fn leave(&mut self, _path: &Flying) {}

    /// All paths of the batch have advanced by one ray.
    fn pause(&mut self) {}
}

/// Active paths and their next rays.
#[derive(Default)]
struct Queue {
    rays: RayQueue,
    paths: Vec<Flying>,
}

impl Queue {
    fn clear(&mut self) {
        self.rays.clear();
        self.paths.clear();
    }

    fn push(&mut self, ray: &Ray, path: Flying) {
        self.rays.push(ray);
        self.paths.push(path);
    }
}

/// The state of a light path.
#[derive(Clone, Copy)]
pub(crate) struct Flying {
    /// Index within the batch.
    pub number: u32,
    /// Flux.
    pub flux: Rgb,
    /// Largest channel of the initial flux.
    start: f64,
    /// Time as a fraction of the shutter interval.
    pub time: f64,
    /// Number of surface bounces.
    pub bounce: u32,
    pub media: MediumStack,
    /// Random number for masks, as in [`Passing::meet`].
    chance: f64,
    /// Remaining share after the last surface, for a reflectance above 1 met again ([`Bsdf::repeat_correction`]). It
    /// applies once the path reaches another surface: of all such surfaces of a path, the one nearest to the viewer
    /// has none.
    pub again: Rgb,
    /// True if the last bounce was specular or nearly so.
    pub is_sharp: bool,
    /// Number of consecutive specular reflections at transmissive surfaces ([`roulette::held`]).
    held: u32,
    /// True if only the hero wavelength is left.
    pub single: bool,
}

impl Flying {
    /// Terminate all wavelengths but the hero, which then stands for all.
    fn end_all_but_hero(&mut self) {
        if !self.single {
            self.flux = Waves::ended(self.flux);
            self.single = true;
        }
    }
}

impl<'a> LightWalk<'a> {
    pub fn new(scene: &'a Scene, emitters: &'a Emitters<'a>, limits: Limits, camera: Option<&'a dyn Camera>) -> Self {
        let needs = scene.plan().needs();
        Self {
            scene,
            emitters,
            limits,
            camera,
            moves: scene.geometry().moves() || camera.is_some_and(|camera| camera.uses_time()),
            times: Times::Drawn,
            waves: Vec::new(),
            passing: Passing::new(needs.masks, needs.nested),
            now: Queue::default(),
            next: Queue::default(),
            hits: Vec::new(),
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

    /// Return whether the scene has masks.
    pub fn passes(&self) -> bool {
        self.passing.is_needed()
    }

    /// Return whether media are nested.
    pub fn is_nested(&self) -> bool {
        self.passing.is_nested()
    }

    /// Trace one path per sampler to its end.
    pub fn follow(&mut self, paths: &mut [Sampler], cancel: &Cancel, visitor: &mut impl Visitor<'a>) {
        self.start(paths, visitor);
        while !self.now.rays.is_empty() && !cancel.is_raised() {
            self.hits.resize(self.now.rays.len(), Hit::MISS);
            self.scene.intersect_queue(&mut self.now.rays, &mut self.hits);
            self.bounce(paths, visitor);
            visitor.pause();
        }
    }

    /// Start the paths.
    fn start(&mut self, paths: &mut [Sampler], visitor: &mut impl Visitor<'a>) {
        self.now.clear();
        for (number, sampler) in (0u32..).zip(paths) {
            let numbers = EmissionDimensions::numbers(sampler);
            let Some(light) = self.emitters.sample(&numbers, self.waves.get(number as usize)) else { continue };
            let (time, of_scene) = self.times.of(number as usize, self.moves, self.camera, sampler);
            let ray = Ray { time: of_scene, ..light.ray };
            let (flux, start) = (light.weight, light.weight.max());
            let (media, chance, again) = (MediumStack::NONE, -1.0, Rgb::ONE);
            let (bounce, is_sharp, held, single) = (0, false, 0, false);
            let path = Flying { number, flux, start, time, bounce, media, chance, again, is_sharp, held, single };
            visitor.set_out(&path, &light);
            self.now.push(&ray, path);
        }
        if self.passing.is_nested() {
            let mut media = Vec::new();
            MediumStack::at(self.scene, self.now.rays.rows(), &mut media);
            for (path, media) in self.now.paths.iter_mut().zip(media) {
                path.media = media;
            }
        }
    }

    /// Advance all paths by one ray.
    fn bounce(&mut self, samplers: &mut [Sampler], visitor: &mut impl Visitor<'a>) {
        self.next.clear();
        self.passing.begin(self.scene, &self.now.rays, &self.hits);
        for i in 0..self.now.rays.len() {
            let (hit, mut path) = (self.hits[i], self.now.paths[i]);
            if !hit.is_hit() {
                visitor.leave(&path);
                continue;
            }
            let ray = self.now.rays.get(i);
            let sampler = &mut samplers[path.number as usize];
            let dimensions = Dimensions::of(path.bounce);
            let number = || sampler.one(dimensions.mask());
            match self.passing.meet(self.scene, i, (&ray, &hit), &path.media, &mut path.chance, number) {
                Met::Nothing(ray, media) => self.next.push(&ray, Flying { media, ..path }),
                Met::Surface { hit, outside, through } => {
                    let (arrived, parting) = match self.waves.get(path.number as usize) {
                        None => (Arrived::new(self.scene, ray, hit, outside), None),
                        Some(&waves) => {
                            let around = self.around(&path.media, &through);
                            Arrived::by_waves(self.scene, (ray, hit), (outside, around), waves)
                        }
                    };
                    let waiting = parting.filter(|parting| parting.waits(arrived.here.bsdf()));
                    if parting.is_some() && waiting.is_none() {
                        path.end_all_but_hero();
                    }
                    let again = arrived.here.bsdf().repeat_correction();
                    if again != Rgb::ONE {
                        path.flux *= path.again;
                        path.again = again;
                    }
                    path.bounce += 1;
                    visitor.meet(&arrived, &path, &through, (sampler, dimensions));
                    self.go_on(&arrived, path, (through, waiting), (sampler, dimensions), visitor);
                }
            }
        }
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// Return the dispersion on both sides of a surface, from the path's media and those of a transmitted ray: for a
    /// hit on the front, and on the back.
    fn around(&self, media: &MediumStack, through: &MediumStack) -> [Dispersive; 2] {
        if self.passing.is_nested() { [media, through].map(MediumStack::dispersion) } else { [Dispersive::NONE; 2] }
    }

    /// Continue a path from a surface, unless it ends there.
    fn go_on(
        &mut self,
        arrived: &Arrived<'a>,
        mut path: Flying,
        (through, parting): (MediumStack, Option<Parting>),
        (sampler, dimensions): (&mut Sampler, Dimensions),
        visitor: &mut impl Visitor<'a>,
    ) {
        if self.limits.max_depth.is_some_and(|most| path.bounce >= most) {
            return;
        }
        let u = sampler.two(dimensions.direction());
        let Some(next) = arrived.onward(&mut || sampler.one(dimensions.scattering_choice()), u) else { return };
        visitor.go_on(arrived, &path, &next);
        match parting {
            Some(_) if next.is_through => path.end_all_but_hero(),
            Some(parting) if !path.single => path.flux *= parting.mirrored(arrived.here.wo()),
            _ => {}
        }
        let mut flux = path.flux * next.weight;
        if path.bounce >= self.limits.roulette_depth.min(roulette::AT_LATEST) {
            let survival = roulette::survival(flux / path.start, 1.0).min(roulette::held(path.held));
            let survives = sampler.one(dimensions.roulette()) < survival;
            if !survives {
                return;
            }
            flux /= survival;
        }
        if flux.is_black() || !flux.is_finite() {
            return;
        }
        let ray = arrived.here.ray_origin().ray(next.direction);
        let ray = Ray { time: arrived.ray.time, misses: [arrived.hit.primitive, Ray::NO_TRIANGLE], ..ray };
        let media = if next.is_through { through } else { path.media };
        let is_sharp = next.is_single || !is_matt(arrived.here.bsdf());
        let is_held = roulette::is_held(arrived.here.bsdf().transmits(), next.is_single, next.is_through);
        let held = if is_held { path.held.saturating_add(1) } else { 0 };
        self.next.push(&ray, Flying { flux, media, chance: -1.0, is_sharp, held, ..path });
    }
}
