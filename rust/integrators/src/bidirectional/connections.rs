//! Connections of camera subpaths to lights and to light vertices.

use super::PathStrategy;
use super::camera_subpaths::CameraSubpaths;
use super::light_vertices::LightVertex;
use crate::light_paths::{of_asked, weight};
use crate::wavefront::{Arrival, Subpath, VertexContext};
use raywright_base::math::Ray;
use raywright_optics::spectra::Waves;
use raywright_scene::{Emitters, LightSampleContext};

impl<'a> CameraSubpaths<'a> {
    /// Sample one light.
    pub(super) fn ask(
        &self,
        emitters: &Emitters,
        arrival: &Arrival<'_, 'a>,
        path: &Subpath,
        context: &mut VertexContext<'_>,
    ) {
        let (at, choice) = (arrival.vertex(), context.dimensions.light_choice(0));
        let (choice, u) = (context.one(choice), context.two(choice + 1));
        let receiver = LightSampleContext { waves: path.waves, ..at.receiver() };
        let Some((light, departure, asked)) = emitters.sample_direct(&receiver, choice, u) else { return };
        let (scattered, pdf) = at.evaluate(light.direction);
        let arriving = path.beta * scattered * light.weight;
        if arriving.is_black() {
            return;
        }
        let weight = match self.alone {
            Some(_) => self.full(1, path.bounce + 2),
            None => {
                let reverse = at.light_back_pdf(light.direction);
                of_asked(&self.end(path).partial, (asked, &departure), pdf, at.cosine(light.direction), reverse)
            }
        };
        let ray = match &light.source {
            Some(source) => at.origin().segment(source),
            None => at.origin().ray(light.direction),
        };
        context.connect(arrival, &arrival.leaving(ray, light.primitive), arriving * weight, [0.0; 2]);
    }

    /// Connect to a light vertex.
    pub(super) fn connect(
        &self,
        emitters: &Emitters,
        arrival: &Arrival<'_, 'a>,
        path: &Subpath,
        light: &LightVertex<'a>,
        context: &mut VertexContext<'_>,
    ) {
        let (at, there) = (arrival.vertex(), &light.at);
        let way = there.position() - at.position();
        let square = way.length_squared();
        let distance = square.sqrt();
        let direction = way / distance;
        if !direction.is_finite() || at.is_hidden_from(direction) || there.is_hidden_from(-direction) {
            return;
        }
        let (scattered, pdf) = at.evaluate(direction);
        if scattered.is_black() {
            return;
        }
        let met = there.met_from(-direction, distance);
        let mut arriving = path.beta * scattered * light.flux * met.sent / square;
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
                let onward = there.light_pdf(-direction);
                let one = light.end.others(emitters, there, &met, pdf * there.cosine(direction) / square);
                let reverse = at.light_back_pdf(direction);
                weight(one, self.end(path).partial.others(onward * at.cosine(direction) / square, reverse))
            }
        };
        // The near side of a curved shape may hide the vertex on its far side.
        let is_curved = self.job.scene.geometry().shape(there.primitive()).is_some();
        let to = if is_curved { Ray::NO_TRIANGLE } else { there.primitive() };
        let segment = arrival.leaving(at.origin().segment(&there.origin()), to);
        context.connect(arrival, &segment, arriving * weight, [0.0; 2]);
    }

    /// Return the weight of a strategy if only one is shown: 1 or 0.
    pub(super) fn full(&self, light: u32, camera: u32) -> f64 {
        let way = PathStrategy { vertices: [light, camera], merges: false };
        f64::from(u8::from(self.alone == Some(way)))
    }
}
