//! Connections of camera paths to lights and to light vertices.

use super::PathStrategy;
use super::camera_paths::EyePath;
use super::light_vertices::LightVertex;
use super::worker::BidirectionalWorker;
use crate::light_paths::{Vertex, of_asked, weight};
use crate::media::medium_traversal::MediumTraversal;
use crate::media::path_numbers::PathNumbers;
use raywright_base::math::Ray;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{Emitters, LightSampleContext};

impl<'a> BidirectionalWorker<'a> {
    /// Sample one light.
    pub(super) fn ask(
        &mut self,
        emitters: &Emitters,
        at: &Vertex,
        path: &EyePath,
        (numbers, cancel): (&mut PathNumbers, &Cancel),
        radiance: &mut Rgb,
    ) {
        let choice = numbers.ray.light_choice(0);
        let (choice, u) = (numbers.one(choice), numbers.two(choice + 1));
        let receiver = LightSampleContext { waves: path.waves, ..at.receiver() };
        let Some((light, departure, asked)) = emitters.sample_direct(&receiver, choice, u) else { return };
        let (scattered, pdf) = at.evaluate(light.direction);
        let arriving = path.throughput() * scattered * light.weight;
        if arriving.is_black() {
            return;
        }
        let weight = match self.alone {
            Some(_) => self.full(1, path.bounce + 2),
            None => {
                let reverse = at.light_back_pdf(light.direction);
                of_asked(&path.partial, (asked, &departure), pdf, at.cosine(light.direction), reverse)
            }
        };
        let ray = match &light.source {
            Some(source) => at.origin().segment(source),
            None => at.origin().ray(light.direction),
        };
        let (ray, waves) = (at.leaving(ray, light.primitive), path.waves_with(false));
        self.send(arriving * weight, ray, (at, waves, at.is_in_medium()), path.sample, (numbers, cancel), radiance);
    }

    /// Connect to a light vertex.
    pub(super) fn connect(
        &mut self,
        emitters: &Emitters,
        at: &Vertex,
        path: &EyePath,
        light: &LightVertex<'a>,
        numbers: (&mut PathNumbers, &Cancel),
        radiance: &mut Rgb,
    ) {
        let there = &light.at;
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
        let mut arriving = path.throughput() * scattered * light.flux * met.sent / square;
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
                weight(one, path.partial.others(onward * at.cosine(direction) / square, reverse))
            }
        };
        let segment = at.leaving(at.origin().segment(&there.origin()), there.primitive());
        let roulette = at.is_in_medium() || there.is_in_medium();
        let from = (at, path.waves_with(light.single), roulette);
        self.send(arriving * weight, segment, from, path.sample, numbers, radiance);
    }

    /// Return the weight of a strategy if only one is shown: 1 or 0.
    pub(super) fn full(&self, light: u32, camera: u32) -> f64 {
        let way = PathStrategy { vertices: [light, camera], merges: false };
        f64::from(u8::from(self.alone == Some(way)))
    }

    /// Add the share of light that comes along a shadow ray, or queue the ray where each surface occludes. `roulette`
    /// applies if an end of it was sampled in a medium.
    fn send(
        &mut self,
        light: Rgb,
        ray: Ray,
        (at, waves, roulette): (&Vertex, Option<Waves>, bool),
        sample: u32,
        (numbers, cancel): (&mut PathNumbers, &Cancel),
        radiance: &mut Rgb,
    ) {
        if light.is_black() || !light.is_finite() {
            return;
        }
        if self.is_plain {
            self.shadows.push(&ray);
            self.shadows.bring(sample, light);
            return;
        }
        let course = MediumTraversal { roulette, ..MediumTraversal::alone(self.job.scene, waves) };
        let light = course.through(light, ray, at.media(ray.direction), numbers, cancel);
        *radiance += if light.is_finite() { light } else { Rgb::ZERO };
    }
}
