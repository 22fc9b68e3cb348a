//! A batch of paths on their way.

use super::aiming::{Arrival, arrive, draw};
use super::alive::{Alive, Queue};
use super::branches::singles;
use super::dimensions::Dimensions;
use super::features::{Baggage, Features};
use super::nesting::{Boundary, Inside, around};
use super::reuse::Reuse;
use super::shadows::{Shadows, opacity};
use super::weights::{ROULETTE_AT_LATEST, power_heuristic, survival};
use super::{Follow, Settings};
use crate::integrators::{CameraSample, Worker};
use crate::math::{DVec3, Hit, LANES, Ray};
use crate::optics::{Bsdf, Rgb};
use crate::sampling::Sampler;
use crate::scene::textures::TexturePoint;
use crate::scene::{
    Aim, Caustics, Departure, Footprint, Interaction, Receiver, Scattered, Scatters, Scene, SurfacePoint, is_matt,
};
use crate::simd::Level;
use crate::workers::Cancel;
use std::marker::PhantomData;

/// What one thread works with, see [`Settings::worker`].
pub(super) struct TransportWorker<'a, N> {
    pub(super) settings: Settings,
    pub(super) scene: &'a Scene,
    /// That of a camera's ray.
    footprint: Footprint,
    masks: bool,
    pub(super) nested: bool,
    widths: bool,
    /// Where paths aim, if they do.
    caustics: Option<&'a Caustics>,
    /// Whether paths need no more of a diffuse surface than its colour.
    pub(super) in_lanes: bool,
    pub(super) level: Level,
    pub(super) now: Queue,
    pub(super) next: Queue,
    pub(super) hits: Vec<Hit>,
    /// The paths that have come to diffuse surfaces.
    diffuse: Vec<u32>,
    /// The parts of rays around hits of what encloses a medium.
    windows: Vec<Ray>,
    pub(super) shadows: Shadows,
    pub(super) reuse: Reuse,
    /// What samples find for themselves, and then what they find for sharing.
    found: Vec<Rgb>,
    features: PhantomData<N>,
}

/// A point that a path has come to.
pub(super) struct Vertex<'p, S> {
    pub(super) here: Interaction<S>,
    pub(super) path: &'p Alive,
    pub(super) baggage: &'p Baggage,
    pub(super) dimensions: Dimensions,
    /// What is behind the surface, for a path that goes through it.
    pub(super) through: &'p Inside,
    /// The width there.
    pub(super) width: f64,
    pub(super) time: f64,
    /// Where light comes from by way of what is sharp.
    pub(super) aim: Option<Aim<'p>>,
    /// Whether roulette has been played.
    pub(super) arrival: Arrival,
}

impl<'a, N: Features> TransportWorker<'a, N> {
    pub fn new(settings: Settings, scene: &'a Scene, footprint: Footprint) -> Self {
        let needs = scene.plan().needs();
        Self {
            settings,
            scene,
            footprint,
            masks: N::BAGGAGE && needs.masks,
            nested: N::BAGGAGE && needs.nested,
            widths: N::BAGGAGE && needs.points.width,
            caustics: if settings.aims { scene.caustics() } else { None },
            in_lanes: settings.are_plain() && !settings.aims && !(N::BAGGAGE && needs.points.width),
            level: Level::current().unwrap_or(Level::Scalar),
            diffuse: Vec::new(),
            now: Queue::default(),
            next: Queue::default(),
            hits: Vec::new(),
            windows: Vec::new(),
            shadows: Shadows::default(),
            reuse: Reuse::default(),
            found: Vec::new(),
            features: PhantomData,
        }
    }

    /// Puts the camera's rays into the queue.
    fn start(&mut self, samples: &[CameraSample]) {
        self.now.clear();
        self.now.rays.extend(samples.iter().map(|s| s.ray));
        self.now.alive.extend((0u32..).zip(samples).map(|(sample, _)| Alive {
            throughput: Rgb::ONE,
            normal: DVec3::ZERO,
            pdf: f64::INFINITY,
            scale: 1.0,
            sample,
            bounce: 0,
            each: false,
            gilded: false,
            aimed: 1.0,
        }));
        if N::BAGGAGE {
            let start = Baggage { footprint: self.footprint, ..Baggage::default() };
            self.now.baggage.resize(samples.len(), start);
            if self.nested {
                let mut inside = Vec::new();
                Inside::at(self.scene, &self.now.rays, &mut inside);
                for (baggage, inside) in self.now.baggage.iter_mut().zip(inside) {
                    baggage.inside = inside;
                }
            }
        }
    }

    /// Takes all paths from their rays' hits to their next rays.
    fn shade(&mut self, samples: &mut [CameraSample], radiance: &mut [Rgb]) {
        self.shadows.clear();
        self.next.clear();
        self.windows.clear();
        if self.nested {
            let hits = self.now.rays.iter().zip(&self.hits).filter(|(_, hit)| hit.is_hit());
            self.windows.extend(hits.filter_map(|(ray, hit)| around(self.scene, ray, hit)));
        }
        let crossings = if self.nested { self.scene.crossings(&self.windows) } else { Default::default() };
        let (mut window, count) = (0, samples.len());
        for i in 0..self.now.rays.len() {
            let (ray, path, mut hit) = (self.now.rays[i], self.now.alive[i], self.hits[i]);
            let mut own = if N::BAGGAGE { self.now.baggage[i] } else { Baggage::NONE };
            let arriving = &mut radiance[path.sample as usize];
            if !hit.is_hit() {
                *arriving += path.throughput * self.outside_light(&ray, &path);
                continue;
            }
            if !(N::BAGGAGE && (self.nested || self.masks))
                && self.diffuse(self.scene.geometry().locate(hit.primitive).0).is_some()
            {
                self.diffuse.push(i as u32);
                continue;
            }
            let mut surface = self.scene.geometry().surface(&ray, &hit);
            let (mut outside, mut behind) = (1.0, None);
            let dimensions = Dimensions::of(path.bounce, own.branch);
            let sampler = &mut samples[Self::own(path.sample, count)].sampler;
            if N::BAGGAGE && self.nested && around(self.scene, &ray, &hit).is_some() {
                window += 1;
                match Boundary::new(self.scene, &ray, &own.inside, &crossings, window - 1) {
                    Boundary::None(inside) => {
                        own.inside = inside;
                        self.pass(Ray { t_min: self.windows[window - 1].t_max.next_up(), ..ray }, path, own);
                        continue;
                    }
                    Boundary::Between { hit: owner, outside: ior, through } => {
                        if owner.primitive != hit.primitive || owner.inner != hit.inner {
                            (hit, surface) = (owner, self.scene.geometry().surface(&ray, &owner));
                        }
                        (outside, behind) = (ior, Some(through));
                    }
                }
            }
            if N::BAGGAGE && self.masks && self.is_passed(&ray, &hit, &surface, &mut own, dimensions, sampler) {
                self.pass(Ray { t_min: hit.t.next_up(), ..ray }, path, own);
                continue;
            }
            if N::BAGGAGE && outside == 1.0 && self.diffuse(surface.shape).is_some() {
                (self.hits[i], self.now.baggage[i]) = (hit, own);
                self.diffuse.push(i as u32);
                continue;
            }
            let baggage = if N::BAGGAGE { &own } else { &Baggage::NONE };
            *arriving += path.throughput * self.emitted(&ray, &hit, &surface, &path, baggage);
            if self.settings.max_depth.is_some_and(|depth| path.bounce >= depth) {
                continue;
            }
            let (time, through) = (ray.time, behind.as_ref().unwrap_or(&baggage.inside));
            if N::PLAIN {
                // Says once more which kind it is, so that nothing is asked of it at each use.
                let Some(&Bsdf::Diffuse(diffuse)) = self.scene.plan().constant(surface.shape) else { continue };
                let shading = surface.shading_normal;
                let here = Interaction::with(&ray, surface, (shading, None), Bsdf::Diffuse(diffuse));
                let path = &self.known(path, &here);
                let (width, aim, arrival) = (0.0, None, Arrival::GoesOn);
                self.scatter(Vertex { here, path, baggage, dimensions, through, width, time, aim, arrival }, sampler);
            } else {
                let width = if N::BAGGAGE && self.widths { baggage.footprint.at(hit.t).width } else { 0.0 };
                let here = Interaction::new(self.scene, &ray, &hit, surface, width, outside);
                let mut path = self.known(path, &here);
                path.meet(here.scattering().again());
                let (aim, arrival) = self.aim(&mut path, &here, || sampler.one(dimensions.roulette()));
                if arrival == Arrival::Ends {
                    continue;
                }
                let path = &path;
                let vertex = Vertex { here, path, baggage, dimensions, through, width, time, aim, arrival };
                if N::BAGGAGE && self.settings.ambient != Rgb::ZERO {
                    let share = vertex.here.ambient(self.scene, &ray, &hit, width, outside);
                    *arriving += path.throughput * share * self.settings.ambient;
                }
                if N::BAGGAGE && self.settings.follow == Follow::EachSingle {
                    self.split_singles(&vertex);
                }
                self.scatter(vertex, sampler);
            }
        }
        let diffuse = std::mem::take(&mut self.diffuse);
        for which in diffuse.chunks(LANES) {
            self.shade_diffuse(which, samples, radiance);
        }
        self.diffuse = diffuse;
        self.diffuse.clear();
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// The index of a sample, for what a path finds for it or for sharing.
    #[inline]
    pub(super) fn own(sample: u32, samples: usize) -> usize {
        let index = sample as usize;
        if N::SHARES && index >= samples { index - samples } else { index }
    }

    /// A path that comes to a surface, as the one that goes on from there.
    #[inline]
    fn known<S: Scatters>(&mut self, path: Alive, here: &Interaction<S>) -> Alive {
        if N::SHARES { self.reuse.visit(path, here) } else { path }
    }

    /// Where light comes from by way of what is sharp, at a point that a path has come to; and whether the path goes on
    /// there.
    #[inline]
    fn aim<S: Scatters>(
        &self,
        path: &mut Alive,
        here: &Interaction<S>,
        number: impl FnOnce() -> f64,
    ) -> (Option<Aim<'a>>, Arrival) {
        let Some(caustics) = self.caustics else { return (None, Arrival::GoesOn) };
        if !is_matt(here.scattering()) {
            return (None, Arrival::GoesOn);
        }
        // The density with which a path comes to the second point that it shares must be known.
        let aims = !N::SHARES || path.bounce > 0;
        let aim = if aims { caustics.aim(here.position()) } else { None };
        let arrival = arrive(path, aim.as_ref(), number);
        (aim, arrival)
    }

    /// What arrives from outside the scene at a ray that meets nothing.
    #[inline]
    fn outside_light(&self, ray: &Ray, path: &Alive) -> Rgb {
        let lights = self.scene.lights();
        let arriving = lights.outside(ray.direction);
        if arriving == Rgb::ZERO || path.pdf == f64::INFINITY {
            return arriving;
        }
        let receiver = Receiver { position: ray.origin, normal: path.normal };
        if !N::PLAIN && path.each {
            let weight = |drawn: f64| power_heuristic(path.pdf, drawn * self.asked_from(path));
            return lights.outside_weighed(&receiver, ray.direction, weight);
        }
        let drawn = lights.outside_pdf(&receiver, ray.direction);
        arriving * power_heuristic(path.pdf, drawn * self.asked_from(path))
    }

    /// How often light was asked where the path was scattered last.
    #[inline]
    fn asked_from(&self, path: &Alive) -> f64 {
        if N::BAGGAGE && path.bounce == 1 { f64::from(self.settings.light_samples) } else { 1.0 }
    }

    /// What a surface sends back along a ray.
    #[inline]
    pub(super) fn emitted(&self, ray: &Ray, hit: &Hit, surface: &SurfacePoint, path: &Alive, baggage: &Baggage) -> Rgb {
        let cosine = -ray.direction.dot(surface.normal);
        let emission = if N::PLAIN {
            self.scene.lights().emission(surface.shape).towards(cosine, &TexturePoint::NOWHERE)
        } else {
            let width = || if N::BAGGAGE && self.widths { baggage.footprint.at(hit.t).width } else { 0.0 };
            self.scene.emission_at(surface).sent(self.scene.geometry(), ray, hit, surface, width)
        };
        if emission == Rgb::ZERO || path.pdf == f64::INFINITY {
            return emission;
        }
        let receiver = Receiver { position: ray.origin, normal: path.normal };
        let (lights, geometry) = (self.scene.lights(), self.scene.geometry());
        let drawn = if !N::PLAIN && path.each {
            lights.own_pdf(geometry, &receiver, ray, hit, cosine)
        } else {
            lights.surface_pdf(geometry, &receiver, ray, hit, cosine)
        };
        emission * power_heuristic(path.pdf, drawn * self.asked_from(path))
    }

    /// Whether a ray passes a mask.
    fn is_passed(
        &self,
        ray: &Ray,
        hit: &Hit,
        surface: &SurfacePoint,
        baggage: &mut Baggage,
        dimensions: Dimensions,
        sampler: &mut Sampler,
    ) -> bool {
        let opacity = opacity(self.scene, ray, hit, surface);
        if opacity >= 1.0 {
            return false;
        }
        if baggage.chance < 0.0 {
            baggage.chance = sampler.one(dimensions.mask());
        }
        let is_passed = baggage.chance >= opacity;
        if is_passed {
            baggage.chance = (baggage.chance - opacity) / (1.0 - opacity);
        }
        is_passed
    }

    /// Sends a path on along the ray that it was on: with the same origin, so that nothing but the surface is left out.
    fn pass(&mut self, ray: Ray, path: Alive, baggage: Baggage) {
        self.next.rays.push(ray);
        self.next.alive.push(path);
        self.next.baggage.push(baggage);
    }

    /// Asks lights, and sends the path on to where its surface scatters it.
    #[inline]
    fn scatter<S: Scatters>(&mut self, vertex: Vertex<'_, S>, sampler: &mut Sampler) {
        let is_first = N::BAGGAGE && vertex.path.bounce == 0;
        let (asked, splits) = if is_first { (self.settings.light_samples, self.settings.splits) } else { (1, 1) };
        if !self.scene.lights().is_dark() && !vertex.here.scattering().is_delta() {
            for number in 0..asked {
                self.ask_a_light(&vertex, (number, asked), splits, sampler);
            }
        }
        if N::BAGGAGE && matches!(self.settings.follow, Follow::EachSingle | Follow::Nothing) {
            return;
        }
        for branch in 0..splits {
            // The first goes on as the path that it comes from.
            let branch = if branch == 0 { vertex.baggage.branch } else { branch };
            let dimensions = if N::BAGGAGE { Dimensions::of(vertex.path.bounce, branch) } else { vertex.dimensions };
            let u = sampler.two(dimensions.direction());
            let mut choice = || sampler.one(dimensions.scattering_choice());
            let drawn = match &vertex.aim {
                None => vertex.here.sample(choice, u).map(|next| (next, 1.0)),
                Some(aim) => draw(&vertex.here, aim, choice(), u),
            };
            let Some((next, denser)) = drawn else { continue };
            if self.is_followed(next.pdf) {
                self.send(&vertex, &next, denser, (branch, splits), |d| sampler.one(d));
            }
        }
    }

    /// Whether paths go on along a direction that is drawn with this density.
    #[inline]
    pub(super) fn is_followed(&self, pdf: f64) -> bool {
        if !N::BAGGAGE {
            return true;
        }
        match self.settings.follow {
            Follow::All => true,
            Follow::Sharper(than) => pdf > than,
            Follow::EachSingle => pdf == f64::INFINITY,
            Follow::Nothing => false,
        }
    }

    /// Follows every single direction that a surface scatters into.
    fn split_singles(&mut self, vertex: &Vertex<'_, crate::scene::materials::Scattering>) {
        let mut branch = vertex.baggage.branch.wrapping_mul(2);
        singles(vertex.here.scattering(), vertex.here.wo(), |single| {
            if let Some(next) = vertex.here.scattered(&single) {
                self.send(vertex, &next, 1.0, (branch, 1), |_| 0.0);
                branch = branch.wrapping_add(1);
            }
        });
    }

    /// Queues a path that goes on along a direction drawn, one of so many, unless roulette ends it.
    #[inline]
    fn send<S: Scatters>(
        &mut self,
        vertex: &Vertex<'_, S>,
        next: &Scattered,
        denser: f64,
        (branch, splits): (u32, u32),
        mut number: impl FnMut(u32) -> f64,
    ) {
        let mut path = *vertex.path;
        path.throughput *= next.weight;
        path.pdf = next.pdf;
        path.aim(denser);
        if N::BAGGAGE && splits > 1 {
            path.throughput /= f64::from(splits);
            path.pdf *= f64::from(splits);
        }
        path.normal = vertex.here.receiver().normal;
        path.scale *= next.eta * next.eta;
        path.each = self.asks_each(&vertex.here);
        path.bounce = path.bounce.saturating_add(1);
        if N::BAGGAGE && path.throughput.max_element() * path.scale < self.settings.least {
            return;
        }
        // The density with which a path comes to its second point must be known.
        let is_played = (!N::SHARES || path.bounce > 1) && vertex.arrival == Arrival::GoesOn;
        if is_played && path.bounce >= self.settings.roulette_depth.min(ROULETTE_AT_LATEST) {
            let dimensions = if N::BAGGAGE { Dimensions::of(vertex.path.bounce, branch) } else { vertex.dimensions };
            let survival = survival(path.throughput, path.importance());
            if number(dimensions.roulette()) >= survival {
                return;
            }
            path.throughput /= survival;
        }
        let ray = Departure::new(vertex.here.surface()).ray(next.direction);
        self.next.rays.push(Ray { time: vertex.time, ..ray });
        self.next.alive.push(path);
        if N::BAGGAGE {
            self.next.baggage.push(Baggage {
                footprint: if self.widths { widened(vertex, next) } else { vertex.baggage.footprint },
                inside: if next.is_through { *vertex.through } else { vertex.baggage.inside },
                chance: -1.0,
                branch,
            });
        }
    }
}

/// The bundle of rays after a surface.
///
/// A mirror of mean curvature H, seen by a bundle of width w, spreads it by 2Hw (Akenine-Möller et al., "Improved
/// Shader and Texture Level of Detail Using Ray Cones", 2021), and refraction by as much as it bends; a direction drawn
/// with density p has its neighbours, if some 256 are drawn for a pixel, about 1/√(256 p) away (after Suykens and
/// Willems, "Path Differentials and Applications", 2001).
fn widened<S: Scatters>(vertex: &Vertex<'_, S>, next: &Scattered) -> Footprint {
    let (before, curvature) = (vertex.baggage.footprint, vertex.here.curvature());
    let bent = if next.is_through {
        before.spread / next.eta + curvature * vertex.width * (1.0 / next.eta - 1.0)
    } else {
        before.spread + 2.0 * curvature * vertex.width
    };
    let scattered = 1.0 / (16.0 * next.pdf.sqrt());
    Footprint { width: vertex.width, spread: if scattered > 0.0 { bent.abs().max(scattered) } else { bent } }
}

impl<N: Features> TransportWorker<'_, N> {
    /// Follows the paths of these samples to their ends, and adds what they find.
    fn follow(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        self.start(samples);
        while !self.now.rays.is_empty() && !cancel.is_raised() {
            self.hits.resize(self.now.rays.len(), Hit::MISS);
            self.scene.intersect(&self.now.rays, &mut self.hits);
            self.shade(samples, radiance);
            if !self.settings.shadows {
                self.shadows.add_all(radiance);
            } else if self.masks || self.nested {
                self.shadows.add_through(self.scene, self.nested, radiance);
            } else {
                self.shadows.add_unblocked(self.scene, radiance);
            }
        }
    }
}

impl<N: Features> Worker for TransportWorker<'_, N> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        assert_eq!(samples.len(), radiance.len());
        if N::SHARES {
            return self.radiance_in_groups(samples, &vec![1; samples.len()], cancel, radiance);
        }
        radiance.fill(Rgb::ZERO);
        // Each sample is on its own, so that a batch of paths that split may be worked on in parts.
        let splits = self.settings.splits.max(self.settings.light_samples) as usize;
        let together = if N::BAGGAGE && self.settings.follow == Follow::EachSingle { 512 } else { 4096 };
        let part = if N::BAGGAGE { (together / splits).max(16) } else { samples.len().max(1) };
        for (samples, radiance) in samples.chunks_mut(part).zip(radiance.chunks_mut(part)) {
            self.follow(samples, cancel, radiance);
        }
    }

    fn radiance_in_groups(
        &mut self,
        samples: &mut [CameraSample],
        groups: &[u32],
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        if !N::SHARES {
            return self.radiance(samples, cancel, radiance);
        }
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        found.resize(2 * samples.len(), Rgb::ZERO);
        self.reuse.begin(samples.len());
        self.follow(samples, cancel, &mut found);
        let (own, shared) = found.split_at(samples.len());
        radiance.copy_from_slice(own);
        let chance = |sample: u32| samples[sample as usize].sampler.one(Dimensions::SHARING);
        self.reuse.share(self.scene, groups, shared, cancel, radiance, chance);
        self.found = found;
    }
}
