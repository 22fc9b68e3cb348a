//! Camera paths that are followed one by one, in f64: where f32 does not suffice, and for tests of the stages.
//!
//! Paths carry densities for three wavelengths. One of them, the hero, samples distances. All are weighted by the mean
//! of the three densities (Wilkie et al., "Hero Wavelength Spectral Sampling", 2014; Miller, Georgiev and Jarosz, "A
//! Null-Scattering Path Integral Formulation of Light Transport", 2019).

mod camera_paths;
mod direct_light;
mod equiangular;
mod final_gather;
mod path_state;

use super::known_light::KnownLight;
use super::media::equiangular::PointLights;
use super::path_settings::PathSettings;
use super::{Job, Session, Worker};
use camera_paths::Walker;
use raywright_scene::{Footprint, Scene};
use std::sync::Arc;

/// Paths of a picture that are followed one by one, in f64.
pub(super) struct OneByOne<'a> {
    settings: PathSettings,
    scene: &'a Scene,
    /// Footprint of camera rays.
    footprint: Footprint,
    /// Point lights.
    points: PointLights<'a>,
    /// Known light at scattering events.
    known: Option<Arc<dyn KnownLight + 'a>>,
}

impl<'a> OneByOne<'a> {
    /// Make the session of a picture, with known light at scattering events or without.
    pub fn new(job: Job<'a>, settings: PathSettings, known: Option<Arc<dyn KnownLight + 'a>>) -> Self {
        let points = PointLights::of(job.scene);
        Self { settings, scene: job.scene, footprint: job.footprint, points, known }
    }
}

impl Session for OneByOne<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        let footprint = self.scene.plan().needs().points.width.then_some(self.footprint);
        Box::new(Walker {
            settings: self.settings,
            scene: self.scene,
            footprint,
            points: &self.points,
            known: self.known.as_deref(),
        })
    }
}
