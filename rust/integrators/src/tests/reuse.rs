//! Path reuse within groups of pixels.

use super::{job, samples_of};
use crate::{CameraSample, Integrator, Path};
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::{Diffuse, Rgb};
use raywright_scene::fixtures::{cornell, furnace, inward_box, rectangle, scene, shape};
use raywright_scene::materials::BsdfMix;
use raywright_scene::textures::Needs;
use raywright_scene::{Camera, Material, Mesh, PointLight, Scene, SceneDescription, ShadingPoint, Shape};
use std::sync::Arc;

/// Return an integrator without roulette, which reused paths play relative to their second surface.
fn path(reuse: u32) -> Path {
    Path { max_depth: Some(6), roulette_depth: u32::MAX, reuse, ..Path::default() }
}

/// Return groups of samples, each over all pixels of a centered square of a given side.
fn groups(camera: &dyn Camera, side: u32, count: u32) -> Vec<CameraSample> {
    let [left, top] = [camera.width(), camera.height()].map(|n| (n - side) / 2);
    let through = |pixel: u32, number: u32| {
        let film = [f64::from(left + pixel % side) + 0.5, f64::from(top + pixel / side) + 0.5];
        CameraSample { ray: camera.ray(film, [0.5; 2], 0.0).ray, sampler: Sampler::new(11, pixel, number) }
    };
    (0..count)
        .flat_map(|number| (0..side * side).map(move |pixel| (pixel, number)))
        .map(|(p, n)| through(p, n))
        .collect()
}

/// Return the radiance of samples in groups of one size, traced in batches of `together`.
fn shared(scene: &Scene, path: &Path, samples: &[CameraSample], group: usize, together: usize) -> Vec<Rgb> {
    let session = path.begin(job(scene), &Cancel::default());
    let mut worker = session.worker();
    let mut all = Vec::new();
    for batch in samples.chunks(group * together) {
        let mut values = vec![Rgb::ZERO; batch.len()];
        let groups = vec![group as u32; batch.len() / group];
        worker.radiance_in_groups(&mut batch.to_vec(), &groups, &Cancel::default(), &mut values);
        all.extend(values);
    }
    all
}

/// Return the mean of the groups' green means, its standard error, and the mean squared deviation of the samples from
/// it.
fn told(values: &[Rgb], group: usize) -> (f64, f64, f64) {
    let means: Vec<f64> = values.chunks(group).map(|g| g.iter().map(|v| v[1]).sum::<f64>() / group as f64).collect();
    let count = means.len() as f64;
    let mean = means.iter().sum::<f64>() / count;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let spread = values.iter().map(|v| (v[1] - mean).powi(2)).sum::<f64>() / values.len() as f64;
    (mean, (variance / count).sqrt(), spread)
}

#[test]
fn a_furnace_shines_by_its_geometric_series() {
    // Groups of rays from one point inside, in directions up to 71 degrees apart.
    let samples: Vec<_> = (0..40_000u32)
        .map(|i| {
            let turned = DVec3::new(f64::from(i % 4) - 1.5, f64::from(i / 4 % 4) - 1.5, 3.0).normalize();
            CameraSample { ray: Ray::new(DVec3::new(0.1, -0.2, 0.3), turned), sampler: Sampler::new(4, i % 16, i / 16) }
        })
        .collect();
    for (albedo, roulette_depth) in [(0.0, 4), (0.3, 0), (0.3, 1), (0.7, 2), (0.7, 4)] {
        let path = Path { roulette_depth, reuse: 4, ..Path::default() };
        let (mean, error, _) = told(&shared(&furnace(albedo, 2.0), &path, &samples, 16, 50), 16);
        let expected = 2.0 / (1.0 - albedo);
        // Four standard errors, which are below half a percent.
        assert!((mean - expected).abs() <= 4.0 * error + 1e-9, "{albedo}: {mean} ± {error}, not {expected}");
        assert!(error < 0.005 * expected);
    }
}

#[test]
fn a_group_of_one_is_a_path_on_its_own() {
    let (scene, camera) = cornell(16, 16);
    let samples = groups(&camera, 8, 20);
    let alone = shared(&scene, &path(4), &samples, 1, 100);
    let mut plain = vec![Rgb::ZERO; samples.len()];
    let alone_path = path(1);
    let session = alone_path.begin(job(&scene), &Cancel::default());
    session.worker().radiance(&mut samples.clone(), &Cancel::default(), &mut plain);
    // Seven products in f32, of which sharing begins anew at the second point.
    assert!(alone.iter().zip(&plain).all(|(a, b)| (*a - *b).abs().max() <= 1e-6 * b.max()));
    assert!(plain.iter().filter(|v| v.max() > 0.0).count() > 1000);
}

#[test]
fn groups_have_the_mean_of_paths_and_an_eighth_of_their_variance() {
    // Light that a point emits or scatters directly has no variance here. Sixteen rays to a small part of a wall.
    let scene = room(vec![]);
    let samples: Vec<_> = (0..64_000u32)
        .map(|i| {
            let (pixel, number) = (i % 16, i / 16);
            let to = DVec3::new(1.9, 0.02 * f64::from(pixel % 4), 0.02 * f64::from(pixel / 4)).normalize();
            CameraSample { ray: Ray::new(DVec3::new(-0.9, 0.0, 0.0), to), sampler: Sampler::new(13, pixel, number) }
        })
        .collect();
    let (together, alone) = (shared(&scene, &path(4), &samples, 16, 60), shared(&scene, &path(1), &samples, 16, 60));
    let ((mean, error, _), (other, other_error, _)) = (told(&together, 16), told(&alone, 16));
    // Four standard errors.
    assert!((mean - other).abs() <= 4.0 * error.hypot(other_error), "{mean} ± {error}, {other} ± {other_error}");
    let spread = |values: &[Rgb]| -> f64 {
        (0..16).map(|pixel| told(&values.iter().skip(pixel).step_by(16).copied().collect::<Vec<_>>(), 1).2).sum()
    };
    let (together, alone) = (spread(&together), spread(&alone));
    assert!(together < alone / 8.0, "{together} and {alone}");
}

#[test]
fn what_arrives_depends_on_the_group_alone() {
    let (scene, camera) = cornell(64, 64);
    for (side, count) in [(2, 200), (4, 60), (8, 12)] {
        let (samples, group) = (groups(&camera, side, count), (side * side) as usize);
        let whole = shared(&scene, &Path { reuse: side, ..Path::default() }, &samples, group, count as usize);
        for together in [1, 7] {
            assert_eq!(shared(&scene, &Path { reuse: side, ..Path::default() }, &samples, group, together), whole);
        }
    }
}

/// A box of gray walls with a lamp in it, and further shapes.
fn room(more: Vec<Shape>) -> Scene {
    let walls = inward_box([-1.0; 3], [2.0; 3]).into_iter().map(|wall| shape(wall, [0.6; 3], 0.0));
    let lamp = PointLight { position: DVec3::new(0.3, 0.5, 0.2), intensity: Rgb::splat(0.5) };
    scene(SceneDescription { shapes: walls.chain(more).collect(), lights: vec![Arc::new(lamp)] })
}

/// An octahedron with the normals of a ball, far from those of its faces.
fn ball() -> Shape {
    let at = |i: usize| raywright_base::math::Vec3::AXES[i];
    let vertices: Vec<_> = (0..3).flat_map(|i| [at(i), -at(i)]).collect();
    let mut faces = Vec::new();
    for (x, y, z) in [(0, 2, 4), (1, 2, 4), (0, 3, 4), (1, 3, 4), (0, 2, 5), (1, 2, 5), (0, 3, 5), (1, 3, 5)] {
        let turns = (x + y + z) % 2 == 0;
        faces.push(if turns { [x, y, z] } else { [y, x, z] });
    }
    let mesh = Mesh {
        vertices: vertices.iter().map(|v| *v * 0.5).collect::<Vec<_>>().into(),
        faces,
        normals: Some(vertices),
        ..Mesh::default()
    };
    shape(mesh, [0.8; 3], 0.0)
}

#[test]
fn shading_normals_do_not_bias() {
    let scene = room(vec![ball()]);
    // Along the wall, past the ball and onto it at all angles.
    let samples: Vec<_> = (0..64_000u32)
        .map(|i| {
            let (pixel, number) = (i % 16, i / 16);
            let from = DVec3::new(-0.9, 0.0, 0.0);
            let to = DVec3::new(0.0, 0.25 * f64::from(pixel % 4) - 0.4, 0.25 * f64::from(pixel / 4) - 0.4);
            CameraSample { ray: Ray::new(from, (to - from).normalize()), sampler: Sampler::new(21, pixel, number) }
        })
        .collect();
    let (together, alone) = (shared(&scene, &path(4), &samples, 16, 60), shared(&scene, &path(1), &samples, 16, 60));
    for pixel in 0..16 {
        let of = |values: &[Rgb]| told(&values.iter().skip(pixel).step_by(16).copied().collect::<Vec<_>>(), 1);
        let ((mean, error, _), (other, other_error, _)) = (of(&together), of(&alone));
        // One of sixteen exceeds four and a half standard errors with a probability of 1 in 9,000.
        let off = (mean - other).abs() / error.hypot(other_error);
        assert!(off <= 4.5, "pixel {pixel}: {mean} ± {error}, {other} ± {other_error}");
    }
}

/// Gray with an opacity of one half.
#[derive(Debug)]
struct Lace;

impl Material for Lace {
    fn bsdf(&self, _at: &ShadingPoint) -> BsdfMix {
        Diffuse { reflectance: Rgb::splat(0.5) }.into()
    }
    fn needs(&self) -> Needs {
        Needs::NONE
    }
    fn validate(&self) -> Result<(), String> {
        Ok(())
    }
    fn opacity(&self, _at: &raywright_scene::textures::TexturePoint) -> f64 {
        0.5
    }
    fn is_opaque(&self) -> bool {
        false
    }
}

#[test]
fn nothing_is_shared_where_nothing_can_be() {
    let four = Path { reuse: 4, ..Path::default() };
    assert_eq!(four.patch(&cornell(8, 8).0), 4);
    for depth in [0, 1] {
        assert_eq!(Path { max_depth: Some(depth), ..four }.patch(&cornell(8, 8).0), 1);
    }
    let sheet = || rectangle([-0.5, -0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let laced = room(vec![Shape { material: Arc::new(Lace), ..shape(sheet(), [0.5; 3], 0.0) }]);
    assert_eq!((four.patch(&laced), four.patch(&room(vec![]))), (1, 4));
    let dark = scene(SceneDescription { shapes: vec![shape(sheet(), [0.5; 3], 0.0)], ..Default::default() });
    assert_eq!(four.patch(&dark), 1);
    let ray = Ray::new(DVec3::new(0.1, 0.2, 0.9), DVec3::new(0.0, 0.6, -0.8));
    assert_eq!(samples_of(&laced, &four, ray, 500), samples_of(&laced, &Path::default(), ray, 500));
}
