//! Light that paths run into.

use super::path_state::PathState;
use super::worker::TransportWorker;
use crate::mis_weight::power_heuristic;
use raywright_base::math::{Hit, Ray};
use raywright_optics::Rgb;
use raywright_scene::{LightSampleContext, LookupContext, SurfacePoint};

impl TransportWorker<'_> {
    /// What arrives from outside the scene at a ray that meets nothing.
    #[inline]
    pub(super) fn infinite_light(&self, ray: &Ray, path: &PathState) -> Rgb {
        let lights = self.scene.lights();
        let waves = self.waves(path.sample);
        let arriving = lights.infinite_radiance_at(ray.direction, waves.as_ref());
        if arriving.is_black() || path.pdf == f64::INFINITY {
            return arriving;
        }
        let receiver = LightSampleContext { position: ray.origin, normal: path.normal, waves };
        if path.each {
            let weight = |drawn: f64| power_heuristic(path.pdf, drawn * self.asked_from(path));
            return lights.outside_weighed(&receiver, ray.direction, weight);
        }
        let drawn = lights.infinite_pdf(&receiver, ray.direction);
        arriving * power_heuristic(path.pdf, drawn * self.asked_from(path))
    }

    /// Whether a point of a surface shines.
    #[inline]
    pub(super) fn shines(&self, surface: &SurfacePoint) -> bool {
        match surface.inner {
            Some(_) => !self.scene.emission_at(surface).is_dark(),
            _ => self.scene.lights().shines(surface.shape),
        }
    }

    /// What a surface sends back along a ray, by how its path looks at it.
    pub(super) fn emitted(
        &self,
        ray: &Ray,
        hit: &Hit,
        surface: &SurfacePoint,
        path: &PathState,
        gaze: LookupContext,
    ) -> Rgb {
        let cosine = -ray.direction.dot(surface.normal);
        let emission = self.scene.emission_at(surface).sent(self.scene.geometry(), ray, hit, surface, || gaze);
        if emission.is_black() || path.pdf == f64::INFINITY {
            return emission;
        }
        let receiver = LightSampleContext { position: ray.origin, normal: path.normal, waves: gaze.waves };
        let (lights, geometry) = (self.scene.lights(), self.scene.geometry());
        let drawn = if path.each {
            lights.own_pdf(geometry, &receiver, ray, hit, cosine)
        } else {
            lights.surface_pdf(geometry, &receiver, ray, hit, cosine)
        };
        emission * power_heuristic(path.pdf, drawn * self.asked_from(path))
    }

    /// How often light was asked where the path was scattered last.
    #[inline]
    fn asked_from(&self, path: &PathState) -> f64 {
        if path.bounce == 1 { f64::from(self.settings.light_samples) } else { 1.0 }
    }
}
