//! Single lights, and what is known of a point on one.

use crate::math::DVec3;
use crate::optics::Rgb;
use crate::sampling::warp;
use crate::scene::{Departure, Geometry};
use crate::shapes::Shape;

/// A light without extent that shines equally in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it is.
    pub position: DVec3,
    /// Radiant intensity, W·sr⁻¹.
    pub intensity: Rgb,
}

/// Light on its way to a point, drawn from a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Where it comes from, as a unit vector.
    pub direction: DVec3,
    /// Radiance over density, were nothing in between.
    pub weight: Rgb,
    /// Density in solid angle. Infinite where a single direction has all of it, as with a point light: weighed against
    /// any other way to find this direction, such a sample then gets all the weight.
    pub pdf: f64,
    /// Where it sets out; `None` if from outside the scene.
    pub source: Option<Departure>,
}

impl PointLight {
    /// The light that reaches `point`, when this one is chosen with a probability.
    #[inline]
    pub(super) fn sample(&self, point: DVec3, probability: f64) -> Option<LightSample> {
        let way = self.position - point;
        let distance = way.length();
        // At the light itself there is no direction.
        (distance > 0.0).then(|| LightSample {
            direction: way / distance,
            weight: self.intensity / (distance * distance * probability),
            pdf: f64::INFINITY,
            source: Some(Departure::free(self.position)),
        })
    }
}

/// The light that reaches `point` from a triangle that emits `radiance` on the side of its normal, by uniform area.
#[inline]
pub(super) fn sample_triangle(
    geometry: &Geometry,
    primitive: u32,
    radiance: Rgb,
    point: DVec3,
    probability: f64,
    u: [f64; 2],
) -> Option<LightSample> {
    let surface = geometry.on_triangle(primitive, warp::uniform_triangle(u));
    let way = surface.position - point;
    let distance = way.length();
    let direction = way / distance;
    let cosine = -direction.dot(surface.normal);
    // Also false where the distance is 0 and the direction NaN.
    if cosine > 0.0 {
        let pdf = probability * solid_angle_pdf(geometry, primitive, distance, cosine);
        Some(LightSample { direction, weight: radiance / pdf, pdf, source: Some(Departure::new(&surface)) })
    } else {
        None
    }
}

/// The light that reaches `point` from a shape that emits `radiance` on the side of its normal.
#[inline]
pub(super) fn sample_shape(
    geometry: &Geometry,
    (primitive, shape): (u32, &dyn Shape),
    radiance: Rgb,
    point: DVec3,
    probability: f64,
    u: [f64; 2],
) -> Option<LightSample> {
    let drawn = shape.sample_from(point, u)?;
    let direction = (drawn.point.position - point).normalize();
    let pdf = probability * drawn.pdf;
    // Also false where the direction is NaN.
    let faces = -direction.dot(drawn.point.normal) > 0.0 && pdf > 0.0;
    faces.then(|| LightSample {
        direction,
        weight: radiance / pdf,
        pdf,
        source: Some(Departure::new(&geometry.on_shape(primitive, &drawn.point))),
    })
}

/// The density in solid angle of a point drawn by area on a triangle, as seen from a distance and under the cosine of
/// an angle to its normal.
#[inline]
pub(super) fn solid_angle_pdf(geometry: &Geometry, primitive: u32, distance: f64, cosine: f64) -> f64 {
    distance * distance / (0.5 * geometry.area_vector(primitive).length() * cosine)
}
