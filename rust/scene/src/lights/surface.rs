//! Light from surfaces.

use super::luminous::{along, fine_digits};
use super::triangle::SeenTriangle;
use super::{Emission, LightSample, LightSampleContext, Luminous};
use crate::textures::{Needs, TexturePoint};
use crate::{Gaze, Geometry, RayOrigin, ShadingPoint, SurfacePoint};
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Rgb;
use raywright_shapes::{Drawn, Point, Seen, Shape, Site};

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
fn seen(shape: &dyn Shape, needs: Needs, place: DVec3, u: [f64; 2]) -> Option<(Seen, [f64; 2])> {
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

/// Light from a shape, from a place of its space where the receiver is. `in_world` gives points of the shape as the
/// scene has them, `crowding` how much denser directions are in the world than in that space.
pub(super) fn sample_shape(
    (geometry, shape): (&Geometry, &dyn Shape),
    luminous: &Luminous,
    (receiver, from): (&LightSampleContext, DVec3),
    place: (u32, u32),
    u: [f64; 2],
    in_world: impl Fn(&Site) -> Option<SurfacePoint>,
    crowding: impl Fn(DVec3) -> f64,
) -> Option<LightSample> {
    let (seen, uv) = seen(shape, luminous.needs(), from, u)?;
    let density = |direction: DVec3, _| seen.pdf * crowding(direction);
    let Some(material) = luminous.open else {
        let surface = in_world(&seen.site)?;
        let sends = |ray: &Ray, hit: &Hit| luminous.sent(geometry, ray, hit, &surface, || receiver.waves);
        return sample(receiver, &surface, place, uv, density, sends);
    };
    // Light from behind the first point may get through it.
    let sends = |point: &Point| {
        let surface = in_world(&point.site())?;
        let way = surface.position - receiver.position;
        let distance = way.length();
        let ray = Ray::new(receiver.position, way / distance);
        let hit = Hit { t: distance, uv: point.uv, primitive: place.0, inner: place.1 };
        let opacity = crate::opacity_at(material, geometry, &ray, &hit, &surface);
        Some((luminous.emission.sent(geometry, &ray, &hit, &surface, || receiver.waves) * opacity, opacity))
    };
    let (point, share) = along(shape, (from, seen.site.position - from), fine_digits(u[1]), sends)?;
    let surface = in_world(&point.site())?;
    let sends = |ray: &Ray, hit: &Hit| luminous.sent(geometry, ray, hit, &surface, || receiver.waves) / share;
    sample(receiver, &surface, place, point.uv, density, sends)
}

/// Light from a primitive of the scene that is no instance.
#[inline]
pub(super) fn sample_primitive(
    geometry: &Geometry,
    luminous: &Luminous,
    primitive: u32,
    receiver: &LightSampleContext,
    u: [f64; 2],
) -> Option<LightSample> {
    match geometry.shape(primitive) {
        Some(shape) => {
            let from = (receiver, receiver.position);
            let in_world = |site: &Site| Some(geometry.on_shape(primitive, site));
            sample_shape((geometry, shape), luminous, from, (primitive, 0), u, in_world, |_| 1.0)
        }
        None => {
            let seen = SeenTriangle::new(geometry.corners(primitive), receiver.position);
            if !luminous.emission.sides.shine(seen.height()) {
                return None;
            }
            let uv = seen.sample(u);
            let surface = geometry.on_triangle(primitive, uv);
            let density = |direction: DVec3, distance| seen.pdf(distance, direction.dot(surface.normal));
            let sends = |ray: &Ray, hit: &Hit| luminous.sent(geometry, ray, hit, &surface, || receiver.waves);
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
