//! A path's encounter with a surface.

use super::materials::Scattering;
use super::{Departure, Scene, ShadingPoint, SurfacePoint};
use crate::math::{DVec3, Frame, Hit, Ray};
use crate::optics::Rgb;

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
    scattering: Scattering,
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

    /// What a ray of unit direction meets at a hit; `width` is how wide the bundle of its neighbours is there.
    #[inline]
    pub fn new(scene: &Scene, ray: &Ray, hit: &Hit, surface: SurfacePoint, width: f64) -> Self {
        let material = scene.material_at(&surface);
        let point = ShadingPoint::new(scene.geometry(), ray, hit, &surface, material.needs(), width);
        let back = -ray.direction;
        let side = 1f64.copysign(back.dot(surface.normal));
        let normal = surface.normal * side;
        let shading = material.normal(&point).unwrap_or(surface.shading_normal);
        let is_smooth = shading == surface.normal;
        let mut shading = shading * side;
        let cosine = shading.dot(back);
        if cosine < Self::GRAZING && !is_smooth {
            shading = (shading + back * (Self::GRAZING - cosine)).normalize();
        }
        let frame = match material.tangent(&point) {
            Some(tangent) => Frame::along(shading, tangent),
            None => Frame::new(shading),
        };
        let scattering = material.scattering(&point);
        Self { surface, normal, frame, scattering, wo: frame.to_local(back) }
    }

    /// Looks up a hit and what is there.
    #[inline]
    pub fn at(scene: &Scene, ray: &Ray, hit: &Hit) -> Self {
        Self::new(scene, ray, hit, scene.geometry().surface(ray, hit), 0.0)
    }

    /// The point met.
    #[inline]
    pub fn position(&self) -> DVec3 {
        self.surface.position
    }

    /// The geometric normal on the side that the ray came from.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.normal
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
        self.scattering.evaluate(self.wo, wi)
    }

    /// Draws where the path goes on to: `choice` and `u` as [`Scattering::sample`] takes them.
    #[inline]
    pub fn sample(&self, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<Scattered> {
        let sample = self.scattering.sample(self.wo, choice, u)?;
        let direction = self.frame.to_world(sample.wi);
        (!self.crosses(sample.wi, direction)).then_some(Scattered { direction, weight: sample.weight, pdf: sample.pdf })
    }

    /// Whether a direction lies above the one normal and below the other.
    #[inline]
    fn crosses(&self, wi: DVec3, direction: DVec3) -> bool {
        wi.z * self.normal.dot(direction) <= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::sampling::{Sampler, warp};
    use crate::scene::fixtures::{rectangle, scene, shape};
    use crate::scene::{Mesh, SceneDescription};

    /// A floor with this shading normal.
    fn floor(normal: DVec3) -> Scene {
        let mesh = rectangle([-10.0, -10.0, 0.0], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0]);
        let mesh = Mesh { normals: Some(vec![normal.as_vec3(); 4]), ..mesh };
        scene(SceneDescription { shapes: vec![shape(mesh, [0.8; 3], 0.0)], ..Default::default() })
    }

    fn look(scene: &Scene, from: DVec3) -> Interaction {
        let ray = Ray::new(from, -from.normalize());
        let mut hits = [Hit::MISS];
        scene.intersect(&[ray], &mut hits);
        Interaction::at(scene, &ray, &hits[0])
    }

    #[test]
    fn nothing_goes_through_a_surface_and_nothing_is_nan() {
        for tilt in [0.0, 0.5, 1.0, 1.5, 1.57] {
            let floor = floor(DVec3::new(f64::sin(tilt), 0.0, f64::cos(tilt)));
            for draw in 0..1000 {
                let mut sampler = Sampler::new(1, 0, draw);
                let from = warp::uniform_sphere(sampler.two(0));
                let here = look(&floor, from);
                let other = warp::uniform_sphere(sampler.two(1));
                let (scattered, pdf) = here.evaluate(other);
                assert!(scattered.is_finite() && pdf.is_finite());
                assert!(scattered == Rgb::ZERO || other.z * from.z > 0.0, "light leaks");
                if let Some(next) = here.sample(|| 0.5, sampler.two(2)) {
                    assert!(next.direction.z * from.z > 0.0, "a path leaks");
                    assert!((next.direction.length() - 1.0).abs() < 1e-12);
                    let (scattered, pdf) = here.evaluate(next.direction);
                    assert!((scattered - next.weight * next.pdf).abs().max_element() < 1e-12);
                    assert!((pdf - next.pdf).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_surface_that_faces_the_viewer_is_not_black() {
        // Seen from beyond the horizon of the shading normal, from either side.
        let floor = floor(DVec3::new(0.8, 0.0, 0.6));
        for side in [1.0, -1.0] {
            let here = look(&floor, DVec3::new(-side, 0.0, 0.2 * side));
            assert!(here.evaluate(DVec3::new(0.6 * side, 0.0, 0.8 * side)).0.x > 0.1);
        }
    }

    #[test]
    fn both_sides_scatter_alike() {
        let floor = floor(Vec3::Z.as_dvec3());
        let towards = DVec3::new(0.6, 0.0, 0.8);
        let above = look(&floor, DVec3::new(0.1, 0.2, 1.0)).evaluate(towards);
        let below = look(&floor, DVec3::new(0.1, 0.2, -1.0)).evaluate(-towards);
        assert_eq!(above, below);
        assert!((above.0.x - 0.8 * 0.8 / std::f64::consts::PI).abs() < 1e-12);
    }
}
