//! Medium traversal between scattering events.

use super::path_numbers::PathNumbers;
use crate::media::current_medium::{self, Filled};
use crate::media::distance_sampling::{Collision, MediumSegment};
use crate::media::hit_classification::{ClassifiedHit, meet, straight};
use crate::media::scattering::Scattering;
use crate::media::spectral_mis::Weights;
use crate::nesting::MediumStack;
use crate::shadows::opacity;
use raywright_base::math::{Hit, Ray};
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Phase, Rgb};
use raywright_scene::Scene;
use raywright_scene::media::Coefficients;

/// Constant parameters of a traversal.
#[derive(Clone, Copy)]
pub(super) struct MediumTraversal<'a> {
    pub scene: &'a Scene,
    /// False if media only attenuate.
    pub scatters: bool,
    /// True if roulette terminates faint light on straight segments in any medium. This requires an end of the segment
    /// that was sampled in a medium.
    pub roulette: bool,
    /// Wavelengths of the light; `None` for RGB.
    pub waves: Option<Waves>,
}

/// The state of a traversal: ray, path weights and media.
#[derive(Clone, Copy)]
pub(super) struct RaySegmentState {
    pub ray: Ray,
    pub weights: Weights,
    pub media: MediumStack<Filled>,
}

/// The end of a traversal.
pub(super) enum TraversalEnd {
    /// A scattering event, and the span of the ray in its medium.
    Medium { here: Scattering, collision: Collision, span: [f64; 2] },
    /// A surface.
    Surface { hit: Hit, outside: f64, through: MediumStack<Filled> },
    /// Outside the scene.
    Outside,
}

/// A path's way to its next scattering event in a medium.
#[derive(Clone, Copy)]
struct LeftDepth {
    /// The wavelength that samples distances.
    hero: usize,
    /// Its optical depth that is left.
    way: f64,
    /// `t` at the start of the current medium.
    start: f64,
}

/// The result of a step.
enum SegmentEnd {
    /// The path goes on along its ray.
    Passes,
    /// Its weight is zero.
    Absorbed,
    /// It has come to the end of its ray.
    Ends(TraversalEnd),
}

/// Returns the light that reaches a path along a span of its ray in a homogeneous scattering medium.
pub(super) type OnTheWay<'o> =
    &'o dyn Fn(&RaySegmentState, [f64; 2], (&Coefficients, Phase), &mut PathNumbers<'_>) -> Rgb;

impl<'a> MediumTraversal<'a> {
    /// Advance a path along its ray to the next scattering event; `None` if its weight is zero. `way` is the optical
    /// depth of its hero before the event, sampled once for all media along the ray. Emission along the way is added to
    /// `light`.
    pub fn advance(
        &self,
        path: &mut RaySegmentState,
        (hero, way): (usize, f64),
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
        light: &mut Rgb,
        on_the_way: Option<OnTheWay<'_>>,
    ) -> Option<TraversalEnd> {
        let mut left = LeftDepth { hero, way, start: path.ray.t_min };
        while !cancel.is_raised() {
            let hit = self.scene.intersect_one(&self.next_ray(path, &left, on_the_way.is_some()));
            match self.step(path, &mut left, &hit, numbers, cancel, light, on_the_way) {
                SegmentEnd::Passes => {}
                SegmentEnd::Absorbed => return None,
                SegmentEnd::Ends(end) => return Some(end),
            }
        }
        None
    }

    /// Return the ray to the first hit that a path needs to know of: not beyond its scattering event in a homogeneous
    /// medium.
    fn next_ray(&self, path: &RaySegmentState, left: &LeftDepth, is_lit: bool) -> Ray {
        let mut ray = path.ray;
        if let Some(here) = self.even(path).filter(|here| here.emission.is_black() && !is_lit) {
            let reach = left.start + left.way / here.extinction[left.hero] * (1.0 + 1e-12);
            ray.t_max = reach.next_up().min(ray.t_max);
        }
        ray
    }

    /// Return the coefficients of a homogeneous medium that scatters at the path's wavelengths, if it is in one.
    fn even(&self, path: &RaySegmentState) -> Option<Coefficients> {
        if !self.scatters {
            return None;
        }
        let (medium, within) = current_medium::around(self.scene, &path.media, &path.ray)?;
        let here = medium.is_even().then(|| medium.at(within.origin))?;
        let here = self.waves.as_ref().map_or(here, |waves| medium.by_waves(here, waves));
        Some(here).filter(|here| !here.scattering.is_black())
    }

    /// Take a path along its ray to its first hit, and through that if it is no surface for the path.
    #[allow(clippy::too_many_arguments)]
    fn step(
        &self,
        path: &mut RaySegmentState,
        left: &mut LeftDepth,
        hit: &Hit,
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
        light: &mut Rgb,
        on_the_way: Option<OnTheWay<'_>>,
    ) -> SegmentEnd {
        if let Some((medium, within)) = current_medium::around(self.scene, &path.media, &path.ray) {
            let span = [left.start, if hit.is_hit() { hit.t } else { f64::INFINITY }];
            if let (Some(lit), Some(here)) = (on_the_way, self.even(path)) {
                *light += lit(path, span, (&here, medium.phase()), numbers);
            }
            let Self { scatters, roulette, waves, .. } = *self;
            let flight = MediumSegment { medium, ray: within, span, length: 1.0, scatters, roulette, waves };
            let of_hero = (left.hero, &mut left.way);
            if let Some(collision) = flight.fly(&mut path.weights, of_hero, numbers.more, cancel, light) {
                let (position, before) = (path.ray.at(collision.t), path.ray.direction);
                let here = Scattering { position, before, phase: medium.phase() };
                return SegmentEnd::Ends(TraversalEnd::Medium { here, collision, span });
            }
            if path.weights.carried.is_black() {
                return SegmentEnd::Absorbed;
            }
        }
        if !hit.is_hit() {
            return SegmentEnd::Ends(TraversalEnd::Outside);
        }
        left.start = hit.t;
        match self.meet(&path.ray, hit, &path.media) {
            ClassifiedHit::Passed(beyond, media) => {
                (path.ray.t_min, path.media) = (beyond, media);
                path.ray.misses[0] = hit.primitive;
            }
            ClassifiedHit::Surface { hit, outside, through, beyond } => {
                let opacity = opacity(self.scene, &path.ray, &hit);
                let straight = straight(self.scene, &path.ray, &hit, outside);
                path.ray.misses[0] = hit.primitive;
                if opacity < 1.0 && numbers.more.next() >= opacity {
                    path.ray.t_min = hit.t.next_up();
                } else if straight > 0.0 && numbers.more.next() < straight {
                    (path.ray.t_min, path.media) = (beyond, through);
                } else {
                    return SegmentEnd::Ends(TraversalEnd::Surface { hit, outside, through });
                }
            }
        }
        SegmentEnd::Passes
    }

    /// Attenuate light along a ray that starts in given media, by everything on it. The wavelength that samples by
    /// chance is drawn when needed, unless given.
    #[allow(clippy::too_many_arguments)]
    pub fn shadow(
        &self,
        mut ray: Ray,
        mut media: MediumStack<Filled>,
        weights: &mut Weights,
        hero: &mut Option<usize>,
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
    ) {
        let length = ray.direction.length();
        let mut start = ray.t_min;
        while !cancel.is_raised() {
            let hit = self.scene.intersect_one(&ray);
            let met = hit.is_hit().then(|| self.meet(&ray, &hit, &media));
            let (mut left, mut pane) = (1.0, 0.0);
            if let Some(ClassifiedHit::Surface { hit, outside, .. }) = &met {
                pane = straight(self.scene, &ray, hit, *outside);
                left -= opacity(self.scene, &ray, hit) * (1.0 - pane);
                if left <= 0.0 {
                    weights.carried = Rgb::ZERO;
                    return;
                }
            }
            let end = if hit.is_hit() { hit.t } else { ray.t_max };
            if let Some((medium, within)) = current_medium::around(self.scene, &media, &ray) {
                let span = [start, end];
                let Self { scatters, roulette, waves, .. } = *self;
                let flight = MediumSegment { medium, ray: within, span, length, scatters, roulette, waves };
                flight.fade(weights, hero, numbers.more, cancel);
            }
            weights.carried *= left;
            if weights.carried.is_black() {
                return;
            }
            (start, ray.misses[0]) = (end, hit.primitive);
            match met {
                None => return,
                Some(ClassifiedHit::Passed(beyond, now)) => (ray.t_min, media) = (beyond, now),
                Some(ClassifiedHit::Surface { through, beyond, .. }) if pane > 0.0 => {
                    (ray.t_min, media) = (beyond, through)
                }
                Some(ClassifiedHit::Surface { hit, .. }) => ray.t_min = hit.t.next_up(),
            }
            if ray.t_min > ray.t_max {
                // The rest of the segment is within rounding.
                return;
            }
        }
        weights.carried = Rgb::ZERO;
    }

    /// Classify a hit. Without media or nested dielectrics, each is a surface in empty space.
    fn meet(&self, ray: &Ray, hit: &Hit, media: &MediumStack<Filled>) -> ClassifiedHit {
        let needs = self.scene.plan().needs();
        if needs.media || needs.nested {
            return meet(self.scene, ray, hit, media);
        }
        ClassifiedHit::Surface { hit: *hit, outside: 1.0, through: *media, beyond: hit.t.next_up() }
    }
}
