//! Light from surfaces.

use super::triangle::SeenTriangle;
use super::{Emission, LightSample, Receiver};
use crate::accel::Primitives;
use crate::math::{DVec3, Hit, Ray};
use crate::optics::Rgb;
use crate::scene::{Departure, Geometry, ShadingPoint, SurfacePoint};

/// What a surface sends from a point of it, met by a ray of unit direction from the receiver.
#[inline]
pub(super) fn radiance(geometry: &Geometry, emission: &Emission, ray: &Ray, hit: &Hit, surface: &SurfacePoint) -> Rgb {
    let cosine = -ray.direction.dot(surface.normal);
    let point = ShadingPoint::new(geometry, ray, hit, surface, emission.needs(), 0.0);
    emission.towards(cosine, &point.texture)
}

/// Light from a point drawn on a primitive. The last is what it sends, asked by the ray to it.
#[inline]
pub(super) fn sample(
    receiver: &Receiver,
    surface: &SurfacePoint,
    (primitive, inner): (u32, u32),
    uv: [f64; 2],
    pdf: impl FnOnce(DVec3, f64) -> f64,
    radiance: impl FnOnce(&Ray, &Hit) -> Rgb,
) -> Option<LightSample> {
    let way = surface.position - receiver.position;
    let distance = way.length();
    let direction = way / distance;
    let ray = Ray::new(receiver.position, direction);
    let radiance = radiance(&ray, &Hit { t: distance, uv, primitive, inner });
    // Also false where the distance is 0 and the direction NaN.
    if radiance == Rgb::ZERO || direction.is_nan() {
        return None;
    }
    let pdf = pdf(direction, distance);
    (pdf > 0.0 && pdf < f64::INFINITY).then(|| LightSample {
        direction,
        weight: radiance / pdf,
        pdf,
        source: Some(Departure::new(surface)),
    })
}

/// Light from a primitive of the scene that is no copy.
#[inline]
pub(super) fn sample_primitive(
    geometry: &Geometry,
    emission: &Emission,
    primitive: u32,
    receiver: &Receiver,
    u: [f64; 2],
) -> Option<LightSample> {
    match geometry.shape(primitive) {
        Some(shape) => {
            let drawn = shape.sample_from(receiver.position, u)?;
            let surface = geometry.on_shape(primitive, &drawn.point);
            let sends = |ray: &Ray, hit: &Hit| radiance(geometry, emission, ray, hit, &surface);
            sample(receiver, &surface, (primitive, 0), drawn.point.uv, |_, _| drawn.pdf, sends)
        }
        None => {
            let seen = SeenTriangle::new(geometry.corners(primitive), receiver.position);
            if !(seen.faces() || emission.both_sides) {
                return None;
            }
            let uv = seen.sample(u);
            let surface = geometry.on_triangle(primitive, uv);
            let density = |direction: DVec3, distance| seen.pdf(distance, direction.dot(surface.normal));
            let sends = |ray: &Ray, hit: &Hit| radiance(geometry, emission, ray, hit, &surface);
            sample(receiver, &surface, (primitive, 0), uv, density, sends)
        }
    }
}

/// The density with which [`sample_primitive`] draws the direction of a ray that meets the primitive under the cosine of an angle to its
/// normal.
#[inline]
pub(super) fn primitive_pdf(geometry: &Geometry, receiver: &Receiver, ray: &Ray, hit: &Hit, cosine: f64) -> f64 {
    match geometry.shape(hit.primitive) {
        Some(shape) => shape.pdf_from(ray.origin, ray.direction),
        None => SeenTriangle::new(geometry.corners(hit.primitive), receiver.position).pdf(hit.t, cosine),
    }
}
