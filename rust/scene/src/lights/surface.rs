//! Emission sampling of surfaces.

use super::luminous::{along, fine_digits};
use super::triangle::SeenTriangle;
use super::{Emission, LightSample, LightSampleContext, Luminous};
use crate::textures::{Needs, TexturePoint};
use crate::{Geometry, LookupContext, RayOrigin, ShadingPoint, SurfacePoint};
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Rgb;
use raywright_shapes::{Drawn, Point, Seen, Shape, Site};

impl Emission {
    /// Radiance of a surface back along a ray of unit direction that hits it; `gaze` computes the lookup context if
    /// needed.
    #[inline]
    pub fn sent<G: Into<LookupContext>>(
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

/// Samples a point of a shape as seen from a position, with surface coordinates if they are needed.
#[inline]
fn seen(shape: &dyn Shape, needs: Needs, place: DVec3, u: [f64; 2]) -> Option<(Seen, [f64; 2])> {
    if !needs.any() {
        return Some((shape.sight_from(place, u)?, [0.0; 2]));
    }
    let Drawn { point, pdf } = shape.sample_from(place, u)?;
    Some((Seen { site: point.site(), pdf }, point.uv))
}

/// Light from a sampled point of a primitive. The last argument computes its radiance from the ray to it.
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
    // Also false if the distance is 0 and the direction NaN.
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

/// Samples light from a shape, from the receiver's position in the shape's space. `in_world` maps points of the shape
/// to the scene, and `crowding` is the ratio of directional densities in the world and in that space.
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
    // Light from behind the first point may pass through it.
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

/// Samples light from a primitive that is not an instance.
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

/// Density with which [`sample_primitive`] samples the direction of a ray that hits the primitive; the cosine is that
/// to its normal.
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
