//! Cones on their way, and what they meet.

use crate::Job;
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::{Bsdf, BsdfSample, Rgb};
use raywright_scene::{Geometry, SurfaceInteraction};
use raywright_shapes::triangle::SolidCone;

/// A cone, and how much what it meets counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    pub apex: DVec3,
    pub axis: DVec3,
    /// Of half its opening, in radians.
    pub angle: f64,
    /// Where it begins: a normal n and an offset, and only where n · x is above it.
    pub beyond: Option<(DVec3, f64)>,
    pub weight: Rgb,
    /// How many surfaces it has met.
    pub bounce: u32,
    /// Whether a rough surface has sent it, which has asked lamps itself.
    pub is_dull: bool,
}

/// The least half angle of a cone, in radians, and the greatest.
const ANGLES: [f64; 2] = [1e-7, 1.4];

impl Cone {
    /// The cone that all of it is in.
    pub fn solid(&self) -> Option<SolidCone> {
        SolidCone::new(self.apex, self.axis, self.angle.to_degrees(), f64::INFINITY)
    }
}

/// Where a cone meets a surface.
pub(super) struct Meeting {
    pub ray: Ray,
    pub hit: Hit,
    /// The cone's diameter there.
    pub width: f64,
    pub here: SurfaceInteraction,
}

impl Meeting {
    /// What a cone meets of a primitive along a direction; `None` if that misses it.
    pub fn new(job: &Job, cone: &Cone, primitive: u32, direction: DVec3) -> Option<Self> {
        let ray = Ray::new(cone.apex, direction);
        let hit = meet(job.scene.geometry(), &ray, primitive, cone.beyond)?;
        let width = 2.0 * hit.t * cone.angle.tan();
        let surface = job.scene.geometry().surface(&ray, &hit);
        Some(Self { ray, hit, width, here: SurfaceInteraction::new(job.scene, &ray, &hit, surface, width, 1.0) })
    }

    /// The radiance that a surface that shines shows to a ray; `None` if that misses it.
    pub fn shown(&self, job: &Job, ray: &Ray, primitive: u32) -> Option<Rgb> {
        let geometry = job.scene.geometry();
        let hit = meet(geometry, ray, primitive, None)?;
        let surface = geometry.surface(ray, &hit);
        Some(job.scene.emission_at(&surface).sent(geometry, ray, &hit, &surface, || 0.0))
    }

    /// The radiance that the surface itself shines with.
    pub fn own(&self, job: &Job) -> Rgb {
        let surface = self.here.surface();
        let emission = job.scene.emission_at(surface);
        if emission.is_dark() {
            return Rgb::ZERO;
        }
        emission.sent(job.scene.geometry(), &self.ray, &self.hit, surface, || self.width)
    }

    /// What is sent back of an even light.
    pub fn ambient(&self, job: &Job, radiance: Rgb) -> Rgb {
        self.here.ambient(job.scene, &self.ray, &self.hit, self.width, 1.0) * radiance
    }

    /// The part of [`Meeting::ambient`]'s share that rough metals have, which cones follow.
    pub fn dull_albedo(&self) -> Rgb {
        let mut albedo = Rgb::ZERO;
        self.here.bsdf().dull_lobes(|weight, metal| albedo += weight * metal.albedo());
        albedo
    }

    /// Calls with the cones that go on as from a mirror or through a pane, and those of rough metals.
    ///
    /// The facets of a metal of roughness α deviate by more than atan α as often as by less, and light by twice that;
    /// of an even cone half is within its half angle over √2.
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

    /// The cone that goes on to a direction, with a half angle.
    ///
    /// A surface of mean curvature H, met by a cone of radius r, adds 2 H r to its half angle: neighbouring normals
    /// differ by H r (Amanatides 1984). So it starts at an apex behind the surface, with its radius there; light that
    /// comes together behind a hollow mirror is taken to spread as much instead.
    fn onward(&self, cone: &Cone, (wi, is_through): (DVec3, bool), bent: f64, weight: Rgb) -> Cone {
        let surface = self.here.surface();
        // The axis is thrown back as the ray is, from where it meets the plane that touches the surface: so a flat
        // mirror shows the very cone, whichever part of it is met.
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

/// Where a ray meets a primitive, or the plane of a face within its outline or nearest to it; `None` where it does not,
/// or only before the cone begins.
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
