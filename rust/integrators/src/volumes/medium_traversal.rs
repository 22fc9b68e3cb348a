//! Medium traversal between scattering events.

use crate::media::current_medium::{self, Filled};
use crate::media::distance_sampling::{Collision, MediumSegment};
use crate::media::hit_classification::{ClassifiedHit, meet, straight};
use crate::media::path_numbers::PathNumbers;
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
pub(crate) struct MediumTraversal<'a> {
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
pub(crate) struct RaySegmentState {
    pub ray: Ray,
    pub weights: Weights,
    pub media: MediumStack<Filled>,
}

/// The end of a traversal.
pub(crate) enum TraversalEnd {
    /// A scattering event, and the span of the ray in its medium.
    Medium { here: Scattering, collision: Collision, span: [f64; 2] },
    /// A surface.
    Surface { hit: Hit, outside: f64, through: MediumStack<Filled> },
    /// Outside the scene.
    Outside,
}

/// Returns the light that reaches a path along a span of its ray in a homogeneous scattering medium.
pub(super) type OnTheWay<'o> =
    &'o dyn Fn(&RaySegmentState, [f64; 2], (&Coefficients, Phase), &mut PathNumbers<'_>) -> Rgb;

impl<'a> MediumTraversal<'a> {
    /// Make the traversal of paths that media scatter.
    pub fn alone(scene: &'a Scene, waves: Option<Waves>) -> Self {
        Self { scene, scatters: true, roulette: false, waves }
    }

    /// Advance a path along its ray to the next scattering event; `None` if its weight is zero. `way` is the optical
    /// depth of its hero before the event, sampled once for all media along the ray. Emission along the way is added to
    /// `light`.
    pub fn advance(
        &self,
        path: &mut RaySegmentState,
        (hero, mut way): (usize, f64),
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
        light: &mut Rgb,
        on_the_way: Option<OnTheWay<'_>>,
    ) -> Option<TraversalEnd> {
        let mut start = path.ray.t_min;
        while !cancel.is_raised() {
            let around = current_medium::around(self.scene, &path.media, &path.ray);
            let scattering = around.as_ref().filter(|(medium, _)| self.scatters && medium.is_even());
            let Self { scatters, roulette, waves, .. } = *self;
            let even = scattering.map(|(medium, within)| {
                let here = medium.at(within.origin);
                waves.as_ref().map_or(here, |waves| medium.by_waves(here, waves))
            });
            let even = even.filter(|here| !here.scattering.is_black());
            let mut asked = path.ray;
            if let Some(here) = even.filter(|here| here.emission.is_black() && on_the_way.is_none()) {
                // Intersections beyond the scattering event are not needed.
                let reach = start + way / here.extinction[hero] * (1.0 + 1e-12);
                asked.t_max = reach.next_up().min(asked.t_max);
            }
            let hit = self.scene.intersect_one(&asked);
            let end = if hit.is_hit() { hit.t } else { f64::INFINITY };
            if let Some((medium, within)) = around {
                let span = [start, end];
                if let (Some(here), Some(lit)) = (even, on_the_way) {
                    *light += lit(path, span, (&here, medium.phase()), numbers);
                }
                let flight = MediumSegment { medium, ray: within, span, length: 1.0, scatters, roulette, waves };
                let weights = &mut path.weights;
                if let Some(collision) = flight.fly(weights, (hero, &mut way), &mut numbers.more, cancel, light) {
                    let (position, before) = (path.ray.at(collision.t), path.ray.direction);
                    let here = Scattering { position, before, phase: medium.phase() };
                    return Some(TraversalEnd::Medium { here, collision, span });
                }
                if path.weights.carried.is_black() {
                    return None;
                }
            }
            if !hit.is_hit() {
                return Some(TraversalEnd::Outside);
            }
            start = hit.t;
            match self.meet(&path.ray, &hit, &path.media) {
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
                        return Some(TraversalEnd::Surface { hit, outside, through });
                    }
                }
            }
        }
        None
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
                flight.fade(weights, hero, &mut numbers.more, cancel);
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

    /// Return the transmitted share of some light along a ray that starts in given media, unbiased in heterogeneous
    /// media. The light may have been sampled by another wavelength. The mean of the product is the product of the
    /// means only for independent choices.
    pub fn through(
        &self,
        light: Rgb,
        ray: Ray,
        media: MediumStack<Filled>,
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
    ) -> Rgb {
        let mut weights = Weights { carried: light, ..Weights::START };
        self.shadow(ray, media, &mut weights, &mut None, numbers, cancel);
        weights.carried / weights.asked.mean()
    }
}
