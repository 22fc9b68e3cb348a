//! The way of paths that start at lights and go through media, one path after the other.

use super::asking::at_once;
use super::course::{Course, Going, Nobody, Place};
use super::filled::Filled;
use super::numbers::{Numbers, depth};
use super::vertex::{Point, Vertex};
use super::weights::Weights;
use crate::light_paths::{Arrived, Dimensions, EmissionDimensions, Limits, Onward, Times};
use crate::nesting::MediumStack;
use crate::parting::Parting;
use crate::{is_matt, roulette};
use raywright_base::math::Ray;
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Camera, EmissionSample, Emitters, Scene};

/// What one thread walks with.
pub(crate) struct MediaLightWalk<'a> {
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
}

/// A path on its way.
#[derive(Clone, Copy)]
pub(crate) struct Drifting {
    /// Its number among those of the batch.
    pub number: u32,
    pub going: Going,
    /// Which wavelength decides how far it gets.
    pub hero: usize,
    /// Its flux when it set out, in the largest channel.
    start: f64,
    /// When it is on its way, while the shutter is open.
    pub time: f64,
    /// How often it has been scattered.
    pub bounce: u32,
    /// As [`crate::light_paths::Flying::again`].
    pub again: Rgb,
    /// Whether it was scattered into a single direction, or nearly so, the last time; or by a medium.
    pub is_sharp: bool,
    pub is_adrift: bool,
    held: u32,
    /// Its wavelengths; none for red, green and blue. And whether the first is all that it carries.
    waves: Option<Waves>,
    pub single: bool,
}

impl Drifting {
    /// The flux that it stands for; where a medium scatters it, that of what is scattered.
    pub fn flux(&self) -> Rgb {
        self.going.weights.throughput()
    }

    /// The wavelengths at which it goes through media.
    pub fn waves(&self) -> Option<Waves> {
        if self.single { self.waves.map(|waves| waves.alone()) } else { self.waves }
    }

    /// Leaves the first of its wavelengths alone, which stands for all from here on.
    fn end_all_but_first(&mut self) {
        if !self.single {
            self.going.weights.end_all_but_first();
            self.single = true;
        }
    }
}

/// Who is told where paths have come to, path by path.
pub(crate) trait MediaVisitor<'a> {
    /// A path has set out.
    fn set_out(&mut self, _path: &Drifting, _light: &EmissionSample) {}

    /// A path has come to a surface, or to where a medium scatters it.
    fn meet(
        &mut self,
        at: &Vertex<'a>,
        path: &Drifting,
        numbers: &mut Numbers,
        dimensions: Dimensions,
        cancel: &Cancel,
    );

    /// A path goes on, unless roulette ends it.
    fn go_on(&mut self, _at: &Vertex<'a>, _path: &Drifting, _next: &Onward) {}

    /// Media have taken so much of the light.
    fn absorb(&mut self, _flux: Rgb) {}

    /// A path has left the scene.
    fn leave(&mut self, _path: &Drifting) {}
}

impl<'a> MediaLightWalk<'a> {
    pub fn new(scene: &'a Scene, emitters: &'a Emitters<'a>, limits: Limits, camera: Option<&'a dyn Camera>) -> Self {
        let moves = scene.geometry().moves() || camera.is_some_and(|camera| camera.uses_time());
        Self { scene, emitters, limits, camera, moves, times: Times::Drawn, waves: Vec::new() }
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

    fn course(&self, path: &Drifting) -> Course<'a> {
        Course::alone(self.scene, path.waves())
    }

    /// Follows a path for each of these numbers to its end.
    pub fn follow(&self, paths: &mut [Sampler], cancel: &Cancel, visitor: &mut impl MediaVisitor<'a>) {
        let mut setting_out = Vec::new();
        for (number, sampler) in (0u32..).zip(paths.iter_mut()) {
            let numbers = EmissionDimensions::numbers(sampler);
            let Some(light) = self.emitters.sample(&numbers, self.waves.get(number as usize)) else { continue };
            let (time, of_scene) = self.times.of(number as usize, self.moves, self.camera, sampler);
            setting_out.push((number, light, time, Ray { time: of_scene, ..light.ray }));
        }
        let rays: Vec<Ray> = setting_out.iter().map(|(.., ray)| *ray).collect();
        let mut media = Vec::new();
        MediumStack::<Filled>::at(self.scene, &rays, &mut media);
        for ((number, light, time, ray), media) in setting_out.into_iter().zip(media) {
            if cancel.is_raised() {
                return;
            }
            let sampler = &mut paths[number as usize];
            let hero = ((sampler.one(EmissionDimensions::HERO) * 3.0) as usize).min(2);
            let weights = Weights { carried: light.weight, ..Weights::START };
            let going = Going { ray, weights, media, passed: 0 };
            let again = Rgb::ONE;
            let (bounce, is_sharp, is_adrift, held, single) = (0, false, false, 0, false);
            let waves = self.waves.get(number as usize).copied();
            let start = light.weight.max();
            let path =
                Drifting { number, going, hero, start, time, bounce, again, is_sharp, is_adrift, held, waves, single };
            self.send(path, &light, sampler, cancel, visitor);
        }
    }

    /// Follows one path.
    fn send(
        &self,
        mut path: Drifting,
        light: &EmissionSample,
        sampler: &mut Sampler,
        cancel: &Cancel,
        visitor: &mut impl MediaVisitor<'a>,
    ) {
        let mut numbers = Numbers::apart(sampler);
        if path.waves.is_some() {
            // Not by the number of the wavelengths: what parts these goes by the first.
            path.hero = numbers.hero();
        }
        visitor.set_out(&path, light);
        if light.is_infinite && self.scene.surrounding().is_some() {
            self.come_from_afar(&mut path, &mut numbers, cancel, visitor);
        }
        while !path.going.weights.carried.is_black() && !cancel.is_raised() {
            let dimensions = Dimensions::of(path.bounce);
            let before = path.flux();
            let way = depth(numbers.one(dimensions.mask()));
            let (hero, mut glow) = (path.hero, Rgb::ZERO);
            let (course, lit, going) = (self.course(&path), None::<&Nobody>, &mut path.going);
            let place = at_once(course.advance(going, (hero, way), &mut numbers, cancel, &mut glow, lit));
            let taken = if place.is_some() { before - path.flux() } else { before };
            visitor.absorb(taken);
            let Going { ray, media, .. } = path.going;
            let mut waiting = None;
            let at = match place {
                None => return,
                Some(Place::Outside) => return visitor.leave(&path),
                Some(Place::Medium { here, collision, .. }) => {
                    Vertex::of_medium(self.scene, here, &collision, (ray, media), path.waves.as_ref())
                }
                Some(Place::Surface { hit, outside, through }) => {
                    let (arrived, parting) = match path.waves {
                        None => (Arrived::new(self.scene, ray, hit, outside), None),
                        Some(waves) => {
                            let around = [&media, &through].map(MediumStack::dispersion);
                            Arrived::by_waves(self.scene, (ray, hit), (outside, around), waves)
                        }
                    };
                    waiting = parting.filter(|parting| parting.waits(arrived.here.bsdf()));
                    if parting.is_some() && waiting.is_none() {
                        path.end_all_but_first();
                    }
                    Vertex::of_surface(arrived, through, media)
                }
            };
            let again = at.again();
            if again != Rgb::ONE {
                path.going.weights.carried *= path.again;
                path.again = again;
            }
            path.bounce += 1;
            visitor.meet(&at, &path, &mut numbers, dimensions, cancel);
            if !self.go_on(&at, &mut path, waiting, &mut numbers, dimensions, visitor) {
                return;
            }
        }
    }

    /// Light from outside has come through a medium without an end.
    fn come_from_afar(
        &self,
        path: &mut Drifting,
        numbers: &mut Numbers,
        cancel: &Cancel,
        visitor: &mut impl MediaVisitor<'a>,
    ) {
        let Ray { origin, direction, time, .. } = path.going.ray;
        let back = Ray { time, ..Ray::new(origin, -direction) };
        let before = path.flux();
        let left = at_once(self.course(path).through(before, back, MediumStack::NONE, numbers, cancel));
        visitor.absorb(before - left);
        path.going.weights.carried = left;
    }

    /// Scatters a path, and says whether it goes on.
    fn go_on(
        &self,
        at: &Vertex<'a>,
        path: &mut Drifting,
        parting: Option<Parting>,
        numbers: &mut Numbers,
        dimensions: Dimensions,
        visitor: &mut impl MediaVisitor<'a>,
    ) -> bool {
        if self.limits.max_depth.is_some_and(|most| path.bounce >= most) {
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
        if path.bounce >= self.limits.roulette_depth.min(roulette::AT_LATEST) {
            // Light leaves a medium sooner or later, unless that has no end.
            let survival = if bsdf.is_some() || self.scene.surrounding().is_some() {
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
