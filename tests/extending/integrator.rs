use raywright::integrators::{CameraSample, Integrator, Job, Session, Worker};
use raywright::math::{Hit, Ray};
use raywright::optics::Rgb;
use raywright::scene::Scene;
use raywright::workers::Cancel;

/// Shows how far away things are: white at the camera, half as bright at a distance.
#[derive(Debug)]
struct Fog {
    distance: f64,
}

impl Integrator for Fog {
    // Made once for a picture: what all threads share, such as a photon map.
    fn begin<'a>(&'a self, job: Job<'a>, _: &Cancel) -> Box<dyn Session + 'a> {
        Box::new(Looking { scene: job.scene, distance: self.distance })
    }
}

#[derive(Clone, Copy)]
struct Looking<'a> {
    scene: &'a Scene,
    distance: f64,
}

impl Session for Looking<'_> {
    // One for each thread, with the memory that it needs.
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(*self)
    }
}

impl Worker for Looking<'_> {
    // A whole batch of rays at a time, as the accelerators like them.
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        if cancel.is_raised() {
            return;
        }
        let rays: Vec<Ray> = samples.iter().map(|sample| sample.ray).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        self.scene.intersect(&rays, &mut hits);
        for (light, hit) in radiance.iter_mut().zip(&hits) {
            *light = Rgb::splat((-hit.t / self.distance).exp2());
        }
    }
}

#[test]
fn fog_halves_what_is_seen_through_its_distance() {
    use raywright::accel::{bvh::Options, trees};
    use raywright::math::{DVec3, Vec3};
    use raywright::render::{Quiet, Settings, Until, render};
    use raywright::scene::cameras::{Body, Measured, Perspective, Viewpoint, Window};
    use raywright::scene::{Mesh, SceneDescription, Shape};
    use raywright::simd::Level;

    let corners = [[3.0, -9.0, -9.0], [3.0, 9.0, -9.0], [3.0, 0.0, 9.0]].map(Vec3::from_array);
    let wall = Mesh { vertices: corners.to_vec().into(), faces: vec![[0, 1, 2]], ..Mesh::default() };
    let shapes = vec![Shape { surface: wall.into(), ..Shape::default() }];
    let level = Level::current().unwrap();
    let described = SceneDescription { shapes, ..SceneDescription::default() };
    let scene = Scene::new(described, |primitives| trees::over(primitives, &Options::default(), level)).unwrap();
    let settings = Settings { until: Until { samples: Some(1), ..Until::default() }, ..Settings::default() };
    let brightness = |towards| {
        let viewpoint = Viewpoint::look_at(DVec3::ZERO, towards, DVec3::Z).unwrap();
        let window = Window::of_view(0.001, Measured::Height, [2.0, 2.0]).unwrap();
        let camera = Perspective::new(Body::new(viewpoint, 2, 2).unwrap(), window);
        render(&scene, &camera, &Fog { distance: 1.5 }, &settings, &mut Quiet).unwrap().rgb()[0][0]
    };
    assert!((brightness(DVec3::X) - 0.25).abs() < 1e-6);
    assert_eq!(brightness(DVec3::NEG_X), 0.0);
}
