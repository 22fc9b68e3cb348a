//! Light tracing: contributions to the film from paths that start at lights.
//!
//! Each sample of a picture has one such path per pixel, and its contribution to a pixel is part of that pixel's sample
//! with the same number. So a pixel's samples stay independent, and the error estimate includes light paths. The bits
//! do not depend on passes or on where samples are taken.

use super::Settings;
use super::filter::{FilmCropping, Filter};
use raywright_base::parallel;
use raywright_base::sampling::{Sampler, SamplerKind};
use raywright_base::workers::Cancel;
use raywright_integrators::{LightWorker, Session, Splat};
use raywright_optics::Rgb;
use raywright_scene::Camera;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Light paths traced together. It determines the order of summation, and thus the bits.
const TOGETHER: u32 = 4096;

/// Maximum number of pixels, over all samples together, in memory at a time: 50 MB.
const AT_ONCE: usize = 1 << 21;

/// Maximum number of chunks stored before summation, of about the same size.
const CHUNKS: usize = 256;

/// Traces light paths for all samples of a picture.
pub(super) struct LightTracer<'a> {
    session: &'a dyn Session,
    filter: &'a dyn Filter,
    /// Cropping of the filter at the film's edges.
    edges: Option<FilmCropping>,
    kind: SamplerKind,
    seed: u64,
    width: u32,
    height: u32,
    idle: Mutex<Vec<Bench<'a>>>,
}

/// State of a thread.
struct Bench<'a> {
    worker: Box<dyn LightWorker + 'a>,
    samplers: Vec<Sampler>,
}

/// Contributions of light paths to each pixel, for a range of sample numbers.
pub(super) struct Brought {
    first: u32,
    width: u32,
    pictures: Vec<Vec<Rgb>>,
}

impl Brought {
    /// Contribution to a pixel in its sample with this number.
    #[inline]
    pub fn to(&self, (x, y): (u32, u32), number: u32) -> Rgb {
        self.pictures[(number - self.first) as usize][y as usize * self.width as usize + x as usize]
    }
}

impl<'a> LightTracer<'a> {
    /// Creates the tracer if the session has light paths.
    pub fn new(camera: &dyn Camera, session: &'a dyn Session, settings: &'a Settings) -> Option<Self> {
        let worker = session.light_worker()?;
        Some(Self {
            session,
            filter: settings.filter.as_ref(),
            edges: FilmCropping::new(settings.filter.as_ref(), [camera.width(), camera.height()]),
            kind: settings.sampler,
            seed: settings.seed,
            width: camera.width(),
            height: camera.height(),
            idle: Mutex::new(vec![Bench { worker, samplers: Vec::new() }]),
        })
    }

    /// Number of samples traced at a time.
    pub fn at_once(&self) -> u32 {
        (AT_ONCE / self.pixel_count().max(1)).clamp(1, 1 << 10) as u32
    }

    fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Contributions of light paths to samples with these numbers, computed by the current thread pool or by this
    /// thread alone. Invalid once canceled.
    pub fn trace(&self, numbers: Range<u32>, alone: bool, cancel: &Cancel) -> Brought {
        let paths = self.pixel_count() as u32;
        let of_number = |number: u32| (0..paths.div_ceil(TOGETHER)).map(move |chunk| (number, chunk));
        let chunks: Vec<(u32, u32)> = numbers.clone().flat_map(of_number).collect();
        let mut pictures = vec![vec![Rgb::ZERO; self.pixel_count()]; numbers.len()];
        for chunks in chunks.chunks(CHUNKS) {
            let follow = |&(number, chunk): &(u32, u32)| {
                let paths = chunk * TOGETHER..paths.min((chunk + 1) * TOGETHER);
                self.follow(number, paths, cancel)
            };
            let brought: Vec<Vec<Splat>> = if alone {
                chunks.iter().map(follow).collect()
            } else {
                parallel::map(chunks.len(), |i| follow(&chunks[i]))
            };
            if cancel.is_raised() {
                break;
            }
            for ((number, _), splats) in chunks.iter().zip(&brought) {
                let picture = &mut pictures[(number - numbers.start) as usize];
                splats.iter().for_each(|splat| self.add(splat, picture));
            }
        }
        Brought { first: numbers.start, width: self.width, pictures }
    }

    /// Traces some of the paths of a sample.
    fn follow(&self, number: u32, paths: Range<u32>, cancel: &Cancel) -> Vec<Splat> {
        /// Light paths use pixel numbers beyond those of any picture.
        const BEYOND: u32 = 1 << 31;
        let mut splats = Vec::new();
        if cancel.is_raised() {
            return splats;
        }
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let bench = idle.or_else(|| Some(Bench { worker: self.session.light_worker()?, samplers: Vec::new() }));
        let Some(mut bench) = bench else { return splats };
        bench.samplers.clear();
        bench.samplers.extend(paths.map(|path| self.kind.sampler(self.seed, BEYOND | path, number)));
        bench.worker.follow(&mut bench.samplers, cancel, &mut splats);
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(bench);
        splats
    }

    /// Adds a splat to all pixels whose filters contain it.
    fn add(&self, splat: &Splat, picture: &mut [Rgb]) {
        let (radius, light) = (self.filter.radius(), splat.light / self.pixel_count() as f64);
        // Pixels whose centers are close enough; the cast clamps negative values to 0.
        let near = |at: f64, count: u32| {
            let (first, end) = ((at - 0.5 - radius).ceil().max(0.0), (at - 0.5 + radius).floor() + 1.0);
            first as u32..(end.max(0.0) as u32).min(count)
        };
        let [x, y] = splat.film;
        let is_on = |at: f64, count: u32| (0.0..=f64::from(count)).contains(&at);
        if self.edges.is_some() && !(is_on(x, self.width) && is_on(y, self.height)) {
            return;
        }
        for row in near(y, self.height) {
            for column in near(x, self.width) {
                let weight = self.filter.evaluate(x - (f64::from(column) + 0.5), y - (f64::from(row) + 0.5));
                let share = self.edges.as_ref().map_or(1.0, |edges| edges.share([column, row]));
                picture[row as usize * self.width as usize + column as usize] += light * (weight / share);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::filter::{Box as BoxFilter, Gaussian, Mitchell, Separable};
    use super::super::{Quiet, RenderError, Rendering, Settings, Until, go_on, render};
    use super::*;
    use raywright_base::math::DVec3;
    use raywright_integrators::{Integrator, LightTraced, Path};
    use raywright_scene::cameras::{Aperture, Body, Fisheye, Mapping, Measured, Orthographic, Panorama, Perspective};
    use raywright_scene::cameras::{ThinLens, Viewpoint, Window};
    use raywright_scene::fixtures::{cornell, furnace};
    use raywright_scene::{Camera, Scene};
    use std::sync::Arc;

    fn settings(samples: u32) -> Settings {
        let until = Until { samples: Some(samples), ..Until::default() };
        Settings { until, threads: Some(2), ..Settings::default() }
    }

    fn run(scene: &Scene, camera: &dyn Camera, integrator: &dyn Integrator, settings: &Settings) -> Rendering {
        render(scene, camera, integrator, settings, &mut Quiet).unwrap()
    }

    /// Mean of all pixels and channels in a block, and its standard error.
    fn block(rendering: &Rendering, [x, y]: [u32; 2], side: u32) -> (f64, f64) {
        let (means, variances) = (rendering.film.means(), rendering.film.variances().unwrap());
        let width = rendering.film.width();
        let within = || (y..y + side).flat_map(|y| (x..x + side).map(move |x| (y * width + x) as usize));
        let count = f64::from(side * side);
        let mean = within().map(|i| means[i].mean()).sum::<f64>() / count;
        // Channels of a pixel are correlated, so the largest of their variances is a safe bound.
        let variance = within().map(|i| variances[i].max()).sum::<f64>() / (count * count);
        (mean, variance.sqrt())
    }

    /// Light tracing and path tracing give the same picture: each block of 4 × 4 pixels agrees within five joint
    /// standard errors, which have a probability of one in two million.
    fn assert_same_picture(scene: &Scene, camera: &dyn Camera, settings: &Settings) {
        let light = run(scene, camera, &LightTraced::default(), settings);
        let path = run(scene, camera, &Path::default(), settings);
        assert_eq!(light.film.dropped(), 0);
        for y in (0..camera.height()).step_by(4) {
            for x in (0..camera.width()).step_by(4) {
                let ((a, off), (b, other)) = (block(&light, [x, y], 4), block(&path, [x, y], 4));
                let error = off.hypot(other);
                assert!((a - b).abs() <= 5.0 * error + 1e-9, "{camera:?} at {x}, {y}: {a} ± {off}, {b} ± {other}");
            }
        }
        let sum = |rendering: &Rendering| rendering.film.means().iter().map(|rgb| rgb.mean()).sum::<f64>();
        assert!((sum(&light) / sum(&path) - 1.0).abs() < 0.05, "{} {}", sum(&light), sum(&path));
    }

    #[test]
    fn a_furnace_shines_by_its_series_at_every_depth() {
        // In a closed box no light is lost: the radiance is the partial geometric series everywhere.
        let scene = furnace(0.5, 1.0);
        let camera = Perspective::looking_at(DVec3::new(0.3, -0.2, 0.1), DVec3::NEG_Z, DVec3::Y, 90.0, 8, 8).unwrap();
        for depth in [0, 1, 2, 5] {
            let traced = LightTraced { max_depth: Some(depth), ..LightTraced::default() };
            let rendering = run(&scene, &camera, &traced, &settings(400));
            let expected = 2.0 - 0.5f64.powi(depth as i32);
            let (mean, error) = block(&rendering, [0, 0], 8);
            assert!((mean - expected).abs() <= 4.0 * error + 1e-12, "{depth}: {mean} ± {error}, not {expected}");
            assert!(error < 0.01 * expected, "{error}");
        }
    }

    #[test]
    fn every_camera_sees_what_paths_do() {
        let (scene, _) = cornell(16, 12);
        let from = Viewpoint::look_at(DVec3::new(0.5, 0.5, 2.4), DVec3::new(0.5, 0.4, 0.0), DVec3::Y).unwrap();
        let inside = Viewpoint::look_at(DVec3::new(0.5, 0.6, 0.9), DVec3::new(0.4, 0.4, 0.0), DVec3::Y).unwrap();
        let body = |from| Body::new(from, 16, 12).unwrap();
        let window = Window::of_view(39.0, Measured::Height, [16.0, 12.0]).unwrap();
        let lens = Aperture::new(0.1, 5, 0.3).unwrap();
        let cameras: Vec<Box<dyn Camera>> = vec![
            Box::new(Perspective::new(body(from), window)),
            Box::new(Perspective::new(body(from).moved_to(inside), window)),
            Box::new(ThinLens::new(body(from), window, lens, 2.0).unwrap()),
            Box::new(Orthographic::new(body(from), 1.1, Measured::Height).unwrap()),
            Box::new(Panorama::new(body(inside))),
            Box::new(Fisheye::new(body(inside), 150.0, Mapping::Stereographic, Measured::Diagonal).unwrap()),
        ];
        for camera in cameras {
            assert_same_picture(&scene, &*camera, &settings(256));
        }
    }

    #[test]
    fn filters_weigh_light_that_comes_by_itself_too() {
        let (scene, camera) = cornell(16, 12);
        for filter in [
            Arc::new(BoxFilter::new(1.3).unwrap()) as Arc<dyn Filter>,
            Arc::new(Separable::new(Gaussian::new(1.5, 0.5).unwrap())),
            Arc::new(Separable::new(Mitchell::new(2.0, 1.0 / 3.0, 1.0 / 3.0).unwrap())),
        ] {
            assert_same_picture(&scene, &camera, &Settings { filter, ..settings(256) });
        }
    }

    #[test]
    fn threads_and_passes_change_no_bit() {
        let (scene, camera) = cornell(70, 61);
        for sampler in
            [SamplerKind::default(), SamplerKind::Sobol(raywright_base::sampling::BatchSize::new(4).unwrap())]
        {
            let settings = |samples, threads| Settings { threads: Some(threads), sampler, ..settings(samples) };
            let one = run(&scene, &camera, &LightTraced::default(), &settings(21, 1));
            let other = run(&scene, &camera, &LightTraced::default(), &settings(21, 3));
            assert_eq!((other.rgb(), other.error), (one.rgb(), one.error));
            let mut parts = Rendering::new(settings(21, 2).film(&camera, 2, 1));
            for samples in [3, 4, 17, 21] {
                let settings = settings(samples, 2);
                while !go_on(&mut parts, &scene, &camera, &LightTraced::default(), &settings, &mut Quiet).unwrap() {}
            }
            assert_eq!(parts.rgb(), one.rgb());
        }
    }

    #[test]
    fn light_comes_to_all_pixels_alike() {
        let (scene, camera) = cornell(8, 8);
        let settings = Settings { adaptive: true, ..settings(16) };
        let refused = render(&scene, &camera, &LightTraced::default(), &settings, &mut Quiet);
        assert!(matches!(refused, Err(RenderError::Unsuited(why)) if why.contains("adaptive=False")));
    }
}
