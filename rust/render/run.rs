//! A render from start to end.

use super::adaptive::Adaptive;
use super::error::estimate;
use super::filter::{self, Filter};
use super::tiles::{Exposure, Goal};
use super::{ErrorEstimate, Film, Progress, Until};
use crate::integrators::Integrator;
use crate::optics::Rgb;
use crate::sampling::SamplerKind;
use crate::scene::{Camera, Scene};
use crate::workers::{Cancel, pool, watched};
use std::fmt;
use std::sync::Arc;
use std::time::Instant;

/// How to render.
#[derive(Clone, Debug)]
pub struct Settings {
    /// When to end. With nothing set, the render goes on until its [`Progress`] ends it.
    pub until: Until,
    /// Which of all possible pictures.
    pub seed: u64,
    /// How many threads work; `None` for as many as there are cores.
    pub threads: Option<usize>,
    /// Where the random numbers come from.
    pub sampler: SamplerKind,
    /// Whether more samples go where more of the error is; else all pixels have the same number.
    pub adaptive: bool,
    /// The radiance to which brighter samples are dimmed, which biases the picture; `None` takes all as they are.
    pub clamp: Option<f64>,
    /// What part of the film a pixel is the mean of.
    pub filter: Arc<dyn Filter>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            until: Until::default(),
            seed: 0,
            threads: None,
            sampler: SamplerKind::default(),
            adaptive: false,
            clamp: None,
            filter: Arc::new(filter::Box::default()),
        }
    }
}

/// How far a render was after a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HistoryRow {
    /// Wall-clock time since the start.
    pub seconds: f64,
    /// Samples of each pixel, or of all on average.
    pub samples: u32,
    /// Estimated relMSE; NaN as long as nothing can be said.
    pub error: f64,
}

/// A finished render.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The picture.
    pub film: Film,
    /// How wrong it still is; `None` if it has too few samples to say.
    pub error: Option<ErrorEstimate>,
    /// How it went, a row a pass.
    pub history: Vec<HistoryRow>,
    /// Wall-clock time it took.
    pub seconds: f64,
}

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RenderError {
    /// Its [`Progress`] ended the render.
    Interrupted,
    /// The threads asked for are not to be had.
    Threads(String),
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interrupted => f.write_str("the render was interrupted"),
            Self::Threads(why) => f.write_str(why),
        }
    }
}

impl std::error::Error for RenderError {}

impl Rendering {
    /// The picture, linear, row by row from the top.
    pub fn rgb(&self) -> Vec<[f32; 3]> {
        single(self.film.means())
    }

    /// The standard error of each pixel; NaN if it has too few samples to say.
    pub fn standard_error(&self) -> Vec<[f32; 3]> {
        match self.film.variances() {
            Some(variances) => single(variances.into_iter().map(|v| v.map(f64::sqrt)).collect()),
            None => vec![[f32::NAN; 3]; self.film.width() as usize * self.film.height() as usize],
        }
    }
}

fn single(pixels: Vec<Rgb>) -> Vec<[f32; 3]> {
    pixels.into_iter().map(|rgb| rgb.to_array().map(|x| x as f32)).collect()
}

/// Renders until the first of `settings.until` is met. `progress` is called on this thread. All work is done on others, but
/// for an integrator that [`Integrator::runs_on_caller`].
///
/// To end at an estimated error is to look at the samples that the picture is made of, and a picture that happens to be
/// darker ends sooner. That bias is far below the error: the estimate is a sum over all pixels, in which each hardly counts.
pub fn render(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn Integrator,
    settings: &Settings,
    progress: &mut dyn Progress,
) -> Result<Rendering, RenderError> {
    let start = Instant::now();
    let exposure = Exposure::new(scene, camera, integrator, settings);
    let side = exposure.tile_side(pool(settings.threads).map_err(RenderError::Threads)?.current_num_threads());
    let batch = settings.sampler.batch();
    let mut film = Film::new(camera.width(), camera.height(), side, batch, settings.adaptive, settings.clamp);
    let mut plan = settings.adaptive.then(|| Adaptive::new(&mut film));
    let (mut error, mut history, mut rate) = (None, Vec::<HistoryRow>::new(), 0.0);
    loop {
        let before = start.elapsed().as_secs_f64();
        let done = film.samples();
        let limit = plan.as_ref().map_or(u32::MAX, |plan| plan.limit(done)) - done;
        let count = settings.until.next_pass(done, batch, before, rate, error.as_ref()).min(limit);
        if count == 0 {
            return Ok(Rendering { film, error, history, seconds: before });
        }
        error = pass(&exposure, &mut film, plan.as_mut(), done + count, settings.threads, progress)?;
        let seconds = start.elapsed().as_secs_f64();
        rate = (seconds - before) / f64::from(count);
        let row = HistoryRow { seconds, samples: film.samples(), error: error.map_or(f64::NAN, |e| e.value) };
        history.push(row);
        if progress.pass(&row).is_break() {
            return Err(RenderError::Interrupted);
        }
    }
}

/// Exposes the film until there are so many samples, and estimates its error.
fn pass(
    exposure: &Exposure,
    film: &mut Film,
    plan: Option<&mut Adaptive>,
    samples: u32,
    threads: Option<usize>,
    progress: &mut dyn Progress,
) -> Result<Option<ErrorEstimate>, RenderError> {
    let prepared = |film: &mut Film| Goal {
        samples,
        plan: plan.map(|plan| {
            plan.prepare(film);
            &*plan
        }),
    };
    let error = if exposure.integrator.runs_on_caller() {
        let (pool, cancel) = (pool(threads).map_err(RenderError::Threads)?, Cancel::default());
        let goal = pool.install(|| prepared(film));
        exposure.expose_here(film, goal, &cancel, || {
            if progress.poll().is_break() {
                cancel.raise();
            }
        });
        (!cancel.is_raised()).then(|| pool.install(|| estimate(film)))
    } else {
        let work = |cancel: &Cancel| {
            let goal = prepared(film);
            exposure.expose(film, goal, cancel);
            (!cancel.is_raised()).then(|| estimate(film))
        };
        let mut ended = false;
        let watch = || {
            ended = progress.poll().is_break();
            !ended
        };
        // Who watches may end a pass that has just been done.
        watched(threads, work, watch).map_err(RenderError::Threads)?.filter(|_| !ended)
    };
    // It is raised by who watches, or by an integrator that cannot go on.
    error.ok_or(RenderError::Interrupted)
}

#[cfg(test)]
mod tests {
    use super::super::Quiet;
    use super::*;
    use crate::integrators::{CameraSample, Path, Worker};
    use crate::scene::Footprint;
    use crate::scene::fixtures::{cornell, furnace};
    use std::ops::ControlFlow;
    use std::time::Duration;

    fn settings(samples: u32, threads: usize) -> Settings {
        Settings {
            until: Until { samples: Some(samples), ..Until::default() },
            threads: Some(threads),
            ..Settings::default()
        }
    }

    #[test]
    fn threads_and_passes_change_no_bit() {
        let (scene, camera) = cornell(21, 13);
        let run = |settings| render(&scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap();
        let one = run(settings(37, 1));
        for threads in [2, 5] {
            let other = run(settings(37, threads));
            assert_eq!(other.rgb(), one.rgb());
            assert_eq!(other.standard_error(), one.standard_error());
            assert_eq!(other.error, one.error);
            let errors = |r: &Rendering| r.history.iter().map(|row| row.error.to_bits()).collect::<Vec<_>>();
            assert_eq!(errors(&other), errors(&one));
        }
        // Ending by time makes other passes. However far it came, the same samples make the same picture.
        let until = Until { seconds: Some(0.05), ..Until::default() };
        let timed = run(Settings { until, ..settings(0, 2) });
        let again = run(settings(timed.film.samples(), 1));
        assert_eq!(again.film.means(), timed.film.means());
    }

    #[test]
    fn seeds_give_other_pictures_of_the_same() {
        let (scene, camera) = cornell(8, 8);
        let run = |seed| {
            let settings = Settings { seed, ..settings(64, 2) };
            render(&scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap()
        };
        let (a, b) = (run(1), run(2));
        assert_ne!(a.rgb(), b.rgb());
        assert_eq!(a.rgb(), run(1).rgb());
    }

    #[test]
    fn adaptive_pictures_have_one_face_too() {
        let (scene, camera) = cornell(21, 13);
        let adaptive = |until, threads| {
            let settings = Settings { adaptive: true, until, ..settings(0, threads) };
            render(&scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap()
        };
        let samples = |samples| Until { samples: Some(samples), ..Until::default() };
        let one = adaptive(samples(90), 1);
        for threads in [2, 5] {
            let other = adaptive(samples(90), threads);
            assert_eq!(other.film.counts(), one.film.counts());
            assert_eq!(other.rgb(), one.rgb());
            assert_eq!(other.error, one.error);
        }
        // Cells round to whole samples, by a pattern.
        let all: u32 = one.film.counts().iter().sum();
        assert!((f64::from(all) / (21.0 * 13.0 * 90.0) - 1.0).abs() < 0.01, "{all}");
        let timed = adaptive(Until { seconds: Some(0.05), ..Until::default() }, 2);
        let again = adaptive(samples(timed.film.samples()), 1);
        assert_eq!(again.film.means(), timed.film.means());
        assert!(adaptive(samples(16), 1).film.counts().iter().all(|&count| count == 16));
    }

    /// Works where it is told, and remembers the largest batch that it was given.
    struct Here(std::thread::ThreadId, std::sync::atomic::AtomicUsize);

    struct HereWorker<'a>(&'a Here, Box<dyn Worker + 'a>);

    impl Integrator for Here {
        fn worker<'a>(&'a self, scene: &'a Scene, footprint: Footprint) -> Box<dyn Worker + 'a> {
            static PATH: Path = Path { max_depth: None, roulette_depth: 4 };
            Box::new(HereWorker(self, PATH.worker(scene, footprint)))
        }
        fn runs_on_caller(&self) -> bool {
            true
        }
    }

    impl Worker for HereWorker<'_> {
        fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
            assert_eq!(std::thread::current().id(), self.0.0);
            if self.0.1.fetch_max(samples.len(), std::sync::atomic::Ordering::Relaxed) == usize::MAX {
                cancel.raise();
            }
            self.1.radiance(samples, cancel, radiance);
        }
    }

    #[test]
    fn an_integrator_may_stay_on_the_calling_thread() {
        let (scene, camera) = cornell(70, 61);
        let mut settings = settings(20, 2);
        for adaptive in [false, true] {
            settings.adaptive = adaptive;
            let here = Here(std::thread::current().id(), Default::default());
            let mine = render(&scene, &camera, &here, &settings, &mut Quiet).unwrap();
            let theirs = render(&scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap();
            assert_eq!((mine.rgb(), mine.error), (theirs.rgb(), theirs.error));
            // The pass from 8 to 16 samples is 34,160 paths.
            assert_eq!(here.1.into_inner(), 70 * 61 * 8);
            // It can end the render.
            let here = Here(std::thread::current().id(), usize::MAX.into());
            let result = render(&scene, &camera, &here, &settings, &mut Quiet);
            assert_eq!(result.err(), Some(RenderError::Interrupted));
            // So can who watches.
            let (here, (_, large)) = (Here(std::thread::current().id(), Default::default()), cornell(300, 300));
            let result = render(&scene, &large, &here, &settings, &mut Impatient(None));
            assert_eq!(result.err(), Some(RenderError::Interrupted));
            assert_eq!(here.1.into_inner(), 65_536);
        }
    }

    #[test]
    fn history_tells_how_it_went() {
        let (scene, camera) = cornell(16, 16);
        let rendering = render(&scene, &camera, &Path::default(), &settings(40, 2), &mut Quiet).unwrap();
        let samples: Vec<u32> = rendering.history.iter().map(|row| row.samples).collect();
        assert_eq!(samples, [1, 2, 4, 8, 16, 32, 40]);
        assert!(rendering.history[0].error.is_nan() && rendering.history[1].error > 0.0);
        assert!(rendering.history.is_sorted_by(|a, b| a.seconds <= b.seconds));
        assert!(rendering.seconds >= rendering.history[6].seconds);
        assert_eq!(rendering.history[6].error, rendering.error.unwrap().value);
        assert_eq!(rendering.film.dropped(), 0);
    }

    #[test]
    fn ends_at_an_error_or_a_time() {
        let (scene, camera) = cornell(24, 24);
        let run = |until| {
            let settings = Settings { until, threads: Some(2), ..Settings::default() };
            render(&scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap()
        };
        let rendering = run(Until { error: Some(0.02), ..Until::default() });
        assert!(rendering.error.unwrap().high <= 0.02);
        assert!(rendering.history[rendering.history.len() - 2].error > 0.01);
        let rendering = run(Until { seconds: Some(0.5), ..Until::default() });
        assert!((0.3..2.0).contains(&rendering.seconds), "{}", rendering.seconds);
        let rendering = run(Until { samples: Some(0), ..Until::default() });
        assert_eq!((rendering.film.samples(), rendering.error), (0, None));
        assert!(rendering.standard_error()[0][0].is_nan() && rendering.rgb()[0] == [0.0; 3]);
    }

    /// Ends the render at the first poll.
    struct Impatient(Option<Instant>);

    impl Progress for Impatient {
        fn pass(&mut self, _row: &HistoryRow) -> ControlFlow<()> {
            ControlFlow::Continue(())
        }

        fn poll(&mut self) -> ControlFlow<()> {
            self.0.get_or_insert_with(Instant::now);
            ControlFlow::Break(())
        }
    }

    #[test]
    fn ends_at_once_when_asked() {
        // A pass of this takes seconds: paths of thousands of bounces.
        let scene = furnace(1.0, 1.0);
        let (_, camera) = cornell(256, 256);
        let mut progress = Impatient(None);
        let result = render(&scene, &camera, &Path::default(), &settings(64, 2), &mut progress);
        assert_eq!(result.err(), Some(RenderError::Interrupted));
        let waited = progress.0.expect("it was polled").elapsed();
        assert!(waited < Duration::from_millis(100), "{waited:?}");
    }

    #[test]
    fn the_error_of_a_cornell_box_is_as_estimated() {
        let (scene, camera) = cornell(24, 24);
        let run = |samples, seed| {
            let settings = Settings { seed, ..settings(samples, 2) };
            render(&scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap()
        };
        let reference = run(3200, 1_000_000).film.means();
        let close = (0..40u64)
            .filter(|&seed| {
                let rendering = run(16, seed);
                let truth: f64 = rendering
                    .film
                    .means()
                    .iter()
                    .zip(&reference)
                    .map(|(x, mu)| ((*x - *mu).powf(2.0) / (*mu * *mu + 0.01)).element_sum() / 3.0)
                    .sum();
                let ratio = rendering.error.unwrap().value / (truth / reference.len() as f64);
                (0.8..1.25).contains(&ratio)
            })
            .count();
        assert!(close >= 38, "{close} of 40");
    }
}
