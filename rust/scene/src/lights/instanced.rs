//! Emissive surfaces in instances.

use super::choice::Strength;
use super::triangle::SeenTriangle;
use super::{LightSample, LightSampleContext, Luminous, surface};
use crate::{Geometry, Instances, Prototype, SurfacePoint};
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::sampling::warp::uniform_triangle;
use raywright_shapes::{Bounds, Site};

/// Emissive primitives in instances of prototypes; each primitive of each instance is a light. Only instances at rest
/// count, and only primitives directly in a prototype, not in nested instances. Beyond [`Copied::MOST`] lights the last
/// shapes are left out. Rays still hit emitters that are left out by chance.
#[derive(Debug, Default)]
pub(super) struct Copied {
    /// The instance shapes with lights listed here, in order.
    shapes: Vec<Glow>,
    lights: Vec<Light>,
}

/// A shape that is instances of a prototype with emissive primitives.
#[derive(Debug)]
struct Glow {
    shape: u32,
    /// Number of its first light.
    first: u32,
    /// Emissive primitives of the prototype, flattened, in order.
    flat: Vec<u32>,
}

/// One primitive of one instance.
#[derive(Debug)]
struct Light {
    /// Primitive number of the instance.
    primitive: u32,
    /// Flattened primitive number in the prototype.
    inner: u32,
    /// World-space corners of a triangle; NaN for another shape.
    corners: [DVec3; 3],
}

impl Copied {
    /// Maximum number of lights in instances per scene.
    pub const MOST: usize = 4096;

    /// Finds the lights of a geometry and their strengths.
    pub fn new(geometry: &Geometry) -> (Self, Vec<Strength>) {
        let (mut all, mut strengths) = (Self::default(), Vec::new());
        if !geometry.has_instances() {
            return (all, strengths);
        }
        for shape in 0..geometry.shapes() as u32 {
            let Some(instances) = geometry.instances_of(shape).filter(|instances| instances.stand_still()) else {
                continue;
            };
            let flat: Vec<u32> = instances.prototype().shining().collect();
            if flat.is_empty() || all.lights.len() + flat.len() * instances.count() > Self::MOST {
                continue;
            }
            let first = all.lights.len() as u32;
            for primitive in geometry.primitives_of(shape) {
                for &inner in &flat {
                    let (light, strength) = Light::new(geometry, instances, primitive, inner);
                    all.lights.push(light);
                    strengths.push(strength);
                }
            }
            all.shapes.push(Glow { shape, first, flat });
        }
        (all, strengths)
    }

    /// Strength of each light.
    pub fn strengths(&self, geometry: &Geometry) -> impl Iterator<Item = Strength> {
        self.lights.iter().map(|light| match geometry.instance(light.primitive) {
            Some((instances, _)) => Light::new(geometry, instances, light.primitive, light.inner).1,
            None => Strength::NONE,
        })
    }

    /// Returns whether the lights of a shape are listed.
    pub fn has(&self, shape: u32) -> bool {
        self.shapes.binary_search_by_key(&shape, |glow| glow.shape).is_ok()
    }

    /// Samples a point of a light by area. Returns its emission, the point, a hit from distance 1, and the density.
    pub fn place<'a>(
        &self,
        light: usize,
        geometry: &'a Geometry,
        u: [f64; 2],
    ) -> Option<(Luminous<'a>, SurfacePoint, Hit, f64)> {
        let Light { primitive, inner, .. } = self.lights[light];
        let (instances, instance) = geometry.instance(primitive)?;
        let (prototype, pose) = (instances.prototype(), instances.pose(instance, 0.0)?);
        let (own, _) = prototype.split(inner);
        let (point, uv, pdf) = match prototype.geometry().shape(own) {
            Some(shape) => {
                let drawn = shape.sample(u)?;
                (prototype.geometry().on_shape(own, &drawn.point.site()), drawn.point.uv, drawn.pdf)
            }
            None => {
                let uv = uniform_triangle(u);
                (prototype.geometry().on_triangle(own, uv), uv, 1.0 / prototype.geometry().area(own))
            }
        };
        // Area scale from the prototype's space to the world.
        let stretch = pose.map().normal(point.normal).length();
        let mut surface = pose.point(&point);
        (surface.shape, surface.inner) = (geometry.locate(primitive).0, Some(inner));
        Some((prototype.luminous(inner), surface, Hit { t: 1.0, uv, primitive, inner }, pdf / stretch))
    }

    /// Primitive number of a light's instance.
    pub fn primitive(&self, light: usize) -> u32 {
        self.lights[light].primitive
    }

    /// Number of emitting sides of a light, and its approximate area. For a shape that is not a triangle, the
    /// instance's scaling is taken as uniform.
    pub fn extent(&self, light: usize, geometry: &Geometry) -> Option<(f64, f64)> {
        let Light { primitive, inner, corners: [a, b, c] } = &self.lights[light];
        let (instances, instance) = geometry.instance(*primitive)?;
        let prototype = instances.prototype();
        let (own, sides) = (prototype.split(*inner).0, prototype.appearance(*inner).1.sides.count());
        let Some(shape) = prototype.geometry().shape(own) else {
            return Some((sides, 0.5 * (*b - *a).cross(*c - *a).length()));
        };
        let stretch = instances.pose(instance, 0.0)?.map().determinant().abs().cbrt();
        Some((sides, shape.area() * stretch * stretch))
    }

    /// Number of lights.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// The light number of a hit in an instance, if it is a light.
    #[inline]
    pub fn find(&self, shape: u32, instance: u32, inner: u32) -> Option<usize> {
        let glow = &self.shapes[self.shapes.binary_search_by_key(&shape, |glow| glow.shape).ok()?];
        let within = glow.flat.binary_search(&inner).ok()?;
        Some(glow.first as usize + instance as usize * glow.flat.len() + within)
    }

    /// Samples light from one light.
    pub fn sample(
        &self,
        light: usize,
        geometry: &Geometry,
        receiver: &LightSampleContext,
        u: [f64; 2],
    ) -> Option<LightSample> {
        let Light { primitive, inner, corners } = &self.lights[light];
        let (instances, instance) = geometry.instance(*primitive)?;
        let (prototype, pose) = (instances.prototype(), instances.pose(instance, 0.0)?);
        let (own, _) = prototype.split(*inner);
        let luminous = prototype.luminous(*inner);
        let place = (*primitive, *inner);
        match prototype.geometry().shape(own) {
            Some(shape) => {
                let from = pose.enter(&Ray::new(receiver.position, DVec3::Z)).origin;
                let in_world = |site: &Site| Some(pose.point(&prototype.geometry().on_shape(own, site)));
                let density = |direction: DVec3| pose.crowding(direction);
                surface::sample_shape((geometry, shape), &luminous, (receiver, from), place, u, in_world, density)
            }
            None => {
                let seen = SeenTriangle::new(*corners, receiver.position);
                let uv = seen.sample(u);
                let surface = pose.point(&prototype.geometry().on_triangle(own, uv));
                let sends = |ray: &Ray, hit: &Hit| luminous.sent(geometry, ray, hit, &surface, || receiver.waves);
                let density = |direction: DVec3, distance| seen.pdf(distance, direction.dot(surface.normal));
                surface::sample(receiver, &surface, place, uv, density, sends)
            }
        }
    }

    /// Density with which [`Copied::sample`] samples the direction of a ray that hits a light; the cosine is that to
    /// the light's normal.
    pub fn pdf(
        &self,
        light: usize,
        geometry: &Geometry,
        receiver: &LightSampleContext,
        (ray, hit): (&Ray, &Hit),
        cosine: f64,
    ) -> f64 {
        let Light { primitive, inner, corners } = &self.lights[light];
        let Some((instances, instance)) = geometry.instance(*primitive) else { return 0.0 };
        match instances.prototype().geometry().shape(instances.prototype().split(*inner).0) {
            Some(shape) => {
                let Some(pose) = instances.pose(instance, 0.0) else { return 0.0 };
                let own = pose.enter(ray);
                let pdf = shape.pdf_of_met(own.origin, own.direction);
                if pdf > 0.0 { pdf * pose.crowding(ray.direction) } else { 0.0 }
            }
            None => SeenTriangle::new(*corners, receiver.position).pdf(hit.t, cosine),
        }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.lights.as_slice())
            + self.shapes.iter().map(|glow| size_of::<Glow>() + size_of_val(glow.flat.as_slice())).sum::<usize>()
    }
}

impl Prototype {
    /// Emission of a primitive, by its flattened number.
    fn luminous(&self, inner: u32) -> Luminous<'_> {
        let (material, emission) = self.appearance(inner);
        Luminous::new(emission, material)
    }

    /// The emissive primitives, flattened, in order, without those in instances.
    fn shining(&self) -> impl Iterator<Item = u32> {
        let own = |shape: &u32| self.geometry().instances_of(*shape).is_none();
        let flat = |shape: u32| {
            let primitives = self.geometry().primitives_of(shape);
            primitives.map(|primitive| self.flatten(&Hit { primitive, ..Hit::MISS }))
        };
        (0..self.geometry().shapes() as u32)
            .filter(own)
            .flat_map(flat)
            .filter(|&flat| !self.appearance(flat).1.is_dark())
    }
}

impl Light {
    fn new(geometry: &Geometry, instances: &Instances, primitive: u32, inner: u32) -> (Self, Strength) {
        let prototype = instances.prototype();
        let (own, luminous) = (prototype.split(inner).0, prototype.luminous(inner));
        let sides = luminous.emission.sides;
        let map =
            geometry.instance(primitive).and_then(|(instances, instance)| Some(instances.pose(instance, 0.0)?.map()));
        let (corners, strength) = match (map, prototype.geometry().shape(own)) {
            (None, _) => ([DVec3::NAN; 3], Strength::NONE),
            (Some(map), Some(shape)) => {
                let bounds = Bounds::of_support(|d| shape.support(map.transposed(d)) + map.shift.dot(d));
                let facing = shape.facing().and_then(|normal| map.normal(normal).try_normalize());
                let area = shape.area_under(&map);
                let strength = luminous
                    .strength(|radiance| Strength::of_shape(area, [bounds.min, bounds.max], facing, radiance, sides));
                ([DVec3::NAN; 3], strength)
            }
            (Some(map), None) => {
                let corners = prototype.geometry().corners(own).map(|corner| map.point(corner));
                let turned = map.determinant() < 0.0;
                (corners, luminous.strength(|radiance| Strength::of_triangle(corners, turned, radiance, sides)))
            }
        };
        (Self { primitive, inner, corners }, strength)
    }
}
