//! Camera paths that are followed one by one.

use super::medium_traversal::{MediumTraversal, OnTheWay, RaySegmentState, TraversalEnd};
use super::path_numbers::PathNumbers;
use super::path_state::PathState;
use crate::dimensions::Dimensions;
use crate::media::current_medium::Filled;
use crate::media::equiangular::{PointLights, ScatteringSpan};
use crate::media::path_numbers::{FurtherNumbers, depth};
use crate::media::scattering::Scattering;
use crate::mis_weight::power_heuristic;
use crate::nesting::MediumStack;
use crate::path_settings::{Follow, PathSettings};
use crate::terminate_wavelengths::Parting;
use crate::widths::widened;
use crate::{CameraSample, Worker, roulette};
use raywright_base::math::{Hit, Ray};
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, BsdfSample, Phase, Rgb};
use raywright_scene::media::Coefficients;
use raywright_scene::{
    Footprint, Interaction, LightSample, LightSampleContext, LookupContext, Scene, SurfaceInteraction,
};

/// Index and count of a single light sample.
pub(super) const ONCE: (u32, u32) = (0, 1);

/// A path tracer of single paths.
#[derive(Clone, Copy)]
pub(super) struct Walker<'a> {
    pub(super) settings: PathSettings,
    pub(super) scene: &'a Scene,
    /// Footprint of camera rays, if materials need it.
    pub(super) footprint: Option<Footprint>,
    /// Point lights.
    pub(super) points: &'a PointLights<'a>,
}

impl<'a> Walker<'a> {
    /// Return the radiance along a camera ray. `waiting` is storage for split paths.
    fn follow(
        &self,
        sample: &mut CameraSample,
        media: MediumStack<Filled>,
        waiting: &mut Vec<PathState>,
        cancel: &Cancel,
    ) -> Rgb {
        let mut light = Rgb::ZERO;
        let u = sample.sampler.one(Dimensions::WAVES);
        let waves = self.scene.plan().needs().waves.then(|| Waves::of(u));
        let mut further = FurtherNumbers::new(sample.sampler.paired());
        let mut numbers = PathNumbers::new(&mut sample.sampler, &mut further);
        // The first wavelength is the hero: dispersion ends all but that. Of red, green and blue it is any.
        let hero = if waves.is_some() { 0 } else { ((u * 3.0) as usize).min(2) };
        let path = PathState::of_camera(sample.ray, media, waves);
        waiting.clear();
        let footprint = self.footprint.unwrap_or_default();
        waiting.push(PathState { footprint, ..path });
        while let Some(mut path) = waiting.pop() {
            while !cancel.is_raised() {
                numbers.ray = Dimensions::of(path.bounce, path.branch);
                let place = self.advance(&mut path, hero, &mut numbers, cancel, &mut light);
                let Some(place) = place else { break };
                let goes_on = match place {
                    TraversalEnd::Medium { here, collision, span } => {
                        path.come_to(collision.t, 0.0);
                        let part = collision.density.map(|density| ScatteringSpan {
                            ray: path.ray,
                            span,
                            t: collision.t,
                            density,
                        });
                        let part = part.filter(|_| self.is_lit(&path));
                        self.scatter(&mut path, &here, part, hero, &mut numbers, cancel, &mut light)
                    }
                    TraversalEnd::Surface { hit, outside, through } => {
                        let at = (hit, outside, through);
                        self.reflect(&mut path, at, hero, waiting, &mut numbers, cancel, &mut light)
                    }
                    TraversalEnd::Outside => false,
                };
                if !goes_on {
                    break;
                }
            }
        }
        waves.map_or(light, |waves| waves.seen(light))
    }

    /// Return the medium traversal of the path's wavelengths.
    pub(super) fn course(&self, waves: Option<Waves>) -> MediumTraversal<'a> {
        MediumTraversal { scene: self.scene, scatters: self.settings.scatters, roulette: false, waves }
    }

    /// Advance a path along its ray to its next scattering event. Return `None` if it leaves the scene, after adding
    /// the light from outside.
    fn advance(
        &self,
        path: &mut PathState,
        hero: usize,
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
        light: &mut Rgb,
    ) -> Option<TraversalEnd> {
        let u = numbers.ray.mask();
        let way = depth(numbers.one(u));
        let mut going = RaySegmentState { ray: path.ray, weights: path.weights, media: path.media };
        let before = *path;
        let lit =
            |now: &RaySegmentState, span, (here, phase): (&Coefficients, Phase), numbers: &mut PathNumbers<'_>| {
                let RaySegmentState { ray, weights, media } = *now;
                let path = PathState { ray, weights, media, ..before };
                self.lit_on_the_way(&path, span, here, phase, hero, numbers, cancel)
            };
        let lit = self.is_lit(path).then_some(&lit as OnTheWay<'_>);
        let place = self.course(path.waves).advance(&mut going, (hero, way), numbers, cancel, light, lit);
        (path.ray, path.weights, path.media) = (going.ray, going.weights, going.media);
        if let Some(TraversalEnd::Outside) = place {
            *light += path.weights.throughput() * self.light_from_outside(path);
            return None;
        }
        place
    }

    /// Return whether point lights are sampled along the path through homogeneous media.
    fn is_lit(&self, path: &PathState) -> bool {
        let may_scatter = self.settings.max_depth.is_none_or(|most| path.bounce < most);
        may_scatter && !self.points.is_empty()
    }

    /// Return the weighted light of infinite lights along a path's ray.
    fn light_from_outside(&self, path: &PathState) -> Rgb {
        let lights = self.scene.lights();
        let arriving = lights.infinite_radiance_at(path.ray.direction, path.waves.as_ref());
        if arriving.is_black() {
            return arriving;
        }
        let receiver = LightSampleContext { position: path.ray.origin, normal: path.normal, waves: path.waves };
        arriving * self.by_chance(path, || lights.infinite_pdf(&receiver, path.ray.direction))
    }

    /// Return the MIS weight of light that a path hits, given the density of light sampling at its last scattering
    /// event.
    fn by_chance(&self, path: &PathState, asked: impl FnOnce() -> f64) -> f64 {
        if path.pdf == f64::INFINITY {
            return 1.0;
        }
        let often = if path.bounce == 1 { f64::from(self.settings.light_samples) } else { 1.0 };
        let asked = asked() * often;
        if asked == 0.0 {
            1.0
        } else {
            power_heuristic(path.pdf * path.weights.drawn.mean(), asked * path.weights.asked.mean())
        }
    }

    /// Scatter a path in a medium and return whether it continues.
    #[allow(clippy::too_many_arguments)]
    fn scatter(
        &self,
        path: &mut PathState,
        here: &Scattering,
        part: Option<ScatteringSpan>,
        hero: usize,
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
        light: &mut Rgb,
    ) -> bool {
        if self.settings.max_depth.is_some_and(|most| path.bounce >= most) {
            return false;
        }
        let media = path.media;
        let asked = self.direct_light(here, path, |_| media, (hero, ONCE), numbers, cancel);
        if let Some((drawn, arrives)) = asked {
            let place = drawn.source.filter(|_| drawn.pdf == f64::INFINITY).map(|source| source.position());
            let weight = match (part, place) {
                (Some(part), Some(place)) => self.points.weight(&part, place),
                _ => 1.0,
            };
            *light += arrives * weight;
        }
        let u = numbers.ray.scattering_choice() + 1;
        let Some(next) = here.sample(&mut || 0.0, numbers.two(u)) else { return false };
        let chance = numbers.ray.roulette();
        self.go_on(path, here, &next, media, numbers.one(chance), self.never_ends())
    }

    /// Scatter a path at a surface and return whether it continues.
    #[allow(clippy::too_many_arguments)]
    fn reflect(
        &self,
        path: &mut PathState,
        (hit, outside, through): (Hit, f64, MediumStack<Filled>),
        hero: usize,
        waiting: &mut Vec<PathState>,
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
        light: &mut Rgb,
    ) -> bool {
        let ray = path.ray;
        let (scene, geometry) = (self.scene, self.scene.geometry());
        path.leaves = hit.primitive;
        let surface = geometry.surface(&ray, &hit);
        let emission = scene.emission_at(&surface);
        let width = if self.footprint.is_some() { path.footprint.at(hit.t).width } else { 0.0 };
        let gaze = LookupContext { width, waves: path.waves };
        if !emission.is_dark() {
            let sent = emission.sent(geometry, &ray, &hit, &surface, || gaze);
            let cosine = -ray.direction.dot(surface.normal);
            let receiver = LightSampleContext { position: ray.origin, normal: path.normal, waves: path.waves };
            let asked = || scene.lights().surface_pdf(geometry, &receiver, &ray, &hit, cosine);
            *light += path.weights.throughput() * sent * self.by_chance(path, asked);
        }
        if self.settings.max_depth.is_some_and(|most| path.bounce >= most) {
            return false;
        }
        let (outside, parting) = path.parting(scene, &surface, &through, outside);
        let here = SurfaceInteraction::new(scene, &ray, &hit, surface, gaze, outside);
        path.come_to(hit.t, here.curvature());
        let later = parting.filter(|parting| parting.waits(here.bsdf()));
        if parting.is_some() && later.is_none() {
            path.end_all_but_hero();
        }
        path.meet(here.bsdf().repeat_correction());
        if !self.settings.ambient.is_black() {
            let share = here.ambient(scene, &ray, &hit, gaze, outside);
            *light += path.weights.throughput() * share * self.settings.ambient;
        }
        let is_first = path.bounce == 0 && !here.bsdf().is_delta();
        let splits = if is_first { f64::from(self.settings.splits) } else { 1.0 };
        path.splits = splits;
        if !here.bsdf().is_delta() {
            let now = path.media;
            let side = |drawn: &LightSample| if here.is_through(drawn.direction) { through } else { now };
            let often = if path.bounce == 0 { self.settings.light_samples } else { 1 };
            for number in 0..often {
                let draw = (hero, (number, often));
                if let Some((_, arrives)) = self.direct_light(&here, path, side, draw, numbers, cancel) {
                    *light += arrives;
                }
            }
        }
        match self.settings.follow {
            Follow::DeltaLobes => return self.split(path, &here, through, later.as_ref(), waiting),
            Follow::Nothing => return false,
            Follow::All | Follow::MinDensity(_) => {}
        }
        if splits > 1.0 {
            self.continue_in_several(path, &here, through, waiting, numbers);
            return false;
        }
        let choice = numbers.ray.scattering_choice();
        let u = numbers.two(choice + 1);
        let Some(next) = here.sample(&mut || numbers.one(choice), u) else { return false };
        if next.pdf < self.settings.least_pdf() {
            return false;
        }
        path.splits = 1.0;
        let media = if next.is_through { through } else { path.media };
        let chance = numbers.ray.roulette();
        path.part(later.as_ref(), here.wo(), &next);
        self.go_on(path, &here, &next, media, numbers.one(chance), true)
    }

    /// Continue a path in every delta direction of a surface.
    fn split(
        &self,
        path: &PathState,
        here: &SurfaceInteraction,
        through: MediumStack<Filled>,
        parting: Option<&Parting>,
        waiting: &mut Vec<PathState>,
    ) -> bool {
        let mut branch = path.branch.wrapping_mul(2);
        here.bsdf().delta_lobes(here.wo(), |single| {
            if let Some(next) = here.to_world(single) {
                let mut one = PathState { branch, ..*path };
                one.part(parting, here.wo(), &next);
                let media = if next.is_through { through } else { path.media };
                if self.go_on(&mut one, here, &next, media, 0.0, true) {
                    waiting.push(one);
                }
                branch = branch.wrapping_add(1);
            }
        });
        false
    }

    /// Continue with several paths.
    fn continue_in_several(
        &self,
        path: &PathState,
        here: &SurfaceInteraction,
        through: MediumStack<Filled>,
        waiting: &mut Vec<PathState>,
        numbers: &mut PathNumbers,
    ) {
        for branch in 0..path.splits as u32 {
            // The first branch keeps the path's index.
            let branch = if branch == 0 { path.branch } else { branch };
            let dimensions = Dimensions::of(path.bounce, branch);
            let choice = dimensions.scattering_choice();
            let u = numbers.two(choice + 1);
            let drawn = here.sample(&mut || numbers.one(choice), u);
            let Some(mut next) = drawn.filter(|next| next.pdf >= self.settings.least_pdf()) else { continue };
            let media = if next.is_through { through } else { path.media };
            next.pdf *= path.splits;
            next.weight /= path.splits;
            let mut one = PathState { branch, splits: 1.0, ..*path };
            let chance = numbers.one(dimensions.roulette());
            if self.go_on(&mut one, here, &next, media, chance, true) {
                waiting.push(one);
            }
        }
    }

    /// Return whether paths could scatter indefinitely between surfaces.
    pub(super) fn never_ends(&self) -> bool {
        self.scene.surrounding().is_some()
    }

    /// Continue a path in a sampled direction, unless roulette with a uniform number ends it, and return whether it
    /// continues. In finite media, unattenuated light is never terminated, as it leaves them eventually.
    pub(super) fn go_on(
        &self,
        path: &mut PathState,
        here: &impl Interaction,
        next: &BsdfSample,
        media: MediumStack<Filled>,
        chance: f64,
        may_never_end: bool,
    ) -> bool {
        let receiver = here.light_context();
        let ray = here.ray_origin().ray(next.wi);
        path.weights.carried *= next.weight;
        path.weights.asked = path.weights.drawn;
        (path.pdf, path.normal, path.media) = (next.pdf, receiver.normal, media);
        if self.footprint.is_some() {
            path.footprint = widened(&path.footprint, path.footprint.width, path.curvature, next);
        }
        path.scale *= next.eta * next.eta;
        path.bounce = path.bounce.saturating_add(1);
        let leaves = std::mem::replace(&mut path.leaves, Ray::NO_TRIANGLE);
        path.ray = Ray { time: path.ray.time, misses: [leaves, Ray::NO_TRIANGLE], ..ray };
        let throughput = path.weights.throughput();
        if throughput.max() * path.scale < self.settings.least {
            return false;
        }
        if path.bounce < self.settings.roulette_depth.min(roulette::AT_LATEST) {
            return !throughput.is_black();
        }
        let survival = if may_never_end {
            roulette::survival(throughput, path.scale)
        } else {
            roulette::survival_among(throughput, path.scale)
        };
        if chance >= survival {
            return false;
        }
        path.weights.carried /= survival;
        true
    }
}

impl Worker for Walker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        assert_eq!(samples.len(), radiance.len());
        let rays: Vec<Ray> = samples.iter().map(|sample| sample.ray).collect();
        let (mut media, mut waiting) = (Vec::new(), Vec::new());
        MediumStack::at(self.scene, &rays, &mut media);
        for ((sample, media), radiance) in samples.iter_mut().zip(media).zip(radiance) {
            if cancel.is_raised() {
                return;
            }
            *radiance = self.follow(sample, media, &mut waiting, cancel);
        }
    }
}
