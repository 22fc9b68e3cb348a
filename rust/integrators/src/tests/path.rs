//! Path tracing.

use super::{assert_radiance, job, radiance, samples_of};
use crate::{CameraSample, Integrator, Path};
use raywright_accel::{Accelerator, BruteForce, Primitives};
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::Sampler;
use raywright_base::simd::Level;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::fixtures::{furnace, inward_box, rectangle, scene, shape};
use raywright_scene::{ConstantEnvironment, Instances, Matrix, PointLight, Prototype, Scene, SceneDescription, Shape};
use std::sync::Arc;

const ANYWHERE: Ray = Ray::new(DVec3::new(0.1, -0.2, 0.3), DVec3::new(0.48, 0.6, 0.64));

#[test]
fn a_furnace_shines_by_its_geometric_series() {
    for albedo in [0.0, 0.1, 0.5, 0.8, 0.9] {
        assert_radiance(&furnace(albedo, 2.0), &Path::default(), ANYWHERE, 50_000, 2.0 / (1.0 - albedo));
    }
}

#[test]
fn a_furnace_shines_so_many_bounces() {
    let scene = furnace(0.5, 1.0);
    for depth in 0..4 {
        let path = Path { max_depth: Some(depth), roulette_depth: u32::MAX, ..Path::default() };
        assert_radiance(&scene, &path, ANYWHERE, 20_000, 2.0 - 0.5f64.powi(depth as i32));
    }
}

#[test]
fn a_furnace_of_copies_shines_as_one_of_walls() {
    // Six instances of one wall with different transforms, in a copy that is still or deforms. Light is found by BSDF
    // sampling alone, and rays that leave such walls must not hit them again.
    let wall = Prototype::new(
        vec![shape(rectangle([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]), [0.5; 3], 2.0)],
        brute,
    );
    let place = |x: DVec3, y: DVec3, z: DVec3| -> Matrix {
        let at = -1.5 * z / z.length();
        std::array::from_fn(|i| [1.5 * x[i], 1.5 * y[i], z[i], at[i]])
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let walls = [
        place(x, y, z),
        place(y, x, -z),
        place(y, z, 3.0 * x),
        place(z, y, -x),
        place(z, x, y),
        place(x, z, -1e-3 * y),
    ];
    let walls = Instances::new(Arc::new(wall.unwrap()), &walls).unwrap();
    let walls = vec![Shape { surface: walls.into(), ..Shape::default() }];
    let room = Arc::new(Prototype::new(walls, brute).unwrap());
    let whole: Matrix = [[30.0, 4.0, 0.0, 7.0], [-1.0, 0.1, 0.0, 1e4], [0.0, 0.2, 1e-2, -5.0]];
    let start: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    for instances in [Instances::new(room.clone(), &[whole]), Instances::moving(room.clone(), vec![[start, whole]])] {
        let shapes = vec![Shape { surface: instances.unwrap().into(), ..Shape::default() }];
        let scene = Scene::new(SceneDescription { shapes, ..Default::default() }, brute).unwrap();
        let ray = Ray { origin: DVec3::new(10.8, 1e4 - 0.08, -4.957), time: 1.0, ..ANYWHERE };
        assert_radiance(&scene, &Path::default(), ray, 20_000, 4.0);
    }
}

fn brute(geometry: &dyn Primitives) -> Box<dyn Accelerator> {
    BruteForce::over(geometry, Level::Scalar)
}

#[test]
fn roulette_changes_no_mean() {
    let [left, right, floor, ceiling, back, front] = inward_box([-1.0; 3], [2.0; 3]);
    let mut shapes: Vec<_> = [left, right, floor, back, front].map(|m| shape(m, [0.7; 3], 0.0)).into();
    shapes.push(shape(ceiling, [0.3; 3], 1.0));
    let scene = scene(SceneDescription { shapes, ..Default::default() });
    let run = |roulette_depth| {
        let path = Path { max_depth: Some(60), roulette_depth, ..Path::default() };
        radiance(&scene, &path, Ray { direction: DVec3::new(0.6, -0.8, 0.0), ..ANYWHERE }, 60_000)
    };
    let (expected, error) = run(u32::MAX);
    for depth in [0, 1, 3, 10] {
        let (mean, other) = run(depth);
        assert!((mean - expected).abs() < 4.0 * error.hypot(other), "{depth}: {mean} not {expected}");
    }
}

#[test]
fn a_bright_furnace_leaves_no_heavy_tail() {
    // Path lengths have the mean 1000 and the standard deviation 1000, and so have the contributions.
    let (mean, error) = radiance(&furnace(0.999, 0.1), &Path::default(), ANYWHERE, 2000);
    assert!((mean - 100.0).abs() < 4.0 * error, "{mean} ± {error}");
    assert!(error < 2.0 * 100.0 / 2000f64.sqrt(), "{error}");
}

#[test]
fn a_furnace_that_loses_nothing_ends() {
    let (mean, _) = radiance(&furnace(1.0, 0.0), &Path::default(), ANYWHERE, 100);
    assert_eq!(mean, 0.0);
}

#[test]
fn a_floor_reflects_the_irradiance_of_a_disk() {
    // Radius 1 at height 1, centered: E = π L r² / (r² + h²) = π/2 L (Howell, C-41 with one small disk). The disk is a
    // polygon of 720 sides of equal area, and the floor has an albedo of 0.8.
    let sides = 720u32;
    let radius = (std::f64::consts::TAU / f64::from(sides) / (std::f64::consts::TAU / f64::from(sides)).sin()).sqrt();
    let corner = |i: u32| {
        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(sides)).sin_cos();
        DVec3::new(radius * cos, radius * sin, 1.0).as_vec3()
    };
    let mut disk = rectangle([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    disk.vertices = (0..sides).map(corner).chain([DVec3::Z.as_vec3()]).collect();
    disk.faces = (0..sides).map(|i| [sides, (i + 1) % sides, i]).collect();
    let floor = rectangle([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    let shapes = vec![shape(floor, [0.8; 3], 0.0), shape(disk, [0.0; 3], 3.0)];
    let scene = scene(SceneDescription { shapes, ..Default::default() });
    let ray = Ray::segment(DVec3::new(0.3, 0.0, 0.4), DVec3::ZERO);
    let ray = Ray { direction: ray.direction.normalize(), t_max: f64::INFINITY, ..ray };
    assert_radiance(&scene, &Path::default(), ray, 20_000, 0.8 * 3.0 / 2.0);
}

#[test]
fn a_point_and_the_sky_light_a_floor() {
    let floor = || vec![shape(rectangle([-9.0, -9.0, 0.0], [18.0, 0.0, 0.0], [0.0, 18.0, 0.0]), [0.5; 3], 0.0)];
    let ray = Ray::new(DVec3::new(0.0, 0.3, 0.4), DVec3::new(0.0, -0.6, -0.8));
    let point = PointLight { position: DVec3::new(1.0, 0.0, 1.0), intensity: Rgb::ONE };
    let points = scene(SceneDescription { shapes: floor(), lights: vec![Arc::new(point)] });
    let expected = 0.5 * 0.353_553_390_593_273_73 / std::f64::consts::PI;
    assert_radiance(&points, &Path::default(), ray, 10, expected);
    let sky = scene(SceneDescription {
        shapes: floor(),
        lights: vec![Arc::new(ConstantEnvironment { radiance: Rgb::splat(2.0) })],
    });
    assert_radiance(&sky, &Path::default(), ray, 1000, 1.0);
    // A ray that hits nothing sees the sky itself.
    assert_radiance(&sky, &Path::default(), Ray::new(DVec3::Z, DVec3::Z), 2, 2.0);
}

#[test]
fn a_sample_does_not_depend_on_its_batch() {
    let scene = furnace(0.7, 1.0);
    let samples: Vec<_> = (0..100).map(|n| CameraSample { ray: ANYWHERE, sampler: Sampler::new(8, n, n) }).collect();
    let run = |size: usize| {
        let path = Path::default();
        let session = path.begin(job(&scene), &Cancel::default());
        let mut worker = session.worker();
        let mut all = Vec::new();
        for batch in samples.chunks(size) {
            let mut values = vec![Rgb::ZERO; batch.len()];
            worker.radiance(&mut batch.to_vec(), &Cancel::default(), &mut values);
            all.extend(values);
        }
        all
    };
    assert_eq!(run(1), run(100));
    assert_eq!(run(7), run(100));
}

#[test]
fn no_film_has_nan_however_bright_or_dim_or_small_the_light() {
    // A lamp of any strength and size over a floor: the light is proportional to its radiance.
    let floor = || shape(rectangle([-9.0, -9.0, 0.0], [18.0, 0.0, 0.0], [0.0, 18.0, 0.0]), [0.5; 3], 0.0);
    let ray = Ray::new(DVec3::new(0.0, 0.3, 0.4), DVec3::new(0.0, -0.6, -0.8));
    for (side, strength) in [(1e-6f32, 1e12), (1e-6, 1e30), (1e-3, 1e-30), (1e-10, 1e20)] {
        let lamp = rectangle([-0.5 * side, -0.5 * side, 1.0], [0.0, side, 0.0], [side, 0.0, 0.0]);
        let shapes = vec![floor(), shape(lamp, [0.0; 3], strength)];
        let scene = scene(SceneDescription { shapes, ..Default::default() });
        let values = samples_of(&scene, &Path::default(), ray, 1000);
        assert!(values.iter().all(|rgb| rgb.is_finite()));
        // Approximated by a point vertically above: E = L A / h².
        let side = f64::from(side);
        let expected = 0.5 / std::f64::consts::PI * strength * side * side;
        let mean = values.iter().map(|rgb| rgb[1]).sum::<f64>() / 1000.0;
        assert!((mean / expected - 1.0).abs() < 1e-4, "{mean}, not {expected}");
    }
}
