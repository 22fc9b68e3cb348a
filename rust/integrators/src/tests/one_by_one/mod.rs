//! Camera paths that are followed one by one, in f64: an independent implementation to compare the stages with.
//!
//! Paths carry densities for three wavelengths. One of them, the hero, samples distances. All are weighted by the mean
//! of the three densities (Wilkie et al., "Hero Wavelength Spectral Sampling", 2014; Miller, Georgiev and Jarosz, "A
//! Null-Scattering Path Integral Formulation of Light Transport", 2019).

mod camera_paths;
mod direct_light;
mod equiangular;
mod medium_traversal;
mod path_numbers;
mod path_state;

use crate::media::equiangular::PointLights;
use crate::path_settings::PathSettings;
use crate::{Job, Session, Worker};
use camera_paths::Walker;
use raywright_scene::{Footprint, Scene};

/// Paths of a picture that are followed one by one, in f64.
pub(in crate::tests) struct OneByOne<'a> {
    settings: PathSettings,
    scene: &'a Scene,
    /// Footprint of camera rays.
    footprint: Footprint,
    /// Point lights.
    points: PointLights<'a>,
}

impl<'a> OneByOne<'a> {
    /// Make the session of a picture.
    pub fn new(job: Job<'a>, settings: PathSettings) -> Self {
        let points = PointLights::of(job.scene);
        Self { settings, scene: job.scene, footprint: job.footprint, points }
    }
}

impl Session for OneByOne<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        let footprint = self.scene.plan().needs().points.width.then_some(self.footprint);
        Box::new(Walker { settings: self.settings, scene: self.scene, footprint, points: &self.points })
    }
}
