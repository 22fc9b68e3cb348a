//! Light that sets out.

use raywright_base::math::{DVec3, Ray};
use raywright_optics::Rgb;

/// Light that sets out from a light along a ray, drawn with regard to nothing that it falls on.
#[derive(Clone, Copy, Debug)]
pub struct EmissionSample {
    /// Its way, of unit direction.
    pub ray: Ray,
    /// The flux, W, that it stands for: radiance times the cosine over the density, or intensity over that of the
    /// direction.
    pub weight: Rgb,
    /// With which it is drawn.
    pub pdf: EmissionPdf,
    /// The unit normal of the surface that it leaves, on that side; zero where it leaves none.
    pub normal: DVec3,
    /// What it comes from.
    pub source: Source,
    /// Whether it comes from outside the scene: its place is one of the plane across its direction.
    pub is_infinite: bool,
}

/// What light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A surface: the number of the light.
    Surface(u32),
    /// A light that is a single point, by its number among those.
    Point(u32),
    /// Any of the infinite lights, by a direction that several may have.
    Infinite,
    /// The single direction of an infinite light, by its number among those.
    Direction(u32),
}

/// The density with which light that sets out is drawn: the product of the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionPdf {
    /// Of the place, by area: on a surface, or of light from outside on a plane across its direction. The probability
    /// of a light that is a single point.
    pub place: f64,
    /// Of the direction, by solid angle; infinite where it is a single one.
    pub direction: f64,
}

/// Light that sets out from a single point, drawn from a light that is one.
#[derive(Clone, Copy, Debug)]
pub struct PointEmission {
    /// The point.
    pub position: DVec3,
    /// Where it goes to, as a unit vector.
    pub direction: DVec3,
    /// Intensity over density.
    pub weight: Rgb,
    /// Density of the direction, by solid angle.
    pub pdf: f64,
}
