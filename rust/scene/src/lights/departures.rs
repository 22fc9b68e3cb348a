//! Sampling densities of the path segment at a light, for multiple importance sampling.
//!
//! A path may be sampled from the light ([`Emitters::sample`]) or from the camera with next-event estimation
//! ([`Lights::sample`]). Each density is computed here from data known at either end, so that both strategies use
//! identical MIS weights.

use super::emission_sample::{EmissionSample, Source};
use super::{Emitters, LightSample, LightSampleContext, Lights};
use crate::{Geometry, SurfacePoint};
use raywright_base::math::{DVec3, Frame, Hit, Ray};
use std::f64::consts::PI;

/// Density of emission along a ray.
///
/// A light with a single position or direction has a probability in place of a density. [`Emitters::asked_from`] uses
/// the same convention, so the ratio of both is correct.
#[derive(Clone, Copy, Debug)]
pub struct EmissionDensity {
    /// The emitter.
    pub source: Source,
    /// Density of the position by area, times density of the direction by solid angle.
    pub density: f64,
    /// Positive cosine of the angle to the surface's normal; 1 if the emitter is not a surface.
    pub cosine: f64,
}

impl EmissionDensity {
    /// Returns whether the light is a delta distribution, so that rays never hit it by chance.
    pub fn is_single(&self) -> bool {
        matches!(self.source, Source::Point(_) | Source::Direction(_))
    }
}

impl Emitters<'_> {
    /// Density of a sampled emission.
    pub fn of_sample(&self, sample: &EmissionSample) -> EmissionDensity {
        let direction = sample.ray.direction;
        match sample.source {
            Source::Surface(light) => {
                self.emission_of_surface(light, sample.normal.dot(direction), (sample.ray.origin, direction))
            }
            Source::Point(_) => self.emission_of_point(sample.source, direction),
            Source::Infinite | Source::Direction(_) => self.emission_of_infinite(sample.source, -direction),
        }
    }

    /// Density of emission from a hit surface back along the ray; `None` if the surface is never sampled.
    pub fn of_hit(&self, ray: &Ray, hit: &Hit, surface: &SurfacePoint) -> Option<EmissionDensity> {
        let light = self.lights.number_of(self.geometry, hit)?;
        let way = (surface.position, -ray.direction);
        Some(self.emission_of_surface(light as u32, way.1.dot(surface.normal), way))
    }

    /// Density of emission from outside along a direction.
    pub fn of_environment(&self, direction: DVec3) -> EmissionDensity {
        self.emission_of_infinite(Source::Infinite, direction)
    }

    /// Samples light like [`Lights::sample`]. Also returns the emission density and the density of
    /// [`Emitters::asked_from`].
    pub fn sample_direct(
        &self,
        receiver: &LightSampleContext,
        choice: f64,
        u: [f64; 2],
    ) -> Option<(LightSample, EmissionDensity, f64)> {
        let (lights, geometry) = (self.lights, self.geometry);
        let (infinite, share) = (&lights.infinite, lights.infinite.share());
        if choice < share {
            let chosen = infinite.choose(choice / share);
            let drawn = infinite.sample_of(chosen, receiver, u)?.chosen(share);
            let source = if drawn.pdf == f64::INFINITY { Source::Direction(chosen as u32) } else { Source::Infinite };
            let departure = self.emission_of_infinite(source, drawn.direction);
            let density = match source {
                Source::Direction(_) => share * infinite.probability(chosen),
                _ => drawn.pdf,
            };
            return Some((drawn, departure, density));
        }
        let choice = if share > 0.0 { ((choice - share) / (1.0 - share)).min(1.0 - f64::EPSILON) } else { choice };
        let (number, probability) = lights.choice.as_ref()?.sample(receiver, choice)?;
        let probability = (1.0 - share) * probability;
        let drawn = lights.sample_within(number, geometry, receiver, u)?.chosen(probability);
        let source = drawn.source?;
        let points = lights.surfaces.len() + lights.copied.len();
        if let Some(point) = number.checked_sub(points) {
            let distance = source.position().distance(receiver.position);
            let departure = self.emission_of_point(Source::Point(point as u32), -drawn.direction);
            return Some((drawn, departure, probability * distance * distance));
        }
        // The offset of the ray's origin is along the surface normal.
        let off = source.offset();
        let largest = off.abs().max_element();
        let normal = if largest > 0.0 { (off / largest).normalize() } else { drawn.direction };
        let way = (source.position(), -drawn.direction);
        Some((drawn, self.emission_of_surface(number as u32, normal.dot(drawn.direction), way), drawn.pdf))
    }

    /// Density with which [`Lights::sample`] samples the direction of incoming light at a receiver, by solid angle, for
    /// light at this distance. For a point light it is the probability over the solid angle of a unit area.
    pub fn asked_from(
        &self,
        receiver: &LightSampleContext,
        departure: &EmissionDensity,
        direction: DVec3,
        distance: f64,
    ) -> f64 {
        let Self { lights, geometry, .. } = self;
        let infinite = &lights.infinite;
        let number = match departure.source {
            Source::Infinite => return lights.infinite_pdf(receiver, -direction),
            Source::Direction(light) => return infinite.share() * infinite.probability(light as usize),
            Source::Surface(light) => light as usize,
            Source::Point(light) => lights.surfaces.len() + lights.copied.len() + light as usize,
        };
        let Some(choice) = &lights.choice else { return 0.0 };
        let probability = (1.0 - infinite.share()) * choice.probability(number, receiver);
        if let Source::Point(_) = departure.source {
            return probability * distance * distance;
        }
        if probability > 0.0 {
            let ray = Ray::new(receiver.position, -direction);
            let hit = Hit { t: distance, primitive: lights.primitive(number), ..Hit::MISS };
            probability * lights.pdf_within(number, geometry, receiver, (&ray, &hit), departure.cosine)
        } else {
            0.0
        }
    }

    /// Density of emission from a position on a surface in a direction.
    fn emission_of_surface(&self, light: u32, cosine: f64, (place, direction): (DVec3, DVec3)) -> EmissionDensity {
        let (probability, cosine) = (self.choice.probability(light as usize), cosine.abs());
        let density = match self.lights.extent(light as usize, self.geometry) {
            Some((sides, area)) if probability > 0.0 => {
                let own = cosine / (PI * sides);
                probability / area * self.aim.from(place).map_or(own, |cones| cones.density(direction, own))
            }
            _ => 0.0,
        };
        EmissionDensity { source: Source::Surface(light), density, cosine }
    }

    fn emission_of_point(&self, source: Source, direction: DVec3) -> EmissionDensity {
        let Source::Point(point) = source else { return EmissionDensity { source, density: 0.0, cosine: 1.0 } };
        let number = self.within - self.lights.inside.len() + point as usize;
        let own = self.lights.inside[point as usize].emission_pdf(direction);
        let aim = self.aim_of_point(point as usize);
        let density = self.choice.probability(number) * aim.map_or(own, |(_, cones)| cones.density(direction, own));
        EmissionDensity { source, density, cosine: 1.0 }
    }

    /// Density of emission from outside along a direction.
    fn emission_of_infinite(&self, source: Source, direction: DVec3) -> EmissionDensity {
        let [across, other] = self.covered(&Frame::new(direction));
        let infinite = &self.lights.infinite;
        let towards = match source {
            Source::Direction(light) => infinite.probability(light as usize),
            _ => infinite.pdf(&LightSampleContext::free(self.middle), direction),
        };
        let density = self.choice.probability(self.within) / (4.0 * across * other) * towards;
        EmissionDensity { source, density, cosine: 1.0 }
    }
}

impl Lights {
    /// The primitive of a surface light, by light number.
    fn primitive(&self, number: usize) -> u32 {
        match self.surfaces.get(number) {
            Some(&primitive) => primitive,
            None => self.copied.primitive(number - self.surfaces.len()),
        }
    }

    /// Number of emitting sides of a surface light, and its approximate area.
    fn extent(&self, number: usize, geometry: &Geometry) -> Option<(f64, f64)> {
        let Some(&primitive) = self.surfaces.get(number) else {
            return self.copied.extent(number - self.surfaces.len(), geometry);
        };
        let area = geometry.shape(primitive).map_or_else(|| geometry.area(primitive), |shape| shape.area());
        Some((self.emission(geometry.locate(primitive).0).sides.count(), area))
    }
}
