//! Samples of light emission, the first segment of light paths.

use raywright_base::math::{DVec3, Ray};
use raywright_optics::Rgb;

/// Light emitted along a ray, sampled independently of any receiver.
#[derive(Clone, Copy, Debug)]
pub struct EmissionSample {
    /// Ray of unit direction.
    pub ray: Ray,
    /// Flux of the sample, W: radiance times cosine over density, or intensity over the density of the direction.
    pub weight: Rgb,
    /// Densities of the sample.
    pub pdf: EmissionPdf,
    /// Unit normal of the emitting surface on the emitting side; zero if the emitter is not a surface.
    pub normal: DVec3,
    /// The emitter.
    pub source: Source,
    /// True if the light is at infinity; its position is then on a plane perpendicular to the direction.
    pub is_infinite: bool,
}

/// The emitter of a light sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A surface, by light number.
    Surface(u32),
    /// A point light, by its number among the lights that are not surfaces.
    Point(u32),
    /// All infinite lights; several may share a direction.
    Infinite,
    /// The delta direction of an infinite light, by its number among those.
    Direction(u32),
}

/// Density of an emission sample: the product of both parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionPdf {
    /// Density of the position by area: on the surface, or on the plane perpendicular to an infinite light's direction.
    /// For a point light, its selection probability.
    pub place: f64,
    /// Density of the direction by solid angle; infinite for a delta direction.
    pub direction: f64,
}

/// Emission from a single point, sampled from a point light.
#[derive(Clone, Copy, Debug)]
pub struct PointEmission {
    /// Position.
    pub position: DVec3,
    /// Unit direction.
    pub direction: DVec3,
    /// Intensity over density.
    pub weight: Rgb,
    /// Density of the direction, by solid angle.
    pub pdf: f64,
}
