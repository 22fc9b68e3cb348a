//! The render loop.

use super::pass_tiles::{Exposure, Stop};
use super::{Progress, Rendering, Settings};
use raywright_base::workers::{Cancel, pool, watched};
use raywright_integrators::{Integrator, Job, Session};
use raywright_scene::{Camera, Scene};
use std::fmt;
use std::time::Instant;

/// The reason why there is no picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RenderError {
    /// Its [`Progress`] ended the render.
    Interrupted,
    /// The requested threads are not available.
    Threads(String),
    /// The integrator does not support this scene or camera.
    Unsuited(String),
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interrupted => f.write_str("the render was interrupted"),
            Self::Threads(why) | Self::Unsuited(why) => f.write_str(why),
        }
    }
}

impl std::error::Error for RenderError {}

/// Renders until the first limit of `settings.until` is met. `progress` is called on this thread. All other work is on
/// other threads, except for an integrator that [`Integrator::runs_on_caller`].
///
/// Ending at an estimated error is a stopping rule that depends on the samples, and a picture that happens to be darker
/// ends sooner. This bias is far below the error, because the estimate is a sum over all pixels with little weight for
/// each.
pub fn render(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn Integrator,
    settings: &Settings,
    progress: &mut dyn Progress,
) -> Result<Rendering, RenderError> {
    let threads = pool(settings.threads).map_err(RenderError::Threads)?.threads();
    let mut rendering = Rendering::new(settings.film(camera, threads, integrator.patch(scene)));
    while !go_on(&mut rendering, scene, camera, integrator, settings, progress)? {}
    Ok(rendering)
}

/// Continues a render. Returns true if it has ended, and false if `progress` asked for a pause. After a pause or an
/// error it can be continued. Limits are checked after each pass; a pass in progress is finished first.
pub fn go_on(
    rendering: &mut Rendering,
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn Integrator,
    settings: &Settings,
    progress: &mut dyn Progress,
) -> Result<bool, RenderError> {
    let (start, earlier) = (Instant::now(), rendering.seconds);
    let spent = || earlier + start.elapsed().as_secs_f64();
    check(integrator, (scene, camera), settings, rendering.epoch().is_some())?;
    let session = begin(integrator, settings.job(scene, camera), settings.threads, progress)?;
    let exposure = Exposure::new(scene, camera, integrator, &*session, settings);
    let pool = pool(settings.threads).map_err(RenderError::Threads)?;
    loop {
        rendering.seconds = spent();
        let done = rendering.film.samples();
        let aim = rendering.next_aim(&settings.until, done, rendering.seconds, rendering.rate());
        if aim == done {
            return Ok(true);
        }
        pool.install(|| rendering.begin(aim));
        let passed = pass(&exposure, rendering, settings.threads, progress);
        rendering.seconds = spent();
        if !passed? {
            return Ok(false);
        }
        let row = pool.install(|| rendering.end(spent()));
        if progress.pass(&row, rendering.is_trusted()).is_break() {
            return Err(RenderError::Interrupted);
        }
        // Passes may be too short for a poll during one.
        if progress.rests() {
            return Ok(false);
        }
    }
}

/// Checks whether an integrator supports a picture.
pub(super) fn check(
    integrator: &dyn Integrator,
    (scene, camera): (&Scene, &dyn Camera),
    settings: &Settings,
    adaptive: bool,
) -> Result<(), RenderError> {
    let of_media = || {
        let is_lost = scene.plan().needs().media && !integrator.takes_media();
        is_lost.then(|| {
            "this integrator does not support media, which the scene has; Path scatters light in them, Direct and \
             Whitted attenuate it"
                .to_owned()
        })
    };
    let of_waves = || {
        let is_lost = scene.plan().needs().waves && !integrator.takes_waves();
        is_lost.then(|| {
            "this integrator does not support wavelengths, and the scene has a spectrum or a dispersive index of \
             refraction; use Path, Bidirectional, PhotonMap, LightTraced, Direct or Whitted"
                .to_owned()
        })
    };
    let of_view = || integrator.view_objection(camera, settings.filter.radius());
    let objection = of_media().or_else(of_waves).or_else(|| integrator.objection(scene, adaptive)).or_else(of_view);
    objection.map_or(Ok(()), |why| Err(RenderError::Unsuited(why)))
}

/// Begins a picture on this number of threads.
pub(super) fn begin<'a>(
    integrator: &'a dyn Integrator,
    job: Job<'a>,
    threads: Option<usize>,
    progress: &mut dyn Progress,
) -> Result<Box<dyn Session + 'a>, RenderError> {
    let mut goes_on = true;
    let watch = || {
        goes_on = progress.poll().is_continue();
        goes_on
    };
    let session = watched(threads, |cancel| integrator.begin(job, cancel), watch).map_err(RenderError::Threads)?;
    if goes_on { Ok(session) } else { Err(RenderError::Interrupted) }
}

/// Works on a pass; returns whether it is complete, or paused otherwise.
fn pass(
    exposure: &Exposure,
    rendering: &mut Rendering,
    threads: Option<usize>,
    progress: &mut dyn Progress,
) -> Result<bool, RenderError> {
    let stop = Stop::default();
    let done = rendering.film.samples();
    let (work, goal) = rendering.goal();
    let tiles = work.tiles.tiles();
    let mut look = || {
        if progress.pauses() {
            stop.pause.raise();
        }
        progress.poll().is_continue()
    };
    let reached = if exposure.stays {
        exposure.expose_here(tiles, done, goal, &stop, || {
            if !look() {
                stop.cancel.raise();
            }
        })
    } else {
        let mut ended = false;
        let watch = || {
            ended = !look();
            if ended {
                stop.cancel.raise();
            }
            !ended
        };
        // The observer may still end a pass that has just been finished.
        let expose = |_: &Cancel| {
            let reached = exposure.expose(tiles, done, goal, &stop);
            work.end();
            reached
        };
        watched(threads, expose, watch).map_err(RenderError::Threads)? && !ended
    };
    // Raised by the observer, or by an integrator that cannot continue.
    if stop.cancel.is_raised() { Err(RenderError::Interrupted) } else { Ok(reached) }
}

#[cfg(test)]
mod tests {
    use super::super::{HistoryRow, Quiet, Until};
    use super::*;
    use raywright_integrators::{CameraSample, Guiding, Path, Worker};
    use raywright_optics::Rgb;
    use raywright_scene::fixtures::{cornell, furnace};
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
        // A time limit leads to other passes. For any number of samples, the same samples give the same picture.
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

    /// An integrator that checks its thread and records its largest batch.
    struct Here(std::thread::ThreadId, std::sync::atomic::AtomicUsize);

    struct HereSession<'a>(&'a Here, Box<dyn Session + 'a>);

    struct HereWorker<'a>(&'a Here, Box<dyn Worker + 'a>);

    impl Integrator for Here {
        fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
            static PATH: Path = Path { max_depth: None, roulette_depth: 4, reuse: 1, guiding: Guiding::None };
            Box::new(HereSession(self, PATH.begin(job, cancel)))
        }
        fn runs_on_caller(&self) -> bool {
            true
        }
    }

    impl Session for HereSession<'_> {
        fn worker(&self) -> Box<dyn Worker + '_> {
            Box::new(HereWorker(self.0, self.1.worker()))
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

    /// Records the numbers of samples at which passes begin.
    #[derive(Default)]
    struct Noting(std::sync::Mutex<Vec<u32>>);

    struct NotingSession<'a>(&'a Noting, Box<dyn Session + 'a>);

    impl Integrator for Noting {
        fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
            static PATH: Path = Path { max_depth: Some(1), roulette_depth: 4, reuse: 1, guiding: Guiding::None };
            Box::new(NotingSession(self, PATH.begin(job, cancel)))
        }
    }

    impl Session for NotingSession<'_> {
        fn worker(&self) -> Box<dyn Worker + '_> {
            self.1.worker()
        }

        fn before_pass(&self, done: u32, _cancel: &Cancel) {
            self.0.0.lock().unwrap().push(done);
        }
    }

    #[test]
    fn a_session_is_told_of_each_pass() {
        let (scene, camera) = cornell(8, 8);
        for adaptive in [false, true] {
            let noting = Noting::default();
            let settings = Settings { adaptive, ..settings(40, 2) };
            let rendering = render(&scene, &camera, &noting, &settings, &mut Quiet).unwrap();
            let began = noting.0.into_inner().unwrap();
            let ended: Vec<u32> = rendering.history.iter().map(|row| row.samples).collect();
            assert_eq!((began[0], &began[1..]), (0, &ended[..ended.len() - 1]));
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
            // The pass from 8 to 16 samples has 34,160 paths.
            assert_eq!(here.1.into_inner(), 70 * 61 * 8);
            // The integrator can end the render.
            let here = Here(std::thread::current().id(), usize::MAX.into());
            let result = render(&scene, &camera, &here, &settings, &mut Quiet);
            assert_eq!(result.err(), Some(RenderError::Interrupted));
            // So can the observer.
            let (here, (_, large)) = (Here(std::thread::current().id(), Default::default()), cornell(300, 300));
            let result = render(&scene, &large, &here, &settings, &mut Impatient(None));
            assert_eq!(result.err(), Some(RenderError::Interrupted));
            // After the first part, or before it on a busy machine.
            let taken = here.1.into_inner();
            assert!(taken == 65_536 || taken == 0, "{taken}");
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
        fn pass(&mut self, _row: &HistoryRow, _trusted: bool) -> ControlFlow<()> {
            ControlFlow::Continue(())
        }

        fn poll(&mut self) -> ControlFlow<()> {
            self.0.get_or_insert_with(Instant::now);
            ControlFlow::Break(())
        }
    }

    #[test]
    fn ends_at_once_when_asked() {
        // A pass of this scene takes seconds: paths have thousands of bounces.
        let scene = furnace(1.0, 1.0);
        let (_, camera) = cornell(256, 256);
        let mut progress = Impatient(None);
        let result = render(&scene, &camera, &Path::default(), &settings(64, 2), &mut progress);
        assert_eq!(result.err(), Some(RenderError::Interrupted));
        let waited = progress.0.expect("it was polled").elapsed();
        assert!(waited < Duration::from_millis(100), "{waited:?}");
    }

    /// Pauses the render, or ends it, at every n-th poll.
    struct Restless {
        looks: u32,
        every: u32,
        ends: bool,
    }

    impl Restless {
        fn is_due(&mut self) -> bool {
            self.looks += 1;
            self.looks.is_multiple_of(self.every)
        }
    }

    impl Progress for Restless {
        fn pass(&mut self, _row: &HistoryRow, _trusted: bool) -> ControlFlow<()> {
            if self.ends && self.is_due() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }

        fn poll(&mut self) -> ControlFlow<()> {
            if self.ends && self.is_due() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }

        fn pauses(&mut self) -> bool {
            !self.ends && self.is_due()
        }
    }

    #[test]
    fn left_at_any_time_it_goes_on_to_the_same() {
        let (scene, camera) = cornell(70, 61);
        for adaptive in [false, true] {
            let settings = Settings { adaptive, ..settings(40, 2) };
            let whole = render(&scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap();
            let here = Here(std::thread::current().id(), Default::default());
            let kinds: [&dyn Integrator; 2] = [&Path::default(), &here];
            for (integrator, ends) in kinds.into_iter().flat_map(|kind| [(kind, false), (kind, true)]) {
                let mut rendering = Rendering::new(settings.film(&camera, 2, 1));
                let mut progress = Restless { looks: 0, every: 1, ends };
                let mut left = 0;
                loop {
                    match go_on(&mut rendering, &scene, &camera, integrator, &settings, &mut progress) {
                        Ok(true) => break,
                        Ok(false) => assert!(!ends),
                        Err(error) => assert!(ends && error == RenderError::Interrupted),
                    }
                    left += 1;
                    // Ending a render loses work in progress, so it must not always end too early.
                    progress = Restless { looks: 0, every: 1 << (left / 2), ends };
                }
                assert!(left > 0 || !ends);
                assert_eq!((&rendering.film, rendering.error), (&whole.film, whole.error));
                let errors = |r: &Rendering| r.history.iter().map(|row| row.error.to_bits()).collect::<Vec<_>>();
                assert_eq!(errors(&rendering), errors(&whole));
            }
        }
    }

    #[test]
    fn passes_too_short_for_a_look_can_be_left_in_between() {
        let (scene, camera) = cornell(2, 2);
        let mut rendering = Rendering::new(settings(40, 1).film(&camera, 1, 1));
        let mut progress = Restless { looks: 0, every: 1, ends: false };
        let mut left = 0;
        while !go_on(&mut rendering, &scene, &camera, &Path::default(), &settings(40, 1), &mut progress).unwrap() {
            left += 1;
        }
        assert_eq!(rendering.film.samples(), 40);
        assert!(left >= rendering.history.len(), "{left}");
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
                    .map(|(x, mu)| ((*x - *mu) * (*x - *mu) / (*mu * *mu + 0.01)).mean())
                    .sum();
                let ratio = rendering.error.unwrap().value / (truth / reference.len() as f64);
                (0.8..1.25).contains(&ratio)
            })
            .count();
        assert!(close >= 38, "{close} of 40");
    }
}
