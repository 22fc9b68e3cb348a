//! The other integrators, each against the light it leaves out and against path tracing.

use super::{assert_radiance, radiance, samples_of};
use crate::{AmbientOcclusion, Direct, Distributed, Integrator, Path, RayCast, Whitted};
use raywright_base::math::{DVec3, Ray};
use raywright_optics::{Conductor, Dielectric, Mirror, Rgb};
use raywright_scene::fixtures::{furnace, rectangle, scene, shape};
use raywright_scene::materials::BsdfMix;
use raywright_scene::textures::Needs;
use raywright_scene::{Light, Material, PointLight, Scene, SceneDescription, ShadingPoint, Shape};
use std::f64::consts::PI;
use std::sync::Arc;

/// A uniform BSDF.
#[derive(Debug)]
struct Of(BsdfMix);

impl Material for Of {
    fn bsdf(&self, _at: &ShadingPoint) -> BsdfMix {
        self.0.clone()
    }
    fn needs(&self) -> Needs {
        Needs::NONE
    }
    fn validate(&self) -> Result<(), String> {
        Ok(())
    }
}

pub(super) fn of(mesh: raywright_scene::Mesh, bsdf: impl Into<BsdfMix>) -> Shape {
    Shape { material: Arc::new(Of(bsdf.into())), ..shape(mesh, [0.0; 3], 0.0) }
}

pub(super) fn floor() -> raywright_scene::Mesh {
    rectangle([-9.0, -9.0, 0.0], [18.0, 0.0, 0.0], [0.0, 18.0, 0.0])
}

pub(super) const DOWN: Ray = Ray::new(DVec3::new(0.0, -0.6, 0.8), DVec3::new(0.0, 0.6, -0.8));

/// Radiance at the origin of a floor of albedo 0.8 under a square of side 2 and radiance 3 at height 1 (Lambert, 1760).
const LIT: f64 = 0.8 / PI * 3.0 * 1.740_839_502_734_206;

fn lit_floor() -> Scene {
    let lamp = rectangle([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]);
    let shapes = vec![shape(floor(), [0.8; 3], 0.0), shape(lamp, [0.0; 3], 3.0)];
    scene(SceneDescription { shapes, ..Default::default() })
}

#[test]
fn a_lamp_gives_lamberts_irradiance_to_each() {
    let ambient = Rgb::splat(0.5);
    let each: [(&dyn Integrator, f64); 9] = [
        (&Direct::default(), LIT),
        (&Direct { light_samples: 4, surface_samples: 1 }, LIT),
        (&Direct { light_samples: 1, surface_samples: 3 }, LIT),
        (&RayCast::default(), LIT),
        (&RayCast { ambient, light_samples: 3, ..RayCast::default() }, LIT + 0.4),
        (&Whitted::default(), LIT),
        (&Whitted { ambient, ..Whitted::default() }, LIT + 0.4),
        (&Distributed::default(), LIT),
        (&Distributed { ambient, splits: 2, ..Distributed::default() }, LIT + 0.4),
    ];
    for (integrator, expected) in each {
        assert_radiance(&lit_floor(), integrator, DOWN, 20_000, expected);
    }
}

#[test]
fn more_samples_take_less_than_as_many_paths() {
    let error = |light_samples, surface_samples| {
        radiance(&lit_floor(), &Direct { light_samples, surface_samples }, DOWN, 4000).1
    };
    // Four independent samples would halve it; stratified ones do better.
    assert!(error(4, 4) < 0.55 * error(1, 1));
}

#[test]
fn a_furnace_shows_as_many_bounces_as_are_followed() {
    let ray = Ray::new(DVec3::new(0.1, -0.2, 0.3), DVec3::new(0.48, 0.6, 0.64));
    let scene = furnace(0.5, 1.0);
    for integrator in [&Direct::default() as &dyn Integrator, &RayCast::default(), &Whitted::default()] {
        assert_radiance(&scene, integrator, ray, 60_000, 1.5);
    }
    assert_radiance(&scene, &Distributed::default(), ray, 40_000, 1.5);
}

/// A lamp of radiance 2 behind a pane of smooth glass, at normal incidence, and one of 5 in front of it.
fn window() -> Scene {
    let (behind, before) = (floor(), rectangle([-9.0, -9.0, 3.0], [0.0, 18.0, 0.0], [18.0, 0.0, 0.0]));
    let pane = rectangle([-9.0, -9.0, 1.0], [18.0, 0.0, 0.0], [0.0, 18.0, 0.0]);
    let shapes = vec![of(pane, Dielectric::new(1.5, 0.0)), shape(behind, [0.0; 3], 2.0), shape(before, [0.0; 3], 5.0)];
    scene(SceneDescription { shapes, ..Default::default() })
}

#[test]
fn whitted_follows_both_the_reflected_and_the_refracted_ray() {
    // Noise-free: 4 % of the front lamp and 96 % of the back lamp, whose radiance is scaled by the squared index.
    let ray = Ray::new(DVec3::new(0.1, 0.2, 2.0), DVec3::NEG_Z);
    let expected = 0.04 * 5.0 + 0.96 * 2.0 / 2.25;
    for value in samples_of(&window(), &Whitted::default(), ray, 10) {
        assert!((value[1] / expected - 1.0).abs() < f64::from(f32::EPSILON), "{value}");
    }
    assert_radiance(&window(), &Path::default(), ray, 60_000, expected);
    // Rays with a contribution below a tenth are not traced.
    let coarse = Whitted { contribution: 0.1, ..Whitted::default() };
    let (mean, _) = radiance(&window(), &coarse, ray, 10);
    assert!((mean / (0.96 * 2.0 / 2.25) - 1.0).abs() < f64::from(f32::EPSILON), "{mean}");
    // Nothing is traced at depth 0.
    assert_eq!(radiance(&window(), &Whitted { max_depth: 0, ..Whitted::default() }, ray, 10), (0.0, 0.0));
}

#[test]
fn mirrors_face_to_face_end_at_the_depth() {
    // Two mirrors of reflectance 0.5, one of them emissive: 1 + 1/4 + 1/16 ..., a term for each return to it.
    let up = rectangle([-9.0, -9.0, 0.0], [18.0, 0.0, 0.0], [0.0, 18.0, 0.0]);
    let down = rectangle([-9.0, -9.0, 1.0], [0.0, 18.0, 0.0], [18.0, 0.0, 0.0]);
    let mirror = Mirror { reflectance: Rgb::splat(0.5) };
    let shapes = vec![Shape { emission: Rgb::ONE.into(), ..of(up, mirror) }, of(down, mirror)];
    let scene = scene(SceneDescription { shapes, ..Default::default() });
    let ray = Ray::new(DVec3::new(0.1, 0.2, 0.5), DVec3::NEG_Z);
    for depth in [0, 1, 2, 3, 6] {
        let expected: f64 = (0..=depth / 2).map(|i| 0.25f64.powi(i as i32)).sum();
        let integrator = Whitted { max_depth: depth, contribution: 0.0, ..Whitted::default() };
        let (mean, _) = radiance(&scene, &integrator, ray, 4);
        assert!((mean - expected).abs() < 1e-12, "{depth}: {mean}, not {expected}");
        assert_radiance(
            &scene,
            &Path { max_depth: Some(depth), roulette_depth: 99, ..Path::default() },
            ray,
            4,
            expected,
        );
    }
}

#[test]
fn gloss_is_followed_and_matt_light_is_not() {
    // A rough metal under a lamp that fills its hemisphere: direct light agrees for both techniques, with paths
    // continued or not.
    let metal = Conductor::new(Rgb::splat(0.2), Rgb::splat(3.9), [0.15; 2]);
    let lamp = rectangle([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]);
    let shapes = vec![of(floor(), metal), shape(lamp, [0.0; 3], 3.0)];
    let scene = scene(SceneDescription { shapes, ..Default::default() });
    let (expected, error) = radiance(&scene, &Direct::default(), DOWN, 100_000);
    for splits in [1, 3] {
        let (mean, other) = radiance(&scene, &Distributed { splits, ..Distributed::default() }, DOWN, 60_000);
        assert!((mean - expected).abs() < 4.0 * error.hypot(other), "{mean} ± {other}, not {expected}");
    }
    let (mean, other) = radiance(&scene, &RayCast::default(), DOWN, 400_000);
    assert!((mean - expected).abs() < 4.0 * error.hypot(other), "{mean} ± {other}, not {expected}");
}

#[test]
fn a_point_light_is_asked_by_all() {
    let point = PointLight { position: DVec3::new(1.0, 0.0, 1.0), intensity: Rgb::ONE };
    let lights: Vec<Arc<dyn Light>> = vec![Arc::new(point)];
    let lit = scene(SceneDescription { shapes: vec![shape(floor(), [0.5; 3], 0.0)], lights });
    let expected = 0.5 * 0.353_553_390_593_273_73 / PI;
    let each: [&dyn Integrator; 5] =
        [&Path::default(), &Direct::default(), &RayCast::default(), &Whitted::default(), &Distributed::default()];
    for integrator in each {
        let (mean, _) = radiance(&lit, integrator, DOWN, 10);
        // Stages compute in f32.
        assert!((mean / expected - 1.0).abs() < 4.0 * f64::from(f32::EPSILON), "{mean}, not {expected}");
    }
}

#[test]
fn a_corner_occludes_half_its_surroundings() {
    // At the foot of an infinite perpendicular wall, half of uniform light is occluded; surfaces beyond the radius do
    // not count.
    let wall = rectangle([-900.0, 1e-3, 0.0], [1800.0, 0.0, 0.0], [0.0, 0.0, 900.0]);
    let shapes = vec![shape(floor(), [0.0; 3], 0.0), shape(wall, [0.0; 3], 0.0)];
    let scene = scene(SceneDescription { shapes, ..Default::default() });
    let ray = Ray::new(DVec3::new(0.0, -0.6, 0.8), DVec3::new(0.0, 0.6, -0.8));
    for cosine in [true, false] {
        let open = AmbientOcclusion { cosine, samples: 4, ..AmbientOcclusion::default() };
        let (mean, error) = radiance(&scene, &open, ray, 20_000);
        assert!((mean - 0.5).abs() < 4.0 * error + 2e-3, "{mean} ± {error}");
        assert_eq!(radiance(&scene, &AmbientOcclusion { radius: 9e-4, ..open }, ray, 100).0, 1.0);
    }
    // Rays that hit nothing are unoccluded.
    assert_eq!(radiance(&scene, &AmbientOcclusion::default(), Ray::new(DVec3::Z, DVec3::Z), 10), (1.0, 0.0));
}
