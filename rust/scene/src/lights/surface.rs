//! Light from surfaces.

use super::triangle::SeenTriangle;
use super::{Emission, LightSample, LightSampleContext};
use crate::textures::{Needs, TexturePoint};
use crate::{Gaze, Geometry, RayOrigin, ShadingPoint, SurfacePoint};
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Rgb;
use raywright_shapes::{Drawn, Seen, Shape};

impl Emission {
    /// What a surface sends back along a ray of unit direction that meets it; `gaze` is how it is looked at there, if
    /// anybody asks.
    #[inline]
    pub fn sent<G: Into<Gaze>>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        hit: &Hit,
        surface: &SurfacePoint,
        gaze: impl FnOnce() -> G,
    ) -> Rgb {
        let (cosine, needs) = (-ray.direction.dot(surface.normal), self.needs());
        if !needs.any() {
            return self.towards(cosine, &TexturePoint::NOWHERE);
        }
        self.towards(cosine, &ShadingPoint::new(geometry, ray, hit, *surface, needs, gaze()).texture)
    }
}

/// Draws a point of a shape as seen from a place, and says where it lies in coordinates if that is needed.
#[inline]
pub(super) fn seen(shape: &dyn Shape, needs: Needs, place: DVec3, u: [f64; 2]) -> Option<(Seen, [f64; 2])> {
    if !needs.any() {
        return Some((shape.sight_from(place, u)?, [0.0; 2]));
    }
    let Drawn { point, pdf } = shape.sample_from(place, u)?;
    Some((Seen { site: point.site(), pdf }, point.uv))
}

/// Light from a point drawn on a primitive. The last is what it sends, asked by the ray to it.
#[inline]
pub(super) fn sample(
    receiver: &LightSampleContext,
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
    if radiance.is_black() || direction.is_nan() {
        return None;
    }
    let pdf = pdf(direction, distance);
    (pdf > 0.0 && pdf < f64::INFINITY).then(|| LightSample {
        direction,
        weight: radiance / pdf,
        pdf,
        source: Some(RayOrigin::new(surface)),
        primitive,
    })
}

/// Light from a primitive of the scene that is no instance.
#[inline]
pub(super) fn sample_primitive(
    geometry: &Geometry,
    emission: &Emission,
    primitive: u32,
    receiver: &LightSampleContext,
    u: [f64; 2],
) -> Option<LightSample> {
    match geometry.shape(primitive) {
        Some(shape) => {
            let (seen, uv) = seen(shape, emission.needs(), receiver.position, u)?;
            let surface = geometry.on_shape(primitive, &seen.site);
            let sends = |ray: &Ray, hit: &Hit| emission.sent(geometry, ray, hit, &surface, || receiver.waves);
            sample(receiver, &surface, (primitive, 0), uv, |_, _| seen.pdf, sends)
        }
        None => {
            let seen = SeenTriangle::new(geometry.corners(primitive), receiver.position);
            if !emission.sides.shine(seen.height()) {
                return None;
            }
            let uv = seen.sample(u);
            let surface = geometry.on_triangle(primitive, uv);
            let density = |direction: DVec3, distance| seen.pdf(distance, direction.dot(surface.normal));
            let sends = |ray: &Ray, hit: &Hit| emission.sent(geometry, ray, hit, &surface, || receiver.waves);
            sample(receiver, &surface, (primitive, 0), uv, density, sends)
        }
    }
}

/// The density with which [`sample_primitive`] draws the direction of a ray that meets the primitive under the cosine
/// of an angle to its normal.
#[inline]
pub(super) fn primitive_pdf(
    geometry: &Geometry,
    receiver: &LightSampleContext,
    ray: &Ray,
    hit: &Hit,
    cosine: f64,
) -> f64 {
    match geometry.shape(hit.primitive) {
        Some(shape) => shape.pdf_of_met(ray.origin, ray.direction),
        None => SeenTriangle::new(geometry.corners(hit.primitive), receiver.position).pdf(hit.t, cosine),
    }
}
