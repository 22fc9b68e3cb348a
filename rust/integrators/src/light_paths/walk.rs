//! The way of paths that start at lights, one bounce at a time.

use super::adjoint::{Arrived, Onward};
use super::dimensions::{Dimensions, EmissionDimensions};
use crate::nesting::MediumStack;
use crate::parting::Parting;
use crate::passing::{Met, Passing};
use crate::{is_matt, roulette};
use raywright_base::math::{Hit, Ray, RayQueue};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Dispersive, Rgb};
use raywright_scene::{Camera, EmissionSample, Emitters, Encounter, Scene};

/// When paths end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// The greatest number of bounces.
    pub max_depth: Option<u32>,
    /// Roulette is played from this number of bounces on.
    pub roulette_depth: u32,
}

/// What one thread walks with.
pub(crate) struct LightWalk<'a> {
    scene: &'a Scene,
    emitters: &'a Emitters<'a>,
    limits: Limits,
    /// Whose shutter paths are on their way under; at any of the scene's times without one.
    camera: Option<&'a dyn Camera>,
    /// Whether anything moves, the camera included.
    moves: bool,
    times: Times,
    /// The wavelengths of paths; none where they carry red, green and blue.
    waves: Vec<Waves>,
    passing: Passing,
    now: Queue,
    next: Queue,
    hits: Vec<Hit>,
}

/// When paths are on their way.
#[derive(Clone, Debug)]
pub(crate) enum Times {
    /// Each at a time that it draws.
    Drawn,
    /// All at one, while the shutter is open from 0 to 1.
    All(f64),
    /// Each at its own, as the scene counts time.
    Each(Vec<f64>),
}

impl Times {
    /// When a path is on its way, while the shutter is open, and as the scene counts time.
    pub fn of(&self, number: usize, moves: bool, camera: Option<&dyn Camera>, sampler: &mut Sampler) -> (f64, f64) {
        let time = match self {
            _ if !moves => 0.0,
            Self::Drawn => sampler.one(EmissionDimensions::TIME),
            Self::All(time) => *time,
            // Nobody asks where the camera is then.
            Self::Each(_) => 0.0,
        };
        match self {
            Self::Each(times) => (time, times[number]),
            _ => (time, camera.map_or(time, |camera| camera.body().scene_time(time))),
        }
    }
}

/// Who is told where paths have come to.
pub(crate) trait Visitor<'a> {
    /// A path has set out.
    fn set_out(&mut self, _path: &Flying, _light: &EmissionSample) {}

    /// A path has come to a surface, where a ray that goes through is in these media.
    fn meet(
        &mut self,
        arrived: &Arrived<'a>,
        path: &Flying,
        through: &MediumStack,
        numbers: (&mut Sampler, Dimensions),
    );

    /// A path goes on from a surface, unless roulette ends it.
    fn go_on(&mut self, _arrived: &Arrived<'a>, _path: &Flying, _next: &Onward) {}

    /// A path has left the scene.
    fn leave(&mut self, _path: &Flying) {}

    /// All paths have come to the ends of their rays.
    fn pause(&mut self) {}
}

/// Paths that go on, and the ray that each is about to follow.
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

/// A path on its way.
#[derive(Clone, Copy)]
pub(crate) struct Flying {
    /// Its number among those of the batch.
    pub number: u32,
    /// The flux that it stands for.
    pub flux: Rgb,
    /// That when it set out, in its largest channel.
    start: f64,
    /// When it is on its way, while the shutter is open.
    pub time: f64,
    /// Surfaces that it has been scattered at.
    pub bounce: u32,
    pub media: MediumStack,
    /// As [`Passing::meet`] has it.
    chance: f64,
    /// What the last surface leaves of light that comes to such a surface again ([`Bsdf::again`]), which counts once
    /// the path has come to another: of all of them on a way, the one that is nearest to the viewer has none.
    pub again: Rgb,
    /// Whether it was scattered into a single direction, or nearly so, the last time.
    pub is_sharp: bool,
    /// How many times in a row glass has held it ([`roulette::held`]).
    held: u32,
    /// Whether the hero of its wavelengths is all that it carries.
    pub single: bool,
}

impl Flying {
    /// Leaves the hero of its wavelengths alone, which stands for all from here on.
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

    /// When the paths that will be followed are on their way.
    pub fn set_times(&mut self, times: Times) {
        self.times = times;
    }

    /// At which wavelengths the paths that will be followed go.
    pub fn set_waves(&mut self, waves: impl Iterator<Item = Waves>) {
        self.waves.clear();
        self.waves.extend(waves);
    }

    /// Whether there is anything that rays may pass.
    pub fn passes(&self) -> bool {
        self.passing.is_needed()
    }

    /// Whether media lie in one another.
    pub fn is_nested(&self) -> bool {
        self.passing.is_nested()
    }

    /// Follows a path for each of these numbers to its end.
    pub fn follow(&mut self, paths: &mut [Sampler], cancel: &Cancel, visitor: &mut impl Visitor<'a>) {
        self.start(paths, visitor);
        while !self.now.rays.is_empty() && !cancel.is_raised() {
            self.hits.resize(self.now.rays.len(), Hit::MISS);
            self.scene.intersect_queue(&mut self.now.rays, &mut self.hits);
            self.bounce(paths, visitor);
            visitor.pause();
        }
    }

    /// Lets paths set out.
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

    /// Takes all paths from their rays' hits to their next rays.
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
                    let again = arrived.here.bsdf().again();
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

    /// How the index of refraction goes with wavelength around what a surface encloses that a path has come to, by what
    /// the path is in and what it would be in beyond: if it has come to the front, and to the back.
    fn around(&self, media: &MediumStack, through: &MediumStack) -> [Dispersive; 2] {
        if self.passing.is_nested() { [media, through].map(MediumStack::dispersion) } else { [Dispersive::NONE; 2] }
    }

    /// Sends a path on from a surface, unless it ends there.
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
