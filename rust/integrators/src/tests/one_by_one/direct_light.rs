//! Light sampling at scattering events.

use super::camera_paths::Walker;
use super::medium_traversal::MediumTraversal;
use super::path_numbers::PathNumbers;
use super::path_state::PathState;
use crate::media::current_medium::Filled;
use crate::media::spectral_mis::Weights;
use crate::mis_weight::power_heuristic;
use crate::nesting::MediumStack;
use crate::path_settings::stratum;
use raywright_base::math::Ray;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{Interaction, LightSample, LightSampleContext};

impl Walker<'_> {
    /// Sample a light at a vertex (next-event estimation) and return the light that arrives. `through` are the media of
    /// rays that leave to the other side, if any do. The sample is one of a number, stratified over the lights.
    pub(super) fn direct_light(
        &self,
        here: &impl Interaction,
        path: &PathState,
        media: impl FnOnce(&LightSample) -> MediumStack<Filled>,
        (hero, draw): (usize, (u32, u32)),
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
    ) -> Option<(LightSample, Rgb)> {
        let choice = numbers.ray.light_choice(draw.0);
        let (choice, u) = (stratum(numbers.one(choice), draw), numbers.two(choice + 1));
        let (lights, geometry) = (self.scene.lights(), self.scene.geometry());
        let receiver = LightSampleContext { waves: path.waves, ..here.light_context() };
        // MIS treats all samples as one with the density multiplied by their number.
        let light = lights.sample(geometry, &receiver, choice, u)?.chosen(f64::from(draw.1));
        let arrives = self.arriving(here, path, &light, media(&light), hero, numbers, cancel)?;
        Some((light, arrives))
    }

    /// Return the light of a sample that arrives at a vertex, weighted by MIS with BSDF or phase function sampling.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn arriving(
        &self,
        here: &impl Interaction,
        path: &PathState,
        light: &LightSample,
        media: MediumStack<Filled>,
        hero: usize,
        numbers: &mut PathNumbers<'_>,
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
        let ray = Ray { time: path.ray.time, misses: [path.leaves, light.primitive], ..ray };
        // Sampling a direction never hits a point light or a directional light.
        let is_followed = pdf >= self.settings.least_pdf();
        let by_chance = path.weights.drawn * if is_followed { path.splits * pdf / light.pdf } else { 0.0 };
        let mut weights = Weights { carried, drawn: by_chance, asked: path.weights.drawn };
        let course = MediumTraversal { roulette: here.light_context().is_free(), ..self.course(path.waves) };
        if self.settings.shadows {
            course.shadow(ray, media, &mut weights, &mut Some(hero), numbers, cancel);
        }
        let asked = weights.asked.mean();
        Some(weights.carried / asked * power_heuristic(asked, weights.drawn.mean()))
    }
}
