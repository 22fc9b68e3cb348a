//! Partially transparent masks.

use super::{assert_radiance, radiance};
use crate::{Integrator, Path, RayCast};
use raywright_base::math::{DVec3, Ray};
use raywright_optics::{Diffuse, Rgb};
use raywright_scene::fixtures::{rectangle, scene, shape};
use raywright_scene::materials::BsdfMix;
use raywright_scene::textures::{Needs, TexturePoint};
use raywright_scene::{Material, PointLight, SceneDescription, ShadingPoint, Shape};
use std::f64::consts::PI;
use std::sync::Arc;

/// A black veil.
#[derive(Debug)]
struct Veil(f64);

impl Material for Veil {
    fn bsdf(&self, _at: &ShadingPoint) -> BsdfMix {
        Diffuse { reflectance: Rgb::ZERO }.into()
    }
    fn needs(&self) -> Needs {
        Needs::NONE
    }
    fn validate(&self) -> Result<(), String> {
        Ok(())
    }
    fn opacity(&self, _at: &TexturePoint) -> f64 {
        self.0
    }
    fn is_opaque(&self) -> bool {
        false
    }
}

fn sheet(height: f32) -> raywright_scene::Mesh {
    rectangle([-50.0, -50.0, height], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0])
}

fn veil(height: f32, opacity: f64) -> Shape {
    Shape { material: Arc::new(Veil(opacity)), ..shape(sheet(height), [0.0; 3], 0.0) }
}

const DOWN: Ray = Ray::new(DVec3::new(0.1, 0.2, 5.0), DVec3::new(0.0, 0.6, -0.8));

#[test]
fn veils_multiply() {
    let lamp = || shape(sheet(0.0), [0.0; 3], 2.0);
    let at = |veils: Vec<Shape>| {
        scene(SceneDescription { shapes: veils.into_iter().chain([lamp()]).collect(), ..Default::default() })
    };
    for path in [Path::default(), Path { max_depth: Some(0), ..Path::default() }] {
        assert_radiance(&at(vec![veil(1.0, 0.25)]), &path, DOWN, 60_000, 1.5);
        let three = vec![veil(1.0, 0.25), veil(1.000_001, 0.5), veil(2.0, 0.1)];
        assert_radiance(&at(three), &path, DOWN, 200_000, 2.0 * 0.75 * 0.5 * 0.9);
        // Fully transparent, and fully opaque.
        assert_radiance(&at(vec![veil(1.0, 0.0), veil(2.0, 0.0)]), &path, DOWN, 100, 2.0);
        assert_eq!(radiance(&at(vec![veil(1.0, 1.0)]), &path, DOWN, 100), (0.0, 0.0));
        // Coincident surfaces count once.
        assert_radiance(&at(vec![veil(1.0, 0.25), veil(1.0, 0.25)]), &path, DOWN, 60_000, 1.5);
    }
}

#[test]
fn light_is_dimmed_by_veils_on_its_way() {
    // A lamp above two veils, and a ray that starts below both.
    let point = PointLight { position: DVec3::new(0.0, 0.0, 4.0), intensity: Rgb::ONE };
    let floor = shape(sheet(0.0), [0.5; 3], 0.0);
    let shapes = vec![veil(2.0, 0.4), veil(3.0, 0.5), floor];
    let lit = scene(SceneDescription { shapes, lights: vec![Arc::new(point)] });
    let ray = Ray::new(DVec3::new(0.0, -0.6, 0.8), DVec3::new(0.0, 0.6, -0.8));
    let expected = 0.5 / PI / 16.0 * 0.6 * 0.5;
    // Both are in f32.
    for integrator in [&Path::default() as &dyn Integrator, &RayCast::default()] {
        let (mean, _) = radiance(&lit, integrator, ray, 50);
        assert!((mean / expected - 1.0).abs() < 4.0 * f64::from(f32::EPSILON), "{mean}, not {expected}");
    }
    let (mean, _) = radiance(&lit, &RayCast { shadows: false, ..RayCast::default() }, ray, 50);
    assert!((mean / expected * 0.3 - 1.0).abs() < 4.0 * f64::from(f32::EPSILON), "{mean}");
}
