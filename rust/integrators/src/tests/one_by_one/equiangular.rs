//! Equiangular sampling of point lights along rays.

use super::camera_paths::Walker;
use super::path_numbers::PathNumbers;
use super::path_state::PathState;
use crate::media::scattering::Scattering;
use crate::media::spectral_mis::Weights;
use crate::mis_weight::power_heuristic;
use raywright_base::workers::Cancel;
use raywright_optics::{Phase, Rgb};
use raywright_scene::media::Coefficients;
use raywright_scene::{Interaction, LightSampleContext};

impl Walker<'_> {
    /// Return the in-scattered light of point lights from a homogeneous medium between two `t` of a path's ray. MIS
    /// combines it with light sampling at the path's own scattering events.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn lit_on_the_way(
        &self,
        path: &PathState,
        span: [f64; 2],
        here: &Coefficients,
        phase: Phase,
        hero: usize,
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
    ) -> Rgb {
        let choice = numbers.ray.light_choice(1);
        let u = [numbers.one(choice), numbers.two(choice + 1)[0]];
        let Some((light, t, pdf)) = self.points.sample(&path.ray, span, u) else { return Rgb::ZERO };
        let left = here.left(t - span[0]);
        let point = Scattering { position: path.ray.at(t), before: path.ray.direction, phase };
        let Some(light) = light.sample(&LightSampleContext { waves: path.waves, ..point.light_context() }, [0.5; 2])
        else {
            return Rgb::ZERO;
        };
        let weights = Weights { carried: path.weights.carried * here.scattering * left / pdf, ..path.weights };
        let there = PathState { weights, ..*path };
        let arrives = self.arriving(&point, &there, &light, path.media, hero, numbers, cancel);
        let Some(arrives) = arrives else {
            return Rgb::ZERO;
        };
        let drawn = (path.weights.drawn * here.extinction * left).mean() / path.weights.drawn.mean();
        arrives * power_heuristic(pdf, drawn)
    }
}
