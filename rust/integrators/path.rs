//! Path tracing.

use super::{CameraSample, Integrator, Worker};
use crate::math::{DVec3, Hit, Ray};
use crate::optics::Rgb;
use crate::sampling::{CAMERA_DIMENSIONS, Sampler};
use crate::scene::{Interaction, Receiver, Scene, ShadingPoint};
use crate::workers::Cancel;

/// Unidirectional path tracing (Kajiya, "The Rendering Equation", 1986): at each bounce one light is asked directly,
/// which is combined with running into lights by chance through multiple importance sampling (Veach and Guibas,
/// "Optimally Combining Sampling Techniques", 1995), and Russian roulette ends paths (Arvo and Kirk, 1990).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path {
    /// The greatest number of bounces off surfaces; 0 shows only what shines itself. `None` is all of them.
    pub max_depth: Option<u32>,
    /// Roulette is played from this number of bounces on.
    pub roulette_depth: u32,
}

impl Default for Path {
    fn default() -> Self {
        Self { max_depth: None, roulette_depth: 4 }
    }
}

impl Path {
    /// Bounces after which roulette is played whatever was asked, so that every path ends.
    const ROULETTE_AT_LATEST: u32 = 4096;

    /// The greatest probability to survive a round: a path in a closed box of albedo 1 ends after some four thousand
    /// bounces.
    const SURVIVAL: f64 = 1.0 - 1.0 / 4096.0;

    /// The probability that a path of this throughput survives a round.
    ///
    /// Dividing by it must not let the throughput grow from round to round: after k rounds of reflectance ρ and survival
    /// q the second moment is (ρ²/q)ᵏ, whose sum over k is finite only for q > ρ². A fixed bound such as the usual 0.95
    /// breaks that in bright surroundings, and the error bar with it. By the root of the throughput, both settle at ρ,
    /// and up to a reflectance of 0.9998 the bound is never reached. The throughput itself would do as well, but ends
    /// paths earlier than pays: in a Cornell box it takes 10 % less time for 15 % more error, and leaves a longer tail.
    #[inline]
    fn survival(throughput: Rgb) -> f64 {
        throughput.max_element().sqrt().min(Self::SURVIVAL)
    }
}

impl Integrator for Path {
    fn worker<'a>(&'a self, scene: &'a Scene) -> Box<dyn Worker + 'a> {
        Box::new(PathWorker {
            path: self,
            scene,
            rays: Vec::new(),
            alive: Vec::new(),
            hits: Vec::new(),
            shadow_rays: Vec::new(),
            unshadowed: Vec::new(),
            occluded: Vec::new(),
        })
    }
}

/// A path on its way.
#[derive(Clone, Copy)]
struct Alive {
    throughput: Rgb,
    /// Density with which the last surface drew this direction; infinite for a camera's ray.
    pdf: f64,
    /// Where that was, as lights see it.
    from: Receiver,
    /// When all of the path is asked.
    time: f64,
    /// Whose sample it is.
    sample: u32,
}

struct PathWorker<'a> {
    path: &'a Path,
    scene: &'a Scene,
    /// The paths that go on, and the ray that each is about to follow.
    rays: Vec<Ray>,
    alive: Vec<Alive>,
    hits: Vec<Hit>,
    /// What would arrive at a sample if nothing lies on the way.
    shadow_rays: Vec<Ray>,
    unshadowed: Vec<(u32, Rgb)>,
    occluded: Vec<bool>,
}

/// The dimensions of a bounce. The choice among several kinds of scattering comes last, as most surfaces have one.
#[derive(Clone, Copy)]
struct Dimensions(u32);

impl Dimensions {
    const EACH: u32 = 6;

    fn of_bounce(bounce: u32) -> Self {
        // Wrapping after 700 million bounces harms nobody.
        Self(CAMERA_DIMENSIONS.wrapping_add(bounce.wrapping_mul(Self::EACH)))
    }
    fn light_choice(self) -> u32 {
        self.0
    }
    fn light_point(self) -> u32 {
        self.0 + 1
    }
    fn direction(self) -> u32 {
        self.0 + 2
    }
    fn roulette(self) -> u32 {
        self.0 + 3
    }
    fn scattering_choice(self) -> u32 {
        self.0 + 4
    }
}

impl Worker for PathWorker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        assert_eq!(samples.len(), radiance.len());
        radiance.fill(Rgb::ZERO);
        self.rays.clear();
        self.rays.extend(samples.iter().map(|s| s.ray));
        self.alive.clear();
        self.alive.extend((0u32..).zip(&*samples).map(|(sample, drawn)| Alive {
            throughput: Rgb::ONE,
            pdf: f64::INFINITY,
            from: Receiver::free(DVec3::ZERO),
            time: drawn.ray.time,
            sample,
        }));
        let mut bounce = 0;
        while !self.rays.is_empty() && !cancel.is_raised() {
            self.hits.resize(self.rays.len(), Hit::MISS);
            self.scene.intersect(&self.rays, &mut self.hits);
            self.shade(bounce, samples, radiance);
            self.gather(radiance);
            bounce += 1;
        }
    }
}

impl PathWorker<'_> {
    /// Adds what paths have run into, sends shadow rays, and takes the paths that go on to the front of the queue.
    fn shade(&mut self, bounce: u32, samples: &mut [CameraSample], radiance: &mut [Rgb]) {
        self.shadow_rays.clear();
        self.unshadowed.clear();
        let last = self.path.max_depth.is_some_and(|depth| bounce >= depth);
        let mut kept = 0;
        for i in 0..self.rays.len() {
            let (ray, path, hit) = (self.rays[i], self.alive[i], self.hits[i]);
            let arriving = &mut radiance[path.sample as usize];
            if !hit.is_hit() {
                let lights = self.scene.lights();
                let weight = power_heuristic(path.pdf, lights.outside_pdf(&path.from, ray.direction));
                *arriving += path.throughput * lights.outside(ray.direction) * weight;
                continue;
            }
            let surface = self.scene.geometry().surface(&ray, &hit);
            let cosine = -ray.direction.dot(surface.normal);
            let emission = self.scene.emission_at(&surface);
            let needs = emission.needs();
            let point = ShadingPoint::new(self.scene.geometry(), &ray, &hit, &surface, needs, 0.0);
            let emission = emission.towards(cosine, &point.texture);
            if emission != Rgb::ZERO {
                let light_pdf = self.scene.lights().surface_pdf(self.scene.geometry(), &path.from, &ray, &hit, cosine);
                *arriving += path.throughput * emission * power_heuristic(path.pdf, light_pdf);
            }
            if last {
                continue;
            }
            let here = Interaction::new(self.scene, &ray, &hit, surface, 0.0);
            let sampler = &mut samples[path.sample as usize].sampler;
            self.ask_a_light(&here, &path, Dimensions::of_bounce(bounce), sampler);
            if let Some((ray, path)) = self.scatter(&here, path, bounce, sampler) {
                self.rays[kept] = ray;
                self.alive[kept] = path;
                kept += 1;
            }
        }
        self.rays.truncate(kept);
        self.alive.truncate(kept);
    }

    /// Next-event estimation: draws light and queues the shadow ray.
    #[inline]
    fn ask_a_light(&mut self, here: &Interaction, path: &Alive, dimensions: Dimensions, sampler: &mut Sampler) {
        if self.scene.lights().is_dark() {
            return;
        }
        let Some(light) = self.scene.lights().sample(
            self.scene.geometry(),
            &Receiver { position: here.position(), normal: here.shading_normal() },
            sampler.one(dimensions.light_choice()),
            sampler.two(dimensions.light_point()),
        ) else {
            return;
        };
        let (scattered, pdf) = here.evaluate(light.direction);
        let arriving = path.throughput * scattered * light.weight * power_heuristic(light.pdf, pdf);
        if arriving != Rgb::ZERO {
            let from = here.departure();
            let ray = match &light.source {
                Some(source) => from.segment(source),
                None => from.ray(light.direction),
            };
            self.shadow_rays.push(Ray { time: path.time, ..ray });
            self.unshadowed.push((path.sample, arriving));
        }
    }

    /// Draws where the path goes on to, if it does.
    #[inline]
    fn scatter(&self, here: &Interaction, mut path: Alive, bounce: u32, sampler: &mut Sampler) -> Option<(Ray, Alive)> {
        let dimensions = Dimensions::of_bounce(bounce);
        let u = sampler.two(dimensions.direction());
        let next = here.sample(|| sampler.one(dimensions.scattering_choice()), u)?;
        path.throughput *= next.weight;
        path.pdf = next.pdf;
        path.from = Receiver { position: here.position(), normal: here.shading_normal() };
        if bounce + 1 >= self.path.roulette_depth.min(Path::ROULETTE_AT_LATEST) {
            let survival = Path::survival(path.throughput);
            if sampler.one(dimensions.roulette()) >= survival {
                return None;
            }
            path.throughput /= survival;
        }
        let ray = here.departure().ray(next.direction);
        Some((Ray { time: path.time, ..ray }, path))
    }

    /// Adds the light of shadow rays that meet nothing.
    fn gather(&mut self, radiance: &mut [Rgb]) {
        self.occluded.resize(self.shadow_rays.len(), false);
        self.scene.occluded(&self.shadow_rays, &mut self.occluded);
        for (&(sample, arriving), &occluded) in self.unshadowed.iter().zip(&self.occluded) {
            if !occluded {
                radiance[sample as usize] += arriving;
            }
        }
    }
}

/// The weight of a draw of one technique, of density `pdf`, beside another of density `other`
/// (Veach and Guibas, 1995, with the exponent 2). Written by the ratio, squares cannot overflow, and an infinite
/// density gets the weight 1.
#[inline]
fn power_heuristic(pdf: f64, other: f64) -> f64 {
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Accelerator, BruteForce};
    use crate::scene::fixtures::{furnace, inward_box, rectangle, scene, shape};
    use crate::scene::{ConstantEnvironment, Copies, Geometry, Group, Matrix, PointLight, SceneDescription, Shape};
    use crate::simd::Level;
    use std::sync::Arc;

    /// Mean and standard error of the green radiance along a ray.
    fn radiance(scene: &Scene, path: &Path, ray: Ray, count: u32) -> (f64, f64) {
        let mut samples: Vec<_> =
            (0..count).map(|number| CameraSample { ray, sampler: Sampler::new(3, 0, number) }).collect();
        let mut values = vec![Rgb::ZERO; count as usize];
        let mut worker = path.worker(scene);
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
        let points = scene(SceneDescription { shapes: floor(), lights: vec![Arc::new(point)] });
        let expected = 0.5 * 0.353_553_390_593_273_73 / std::f64::consts::PI;
        assert_radiance(&points, &Path::default(), ray, 10, expected);
        let sky = Arc::new(ConstantEnvironment { radiance: Rgb::splat(2.0) });
        let sky = scene(SceneDescription { shapes: floor(), lights: vec![sky] });
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
            let mut worker = path.worker(&scene);
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
    fn heuristic_weights_add_up_and_survive_extremes() {
        for (a, b) in [(1.0, 3.0), (1e-200, 1e200), (1e300, 1e300)] {
            assert!((power_heuristic(a, b) + power_heuristic(b, a) - 1.0).abs() < 1e-15);
        }
        assert_eq!(power_heuristic(f64::INFINITY, 5.0), 1.0);
        assert_eq!(power_heuristic(5.0, f64::INFINITY), 0.0);
    }
}
