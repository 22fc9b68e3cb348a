//! Light that is asked for where paths are scattered.

use super::filled::{self, Filled};
use super::flight::Flight;
use super::numbers::Numbers;
use super::path_state::PathState;
use super::surfaces::{Met, meet};
use super::walker::Walker;
use super::weights::Weights;
use crate::integrators::nesting::MediumStack;
use crate::integrators::shadows::opacity;
use crate::integrators::transport::power_heuristic;
use crate::math::{Hit, Ray};
use crate::optics::Rgb;
use crate::optics::spectra::Waves;
use crate::scene::{Encounter, LightSample, LightSampleContext};
use crate::workers::Cancel;

impl Walker<'_> {
    /// Next-event estimation: draws light where a path is, and tells what arrives of it. `through` is what rays start
    /// in that leave to the other side, if they do.
    pub(super) fn direct_light(
        &self,
        here: &impl Encounter,
        path: &PathState,
        media: impl FnOnce(&LightSample) -> MediumStack<Filled>,
        hero: usize,
        numbers: &mut Numbers,
        cancel: &Cancel,
    ) -> Option<(LightSample, Rgb)> {
        let choice = numbers.ray.light_choice(0);
        let (choice, u) = (numbers.one(choice), numbers.two(choice + 1));
        let (lights, geometry) = (self.scene.lights(), self.scene.geometry());
        let light =
            lights.sample(geometry, &LightSampleContext { waves: path.waves, ..here.light_context() }, choice, u)?;
        let arrives = self.arriving(here, path, &light, media(&light), hero, numbers, cancel)?;
        Some((light, arrives))
    }

    /// What arrives where a path is of light that was drawn, weighed beside running into it by chance.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn arriving(
        &self,
        here: &impl Encounter,
        path: &PathState,
        light: &LightSample,
        media: MediumStack<Filled>,
        hero: usize,
        numbers: &mut Numbers,
        cancel: &Cancel,
    ) -> Option<Rgb> {
        let (scattered, pdf) = here.evaluate(light.direction);
        let carried = path.weights.carried * scattered * light.weight;
        if carried.is_black() {
            return None;
        }
        let from = here.ray_origin();
        let ray = match &light.source {
            Some(source) => from.segment(source),
            None => from.ray(light.direction),
        };
        let ray = Ray { time: path.ray.time, misses: [Ray::NO_TRIANGLE, light.primitive], ..ray };
        // Running into a light that is a point or of a single direction never happens.
        let by_chance = path.weights.drawn * if self.follows_all() { pdf / light.pdf } else { 0.0 };
        let mut weights = Weights { carried, drawn: by_chance, asked: path.weights.drawn };
        self.shadow(ray, media, &mut weights, (hero, path.waves), numbers, cancel);
        let asked = weights.asked.mean();
        Some(weights.carried / asked * power_heuristic(asked, weights.drawn.mean()))
    }

    /// Dims light along a ray that starts in some media, by all that lies on it.
    fn shadow(
        &self,
        mut ray: Ray,
        mut media: MediumStack<Filled>,
        weights: &mut Weights,
        (hero, waves): (usize, Option<Waves>),
        numbers: &mut Numbers,
        cancel: &Cancel,
    ) {
        let length = ray.direction.length();
        let mut start = ray.t_min;
        while !cancel.is_raised() {
            let mut hits = [Hit::MISS];
            self.scene.intersect(&[ray], &mut hits);
            let [hit] = hits;
            let met = hit.is_hit().then(|| meet(self.scene, &ray, &hit, &media));
            let mut left = 1.0;
            if let Some(Met::Surface { hit, .. }) = &met {
                left -= opacity(self.scene, &ray, hit);
                if left <= 0.0 {
                    weights.carried = Rgb::ZERO;
                    return;
                }
            }
            let end = if hit.is_hit() { hit.t } else { ray.t_max };
            if let Some((medium, within)) = filled::around(self.scene, &media, &ray) {
                let span = [start, end];
                let flight = Flight { medium, ray: within, span, length, scatters: self.settings.scatters, waves };
                flight.fade(weights, hero, numbers, cancel);
            }
            weights.carried *= left;
            if weights.carried.is_black() {
                return;
            }
            start = end;
            match met {
                None => return,
                Some(Met::Passed(beyond, now)) => (ray.t_min, media) = (beyond, now),
                Some(Met::Surface { hit, .. }) => ray.t_min = hit.t.next_up(),
            }
            if ray.t_min > ray.t_max {
                // The rest of the way is shorter than rounding tells.
                return;
            }
        }
        weights.carried = Rgb::ZERO;
    }
}
