//! Rendering of a radiosity solution.

use super::{CameraSample, Integrator, Job, Session, Worker};
use raywright_accel::Primitives;
use raywright_base::math::{Hit, Ray};
use raywright_base::workers::Cancel;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Patches, Scene, SurfaceInteraction};
use std::f64::consts::FRAC_1_PI;

/// Renders the irradiance of the patches at camera rays' hits, reflected by the surface, and its emission: one ray per
/// sample, from any camera. Textures are evaluated at the hit, not averaged over a patch.
#[derive(Clone, Debug)]
pub struct Radiosity {
    /// Patches of the scene, including all copies.
    pub patches: Patches,
    /// Index of the first of `patches`' primitives for each primitive of the scene, with their count at the end. A copy
    /// of a prototype has all of its primitives.
    pub first: Vec<u32>,
    /// For each of `patches`' primitives, true if mirrored: the second and third corner are swapped.
    pub mirrored: Vec<bool>,
    /// True if `irradiance` also has the back sides, after the front sides; else backs are black.
    pub has_backs: bool,
    /// Irradiance at the three corners of each side of a patch, W/m², linear in between.
    pub irradiance: Vec<[Rgb; 3]>,
    /// Total area of the patches outside copies, which detects another scene.
    pub area: f64,
}

impl Integrator for Radiosity {
    fn begin<'a>(&'a self, job: Job<'a>, _cancel: &Cancel) -> Box<dyn Session + 'a> {
        Box::new(RadiositySession { solution: self, scene: job.scene })
    }

    fn objection(&self, scene: &Scene, _adaptive: bool) -> Option<String> {
        let geometry = scene.geometry();
        let count = geometry.count();
        let faces = self.first.len() - 1;
        if count != faces {
            return Some(format!("the radiosity is of a scene with {faces} faces, this one has {count}: solve again"));
        }
        // The area of copies is not available, but the number of their faces is.
        let mut area = 0.0;
        for primitive in 0..count as u32 {
            let (shape, _) = geometry.locate(primitive);
            let [first, next] = [0, 1].map(|more| self.first[primitive as usize + more]);
            let inside = geometry.instances_of(shape).map(|copies| copies.prototype().count());
            if next - first != inside.unwrap_or(1) {
                return Some(format!("the radiosity is of a scene with another shape {shape}: solve again"));
            }
            // Surfaces that are not finite are never hit, and have no area in the solution.
            let own = if inside.is_none() { geometry.area(primitive) } else { 0.0 };
            area += if own.is_finite() { own } else { 0.0 };
        }
        let is_same = (area - self.area).abs() <= 1e-9 * self.area;
        (!is_same).then(|| {
            format!("the radiosity is of a scene with area {:.6}, this one has {area:.6}: solve again", self.area)
        })
    }
}

/// A solution with its scene.
struct RadiositySession<'a> {
    solution: &'a Radiosity,
    scene: &'a Scene,
}

impl Session for RadiositySession<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(RadiosityWorker { shown: self, rays: Vec::new(), hits: Vec::new() })
    }
}

impl RadiositySession<'_> {
    fn radiance(&self, ray: &Ray, hit: &Hit) -> Rgb {
        if !hit.is_hit() {
            return self.scene.lights().infinite_radiance(ray.direction);
        }
        let geometry = self.scene.geometry();
        let surface = geometry.surface(ray, hit);
        let emission = self.scene.emission_at(&surface).sent(geometry, ray, hit, &surface, || 0.0);
        let primitive = self.solution.first[hit.primitive as usize] + hit.inner;
        let [u, v] = hit.uv;
        let uv = if self.solution.mirrored[primitive as usize] { [v, u] } else { [u, v] };
        let (patch, [u, v]) = self.solution.patches.find(primitive, uv);
        let is_front = surface.is_front(ray);
        if !is_front && !self.solution.has_backs {
            return emission;
        }
        let patch = patch as usize + if is_front { 0 } else { self.solution.patches.count() };
        let [a, b, c] = self.solution.irradiance[patch];
        // Coordinates of other primitives than triangles are no weights, but their corners are equal.
        let irradiance = a + (b - a) * u + (c - a) * v;
        let here = SurfaceInteraction::new(self.scene, ray, hit, surface, 0.0, 1.0);
        emission + here.bsdf().diffuse().unwrap_or(Rgb::ZERO) * irradiance * FRAC_1_PI
    }
}

struct RadiosityWorker<'a> {
    shown: &'a RadiositySession<'a>,
    rays: Vec<Ray>,
    hits: Vec<Hit>,
}

impl Worker for RadiosityWorker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        if cancel.is_raised() {
            return;
        }
        self.rays.clear();
        self.rays.extend(samples.iter().map(|sample| sample.ray));
        self.hits.clear();
        self.hits.resize(self.rays.len(), Hit::MISS);
        self.shown.scene.intersect(&self.rays, &mut self.hits);
        for ((radiance, ray), hit) in radiance.iter_mut().zip(&self.rays).zip(&self.hits) {
            *radiance = self.shown.radiance(ray, hit);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;
    use raywright_scene::Camera;
    use raywright_scene::fixtures::cornell;

    #[test]
    fn a_picture_shows_what_is_emitted_and_reflected() {
        let (scene, camera) = cornell(16, 16);
        let patches = Patches::new(vec![2; scene.geometry().count()]).unwrap();
        let irradiance = vec![[Rgb::splat(2.0); 3]; patches.count()];
        let area = (0..scene.geometry().count() as u32).map(|p| scene.geometry().area(p)).sum();
        let count = patches.primitives();
        let (first, mirrored) = ((0..=count as u32).collect(), vec![false; count]);
        let radiosity = Radiosity { patches, first, mirrored, has_backs: false, irradiance, area };
        assert_eq!(radiosity.objection(&scene, false), None);
        let other = Radiosity { area: 2.0 * area, ..radiosity.clone() };
        assert!(other.objection(&scene, false).unwrap().contains("area"));
        let session = radiosity.begin(Job::new(&scene, &camera, 0, 1), &Cancel::default());
        let rays = (0..256).map(|i| camera.ray([f64::from(i % 16) + 0.5, f64::from(i / 16) + 0.5], [0.5; 2], 0.0).ray);
        let mut samples: Vec<_> = rays.map(|ray| CameraSample { ray, sampler: Sampler::new(0, 0, 0) }).collect();
        let mut seen = vec![Rgb::ZERO; 256];
        session.worker().radiance(&mut samples, &Cancel::default(), &mut seen);
        // White walls, and the lamp, which reflects nothing.
        assert!(seen.iter().any(|light| (light.mean() - 2.0 * 0.73 * FRAC_1_PI).abs() < 1e-12));
        assert!(seen.iter().any(|light| (light.mean() - 15.0).abs() < 1e-12));
    }
}
