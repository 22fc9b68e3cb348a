//! Cone tracing.

mod cone;
mod lamps;

use super::{CameraSample, Integrator, Job, Session, Worker};
use cone::{Cone, ConeHit};
use lamps::{Lamp, lamps, light};
use raywright_base::math::DVec3;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{Camera, ConeFilter, Coverage, Perspective, Scene};

/// Cone tracing (Amanatides, "Ray Tracing with Cones", 1984): one cone per pixel, of its solid angle, instead of
/// samples. Surfaces are weighted by the share of the cone that they cover, nearest first. Area lamps have soft shadows
/// by the unoccluded share of the cone to them. Mirrors reflect cones, wider if curved, and rough metals widen them by
/// their roughness. So one sample has no noise.
///
/// It has the limits of Whitted ray tracing, and approximations of the paper that require small cones: a surface is
/// shaded at one point within a cone, and spheres dim their background uniformly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeTraced {
    /// Maximum number of surfaces on a path of light.
    pub max_depth: u32,
    /// Minimum contribution of a cone to its pixel in any color; others are not traced.
    pub contribution: f64,
    /// Uniform incident radiance that replaces light not traced. Surfaces reflect their ambient share of it
    /// ([`Material::ambient`](raywright_scene::Material::ambient)).
    pub ambient: Rgb,
}

impl Default for ConeTraced {
    fn default() -> Self {
        Self { max_depth: 8, contribution: 1.0 / 512.0, ambient: Rgb::ZERO }
    }
}

impl Integrator for ConeTraced {
    fn begin<'a>(&'a self, job: Job<'a>, _cancel: &Cancel) -> Box<dyn Session + 'a> {
        let coverage = Coverage::new(job.scene).ok();
        Box::new(Tracing { settings: *self, lamps: lamps(&job), job, coverage })
    }

    fn objection(&self, scene: &Scene, _: bool) -> Option<String> {
        if let Err(shape) = Coverage::new(scene) {
            return Some(format!(
                "cones support only meshes and spheres, and shape {shape} is neither: use Distributed"
            ));
        }
        let unsuited = |shape: u32| {
            let material = scene.material(shape);
            let masked = (!material.is_opaque()).then_some("has a mask, which cones do not support");
            masked.or(material.interior().map(|_| "is of glass, and cones do not support refraction"))
        };
        let mut shapes = 0..scene.geometry().shapes() as u32;
        if let Some((shape, why)) = shapes.find_map(|shape| Some((shape, unsuited(shape)?))) {
            return Some(format!("shape {shape} {why}: use Distributed"));
        }
        let is_around = scene.lights().others().any(|light| light.place().is_none());
        is_around.then(|| "cones do not support environments: use Distributed".into())
    }

    fn view_objection(&self, camera: &dyn Camera, filter_radius: f64) -> Option<String> {
        if camera.as_perspective().is_none() {
            return Some("cones support only a pinhole camera that does not move: use a Camera, or Distributed".into());
        }
        (filter_radius != 0.5).then(|| "cones average each pixel over its square: use BoxFilter()".into())
    }
}

/// Data shared by the workers of a picture.
struct Tracing<'a> {
    settings: ConeTraced,
    job: Job<'a>,
    lamps: Vec<Lamp>,
    /// `None` for scenes that cones cannot intersect.
    coverage: Option<Coverage<'a>>,
}

/// Return the cone of a pixel: around the ray through its center, with the solid angle of its square.
fn of_pixel(camera: &Perspective, [x, y]: [f64; 2]) -> Cone {
    let corner = |dx: f64, dy: f64| camera.ray_through(x + dx, y + dy).direction;
    let middle = camera.ray_through(x + 0.5, y + 0.5);
    let [a, b, c, d] = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
    let triangle = |p: DVec3, q: DVec3, r: DVec3| {
        // Computed from differences, which keep the precision of small angles.
        2.0 * p.dot((q - p).cross(r - p)).abs().atan2(1.0 + p.dot(q) + q.dot(r) + r.dot(p))
    };
    let solid_angle = triangle(a, b, c) + triangle(a, c, d);
    let angle = 2.0 * (solid_angle / (4.0 * std::f64::consts::PI)).sqrt().asin();
    Cone {
        apex: middle.origin,
        axis: middle.direction,
        angle,
        beyond: None,
        weight: Rgb::ONE,
        bounce: 0,
        is_dull: false,
    }
}

impl Tracing<'_> {
    /// Return the mean radiance of a pixel.
    fn pixel(&self, pixel: u32) -> Rgb {
        let (Some(coverage), Some(camera)) = (&self.coverage, self.job.camera.as_perspective()) else {
            return Rgb::ZERO;
        };
        let width = camera.width();
        let mut cones = vec![of_pixel(camera, [f64::from(pixel % width), f64::from(pixel / width)])];
        let mut radiance = Rgb::ZERO;
        while let Some(cone) = cones.pop() {
            let Some(solid) = cone.solid() else { continue };
            let counted = ConeFilter { beyond: cone.beyond, ..ConeFilter::default() };
            coverage.meet(&solid, counted, |covering| {
                let Some(met) = ConeHit::new(&self.job, &cone, covering.primitive, covering.direction) else {
                    return;
                };
                if !cone.is_dull {
                    radiance += cone.weight * covering.share * met.own(&self.job);
                }
                if cone.bounce >= self.settings.max_depth {
                    return;
                }
                let mut sent = light(&self.job, coverage, &self.lamps, &met);
                if !self.settings.ambient.is_black() {
                    let followed = cone.bounce + 1 < self.settings.max_depth;
                    let dull = if followed { met.dull_albedo() } else { Rgb::ZERO };
                    let ambient = self.settings.ambient;
                    sent += (met.ambient(&self.job, ambient) - dull * ambient).at_least(Rgb::ZERO);
                }
                radiance += cone.weight * covering.share * sent;
                met.goes_on(&cone, covering.share, |next| {
                    let counts = !next.weight.is_black() && next.weight.max() >= self.settings.contribution;
                    if counts {
                        cones.push(next);
                    }
                });
            });
        }
        radiance
    }
}

impl Session for Tracing<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(ConeWorker(self))
    }
}

/// The worker that shades pixels.
struct ConeWorker<'a>(&'a Tracing<'a>);

impl Worker for ConeWorker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        for (sample, radiance) in samples.iter().zip(radiance) {
            if cancel.is_raised() {
                return;
            }
            *radiance = self.0.pixel(sample.sampler.pixel());
        }
    }
}
