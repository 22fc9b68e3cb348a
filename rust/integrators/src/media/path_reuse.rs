//! Path reuse in homogeneous media.

use super::point_pairs::{Takers, TargetDirections};
use crate::media::current_medium::Filled;
use crate::nesting::{Filling, MediumStack};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::workers::Cancel;
use raywright_optics::{Phase, Rgb};
use raywright_scene::lights::Place;
use raywright_scene::media::Coefficients;
use raywright_scene::{RayOrigin, Scene};
use std::f64::consts::FRAC_1_PI;

/// Return whether paths can be reused: some medium is homogeneous and scatters, and nothing moves. Scenes with point
/// lights are excluded, as these are sampled along each path's own rays.
pub(crate) fn can_share(scene: &Scene) -> bool {
    let needs = scene.plan().needs();
    let is_point = |place| matches!(place, Some(Place::Point(_)));
    needs.even_media
        && !needs.motion
        && (needs.glow || !scene.lights().is_dark())
        && !scene.lights().others().any(|light| is_point(light.place()))
}

/// The shared vertices of a path: its first scattering event in a homogeneous medium, and the next vertex. The segment
/// between them lies in that medium alone, or leaves it for a matte surface (after Bekaert, Sbert and Halton,
/// "Accelerating Path Tracing by Re-Using Paths", 2002).
///
/// Path j of a group goes from a first vertex xⱼ to a second, yⱼ. If yⱼ is in the medium, its incident light is known
/// from two directions: a light sample, and the sampled continuation of the path. This light serves every first vertex
/// that sees yⱼ through the medium alone. So each first vertex uses it as one more sample. The balance heuristic (Veach
/// and Guibas, 1995) combines the densities of the group's paths: pₖ = f(xₖ → yⱼ) σ e^(−σs) / d², with the phase
/// function f, the extinction σ and a distance d of which the length s lies in the medium. For the sampled direction,
/// the density also has the factor f(xₖ → yⱼ → ω). If yⱼ is matte, its reflected radiance is the same in all
/// directions, and its cosine replaces σ. For several colors, e^(−σs) is the mean, weighted by each color's density of
/// sampling the path before.
#[derive(Clone, Copy, Default)]
pub(crate) struct SharedVertices {
    pub first: Option<FirstVertex>,
    pub second: Option<SecondVertex>,
}

/// A first vertex, which receives light.
#[derive(Clone, Copy)]
pub(crate) struct FirstVertex {
    position: DVec3,
    before: DVec3,
    phase: Phase,
    here: Coefficients,
    /// Path throughput including scattering there.
    brought: Rgb,
    /// Relative density with which each color sampled it.
    drawn: Rgb,
    /// Identifier of the medium's shape, and the number of earlier scattering events if that limits the contributions.
    among: ((u32, u32), u32),
    /// True if space is empty beyond that shape.
    pub is_alone: bool,
}

/// A second vertex, which provides light.
#[derive(Clone, Copy)]
pub(crate) struct SecondVertex {
    departure: RayOrigin,
    /// Surface normal on the visible side; `None` in the medium.
    normal: Option<DVec3>,
    /// Share of the segment in the medium; and true if the segment leaves it.
    inside: f64,
    is_beyond: bool,
    /// Direction of the light sample and its light; and the sampled direction.
    pub to_light: DVec3,
    pub lit: Rgb,
    pub onward: DVec3,
    /// Light found along the sampled direction; for a surface, its reflected radiance.
    pub found: Rgb,
}

impl FirstVertex {
    /// Maximum forward scattering relative to isotropic scattering with reuse. With a narrower phase function, the
    /// paths of a group rarely look into each other's directions, and such samples have high weights. At a mean cosine
    /// of 0.95 the error is 120 times larger, and underestimated.
    const NARROWEST: f64 = 256.0;

    /// Make a first vertex at a point where a medium of these coefficients scatters a path, which comes in a direction
    /// with a throughput, after so many bounces if their number is limited; `None` if reuse is not worthwhile there.
    pub fn new(
        (position, before): (DVec3, DVec3),
        (phase, here): (Phase, Coefficients),
        (throughput, drawn): (Rgb, Rgb),
        media: &MediumStack<Filled>,
        bounces: Option<u32>,
    ) -> Option<Self> {
        let is_alone = media.depth() == 1;
        let among = (Filled::there(media), bounces.unwrap_or(0));
        let vertex = Self { position, before, phase, here, brought: throughput, drawn: drawn / 3.0, among, is_alone };
        (phase.greatest() <= Self::NARROWEST * 0.25 * FRAC_1_PI).then_some(vertex)
    }
}

impl SecondVertex {
    /// Density of the sampled direction in the medium, in place of each phase function's: one weight for all
    /// receivers.
    pub const PDF: f64 = 0.25 * FRAC_1_PI;

    /// Make a second vertex in the medium.
    pub fn of_medium(position: DVec3) -> Self {
        let (departure, normal, inside, is_beyond) = (RayOrigin::free(position), None, 1.0, false);
        Self { departure, normal, inside, is_beyond, ..Self::AT_NOTHING }
    }

    /// Make a second vertex on a matte surface. The path came there in the medium for a share of its way.
    pub fn of_surface(departure: RayOrigin, normal: DVec3, inside: f64) -> Self {
        Self { departure, normal: Some(normal), inside, is_beyond: inside < 1.0, ..Self::AT_NOTHING }
    }

    const AT_NOTHING: Self = Self {
        departure: RayOrigin::free(DVec3::ZERO),
        normal: None,
        inside: 1.0,
        is_beyond: false,
        to_light: DVec3::X,
        lit: Rgb::ZERO,
        onward: DVec3::X,
        found: Rgb::ZERO,
    };

    /// Return whether it provides no light.
    fn is_black(&self) -> bool {
        self.lit.is_black() && self.found.is_black()
    }

    /// Return the share of the segment to a first vertex that lies in its medium, given all hits on it; 0 if occluded.
    fn seen(&self, scene: &Scene, first: &FirstVertex, hits: &[Hit]) -> f64 {
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

/// Path reuse, with storage for one group at a time.
#[derive(Default)]
pub(crate) struct Reuse {
    takers: Takers,
    /// Samples that receive and samples that provide light.
    taking: Vec<usize>,
    giving: Vec<usize>,
    rays: Vec<Ray>,
    occluded: Vec<bool>,
    /// For each pair of a provider and a receiver, the share of the segment in the medium; 0 if occluded.
    seen: Vec<f64>,
}

impl Reuse {
    /// Rays with a common origin that the accelerator traverses as one packet.
    const BUNDLE: usize = 16;

    /// Add to each sample's radiance its share of the group's results.
    pub fn share(
        &mut self,
        scene: &Scene,
        groups: &[u32],
        parts: &[SharedVertices],
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        let mut start = 0;
        for &count in groups {
            if cancel.is_raised() {
                return;
            }
            let (parts, radiance) = (&parts[start..][..count as usize], &mut radiance[start..][..count as usize]);
            start += count as usize;
            // For each medium, and each depth.
            let mut done = Vec::new();
            for first in parts.iter().filter(|parts| parts.second.is_some()).filter_map(|parts| parts.first) {
                if !done.contains(&first.among) {
                    done.push(first.among);
                    self.share_within(scene, &first, parts, radiance);
                }
            }
        }
    }

    /// Share within one medium, that of a path.
    fn share_within(&mut self, scene: &Scene, of: &FirstVertex, parts: &[SharedVertices], radiance: &mut [Rgb]) {
        let Self { takers, taking, giving, .. } = self;
        takers.clear();
        taking.clear();
        giving.clear();
        for (i, SharedVertices { first, second }) in parts.iter().enumerate() {
            let Some(first) = first.filter(|first| first.among == of.among) else { continue };
            takers.push(first.position, first.before);
            taking.push(i);
            if second.is_some_and(|second| !second.is_black()) {
                giving.push(i);
            }
        }
        self.look(scene, of, parts);
        for number in 0..self.giving.len() {
            self.give(number, of, parts, radiance);
        }
    }

    /// Distribute the light of one provider.
    fn give(&mut self, number: usize, of: &FirstVertex, parts: &[SharedVertices], radiance: &mut [Rgb]) {
        let (giver, count) = (self.giving[number], self.taking.len());
        let Some(second) = parts[giver].second else { return };
        let seen = &mut self.seen[number * count..][..count];
        if let Some(own) = self.taking.iter().position(|&taker| taker == giver)
            && seen[own] == 0.0
        {
            // If its own path would be occluded, as with coincident surfaces, no other path receives this light.
            seen.fill(0.0);
            seen[own] = second.inside;
        }
        let seen = &*seen;
        let way =
            TargetDirections { to: second.departure.position(), onward: second.onward, to_light: second.to_light };
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

    /// Test the visibility of all pairs in the medium of a path.
    fn look(&mut self, scene: &Scene, of: &FirstVertex, parts: &[SharedVertices]) {
        self.seen.clear();
        let (primitive, _) = of.among.0;
        let is_clear = primitive != Filled::NONE.shape().0
            && scene.plan().lone_shapes().is_empty(scene.geometry().locate(primitive).0);
        for &giver in &self.giving {
            let Some(second) = parts[giver].second else { continue };
            if is_clear && second.normal.is_none() {
                self.seen.extend(self.taking.iter().map(|_| 1.0));
                continue;
            }
            let firsts = self.taking.iter().filter_map(|&taker| parts[taker].first);
            self.rays.clear();
            let to = |first: &FirstVertex| second.departure.segment(&RayOrigin::free(first.position));
            self.rays.extend(firsts.clone().map(|first| to(&first)));
            let faces = |first: &FirstVertex| {
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
            // Pad so that the packet has a single origin.
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
