//! Connections of camera paths to lights and to light vertices.

use super::PathStrategy;
use super::camera_paths::{EyePath, EyeVertex};
use super::light_vertices::LightVertex;
use super::worker::BidirectionalWorker;
use crate::light_paths::{of_asked, onward_pdf, weight};
use raywright_base::math::Ray;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Emitters, Interaction, LightSampleContext};

impl<'a> BidirectionalWorker<'a> {
    /// Sample one light, chosen and sampled by the given numbers.
    pub(super) fn ask(&mut self, emitters: &Emitters, at: &EyeVertex, path: &EyePath, (choice, u): (f64, [f64; 2])) {
        let here = at.here();
        let receiver = LightSampleContext { waves: at.arrived.waves, ..at.arrived.here.light_context() };
        let Some((light, departure, asked)) = emitters.sample_direct(&receiver, choice, u) else { return };
        let (scattered, pdf) = at.evaluate(light.direction);
        let arriving = path.throughput * scattered * light.weight;
        if arriving.is_black() {
            return;
        }
        let weight = match self.alone {
            Some(_) => self.full(1, path.bounce + 2),
            None => {
                let reverse = at.onward_pdf(light.direction);
                of_asked(&path.partial, (asked, &departure), pdf, at.arrived.cosine(light.direction), reverse)
            }
        };
        let from = here.ray_origin();
        let ray = match &light.source {
            Some(source) => from.segment(source),
            None => from.ray(light.direction),
        };
        self.send(at, path, at.leaving(ray, light.primitive), arriving * weight);
    }

    /// Connect to a light vertex.
    pub(super) fn connect(&mut self, emitters: &Emitters, at: &EyeVertex, path: &EyePath, light: &LightVertex<'a>) {
        let (here, there) = (at.here(), &light.arrived);
        let way = there.here.position() - here.position();
        let square = way.length_squared();
        let distance = square.sqrt();
        let direction = way / distance;
        let is_hidden = there.here.is_through(-direction) && !there.here.bsdf().transmits();
        if !direction.is_finite() || at.is_hidden_from(direction) || is_hidden {
            return;
        }
        let (scattered, pdf) = at.evaluate(direction);
        if scattered.is_black() {
            return;
        }
        let met = there.met_from(-direction, distance, 0.0);
        let sent = there.share(-direction, || met.evaluate(there.back()).0);
        let mut arriving = path.throughput * scattered * light.flux * sent / square;
        if path.has_gamut_excess {
            arriving *= light.again;
        }
        if path.single && light.single {
            arriving = Waves::joined(arriving);
        }
        if arriving.is_black() || !arriving.is_finite() {
            return;
        }
        let weight = match self.alone {
            Some(_) => self.full(light.bounce + 1, path.bounce + 2),
            None => {
                let onward = onward_pdf(&there.here, -direction);
                let one = light.end.others(emitters, there, &met, pdf * there.cosine(direction) / square);
                let reverse = at.onward_pdf(direction);
                weight(one, path.partial.others(onward * at.arrived.cosine(direction) / square, reverse))
            }
        };
        let segment = here.ray_origin().segment(&there.here.ray_origin());
        self.send(at, path, at.leaving(segment, there.hit.primitive), arriving * weight);
    }

    /// Return the weight of a strategy if only one is shown: 1 or 0.
    pub(super) fn full(&self, light: u32, camera: u32) -> f64 {
        let way = PathStrategy { vertices: [light, camera], merges: false };
        if self.alone == Some(way) { 1.0 } else { 0.0 }
    }

    /// Queue the shadow ray of a connection.
    fn send(&mut self, at: &EyeVertex, path: &EyePath, ray: Ray, arriving: Rgb) {
        if arriving.is_black() || !arriving.is_finite() {
            return;
        }
        self.shadows.push(&ray);
        self.shadows.bring(path.sample, arriving);
        if self.passing.is_nested() {
            self.shadows.start_in(at.media(ray.direction, path));
        }
    }
}
