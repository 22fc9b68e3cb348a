//! Gain from leaving out what a scene does not need: the same paths in a closed room, alone and with an object outside
//! of it that no path meets, but that needs more. They run in turns, so that other load on the machine affects all
//! alike. Their means are compared before timing.

use raywright::accel::bvh::{self, Options};
use raywright::integrators::{CameraSample, Integrator, Job, Path};
use raywright::math::{DVec3, Ray, Vec3};
use raywright::optics::{Phase, Rgb};
use raywright::sampling::Sampler;
use raywright::scene::materials::{BoundaryMaterial, DielectricMaterial, Interior, Mask};
use raywright::scene::media::Homogeneous;
use raywright::scene::{DiffuseMaterial, Material, Mesh, Perspective, Scene, SceneDescription, Shape};
use raywright::shapes::Sphere;
use raywright::simd::Level;
use raywright::workers::Cancel;
use std::sync::Arc;
use std::time::Instant;

/// Number of turns.
const TURNS: usize = 31;

/// Paths per timing.
const PATHS: u32 = 4096;

fn main() {
    // Without this flag, as in `cargo test --benches`, everything is checked and nothing timed.
    let is_timed = std::env::args().any(|arg| arg == "--bench");
    let scenes = scenes();
    let camera =
        Perspective::looking_at(DVec3::new(0.0, 0.0, 0.9), DVec3::ZERO, DVec3::Y, 60.0, 64, 64).expect("a camera");
    let run = |scene: &Scene| {
        let mut samples: Vec<_> = (0..PATHS).map(sample).collect();
        let mut radiance = vec![Rgb::ZERO; samples.len()];
        let path = Path::default();
        let session = path.begin(Job::new(scene, &camera, 0, 1), &Cancel::default());
        let mut worker = session.worker();
        let start = Instant::now();
        worker.radiance(&mut samples, &Cancel::default(), &mut radiance);
        (start.elapsed().as_secs_f64(), radiance)
    };
    let found = scenes.each_ref().map(|(_, scene)| {
        let sum: Rgb = run(scene).1.into_iter().sum();
        sum[1] / f64::from(PATHS)
    });
    assert!(found.iter().all(|mean| (mean / found[0] - 1.0).abs() < 0.05), "{found:?}");
    if !is_timed {
        return;
    }
    let mut seconds = scenes.each_ref().map(|_| Vec::new());
    for turn in 0..TURNS {
        for i in 0..scenes.len() {
            let which = (i + turn) % scenes.len();
            seconds[which].push(run(&scenes[which].1).0);
        }
    }
    println!("Paths of a closed room of one diffuse color a wall, on one thread.");
    println!();
    println!("| outside of the room | thousand paths a second | time over the first |");
    println!("|---|---|---|");
    for ((outside, _), times) in scenes.iter().zip(&seconds) {
        let ratios = times.iter().zip(&seconds[0]).map(|(mine, first)| mine / first).collect();
        let rate = f64::from(PATHS) / median(times.clone()) / 1e3;
        println!("| {outside} | {rate:.0} | {:.2} |", median(ratios));
    }
}

/// The room, alone and with something outside of it.
fn scenes() -> [(&'static str, Scene); 5] {
    let matte = || Arc::new(DiffuseMaterial { reflectance: Rgb::splat(0.5).into() });
    let glass =
        |priority| DielectricMaterial { interior: Interior::new(1.5, priority), roughness: 0.0.into(), medium: None };
    let haze = Homogeneous::new(Rgb::splat(0.1), Rgb::splat(0.5), Rgb::ZERO, Phase::Rayleigh).expect("a medium");
    let ball = |radius: f64, material: Arc<dyn Material>| {
        let sphere: Arc<dyn raywright::shapes::Shape> = Arc::new(Sphere { center: DVec3::new(9.0, 0.0, 0.0), radius });
        Shape { surface: sphere.into(), material, emission: Rgb::ZERO.into() }
    };
    [
        ("nothing", room(vec![])),
        ("glass", room(vec![ball(1.0, Arc::new(glass(0)))])),
        ("a mask", room(vec![ball(1.0, Arc::new(Mask { material: matte(), opacity: 0.5.into() }))])),
        ("glass in glass", room(vec![ball(1.0, Arc::new(glass(0))), ball(0.5, Arc::new(glass(1)))])),
        ("haze", room(vec![ball(1.0, Arc::new(BoundaryMaterial { medium: Arc::new(haze), priority: 0 }))])),
    ]
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Return a path from the room's center in a direction of its own.
fn sample(number: u32) -> CameraSample {
    let mut sampler = Sampler::new(1, number, 0);
    let [x, y] = sampler.two(0);
    let direction = DVec3::new(x - 0.5, y - 0.5, -0.7).normalize();
    CameraSample { ray: Ray::new(DVec3::new(0.0, 0.0, 0.9), direction), sampler }
}

/// Return a room from −1 to 1 with a lamp under its ceiling, and other shapes.
fn room(others: Vec<Shape>) -> Scene {
    let wall = |corner: Vec3, side: Vec3, other: Vec3, reflectance: Rgb, emission: f64| Shape {
        surface: Mesh {
            vertices: vec![corner, corner + side, corner + side + other, corner + other].into(),
            faces: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
        .into(),
        material: Arc::new(DiffuseMaterial { reflectance: reflectance.into() }),
        emission: Rgb::splat(emission).into(),
    };
    let (x, y, z, low, high) = (2.0 * Vec3::X, 2.0 * Vec3::Y, 2.0 * Vec3::Z, -Vec3::ONE, Vec3::ONE);
    let white = Rgb::splat(0.73);
    let mut shapes = vec![
        wall(low, y, z, Rgb::new(0.63, 0.065, 0.05), 0.0),
        wall(high, -z, -y, Rgb::new(0.14, 0.45, 0.091), 0.0),
        wall(low, z, x, white, 0.0),
        wall(high, -x, -z, white, 0.0),
        wall(low, x, y, white, 0.0),
        wall(high, -y, -x, white, 0.0),
        wall(Vec3::new(-0.3, 0.99, -0.3), 0.3 * x, 0.3 * z, Rgb::ZERO, 15.0),
    ];
    shapes.extend(others);
    let level = Level::current().expect("a level of this processor");
    let description = SceneDescription { shapes, ..SceneDescription::default() };
    Scene::new(description, |geometry| bvh::wide(8, geometry, &Options::default(), level)).expect("a scene")
}
