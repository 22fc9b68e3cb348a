//! A render from start to end.

use super::error::estimate;
use super::tiles::Exposure;
use super::{ErrorEstimate, Film, Progress, Until};
use crate::integrators::Integrator;
use crate::optics::Rgb;
use crate::sampling::SamplerKind;
use crate::scene::{Camera, Scene};
use crate::workers::{Cancel, pool, watched};
use std::fmt;
use std::ops::ControlFlow;
use std::time::Instant;

/// How to render.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// When to end. With nothing set, the render goes on until its [`Progress`] ends it.
    pub until: Until,
    /// Which of all possible pictures.
    pub seed: u64,
    /// How many threads work; `None` for as many as there are cores.
    pub threads: Option<usize>,
    /// Where the random numbers come from.
    pub sampler: SamplerKind,
}

/// How far a render was after a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HistoryRow {
    /// Wall-clock time since the start.
    pub seconds: f64,
    /// Samples of each pixel.
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

/// Renders until the first of `settings.until` is met. `progress` is called on this thread, all work is done on others.
pub fn render(
    scene: &Scene,
    camera: &Camera,
    integrator: &dyn Integrator,
    settings: &Settings,
    progress: &mut dyn Progress,
) -> Result<Rendering, RenderError> {
    let start = Instant::now();
    let exposure = Exposure::new(scene, camera, integrator, settings.sampler, settings.seed);
    let tile = exposure.tile_side(pool(settings.threads).map_err(RenderError::Threads)?.current_num_threads());
    let batch = settings.sampler.batch();
    let mut film = Film::new(camera.width(), camera.height(), tile, batch);
    let (mut error, mut history, mut rate) = (None, Vec::<HistoryRow>::new(), 0.0);
    loop {
        let before = start.elapsed().as_secs_f64();
        let done = film.samples();
        let count = settings.until.next_pass(done, before, rate, error.as_ref()).next_multiple_of(batch);
        if count == 0 {
            return Ok(Rendering { film, error, history, seconds: before });
        }
        let mut flow = ControlFlow::Continue(());
        let work = |cancel: &Cancel| {
            exposure.expose(&mut film, done..done + count, cancel);
            estimate(&film)
        };
        let poll = || {
            flow = progress.poll();
            flow.is_continue()
        };
        error = watched(settings.threads, work, poll).map_err(RenderError::Threads)?;
        if flow.is_break() {
            return Err(RenderError::Interrupted);
        }
        let seconds = start.elapsed().as_secs_f64();
        rate = (seconds - before) / f64::from(count);
        let row = HistoryRow { seconds, samples: film.samples(), error: error.map_or(f64::NAN, |e| e.value) };
        history.push(row);
        if progress.pass(&row).is_break() {
            return Err(RenderError::Interrupted);
        }
    }
}
