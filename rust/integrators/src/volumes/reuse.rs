//! Paths that share what they find in an even medium.

use super::filled::Filled;
use super::pairs::{Takers, Way};
use super::path_state::PathState;
use super::scattering::Scattering;
use crate::nesting::Filling;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::workers::Cancel;
use raywright_optics::{Bsdf, Phase, Rgb};
use raywright_scene::lights::Place;
use raywright_scene::media::Coefficients;
use raywright_scene::{Encounter, RayOrigin, Scene, SurfaceInteraction};
use std::f64::consts::FRAC_1_PI;

/// Whether paths can share what they find among media: some medium is even and scatters, and whatever is seen of it is
/// seen at any time. Light of points is drawn where it comes to a path on its way, which each has to itself.
pub(crate) fn can_share(scene: &Scene) -> bool {
    let needs = scene.plan().needs();
    let is_point = |place| matches!(place, Some(Place::Point(_)));
    needs.even_media
        && !needs.motion
        && !needs.waves
        && (needs.glow || !scene.lights().is_dark())
        && !scene.lights().others().any(|light| is_point(light.place()))
}

/// What a path leaves to be shared: from where an even medium scattered it first, and from where it came next, through
/// nothing but that medium, or out of it to a matt surface (after Bekaert, Sbert and Halton, "Accelerating Path Tracing
/// by Re-Using Paths", 2002).
///
/// Path j of a group goes from a first point xⱼ to a second, yⱼ. If that is in the medium, light from two directions
/// is known there: that of a light that was asked for, and one that was drawn and the rest of the path followed. It is
/// worth the same to all first points that see yⱼ, with nothing between but the medium. So each takes its part of it,
/// as one more sample, weighed by the balance heuristic (Veach and Guibas, 1995) over the densities with which the
/// paths of the group would have drawn the same: pₖ = f(xₖ → yⱼ) σ e^(−σs) / d², of phase function f, extinction σ and
/// a way of d of which s lies in the medium; for the direction that was drawn at yⱼ, times f(xₖ → yⱼ → ω). If yⱼ is
/// matt, what it reflects is the same for all, and its cosine stands for σ. Of several colours e^(−σs) is the mean, by
/// how likely each is to have drawn what came before.
#[derive(Clone, Copy, Default)]
pub(super) struct Parts {
    pub first: Option<First>,
    pub second: Option<Second>,
}

/// A first point, which takes.
#[derive(Clone, Copy)]
pub(super) struct First {
    position: DVec3,
    before: DVec3,
    phase: Phase,
    here: Coefficients,
    /// What the path brings there, scattered.
    brought: Rgb,
    /// How likely each colour is to have drawn it.
    drawn: Rgb,
    /// What stands for the shape that the medium fills; and how often the path was scattered before, where that limits
    /// what is found.
    among: ((u32, u32), u32),
    /// Whether beyond that shape space is clear.
    pub is_alone: bool,
}

/// A second point, which gives.
#[derive(Clone, Copy)]
pub(super) struct Second {
    departure: RayOrigin,
    /// Of a surface its normal on the side that is seen; none in the medium.
    normal: Option<DVec3>,
    /// How much of the way there is in the medium, and whether any is not.
    inside: f64,
    is_beyond: bool,
    /// To the light that was asked for, and what arrives from there; and the way on.
    to_light: DVec3,
    lit: Rgb,
    onward: DVec3,
    /// What the path found there; of a surface, what it reflects.
    pub found: Rgb,
}

impl First {
    /// How much more goes straight on than by even scattering, at most, where paths share: those of a group seldom go
    /// where another looks, and then bring all the more (at a mean cosine of 0.95, 120 times the error, and too little
    /// of it is told).
    const NARROWEST: f64 = 256.0;

    /// Whether what is found from there is worth sharing.
    pub fn may_be(here: &Scattering) -> bool {
        here.phase.greatest() <= Self::NARROWEST * 0.25 * FRAC_1_PI
    }

    /// Where a path is scattered, with what the medium does there, and whether there is a last bounce.
    pub fn new(here: &Scattering, of: Coefficients, path: &PathState, is_limited: bool) -> Self {
        let weights = &path.weights;
        Self {
            position: here.position,
            before: here.before,
            phase: here.phase,
            here: of,
            brought: weights.throughput(),
            drawn: weights.drawn / (3.0 * weights.drawn.mean()),
            among: (Filled::there(&path.media), if is_limited { path.bounce } else { 0 }),
            is_alone: path.media.depth() == 1,
        }
    }
}

impl Second {
    /// A point of the medium, and what arrives from a light, and the way on.
    pub fn of_medium(position: DVec3, (to_light, lit): (DVec3, Rgb), onward: DVec3) -> Self {
        let (normal, inside, is_beyond) = (None, 1.0, false);
        let departure = RayOrigin::free(position);
        Self { departure, normal, inside, is_beyond, to_light, lit, onward, found: Rgb::ZERO }
    }

    /// A surface to which a path has come by a `t` of its ray, if that reflects the same to all.
    pub fn of_surface<B: Bsdf>(here: &SurfaceInteraction<B>, path: &PathState, t: f64) -> Option<Self> {
        let is_matt = here.bsdf().diffuse().is_some() && here.is_flat() && !here.is_bent() && here.cosine() > 0.0;
        let is_beyond = path.passed > 0;
        let second = Self {
            departure: here.ray_origin(),
            normal: Some(here.normal()),
            inside: if is_beyond { path.ray.t_min / t } else { 1.0 },
            is_beyond,
            to_light: DVec3::X,
            lit: Rgb::ZERO,
            onward: DVec3::X,
            found: Rgb::ZERO,
        };
        is_matt.then_some(second)
    }

    /// Whether what it gives is worth nothing.
    fn is_black(&self) -> bool {
        self.lit.is_black() && self.found.is_black()
    }

    /// How much of the way from there to a first point lies in its medium, if it sees it, by what else does.
    fn seen(&self, scene: &Scene, first: &First, hits: &[Hit]) -> f64 {
        match hits {
            [] if !self.is_beyond => 1.0,
            [hit] if self.is_beyond && first.is_alone => {
                let is_end = Filled::of(scene, hit).is_some_and(|filled| filled.shape() == first.among.0);
                if is_end { 1.0 - hit.t } else { 0.0 }
            }
            _ => 0.0,
        }
    }
}

/// Who shares: room for one group at a time.
#[derive(Default)]
pub(super) struct Reuse {
    takers: Takers,
    /// The samples that take, and those that give.
    taking: Vec<usize>,
    giving: Vec<usize>,
    rays: Vec<Ray>,
    occluded: Vec<bool>,
    /// Of the way from each that gives to each that takes, how much is in the medium; 0 where nothing is seen.
    seen: Vec<f64>,
}

impl Reuse {
    /// Rays that the accelerator takes through its tree together, if they have one origin.
    const BUNDLE: usize = 16;

    /// Adds to the radiance of each sample what it takes of what all of its group have found.
    pub fn share(&mut self, scene: &Scene, groups: &[u32], parts: &[Parts], cancel: &Cancel, radiance: &mut [Rgb]) {
        let mut start = 0;
        for &count in groups {
            if cancel.is_raised() {
                return;
            }
            let (parts, radiance) = (&parts[start..][..count as usize], &mut radiance[start..][..count as usize]);
            start += count as usize;
            // One medium after the other, and one depth.
            let mut done = Vec::new();
            for first in parts.iter().filter(|parts| parts.second.is_some()).filter_map(|parts| parts.first) {
                if !done.contains(&first.among) {
                    done.push(first.among);
                    self.share_within(scene, &first, parts, radiance);
                }
            }
        }
    }

    /// The same in one medium, that of a path.
    fn share_within(&mut self, scene: &Scene, of: &First, parts: &[Parts], radiance: &mut [Rgb]) {
        let Self { takers, taking, giving, .. } = self;
        takers.clear();
        taking.clear();
        giving.clear();
        for (i, Parts { first, second }) in parts.iter().enumerate() {
            let Some(first) = first.filter(|first| first.among == of.among) else { continue };
            takers.push(first.position, first.before);
            taking.push(i);
            if second.is_some_and(|second| !second.is_black()) {
                giving.push(i);
            }
        }
        self.look(scene, parts);
        for number in 0..self.giving.len() {
            self.give(number, of, parts, radiance);
        }
    }

    /// Shares out what one gives.
    fn give(&mut self, number: usize, of: &First, parts: &[Parts], radiance: &mut [Rgb]) {
        let (giver, count) = (self.giving[number], self.taking.len());
        let Some(second) = parts[giver].second else { return };
        let seen = &mut self.seen[number * count..][..count];
        if let Some(own) = self.taking.iter().position(|&taker| taker == giver)
            && seen[own] == 0.0
        {
            // What its own path would not have seen, as where surfaces lie on each other, nobody else is to take.
            seen.fill(0.0);
            seen[own] = second.inside;
        }
        let seen = &*seen;
        let way = Way { to: second.departure.position(), onward: second.onward, to_light: second.to_light };
        self.takers.meet(&way, second.normal, seen, &of.phase, of.here.extinction);
        let (scattering, extinction) = match second.normal {
            None => (of.here.scattering, of.here.extinction),
            Some(_) => (Rgb::ONE, Rgb::ONE),
        };
        let firsts = || (0..count).filter(|&place| seen[place] > 0.0).map(|place| (place, self.taking[place]));
        let (mut lit, mut found) = (0.0, 0.0);
        for (place, taker) in firsts() {
            let (pair, Some(first)) = (self.takers.pair(place), &parts[taker].first) else { continue };
            let density = pair.share * (first.drawn * extinction * pair.left).sum();
            lit += density;
            found += density * pair.onward;
        }
        let over = |light: Rgb, sum: f64| if sum > 0.0 { light / sum } else { Rgb::ZERO };
        let (lit, found) = (over(second.lit, lit), over(second.found, found));
        for (place, taker) in firsts() {
            let (pair, Some(first)) = (self.takers.pair(place), &parts[taker].first) else { continue };
            let arrives = (lit * pair.to_light + found * pair.onward) * pair.share;
            radiance[taker] += first.brought * scattering * pair.left * arrives;
        }
    }

    /// Looks from all that give to all that take.
    fn look(&mut self, scene: &Scene, parts: &[Parts]) {
        self.seen.clear();
        for &giver in &self.giving {
            let Some(second) = parts[giver].second else { continue };
            let firsts = self.taking.iter().filter_map(|&taker| parts[taker].first);
            self.rays.clear();
            let to = |first: &First| second.departure.segment(&RayOrigin::free(first.position));
            self.rays.extend(firsts.clone().map(|first| to(&first)));
            let faces = |first: &First| {
                let way = first.position - second.departure.position();
                second.normal.is_none_or(|normal| normal.dot(way) > 0.0)
            };
            if second.is_beyond {
                let crossings = scene.crossings(&self.rays);
                let seen = firsts.enumerate().map(|(i, first)| {
                    if faces(&first) { second.seen(scene, &first, crossings.of_ray(i)) } else { 0.0 }
                });
                self.seen.extend(seen);
                continue;
            }
            // None of another origin goes with them.
            let last = self.rays[self.rays.len() - 1];
            self.rays.resize(self.rays.len().next_multiple_of(Self::BUNDLE), last);
            self.occluded.clear();
            self.occluded.resize(self.rays.len(), false);
            scene.occluded(&self.rays, &mut self.occluded);
            let blocked = self.occluded.iter();
            self.seen.extend(firsts.zip(blocked).map(|(first, &is)| if faces(&first) && !is { 1.0 } else { 0.0 }));
        }
    }
}
