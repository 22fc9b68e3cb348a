//! MIS partials of camera subpaths.

use crate::light_paths::Partial;
use crate::path_vertices::{Onward, Vertex};
use raywright_base::math::DVec3;
use raywright_scene::LightSampleContext;

/// MIS state of a camera subpath at its last vertex.
#[derive(Clone, Copy)]
pub(super) struct CameraEnd {
    pub partial: Partial,
    /// Merging disk as in [`Partial::merging`]; 0 without merging.
    pub disk: f64,
    /// Context of light sampling there, for lights that the next ray hits.
    pub receiver: LightSampleContext,
}

impl CameraEnd {
    /// Start at the camera.
    pub fn new(origin: DVec3, disk: f64) -> Self {
        Self { partial: Partial::of_camera(1.0, 0.0), disk, receiver: LightSampleContext::free(origin) }
    }

    /// Arrive at a vertex after the first, or at the first one with the density of camera rays there.
    pub fn arrive(&mut self, at: &Vertex, first: Option<(f64, f64)>) {
        let cosine = at.cosine(at.back());
        self.partial = match first {
            Some((paths, density)) => Partial::of_camera(paths, density * cosine),
            None => self.partial.arrived(at.t, cosine),
        };
        if self.disk > 0.0 && at.matte().is_some() {
            self.partial = self.partial.merging(self.disk);
        }
    }

    /// Leave a vertex.
    pub fn go_on(&mut self, at: &Vertex, next: &Onward) {
        let cosine = at.cosine(next.direction);
        self.partial = if next.is_single {
            self.partial.scattered_singly(cosine)
        } else {
            let forward = if at.is_wide() { at.evaluate(next.direction).1 } else { next.pdf };
            self.partial.scattered(cosine, forward, at.light_back_pdf(next.direction))
        };
        let position = at.origin().ray(next.direction).origin;
        self.receiver = LightSampleContext { position, ..at.receiver() };
    }
}
