//! Sessions of integrators that follow paths from the camera.

use super::known_light::KnownLight;
use super::one_by_one::OneByOne;
use super::path_settings::PathSettings;
use super::wavefront::Wavefront;
use super::{Job, Session};
use raywright_base::workers::Cancel;
use std::sync::Arc;

/// Begins with stages over columns in f32, or one path at a time in f64 where f32 does not suffice.
pub(super) fn begin<'a>(settings: PathSettings, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
    if !Wavefront::takes(&job) {
        return Box::new(OneByOne::new(job, settings, None));
    }
    let guide = settings.guiding.guide(job.scene, job.camera, cancel);
    Box::new(Wavefront::new(job, settings, guide, None))
}

/// The same, where some light is known.
pub(super) fn begin_with<'a>(
    settings: PathSettings,
    job: Job<'a>,
    known: Arc<dyn KnownLight + 'a>,
) -> Box<dyn Session + 'a> {
    if Wavefront::takes(&job) {
        Box::new(Wavefront::new(job, settings, None, Some(known)))
    } else {
        Box::new(OneByOne::new(job, settings, Some(known)))
    }
}
