//! Light that is taken to arrive from everywhere in place of what is not followed.

use super::worker::TransportWorker;
use raywright_base::math::{Hit, Ray};
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{LookupContext, SurfaceInteraction};

impl TransportWorker<'_> {
    /// Adds what a surface sends back of it to a path of this throughput, that looks at it so, with such an index of
    /// refraction on the other side.
    #[inline]
    pub(super) fn add_ambient<B: Bsdf>(
        &self,
        here: &SurfaceInteraction<B>,
        (ray, hit): (&Ray, &Hit),
        (gaze, outside): (LookupContext, f64),
        throughput: Rgb,
        light: &mut Rgb,
    ) {
        if !self.settings.ambient.is_black() {
            *light += throughput * here.ambient(self.scene, ray, hit, gaze, outside) * self.settings.ambient;
        }
    }
}
