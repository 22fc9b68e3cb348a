//! Integrators against closed forms.

use super::*;
use crate::accel::{Accelerator, BruteForce};
use crate::math::DVec3;
use crate::scene::fixtures::{furnace, inward_box, rectangle, scene, shape};
use crate::scene::{Copies, Geometry, Group, Matrix, PointLight, SceneDescription, Shape};
use crate::simd::Level;
use std::sync::Arc;

/// Mean and standard error of the green radiance along a ray.
fn radiance(scene: &Scene, path: &Path, ray: Ray, count: u32) -> (f64, f64) {
    let mut samples: Vec<_> =
        (0..count).map(|number| CameraSample { ray, sampler: Sampler::new(3, 0, number) }).collect();
    let mut values = vec![Rgb::ZERO; count as usize];
    let mut worker = path.worker(scene, Footprint::default());
    for (samples, values) in samples.chunks_mut(4096).zip(values.chunks_mut(4096)) {
        worker.radiance(samples, &Cancel::default(), values);
    }
    let mean = values.iter().map(|v| v.y).sum::<f64>() / f64::from(count);
    let variance = values.iter().map(|v| (v.y - mean).powi(2)).sum::<f64>() / f64::from(count - 1);
    (mean, (variance / f64::from(count)).sqrt())
}

/// Within four standard errors (chance exceeds them once in 16,000 cases), which are below 1 %.
fn assert_radiance(scene: &Scene, path: &Path, ray: Ray, count: u32, expected: f64) {
    let (mean, error) = radiance(scene, path, ray, count);
    assert!((mean - expected).abs() <= 4.0 * error + 1e-9 * expected, "{mean} ± {error}, not {expected}");
    assert!(error < 0.01 * expected, "{error} of {expected}");
}

const ANYWHERE: Ray = Ray {
    origin: DVec3::new(0.1, -0.2, 0.3),
    direction: DVec3::new(0.48, 0.6, 0.64),
    t_min: 0.0,
    t_max: f64::INFINITY,
    time: 0.0,
};

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
        let path = Path { max_depth: Some(depth), roulette_depth: u32::MAX };
        assert_radiance(&scene, &path, ANYWHERE, 20_000, 2.0 - 0.5f64.powi(depth as i32));
    }
}

#[test]
fn a_furnace_of_copies_shines_as_one_of_walls() {
    // Six copies of one wall, each under a map of its own, and a copy of that moving out of shape: light that is not sampled but
    // found, and rays that leave walls under such maps without meeting them.
    let wall = Group::new(
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
    let walls = Copies::new(Arc::new(wall.unwrap()), &walls).unwrap();
    let walls = vec![Shape { surface: walls.into(), ..Shape::default() }];
    let room = Arc::new(Group::new(walls, brute).unwrap());
    let whole: Matrix = [[30.0, 4.0, 0.0, 7.0], [-1.0, 0.1, 0.0, 1e4], [0.0, 0.2, 1e-2, -5.0]];
    let start: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    for copies in [Copies::new(room.clone(), &[whole]), Copies::moving(room.clone(), vec![[start, whole]])] {
        let shapes = vec![Shape { surface: copies.unwrap().into(), ..Shape::default() }];
        let scene = Scene::new(SceneDescription { shapes, ..Default::default() }, brute).unwrap();
        let ray = Ray { origin: DVec3::new(10.8, 1e4 - 0.08, -4.957), time: 1.0, ..ANYWHERE };
        assert_radiance(&scene, &Path::default(), ray, 20_000, 4.0);
    }
}

fn brute(geometry: &Geometry) -> Box<dyn Accelerator> {
    BruteForce::over(geometry, Level::Scalar)
}

#[test]
fn roulette_changes_no_mean() {
    let [left, right, floor, ceiling, back, front] = inward_box([-1.0; 3], [2.0; 3]);
    let mut shapes: Vec<_> = [left, right, floor, back, front].map(|m| shape(m, [0.7; 3], 0.0)).into();
    shapes.push(shape(ceiling, [0.3; 3], 1.0));
    let scene = scene(SceneDescription { shapes, ..Default::default() });
    let run = |roulette_depth| {
        let path = Path { max_depth: Some(60), roulette_depth };
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
    // The length of a path in it has mean 1000 and standard deviation 1000, and so has what it brings.
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
    // Radius 1 at height 1, centred: E = π L r² / (r² + h²) = π/2 L (Howell, C-41 with one small disk). The disk is a
    // polygon of 720 sides of the same area, and the floor an albedo of 0.8.
    let sides = 720u32;
    let radius =
        (std::f64::consts::TAU / f64::from(sides) / (std::f64::consts::TAU / f64::from(sides)).sin()).sqrt();
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
    let points = scene(SceneDescription { shapes: floor(), points: vec![point], ..Default::default() });
    let expected = 0.5 * 0.353_553_390_593_273_73 / std::f64::consts::PI;
    assert_radiance(&points, &Path::default(), ray, 10, expected);
    let sky = scene(SceneDescription { shapes: floor(), environment: Rgb::splat(2.0), ..Default::default() });
    assert_radiance(&sky, &Path::default(), ray, 1000, 1.0);
    // A ray that meets nothing sees the sky itself.
    assert_radiance(&sky, &Path::default(), Ray::new(DVec3::Z, DVec3::Z), 2, 2.0);
}

#[test]
fn a_sample_does_not_depend_on_its_batch() {
    let scene = furnace(0.7, 1.0);
    let samples: Vec<_> =
        (0..100).map(|n| CameraSample { ray: ANYWHERE, sampler: Sampler::new(8, n, n) }).collect();
    let run = |size: usize| {
        let path = Path::default();
        let mut worker = path.worker(&scene, Footprint::default());
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
