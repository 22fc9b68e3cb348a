//! Cones and their intersections.

use crate::Job;
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::{Bsdf, BsdfSample, Rgb};
use raywright_scene::{Geometry, SurfaceInteraction};
use raywright_shapes::triangle::SolidCone;

/// A cone and its weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    pub apex: DVec3,
    pub axis: DVec3,
    /// Half opening angle in radians.
    pub angle: f64,
    /// Plane where the cone begins: a normal n and an offset; the cone is the part where n · x exceeds it.
    pub beyond: Option<(DVec3, f64)>,
    pub weight: Rgb,
    /// Number of surfaces so far.
    pub bounce: u32,
    /// True for cones from rough surfaces, where lamps have been sampled already.
    pub is_dull: bool,
}

/// Minimum and maximum half angle in radians.
const ANGLES: [f64; 2] = [1e-7, 1.4];

impl Cone {
    /// Return the enclosing solid cone.
    pub fn solid(&self) -> Option<SolidCone> {
        SolidCone::new(self.apex, self.axis, self.angle.to_degrees(), f64::INFINITY)
    }
}

/// The intersection of a cone with a surface.
pub(super) struct ConeHit {
    pub ray: Ray,
    pub hit: Hit,
    /// Cone diameter there.
    pub width: f64,
    pub here: SurfaceInteraction,
}

impl ConeHit {
    /// Intersect a cone's ray in a direction with a primitive; `None` for a miss.
    pub fn new(job: &Job, cone: &Cone, primitive: u32, direction: DVec3) -> Option<Self> {
        let ray = Ray::new(cone.apex, direction);
        let hit = meet(job.scene.geometry(), &ray, primitive, cone.beyond)?;
        let width = 2.0 * hit.t * cone.angle.tan();
        let surface = job.scene.geometry().surface(&ray, &hit);
        Some(Self { ray, hit, width, here: SurfaceInteraction::new(job.scene, &ray, &hit, surface, width, 1.0) })
    }

    /// Return the emitted radiance of a surface toward a ray; `None` for a miss.
    pub fn shown(&self, job: &Job, ray: &Ray, primitive: u32) -> Option<Rgb> {
        let geometry = job.scene.geometry();
        let hit = meet(geometry, ray, primitive, None)?;
        let surface = geometry.surface(ray, &hit);
        Some(job.scene.emission_at(&surface).sent(geometry, ray, &hit, &surface, || 0.0))
    }

    /// Return the emitted radiance.
    pub fn own(&self, job: &Job) -> Rgb {
        let surface = self.here.surface();
        let emission = job.scene.emission_at(surface);
        if emission.is_dark() {
            return Rgb::ZERO;
        }
        emission.sent(job.scene.geometry(), &self.ray, &self.hit, surface, || self.width)
    }

    /// Return the reflected radiance of uniform incident radiance.
    pub fn ambient(&self, job: &Job, radiance: Rgb) -> Rgb {
        self.here.ambient(job.scene, &self.ray, &self.hit, self.width, 1.0) * radiance
    }

    /// Return the part of the albedo of [`ConeHit::ambient`] that is due to rough metals, for which cones are traced.
    pub fn dull_albedo(&self) -> Rgb {
        let mut albedo = Rgb::ZERO;
        self.here.bsdf().dull_lobes(|weight, metal| albedo += weight * metal.albedo());
        albedo
    }

    /// Visit the reflected, refracted and rough metal cones.
    ///
    /// The facets of a metal of roughness α have the median slope α, and light deviates by twice the facet's angle.
    /// Half of a uniform cone lies within its half angle over √2.
    pub fn goes_on(&self, cone: &Cone, share: f64, mut each: impl FnMut(Cone)) {
        self.here.bsdf().delta_lobes(self.here.wo(), |single| {
            let Some(BsdfSample { wi, weight, is_through, .. }) = self.here.to_world(single) else { return };
            let bent = if is_through { cone.angle } else { cone.angle + self.here.curvature() * self.width };
            each(self.onward(cone, (wi, is_through), bent, weight * share));
        });
        let (normal, way) = (self.here.shading_normal(), self.ray.direction);
        let mirrored = way - normal * (2.0 * normal.dot(way));
        if self.here.is_through(mirrored) {
            return;
        }
        self.here.bsdf().dull_lobes(|weight, metal| {
            let spread = 2.0 * std::f64::consts::SQRT_2 * metal.roughness().atan();
            let bent = cone.angle + self.here.curvature() * self.width;
            let weight = weight * metal.reflectance(self.here.cosine()) * share;
            let onward = self.onward(cone, (mirrored, false), bent.abs() + spread, weight);
            each(Cone { is_dull: true, ..onward });
        });
    }

    /// Return the cone that continues in a direction with a half angle.
    ///
    /// A surface of mean curvature H, hit by a cone of radius r, adds 2 H r to the half angle: neighboring normals
    /// differ by H r (Amanatides 1984). The new apex lies behind the surface, so that the radii agree there. Convergent
    /// light behind a concave mirror is replaced by equally divergent light.
    fn onward(&self, cone: &Cone, (wi, is_through): (DVec3, bool), bent: f64, weight: Rgb) -> Cone {
        let surface = self.here.surface();
        // The axis is reflected like the ray, about its intersection with the tangent plane. So a flat mirror reflects
        // the same cone from any point on it.
        let along = surface.normal.dot(surface.position - cone.apex) / surface.normal.dot(cone.axis);
        let is_near = along > 0.5 * self.hit.t && along < 2.0 * self.hit.t;
        let (axis, distance) = if is_near { (cone.axis, along) } else { (self.ray.direction, self.hit.t) };
        let angle = bent.abs().clamp(ANGLES[0], ANGLES[1]);
        let half = (wi - self.ray.direction).try_normalize().filter(|_| !is_through);
        let onward = half.map_or(axis, |half| axis - half * (2.0 * half.dot(axis)));
        let apex = cone.apex + axis * distance - onward * (distance * cone.angle.tan() / angle.tan());
        let normal = if surface.normal.dot(wi) < 0.0 { -surface.normal } else { surface.normal };
        let beyond = Some((normal, normal.dot(surface.position) + surface.error));
        let weight = cone.weight * weight;
        Cone { apex, axis: onward, angle, beyond, weight, bounce: cone.bounce + 1, is_dull: false }
    }
}

/// Intersect a ray with a primitive, or with the plane of a face inside its outline or nearest to it. Return `None` for
/// a miss, or if all intersections precede the start of the cone.
fn meet(geometry: &Geometry, ray: &Ray, primitive: u32, beyond: Option<(DVec3, f64)>) -> Option<Hit> {
    let is_beyond = |t: f64| beyond.is_none_or(|(normal, offset)| normal.dot(ray.at(t)) > offset);
    if let Some(shape) = geometry.shape(primitive) {
        let mut found = None;
        shape.meet(ray, &mut |candidate| {
            found = is_beyond(candidate.t).then_some(Hit { t: candidate.t, uv: candidate.uv, primitive, inner: 0 });
            found.is_some()
        });
        return found;
    }
    let normal = geometry.normal(primitive);
    let [a, ..] = geometry.corners(primitive);
    let t = normal.dot(a - ray.origin) / normal.dot(ray.direction);
    let is_met = t.is_finite() && t > 0.0;
    is_met.then(|| Hit { t, uv: geometry.weights(primitive, ray.at(t)), primitive, inner: 0 })
}
