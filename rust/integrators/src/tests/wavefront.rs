//! Wavefront stages against paths that are followed one by one in f64.

use super::kinds::{self, floor};
use super::one_by_one::OneByOne;
use super::{job, samples_of};
use crate::path_settings::{Follow, PathSettings};
use crate::wavefront::{Wavefront, f32_holds};
use crate::{CameraSample, Guide, Guiding, Integrator, Path, Session};
use raywright_base::math::{DVec3, Ray, Vec3};
use raywright_base::sampling::{Sampler, warp};
use raywright_base::workers::Cancel;
use raywright_optics::{AnyBsdf, Coated, Conductor, Dielectric, Diffuse, Mirror, Rgb, ThinDielectric};
use raywright_scene::Sides;
use raywright_scene::fixtures::{cornell, furnace, rectangle, scene, shape};
use raywright_scene::materials::BsdfMix;
use raywright_scene::textures::{Needs, TexturePoint};
use raywright_scene::{
    ConstantEnvironment, Light, Material, Mesh, PointLight, Scene, SceneDescription, ShadingPoint, Shape,
};
use raywright_shapes::Sphere;
use std::sync::Arc;

const DEPTH: u32 = 4;

/// Return the radiance of samples in all directions from a place.
fn found(session: &dyn Session, from: DVec3, count: u32) -> Vec<Rgb> {
    let samples = (0..count).map(|number| {
        let mut sampler = Sampler::new(3, 7, number);
        let ray = Ray::new(from, warp::uniform_sphere(sampler.two(0)));
        CameraSample { ray, sampler }
    });
    let mut samples: Vec<_> = samples.collect();
    let mut values = vec![Rgb::ZERO; samples.len()];
    session.worker().radiance(&mut samples, &Cancel::default(), &mut values);
    values
}

/// Assert equal samples by wavefront stages and in f64, but for f32 rounding. A few rays pass an edge on its other
/// side.
#[track_caller]
fn assert_same(scene: &Scene, from: DVec3) {
    assert!(f32_holds(scene));
    assert_same_by(scene, PathSettings::path(Some(DEPTH), u32::MAX), from);
}

/// The same for an integrator's settings.
#[track_caller]
pub(super) fn assert_same_by(scene: &Scene, settings: PathSettings, from: DVec3) {
    let oracle = OneByOne::new(job(scene), settings);
    assert_equal_samples(&Wavefront::new(job(scene), settings, None, None), &oracle, from);
    assert_equal_samples(&Wavefront::new(job(scene), settings, None, None).with_light_in_f64(), &oracle, from);
}

#[track_caller]
pub(super) fn assert_equal_samples(stages: &dyn Session, in_f64: &dyn Session, from: DVec3) {
    let count = 20_000;
    let (stages, wanted) = (found(stages, from, count), found(in_f64, from, count));
    let largest = wanted.iter().map(|value| value.max()).fold(0.0, f64::max);
    assert!(largest > 0.0);
    let differ = stages.iter().zip(&wanted).filter(|&(&got, &wanted)| {
        (0..3).any(|channel| (got[channel] - wanted[channel]).abs() > 1e-3 * (wanted[channel].abs() + 0.01 * largest))
    });
    let differ = differ.count();
    assert!(differ <= count as usize / 200, "{differ} of {count} differ");
}

/// Assert equal means by wavefront stages and in f64, within four standard errors (false alarm rate 1 in 16,000).
#[track_caller]
fn assert_same_mean(scene: &Scene, from: DVec3) {
    assert_same_mean_as(scene, None, from);
}

/// The same, with paths that are guided.
#[track_caller]
fn assert_same_mean_as(scene: &Scene, guide: Option<Arc<Guide>>, from: DVec3) {
    assert!(f32_holds(scene));
    let settings = PathSettings::path(Some(DEPTH), u32::MAX);
    let mean = |session: &dyn Session| {
        let values = found(session, from, 200_000);
        let mean = values.iter().copied().sum::<Rgb>() / values.len() as f64;
        let square = values.iter().map(|value| (value[1] - mean[1]).powi(2)).sum::<f64>();
        (mean[1], square / (values.len() as f64).powi(2))
    };
    let (got, one) = mean(&Wavefront::new(job(scene), settings, guide, None));
    let (wanted, other) = mean(&OneByOne::new(job(scene), settings));
    let error = (one + other).sqrt();
    assert!(error < 0.02 * wanted && (got - wanted).abs() < 4.0 * error, "{got}, not {wanted} ± {error}");
}

#[test]
fn stages_find_what_f64_finds() {
    let (cornell, _) = cornell(4, 4);
    assert_same(&cornell, DVec3::new(0.5, 0.6, 0.9));
    assert_same(&furnace(0.5, 1.0), DVec3::new(0.1, -0.2, 0.3));
}

#[test]
fn stages_know_all_lights() {
    let floor = || shape(rectangle([-4.0, 0.0, -4.0], [0.0, 0.0, 8.0], [8.0, 0.0, 0.0]), [0.7, 0.5, 0.2], 0.0);
    let lamp = |x: f32, light: f64| shape(rectangle([x, 2.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.1, 0.3]), [0.1; 3], light);
    let sky = || Arc::new(ConstantEnvironment { radiance: Rgb::new(0.5, 1.0, 2.0) });
    let point = || Arc::new(PointLight { position: DVec3::new(0.5, 1.0, 0.0), intensity: Rgb::new(3.0, 2.0, 1.0) });
    let same = |shapes: Vec<Shape>, lights: Vec<Arc<dyn Light>>| {
        assert_same(&scene(SceneDescription { shapes, lights }), DVec3::new(0.0, 1.5, 0.3));
    };
    same(vec![floor()], vec![sky()]);
    same(vec![floor(), lamp(-1.0, 9.0)], vec![sky(), point()]);
    same(vec![floor()], vec![point()]);
    // Enough lights for a light BVH.
    same(vec![floor(), lamp(-1.0, 9.0), lamp(0.5, 4.0), lamp(2.0, 1.0)], vec![]);
}

/// A room of matte walls, with a lamp at its ceiling, and these shapes in it.
fn room(lamps: Vec<Shape>, inside: Vec<Shape>) -> Scene {
    let wall = |corner: [f32; 3], u: [f32; 3], v: [f32; 3], colour| shape(rectangle(corner, u, v), colour, 0.0);
    let [x, y, z] = [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    let mut shapes = vec![
        wall([-2.0, 0.0, -2.0], z, x, [0.7; 3]),
        wall([-2.0, 4.0, -2.0], x, z, [0.7; 3]),
        wall([-2.0, 0.0, -2.0], x, y, [0.6; 3]),
        wall([-2.0, 0.0, -2.0], y, z, [0.7, 0.2, 0.1]),
        wall([2.0, 0.0, -2.0], z, y, [0.1, 0.2, 0.7]),
    ];
    shapes.extend(lamps);
    shapes.extend(inside);
    scene(SceneDescription { shapes, lights: vec![] })
}

/// A BSDF that is the same everywhere.
#[derive(Debug)]
struct Even(AnyBsdf);

impl Material for Even {
    fn bsdf(&self, _at: &ShadingPoint) -> BsdfMix {
        BsdfMix::One(self.0)
    }
    fn needs(&self) -> Needs {
        Needs::NONE
    }
    fn validate(&self) -> Result<(), String> {
        Ok(())
    }
    fn constant(&self) -> Option<AnyBsdf> {
        Some(self.0)
    }
}

fn of(mesh: Mesh, bsdf: impl Into<AnyBsdf>) -> Shape {
    Shape { material: Arc::new(Even(bsdf.into())), ..shape(mesh, [0.0; 3], 0.0) }
}

fn ball(x: f64, y: f64, z: f64, radius: f64, bsdf: impl Into<AnyBsdf>) -> Shape {
    let sphere: Arc<dyn raywright_shapes::Shape> = Arc::new(Sphere { center: DVec3::new(x, y, z), radius });
    Shape { surface: sphere.into(), ..of(floor(), bsdf) }
}

fn lamp_ball(x: f64, y: f64, z: f64, radius: f64, light: f64) -> Shape {
    let lamp = shape(floor(), [0.0; 3], light);
    Shape { surface: ball(x, y, z, radius, Diffuse { reflectance: Rgb::ZERO }).surface, ..lamp }
}

#[test]
fn stages_know_spheres_and_all_ways_of_scattering() {
    let eye = DVec3::new(0.1, 1.7, 1.8);
    let panel = || shape(rectangle([-0.5, 3.9, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), [0.1; 3], 10.0);
    let rough = || Conductor::new(Rgb::new(0.2, 0.9, 1.1), Rgb::new(3.9, 2.4, 2.2), [0.4; 2]);
    assert_same(&room(vec![panel()], vec![ball(0.4, 1.0, 0.2, 0.9, Mirror { reflectance: Rgb::splat(0.9) })]), eye);
    assert_same(&room(vec![panel()], vec![ball(0.4, 1.0, 0.2, 0.9, Dielectric::new(1.5, 0.0))]), eye);
    assert_same(&room(vec![panel()], vec![ball(0.4, 1.0, 0.2, 0.9, rough())]), eye);
    assert_same(&room(vec![panel()], vec![ball(0.4, 1.0, 0.2, 0.9, Dielectric::new(1.5, 0.4))]), eye);
    assert_same(&room(vec![panel()], vec![ball(0.4, 1.0, 0.2, 0.9, Coated::new(Rgb::splat(0.5), 1.5, 0.3))]), eye);
    // Panes pass light straight on.
    let pane = || rectangle([-1.5, 1.0, -1.5], [0.0, 0.0, 3.0], [3.0, 0.0, 0.0]);
    assert_same(&room(vec![panel()], vec![of(pane(), ThinDielectric::new(1.5))]), eye);
    // Lamps that are spheres, which f64 draws by other numbers, and of which each is asked at what is glossy.
    let lamps = || vec![lamp_ball(-1.0, 3.0, 0.0, 0.3, 20.0), lamp_ball(1.0, 2.0, -1.0, 0.4, 8.0)];
    let glossy = Conductor::new(Rgb::new(0.2, 0.9, 1.1), Rgb::new(3.9, 2.4, 2.2), [0.3; 2]);
    let plate = of(rectangle([-1.0, 0.5, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]), glossy);
    assert_same_mean(&room(lamps(), vec![]), eye);
    assert_same_mean(&room(lamps(), vec![plate]), eye);
    // Within a lamp.
    let mut around = lamp_ball(0.0, 2.0, 0.0, 6.0, 2.0);
    around.emission.sides = Sides::Both;
    assert_same_mean(&room(vec![around], vec![ball(0.4, 1.0, 0.2, 0.9, rough())]), eye);
}

/// A floor whose shading normals lean.
fn leaning_floor() -> Mesh {
    let lean = |x: f32, y: f32| Vec3::new(x, 1.0, y).normalize();
    let normals = vec![lean(0.3, 0.0), lean(-0.2, 0.1), lean(0.0, -0.3), lean(0.1, 0.2)];
    Mesh { normals: Some(normals), ..rectangle([-2.0, 0.3, -2.0], [0.0, 0.0, 4.0], [4.0, 0.0, 0.0]) }
}

#[test]
fn stages_know_shading_normals_and_materials_that_vary() {
    let eye = DVec3::new(0.1, 1.7, 1.8);
    let panel = || shape(rectangle([-0.5, 3.9, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), [0.1; 3], 10.0);
    let rough = Conductor::new(Rgb::new(0.2, 0.9, 1.1), Rgb::new(3.9, 2.4, 2.2), [0.4; 2]);
    assert_same(&room(vec![panel()], vec![shape(leaning_floor(), [0.7, 0.5, 0.3], 0.0)]), eye);
    assert_same(&room(vec![panel()], vec![of(leaning_floor(), rough)]), eye);
    assert_same(&room(vec![panel()], vec![of(leaning_floor(), Dielectric::new(1.5, 0.4))]), eye);
    // Materials that are asked at each point.
    let asked = |bsdf: BsdfMix| kinds::of(leaning_floor(), bsdf);
    assert_same(&room(vec![panel()], vec![asked(Diffuse { reflectance: Rgb::splat(0.6) }.into())]), eye);
    let two = BsdfMix::mixed(
        (Rgb::splat(0.5), Diffuse { reflectance: Rgb::splat(0.6) }.into()),
        (Rgb::splat(0.5), Mirror { reflectance: Rgb::ONE }.into()),
    );
    assert_same(&room(vec![panel()], vec![asked(two)]), eye);
}

#[test]
fn roulette_of_stages_changes_no_mean() {
    let (scene, _) = cornell(4, 4);
    let ray = Ray::new(DVec3::new(0.5, 0.6, 0.9), DVec3::new(0.48, -0.6, -0.64));
    let mean = |roulette_depth: u32| {
        let path = Path { max_depth: Some(30), roulette_depth, ..Path::default() };
        let values = samples_of(&scene, &path, ray, 60_000);
        let mean = values.iter().map(|value| value[1]).sum::<f64>() / values.len() as f64;
        let square = values.iter().map(|value| (value[1] - mean).powi(2)).sum::<f64>();
        (mean, (square / (values.len() as f64).powi(2)).sqrt())
    };
    let (wanted, error) = mean(u32::MAX);
    for depth in [0, 2, 5] {
        let (got, other) = mean(depth);
        assert!((got - wanted).abs() < 4.0 * error.hypot(other), "{depth}: {got}, not {wanted} ± {error}");
    }
}

#[test]
fn points_on_large_triangles_are_as_near_as_on_small_ones() {
    let point = PointLight { position: DVec3::new(1.0, 0.0, 1.0), intensity: Rgb::ONE };
    let lights: Vec<Arc<dyn Light>> = vec![Arc::new(point)];
    let expected = 0.5 * 0.353_553_390_593_273_73 / std::f64::consts::PI;
    let ray = Ray::new(DVec3::new(0.0, -0.6, 0.8), DVec3::new(0.0, 0.6, -0.8));
    for size in [2f32, 2e3, 2e6] {
        let ground = rectangle([-0.45 * size, -0.55 * size, 0.0], [size, 0.0, 0.0], [0.0, size, 0.0]);
        let scene = scene(SceneDescription { shapes: vec![shape(ground, [0.5; 3], 0.0)], lights: lights.clone() });
        assert!(f32_holds(&scene));
        let mut samples = [0, 1, 2, 3].map(|number| CameraSample { ray, sampler: Sampler::new(3, 7, number) });
        let mut values = [Rgb::ZERO; 4];
        let session = Wavefront::new(job(&scene), PathSettings::path(None, 4), None, None);
        session.worker().radiance(&mut samples, &Cancel::default(), &mut values);
        for value in values {
            let off = value[1] / expected - 1.0;
            assert!(off.abs() < 8.0 * f64::from(f32::EPSILON), "{size}: {off:e}");
        }
    }
}

#[test]
fn guided_paths_find_on_average_what_others_find() {
    let eye = DVec3::new(0.1, 1.7, 1.8);
    let panel = || shape(rectangle([-1.0, 3.9, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]), [0.1; 3], 2.0);
    let pane = || rectangle([-1.5, 1.0, -1.5], [0.0, 0.0, 3.0], [3.0, 0.0, 0.0]);
    let glass = room(vec![panel()], vec![ball(0.4, 1.0, 0.2, 0.9, Dielectric::new(1.5, 0.0))]);
    let pane = room(vec![panel()], vec![of(pane(), ThinDielectric::new(1.5))]);
    for scene in [&glass, &pane] {
        let path =
            Path { max_depth: Some(DEPTH), roulette_depth: u32::MAX, guiding: Guiding::Photons, ..Path::default() };
        assert!(f32_holds(scene) && path.guiding_in(scene) == Guiding::Photons);
        let guide = Guide::of(scene, &Cancel::default());
        assert!(guide.is_some());
        assert_same_mean_as(scene, guide, eye);
    }
}

#[test]
fn what_a_sample_finds_depends_on_no_other() {
    // Kinds of surfaces that sort paths, one that transmits under a sky, and lamps of both forms.
    let eye = DVec3::new(0.1, 1.7, 1.8);
    let panel = shape(rectangle([-0.5, 3.9, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), [0.1; 3], 10.0);
    let rough = Conductor::new(Rgb::new(0.2, 0.9, 1.1), Rgb::new(3.9, 2.4, 2.2), [0.2; 2]);
    let inside = || {
        vec![
            ball(0.8, 1.0, 0.2, 0.5, rough),
            ball(-0.6, 0.6, 0.3, 0.4, Dielectric::new(1.5, 0.0)),
            ball(-0.2, 2.0, -0.8, 0.4, Dielectric::new(1.4, 0.3)),
            of(leaning_floor(), Coated::new(Rgb::splat(0.5), 1.5, 0.3)),
        ]
    };
    let lit = room(vec![panel, lamp_ball(-1.0, 3.0, 0.0, 0.3, 20.0)], inside());
    let sky = Arc::new(ConstantEnvironment { radiance: Rgb::new(0.5, 1.0, 2.0) });
    let open = scene(SceneDescription { shapes: inside(), lights: vec![sky] });
    for scene in [&lit, &open] {
        let job = job(scene);
        assert!(f32_holds(job.scene));
        let path = Path { guiding: Guiding::Photons, ..Path::default() };
        let session = path.begin(job, &Cancel::default());
        let samples: Vec<_> = (0..5000)
            .map(|number| {
                let mut sampler = Sampler::new(3, 7, number);
                CameraSample { ray: Ray::new(eye, warp::uniform_sphere(sampler.two(0))), sampler }
            })
            .collect();
        assert_each_on_its_own(&*session, &samples, &[7, 100, 4097]);
    }
}

/// Assert that samples find the same whether so many are taken at a time, or all.
#[track_caller]
pub(super) fn assert_each_on_its_own(session: &dyn Session, samples: &[CameraSample], parts: &[usize]) {
    let in_parts = |part: usize| {
        let mut values = vec![Rgb::ZERO; samples.len()];
        let mut worker = session.worker();
        for (samples, values) in samples.chunks(part).zip(values.chunks_mut(part)) {
            worker.radiance(&mut samples.to_vec(), &Cancel::default(), values);
        }
        values
    };
    let whole = in_parts(samples.len());
    assert!(whole.iter().any(|value| !value.is_black()));
    for &part in parts {
        assert!(in_parts(part) == whole, "{part} at a time");
    }
}

/// A matte surface of which a part is there.
#[derive(Debug)]
struct Pierced(f64);

impl Material for Pierced {
    fn bsdf(&self, _at: &ShadingPoint) -> BsdfMix {
        Diffuse { reflectance: Rgb::new(0.8, 0.6, 0.3) }.into()
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

#[test]
fn stages_pass_masks() {
    let lamp = || shape(rectangle([-0.5, 3.9, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), [0.0; 3], 8.0);
    let sheet = |y: f32, opacity: f64| Shape {
        material: Arc::new(Pierced(opacity)),
        ..shape(rectangle([-1.5, y, -1.5], [0.0, 0.3, 3.0], [3.0, 0.0, 0.0]), [0.0; 3], 0.0)
    };
    let own = Shape { emission: Rgb::splat(5.0).into(), ..sheet(0.5, 0.5) };
    let inside = vec![
        sheet(2.0, 0.4),
        sheet(3.0, 0.7),
        sheet(1.0, 0.0),
        own,
        ball(1.0, 0.5, -1.0, 0.5, Mirror { reflectance: Rgb::ONE }),
    ];
    let scene = room(vec![lamp()], inside);
    assert!(scene.plan().needs().masks);
    // They pass by other numbers.
    assert_same_mean(&scene, DVec3::new(0.2, 1.4, 1.7));
}

#[test]
fn stages_cast_rays() {
    let (cornell, _) = cornell(4, 4);
    let lamp = shape(rectangle([-0.5, 3.9, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), [0.0; 3], 8.0);
    let metal = Conductor::new(Rgb::new(0.2, 0.9, 1.1), Rgb::new(3.9, 2.4, 2.2), [0.4; 2]);
    let glossy = room(vec![lamp], vec![of(rectangle([-1.0, 0.1, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]), metal)]);
    for (scene, from) in [(&cornell, DVec3::new(0.5, 0.6, 0.9)), (&glossy, DVec3::new(0.2, 1.4, 1.7))] {
        for shadows in [true, false] {
            let settings = PathSettings { follow: Follow::Nothing, shadows, ..PathSettings::dimmed(1) };
            assert_same_by(scene, settings, from);
        }
    }
}
