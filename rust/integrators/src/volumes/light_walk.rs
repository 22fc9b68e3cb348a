//! Tracing of light paths through media, one path at a time.

use super::medium_traversal::{MediumTraversal, RaySegmentState, TraversalEnd};
use super::vertex::{Point, Vertex};
use crate::light_paths::{Arrived, Dimensions, EmissionDimensions, Limits, Onward, Times};
use crate::media::current_medium::Filled;
use crate::media::path_numbers::{PathNumbers, depth};
use crate::media::spectral_mis::Weights;
use crate::nesting::MediumStack;
use crate::terminate_wavelengths::Parting;
use crate::{is_matt, roulette};
use raywright_base::math::Ray;
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Camera, EmissionSample, Emitters, Scene};

/// Per-thread state.
pub(crate) struct MediaLightWalk<'a> {
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
}

/// The state of a light path in media.
#[derive(Clone, Copy)]
pub(crate) struct Drifting {
    /// Index within the batch.
    pub number: u32,
    pub going: RaySegmentState,
    /// Wavelength that samples distances.
    pub hero: usize,
    /// Largest channel of the initial flux.
    start: f64,
    /// Time as a fraction of the shutter interval.
    pub time: f64,
    /// Number of scattering events.
    pub bounce: u32,
    /// Remaining share as in [`crate::light_paths::Flying::repeat_correction`].
    pub again: Rgb,
    /// True if the last bounce was specular or nearly so; and true if a medium scattered it.
    pub is_sharp: bool,
    pub is_adrift: bool,
    held: u32,
    /// Wavelengths, `None` for RGB; and true if only the first is left.
    waves: Option<Waves>,
    pub single: bool,
}

impl Drifting {
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

/// Receives the vertices of light paths, one path after the other.
pub(crate) trait MediaVisitor<'a> {
    /// A path starts.
    fn set_out(&mut self, _path: &Drifting, _light: &EmissionSample) {}

    /// A path arrives at a surface or a scattering event.
    fn meet(
        &mut self,
        at: &Vertex<'a>,
        path: &Drifting,
        numbers: &mut PathNumbers,
        dimensions: Dimensions,
        cancel: &Cancel,
    );

    /// A path continues, unless roulette terminates it.
    fn go_on(&mut self, _at: &Vertex<'a>, _path: &Drifting, _next: &Onward) {}

    /// Media have absorbed flux.
    fn absorb(&mut self, _flux: Rgb) {}

    /// A path leaves the scene.
    fn leave(&mut self, _path: &Drifting) {}
}

impl<'a> MediaLightWalk<'a> {
    pub fn new(scene: &'a Scene, emitters: &'a Emitters<'a>, limits: Limits, camera: Option<&'a dyn Camera>) -> Self {
        let moves = scene.geometry().moves() || camera.is_some_and(|camera| camera.uses_time());
        Self { scene, emitters, limits, camera, moves, times: Times::Drawn, waves: Vec::new() }
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

    fn course(&self, path: &Drifting) -> MediumTraversal<'a> {
        MediumTraversal::alone(self.scene, path.waves())
    }

    /// Trace one path per sampler to its end.
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
            let going = RaySegmentState { ray, weights, media };
            let again = Rgb::ONE;
            let (bounce, is_sharp, is_adrift, held, single) = (0, false, false, 0, false);
            let waves = self.waves.get(number as usize).copied();
            let start = light.weight.max();
            let path =
                Drifting { number, going, hero, start, time, bounce, again, is_sharp, is_adrift, held, waves, single };
            self.send(path, &light, sampler, cancel, visitor);
        }
    }

    /// Trace one path.
    fn send(
        &self,
        mut path: Drifting,
        light: &EmissionSample,
        sampler: &mut Sampler,
        cancel: &Cancel,
        visitor: &mut impl MediaVisitor<'a>,
    ) {
        let mut numbers = PathNumbers::apart(sampler);
        if path.waves.is_some() {
            // This choice must be independent of the wavelengths' own: dispersion keeps the first.
            path.hero = numbers.more.hero();
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
            let (course, going) = (self.course(&path), &mut path.going);
            let place = course.advance(going, (hero, way), &mut numbers, cancel, &mut glow, None);
            let taken = if place.is_some() { before - path.flux() } else { before };
            visitor.absorb(taken);
            let RaySegmentState { ray, media, .. } = path.going;
            let mut waiting = None;
            let at = match place {
                None => return,
                Some(TraversalEnd::Outside) => return visitor.leave(&path),
                Some(TraversalEnd::Medium { here, collision, .. }) => {
                    Vertex::of_medium(self.scene, here, &collision, (ray, media), path.waves.as_ref())
                }
                Some(TraversalEnd::Surface { hit, outside, through }) => {
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
            let again = at.repeat_correction();
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

    /// Attenuate light from outside by the infinite medium.
    fn come_from_afar(
        &self,
        path: &mut Drifting,
        numbers: &mut PathNumbers,
        cancel: &Cancel,
        visitor: &mut impl MediaVisitor<'a>,
    ) {
        let Ray { origin, direction, time, .. } = path.going.ray;
        let back = Ray { time, ..Ray::new(origin, -direction) };
        let before = path.flux();
        let left = self.course(path).through(before, back, MediumStack::NONE, numbers, cancel);
        visitor.absorb(before - left);
        path.going.weights.carried = left;
    }

    /// Scatter a path and return whether it continues.
    fn go_on(
        &self,
        at: &Vertex<'a>,
        path: &mut Drifting,
        parting: Option<Parting>,
        numbers: &mut PathNumbers,
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
            // Light leaves a finite medium eventually.
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
