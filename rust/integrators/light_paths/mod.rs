//! Paths that start at lights, one bounce at a time.

mod adjoint;
mod dimensions;

use super::nesting::MediumStack;
use super::passing::{Met, Passing};
use super::shadows::Shadows;
use super::{Job, LightWorker, Splat};
use crate::math::{Hit, Ray, RayQueue};
use crate::optics::{Bsdf, Rgb};
use crate::sampling::Sampler;
use crate::scene::{Camera, EmissionNumbers, Emitters, Encounter, Footprint, RayOrigin, Scene};
use crate::workers::Cancel;
use adjoint::Arrived;
use dimensions::{DIRECTION, Dimensions, LIGHT_CHOICE, OUTSIDE, PLACE, TIME};

/// When paths end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// The greatest number of bounces.
    pub max_depth: Option<u32>,
    /// Roulette is played from this number of bounces on.
    pub roulette_depth: u32,
}

/// What one thread follows paths from lights with.
pub(super) struct LightPaths<'a> {
    scene: &'a Scene,
    camera: &'a dyn Camera,
    footprint: Footprint,
    emitters: &'a Emitters<'a>,
    limits: Limits,
    /// Whether anything moves, the camera included.
    moves: bool,
    /// Whether anybody asks how wide the camera's rays are.
    widths: bool,
    passing: Passing,
    now: Queue,
    next: Queue,
    hits: Vec<Hit>,
    /// From surfaces to the camera.
    shadows: Shadows,
    /// What these bring, and where to.
    seen: Vec<[f64; 2]>,
    light: Vec<Rgb>,
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
struct Flying {
    /// Its number among those of the batch.
    number: u32,
    /// The flux that it stands for.
    flux: Rgb,
    /// A mean of that when it set out.
    start: f64,
    /// When it is on its way, while the shutter is open.
    time: f64,
    /// Surfaces that it has been scattered at.
    bounce: u32,
    media: MediumStack,
    /// As [`Passing::meet`] has it.
    chance: f64,
    /// What the last surface leaves of light that comes to such a surface again ([`Bsdf::again`]), which counts once
    /// the path has come to another: of all of them on a way, the one that is nearest to the viewer has none.
    again: Rgb,
}

impl<'a> LightPaths<'a> {
    pub fn new(job: Job<'a>, emitters: &'a Emitters<'a>, limits: Limits) -> Self {
        let Job { scene, camera, footprint } = job;
        let needs = scene.plan().needs();
        Self {
            scene,
            camera,
            footprint,
            emitters,
            limits,
            moves: scene.geometry().moves() || camera.uses_time(),
            widths: needs.points.width,
            passing: Passing::new(needs.masks, needs.nested),
            now: Queue::default(),
            next: Queue::default(),
            hits: Vec::new(),
            shadows: Shadows::default(),
            seen: Vec::new(),
            light: Vec::new(),
        }
    }

    /// Lets paths set out.
    fn start(&mut self, paths: &mut [Sampler]) {
        self.now.clear();
        for (number, sampler) in (0u32..).zip(paths) {
            let numbers = EmissionNumbers {
                choice: sampler.one(LIGHT_CHOICE),
                outside: sampler.one(OUTSIDE),
                place: sampler.two(PLACE),
                direction: sampler.two(DIRECTION),
            };
            let Some(light) = self.emitters.sample(&numbers) else { continue };
            let time = if self.moves { sampler.one(TIME) } else { 0.0 };
            let ray = Ray { time: self.camera.body().scene_time(time), ..light.ray };
            let (flux, start) = (light.weight, light.weight.mean());
            let (media, chance, again) = (MediumStack::NONE, -1.0, Rgb::ONE);
            self.now.push(&ray, Flying { number, flux, start, time, bounce: 0, media, chance, again });
        }
        if self.passing.is_nested() {
            let mut media = Vec::new();
            MediumStack::at(self.scene, self.now.rays.rows(), &mut media);
            for (path, media) in self.now.paths.iter_mut().zip(media) {
                path.media = media;
            }
        }
    }

    /// Takes all paths from their rays' hits to their next rays, and adds what the camera sees of them.
    fn bounce(&mut self, samplers: &mut [Sampler], splats: &mut Vec<Splat>) {
        self.next.clear();
        self.shadows.clear();
        self.seen.clear();
        self.passing.begin(self.scene, &self.now.rays, &self.hits);
        for i in 0..self.now.rays.len() {
            let hit = self.hits[i];
            if !hit.is_hit() {
                continue;
            }
            let (ray, mut path) = (self.now.rays.get(i), self.now.paths[i]);
            let sampler = &mut samplers[path.number as usize];
            let dimensions = Dimensions::of(path.bounce);
            let number = || sampler.one(dimensions.mask());
            match self.passing.meet(self.scene, i, (&ray, &hit), &path.media, &mut path.chance, number) {
                Met::Nothing(ray, media) => self.next.push(&ray, Flying { media, ..path }),
                Met::Surface { hit, outside, through } => {
                    let arrived = Arrived::new(self.scene, ray, hit, outside);
                    let again = arrived.here.bsdf().again();
                    if again != Rgb::ONE {
                        path.flux *= path.again;
                        path.again = again;
                    }
                    path.bounce += 1;
                    self.connect(&arrived, &path, through, sampler, dimensions);
                    self.go_on(&arrived, path, through, sampler, dimensions);
                }
            }
        }
        self.light.clear();
        self.light.resize(self.seen.len(), Rgb::ZERO);
        if self.passing.is_needed() {
            self.shadows.add_through(self.scene, self.passing.is_nested(), &mut self.light);
        } else {
            self.shadows.add_unblocked(self.scene, &mut self.light);
        }
        let splat = |(&film, &light): (&[f64; 2], &Rgb)| Splat { film, light };
        splats.extend(self.seen.iter().zip(&self.light).map(splat).filter(|splat| !splat.light.is_black()));
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// Finds out where the camera sees light that has come to a surface, if nothing lies between.
    fn connect(
        &mut self,
        arrived: &Arrived,
        path: &Flying,
        through: MediumStack,
        sampler: &mut Sampler,
        dimensions: Dimensions,
    ) {
        let here = &arrived.here;
        if here.bsdf().is_delta() {
            return;
        }
        let lens = if self.camera.uses_lens() { sampler.two(dimensions.lens()) } else { [0.5; 2] };
        let Some(seen) = self.camera.connect(here.position(), lens, path.time) else { return };
        let way = seen.origin - here.position();
        let distance = way.length();
        let direction = way / distance;
        if direction.is_nan() || here.is_through(direction) && !here.bsdf().transmits() {
            return;
        }
        let width = if self.widths { self.footprint.at(distance).width } else { 0.0 };
        let light = path.flux * arrived.towards(direction, distance, width) * seen.density;
        if light.is_black() || !light.is_finite() {
            return;
        }
        let segment = here.ray_origin().segment(&RayOrigin::free(seen.origin));
        let misses = [arrived.hit.primitive, Ray::NO_TRIANGLE];
        self.shadows.push(&Ray { time: arrived.ray.time, misses, ..segment });
        self.shadows.bring(self.seen.len() as u32, light);
        if self.passing.is_nested() {
            self.shadows.start_in(if here.is_through(direction) { through } else { path.media });
        }
        self.seen.push(seen.film);
    }

    /// Sends a path on from a surface, unless it ends there.
    fn go_on(
        &mut self,
        arrived: &Arrived,
        path: Flying,
        through: MediumStack,
        sampler: &mut Sampler,
        dimensions: Dimensions,
    ) {
        if self.limits.max_depth.is_some_and(|most| path.bounce >= most) {
            return;
        }
        let u = sampler.two(dimensions.direction());
        let Some(next) = arrived.onward(|| sampler.one(dimensions.scattering_choice()), u) else { return };
        let mut flux = path.flux * next.weight;
        if path.bounce >= self.limits.roulette_depth {
            let goes_on = (flux.mean() / path.start).min(1.0);
            let survives = sampler.one(dimensions.roulette()) < goes_on;
            if !survives {
                return;
            }
            flux /= goes_on;
        }
        if flux.is_black() || !flux.is_finite() {
            return;
        }
        let ray = arrived.here.ray_origin().ray(next.direction);
        let ray = Ray { time: arrived.ray.time, misses: [arrived.hit.primitive, Ray::NO_TRIANGLE], ..ray };
        let media = if next.is_through { through } else { path.media };
        self.next.push(&ray, Flying { flux, media, chance: -1.0, ..path });
    }
}

impl LightWorker for LightPaths<'_> {
    fn follow(&mut self, paths: &mut [Sampler], cancel: &Cancel, splats: &mut Vec<Splat>) {
        self.start(paths);
        while !self.now.rays.is_empty() && !cancel.is_raised() {
            self.hits.resize(self.now.rays.len(), Hit::MISS);
            self.scene.intersect_queue(&mut self.now.rays, &mut self.hits);
            self.bounce(paths, splats);
        }
    }
}
