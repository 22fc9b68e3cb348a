//! Sessions of integrators that follow paths from the camera.

use super::path_settings::PathSettings;
use super::wavefront::{Wavefront, f32_holds};
use super::{Job, Session};
use raywright_base::workers::Cancel;

/// Begins with a picture.
pub(super) fn begin<'a>(settings: PathSettings, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
    let guide = if f32_holds(job.scene) { settings.guiding.guide(job.scene, job.camera, cancel) } else { None };
    Box::new(Wavefront::new(job, settings, guide, None))
}
