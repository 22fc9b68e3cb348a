//! A path's encounter with a surface.

use super::{Departure, Scene, SurfacePoint};
use crate::math::{DVec3, Frame, Hit, Ray};
use crate::optics::{Bsdf, Rgb};

/// Where a ray has met a surface, seen from the side that it came from.
///
/// Scattering is computed in the shading frame, but which side of the surface a direction lies on is the geometric
/// normal's to say: otherwise light leaks through wherever the two normals disagree
/// (Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, 5.3).
#[derive(Clone, Debug)]
pub struct Interaction {
    surface: SurfacePoint,
    /// Geometric normal on the ray's side.
    normal: DVec3,
    /// Shading frame, its normal on the ray's side too.
    frame: Frame,
    bsdf: Bsdf,
    /// Back along the ray, in the shading frame.
    wo: DVec3,
}

/// A direction drawn from the scattering at a surface.
#[derive(Clone, Copy, Debug)]
pub struct Scattered {
    /// Where the path goes on to, as a unit vector of the world.
    pub direction: DVec3,
    /// What its throughput is multiplied by.
    pub weight: Rgb,
    /// Density in solid angle; infinite for a single direction.
    pub pdf: f64,
}

impl Interaction {
    /// The smallest cosine between shading normal and view. Beyond the horizon of the shading normal a surface would
    /// turn black though it faces the viewer, so there the normal is bent towards the viewer until it just faces him.
    const GRAZING: f64 = 1e-3;

    /// What a ray of unit direction meets at a hit.
    #[inline]
    pub fn new(scene: &Scene, ray: &Ray, surface: SurfacePoint) -> Self {
        let back = -ray.direction;
        let side = 1f64.copysign(back.dot(surface.normal));
        let normal = surface.normal * side;
        let mut shading = surface.shading_normal * side;
        let cosine = shading.dot(back);
        if cosine < Self::GRAZING && surface.shading_normal != surface.normal {
            shading = (shading + back * (Self::GRAZING - cosine)).normalize();
        }
        let frame = Frame::new(shading);
        let bsdf = scene.material(surface.shape).bsdf();
        Self { surface, normal, frame, bsdf, wo: frame.to_local(back) }
    }

    /// Looks up a hit and what is there.
    #[inline]
    pub fn at(scene: &Scene, ray: &Ray, hit: &Hit) -> Self {
        Self::new(scene, ray, scene.geometry().surface(hit))
    }

    /// The point met.
    #[inline]
    pub fn position(&self) -> DVec3 {
        self.surface.position
    }

    /// The shading normal on the side that the ray came from.
    #[inline]
    pub fn shading_normal(&self) -> DVec3 {
        self.frame.normal
    }

    /// Where rays leave from.
    #[inline]
    pub fn departure(&self) -> Departure {
        Departure::new(&self.surface)
    }

    /// Scattering function times cosine for light from a direction, and the density of [`Interaction::sample`] there.
    #[inline]
    pub fn evaluate(&self, direction: DVec3) -> (Rgb, f64) {
        let wi = self.frame.to_local(direction);
        if self.crosses(wi, direction) {
            return (Rgb::ZERO, 0.0);
        }
        (self.bsdf.evaluate(self.wo, wi), self.bsdf.pdf(self.wo, wi))
    }

    /// Draws where the path goes on to: `choice` and `u` as [`Bsdf::sample`] takes them.
    #[inline]
    pub fn sample(&self, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<Scattered> {
        let sample = self.bsdf.sample(self.wo, choice, u)?;
        let direction = self.frame.to_world(sample.wi);
        (!self.crosses(sample.wi, direction)).then_some(Scattered { direction, weight: sample.weight, pdf: sample.pdf })
    }

    /// Whether a direction lies above the one normal and below the other.
    #[inline]
    fn crosses(&self, wi: DVec3, direction: DVec3) -> bool {
        wi.z * self.normal.dot(direction) <= 0.0
    }
}
