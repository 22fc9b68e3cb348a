//! Paths that share what they find in an even medium.

use super::asking::Asks;
use super::filled::Filled;
use super::numbers::Numbers;
use super::pairs::{Takers, Way};
use super::path_state::PathState;
use super::scattering::Scattering;
use super::walker::Walker;
use super::weights::Weights;
use crate::integrators::nesting::MediumStack;
use crate::math::{DVec3, Ray};
use crate::optics::{BsdfSample, Phase, Rgb};
use crate::scene::lights::Place;
use crate::scene::media::Coefficients;
use crate::scene::{Encounter, LightSampleContext, RayOrigin, Scene};
use crate::workers::Cancel;
use std::f64::consts::FRAC_1_PI;

/// Whether paths can share what they find among media: some medium is even and scatters, and whatever is seen of it is
/// seen at any time. Light of points is drawn where it comes to a path on its way, which each has to itself.
pub(in crate::integrators) fn can_share(scene: &Scene) -> bool {
    let needs = scene.plan().needs();
    let is_point = |place| matches!(place, Some(Place::Point(_)));
    needs.even_media
        && !needs.motion
        && !needs.waves
        && (needs.glow || !scene.lights().is_dark())
        && !scene.lights().others().any(|light| is_point(light.place()))
}

/// What a path leaves to be shared: from where it was scattered first, and from where second, with nothing but one even
/// medium between (after Bekaert, Sbert and Halton, "Accelerating Path Tracing by Re-Using Paths", 2002).
///
/// Path j of a group goes from a first point xⱼ to a second, yⱼ, where light from two directions is known: that of a
/// light that was asked for, and one that was drawn and the rest of the path followed. It is worth the same to all first
/// points from which nothing but the medium lies on the way to yⱼ. So each takes its part of it, as one more sample,
/// weighed by the balance heuristic (Veach and Guibas, 1995) over the densities with which the paths of the group
/// would have drawn the same: pₖ = f(xₖ → yⱼ) σ e^(−σd) / d², of phase function f and extinction σ; for the direction
/// that was drawn at yⱼ, times f(xₖ → yⱼ → ω). Of several colours σ e^(−σd) is the mean, by how likely each is to have
/// drawn what came before.
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
    /// What stands for the shape that the medium fills.
    shape: (u32, u32),
}

/// A second point, which gives.
#[derive(Clone, Copy)]
pub(super) struct Second {
    position: DVec3,
    /// To the light that was asked for, and what arrives from there; and the way on, and what the path found there.
    to_light: DVec3,
    lit: Rgb,
    onward: DVec3,
    pub found: Rgb,
}

/// A point of a medium that scatters the same into all directions: what arrives there is told, and not from where.
struct AllWays(Scattering);

impl AllWays {
    /// In whose place each phase function is weighed beside asking for light: one weight for all that take.
    const PDF: f64 = 0.25 * FRAC_1_PI;
}

impl Encounter for AllWays {
    fn position(&self) -> DVec3 {
        self.0.position()
    }

    fn ray_origin(&self) -> RayOrigin {
        self.0.ray_origin()
    }

    fn light_context(&self) -> LightSampleContext {
        self.0.light_context()
    }

    fn evaluate(&self, _direction: DVec3) -> (Rgb, f64) {
        (Rgb::ONE, Self::PDF)
    }

    fn sample(&self, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        self.0.sample(choice, u).map(|drawn| BsdfSample::new(drawn.wi, Rgb::ONE, Self::PDF))
    }
}

impl First {
    /// Where a path is scattered that is in some media.
    pub fn new(here: &Scattering, of: Coefficients, weights: &Weights, media: &MediumStack<Filled>) -> Self {
        Self {
            position: here.position,
            before: here.before,
            phase: here.phase,
            here: of,
            brought: weights.throughput(),
            drawn: weights.drawn / (3.0 * weights.drawn.mean()),
            shape: Filled::there(media),
        }
    }
}

impl<A: Asks> Walker<'_, A> {
    /// Scatters a path where what it finds is shared, and says whether it goes on.
    pub(super) async fn scatter_shared(
        &self,
        path: &mut PathState,
        here: &Scattering,
        hero: usize,
        numbers: &mut Numbers<'_>,
        cancel: &Cancel,
    ) -> Option<(Second, bool)> {
        if self.settings.max_depth.is_some_and(|most| path.bounce >= most) {
            return None;
        }
        // From here on it counts by itself; roulette knows what it has lost.
        path.scale *= path.weights.throughput().max();
        path.weights.carried = Rgb::splat(path.weights.drawn.mean());
        path.is_shared = true;
        let (here, media) = (AllWays(*here), path.media);
        let asked = self.direct_light(&here, path, |_| media, hero, numbers, cancel).await;
        let (to_light, lit) = asked.map_or((DVec3::X, Rgb::ZERO), |(light, arrives)| (light.direction, arrives));
        let u = numbers.ray.direction();
        let next = here.sample(|| 0.0, numbers.two(u))?;
        let chance = numbers.ray.roulette();
        let goes_on = self.go_on(path, &here, &next, media, numbers.one(chance), self.never_ends());
        Some((Second { position: here.position(), to_light, lit, onward: next.wi, found: Rgb::ZERO }, goes_on))
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
            // One medium after the other.
            let mut done = Vec::new();
            for first in parts.iter().filter(|parts| parts.second.is_some()).filter_map(|parts| parts.first) {
                if !done.contains(&first.shape) {
                    done.push(first.shape);
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
            let Some(first) = first.filter(|first| first.shape == of.shape) else { continue };
            takers.push(first.position, first.before);
            taking.push(i);
            if second.is_some_and(|second| !(second.lit.is_black() && second.found.is_black())) {
                giving.push(i);
            }
        }
        self.look(scene, parts);
        let (count, each) = (self.taking.len(), self.each());
        for (number, &j) in self.giving.iter().enumerate() {
            let Some(second) = &parts[j].second else { continue };
            let way = Way { to: second.position, onward: second.onward, to_light: second.to_light };
            self.takers.meet(&way, &of.phase, of.here.extinction);
            let seen = |place: usize| self.taking[place] == j || !self.occluded[number * each + place];
            let (mut lit, mut found) = (0.0, 0.0);
            for place in (0..count).filter(|&place| seen(place)) {
                let pair = self.takers.pair(place);
                let drawn = &parts[self.taking[place]].first.map_or(Rgb::ZERO, |first| first.drawn);
                let density = pair.share * (*drawn * of.here.extinction * pair.left).sum();
                lit += density;
                found += density * pair.onward;
            }
            let over = |light: Rgb, sum: f64| if sum > 0.0 { light / sum } else { Rgb::ZERO };
            let (lit, found) = (over(second.lit, lit), over(second.found, found));
            for place in (0..count).filter(|&place| seen(place)) {
                let (pair, i) = (self.takers.pair(place), self.taking[place]);
                let Some(first) = &parts[i].first else { continue };
                let arrives = (lit * pair.to_light + found * pair.onward) * pair.share;
                radiance[i] += first.brought * of.here.scattering * pair.left * arrives;
            }
        }
    }

    /// How many rays there are from each that gives.
    fn each(&self) -> usize {
        self.taking.len().next_multiple_of(Self::BUNDLE)
    }

    /// Looks from all that give to all that take.
    fn look(&mut self, scene: &Scene, parts: &[Parts]) {
        let each = self.each();
        self.rays.clear();
        for second in self.giving.iter().filter_map(|&j| parts[j].second) {
            let from = RayOrigin::free(second.position);
            let to = self.taking.iter().filter_map(|&i| parts[i].first);
            let before = self.rays.len();
            self.rays.extend(to.map(|first| from.segment(&RayOrigin::free(first.position))));
            // None of another origin goes with them.
            let last = self.rays[self.rays.len() - 1];
            self.rays.resize(before + each, last);
        }
        self.occluded.clear();
        self.occluded.resize(self.rays.len(), false);
        scene.occluded(&self.rays, &mut self.occluded);
    }
}
