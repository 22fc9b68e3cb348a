//! State of a render: a picture that can be continued.

use super::adaptive::Adaptive;
use super::bytes::{Malformed, Reader, Writer, check};
use super::error::estimate;
use super::pass_tiles::Goal;
use super::pooled_variance::{Uncertainty, uncertainty};
use super::sample_allocation::Epoch;
use super::shared_film::{LentFilm, Loan};
use super::tile::FilmTile;
use super::{ErrorEstimate, Film, Until};
use raywright_optics::Rgb;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Progress of a render after a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HistoryRow {
    /// Wall-clock time since the start.
    pub seconds: f64,
    /// Samples per pixel, or on average.
    pub samples: u32,
    /// Estimated relMSE; NaN if it is not known yet.
    pub error: f64,
}

/// A render: its picture so far, and the state needed to continue it, here or elsewhere.
///
/// A render proceeds in passes. During a pass, some cells have more samples than others. Each cell has the first of its
/// samples and nothing else, so a pass can be interrupted and resumed at any time without changing a bit.
#[derive(Debug)]
pub struct Rendering {
    /// The picture.
    pub film: Film,
    /// Error after the last pass; `None` if there are too few samples.
    pub error: Option<ErrorEstimate>,
    /// Progress, one row per pass.
    pub history: Vec<HistoryRow>,
    /// Wall-clock time used.
    pub seconds: f64,
    /// Samples of the film after the current pass, or now if there is none.
    aim: u32,
    plan: Option<Adaptive>,
    sight: Sight,
}

/// A view of a render during a pass, usable from any thread.
#[derive(Clone, Debug, Default)]
pub struct Sight(Arc<Mutex<Option<PassState>>>);

#[derive(Debug)]
struct PassState {
    film: Arc<LentFilm>,
    error: Option<ErrorEstimate>,
    history: Vec<HistoryRow>,
    /// Time used before, and start of the current work.
    seconds: f64,
    since: Instant,
    aim: u32,
    /// True if all work is done, so that the render waits for observers.
    is_done: bool,
}

impl PassState {
    fn rendering(&self, film: Film) -> Rendering {
        let seconds = self.seconds + self.since.elapsed().as_secs_f64();
        let (error, history, aim) = (self.error, self.history.clone(), self.aim);
        Rendering { film, error, history, seconds, aim, plan: None, sight: Sight::default() }
    }
}

impl Sight {
    fn shown(&self) -> MutexGuard<'_, Option<PassState>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns whether a pass is in progress.
    pub fn is_open(&self) -> bool {
        self.shown().is_some()
    }

    /// Returns whether the pass is complete, so that the render waits for observers.
    pub fn is_done(&self) -> bool {
        self.shown().as_ref().is_none_or(|shown| shown.is_done)
    }

    /// The render's state without pixels.
    pub fn outline(&self) -> Option<Rendering> {
        self.shown().as_ref().map(|shown| shown.rendering(shown.film.without_tiles()))
    }

    /// A full copy of the current state, as large as the render.
    pub fn copy(&self) -> Option<Rendering> {
        self.shown().as_ref().map(|shown| shown.rendering(shown.film.copy()))
    }

    /// The picture, linear, row by row from the top.
    pub fn rgb(&self) -> Option<Vec<[f32; 3]>> {
        self.shown().as_ref().map(|shown| shown.film.means())
    }

    /// Number of samples of each pixel.
    pub fn counts(&self) -> Option<Vec<u32>> {
        self.shown().as_ref().map(|shown| shown.film.counts())
    }

    /// Number of samples that were not finite or negative, and number of clamped samples.
    pub fn amiss(&self) -> Option<[u64; 2]> {
        self.shown().as_ref().map(|shown| [shown.film.dropped(), shown.film.clamped()])
    }
}

/// Tiles of a render during a pass, visible to observers.
pub(super) struct Work<'a> {
    pub tiles: Loan<'a>,
    sight: &'a Sight,
}

impl Work<'_> {
    /// Marks the work as done.
    pub fn end(&self) {
        if let Some(shown) = &mut *self.sight.shown() {
            shown.is_done = true;
        }
    }
}

impl Drop for Work<'_> {
    fn drop(&mut self) {
        // Observers must release the tiles before these return.
        *self.sight.shown() = None;
    }
}

impl Rendering {
    /// Creates a render with an empty film. If the film is in halves, sampling is adaptive.
    pub fn new(mut film: Film) -> Self {
        let plan = (film.cells() > 1).then(|| Adaptive::new(&mut film));
        Self { film, error: None, history: Vec::new(), seconds: 0.0, aim: 0, plan, sight: Sight::default() }
    }

    /// The picture, linear, row by row from the top.
    pub fn rgb(&self) -> Vec<[f32; 3]> {
        single(self.film.means())
    }

    /// Uncertainty of each pixel; `None` if there are too few samples.
    pub fn uncertainty(&self) -> Option<Uncertainty> {
        uncertainty(&self.film)
    }

    /// Standard error of each pixel; NaN if there are too few samples.
    pub fn standard_error(&self) -> Vec<[f32; 3]> {
        match self.film.variances() {
            Some(variances) => roots(variances),
            None => vec![[f32::NAN; 3]; self.film.pixel_count()],
        }
    }

    /// Returns whether its error is reliable, or unknown.
    pub fn is_trusted(&self) -> bool {
        self.error.is_none_or(|error| error.is_trusted())
    }

    /// Samples of the film after the current pass; its current number if there is none.
    pub fn aim(&self) -> u32 {
        self.aim
    }

    /// Seconds per sample of all pixels in the last pass; 0 before the first.
    pub fn rate(&self) -> f64 {
        let none = HistoryRow { seconds: 0.0, samples: 0, error: f64::NAN };
        match self.history[..] {
            [] => 0.0,
            [ref only] => step(&none, only),
            [.., ref before, ref last] => step(before, last),
        }
    }

    /// Number of samples after the next pass, if there are `after` before it; equal to `after` if the render ends
    /// there. A pass in progress comes first. `elapsed` and `rate` are as in [`Until`]; `after` may be in the future.
    pub fn next_aim(&self, until: &Until, after: u32, elapsed: f64, rate: f64) -> u32 {
        if after < self.aim {
            return self.aim;
        }
        let error = self.error.as_ref().filter(|_| after == self.film.samples());
        let above = |row: &&HistoryRow| row.error.is_nan() || until.error.is_some_and(|target| row.error > target);
        let above = self.history.iter().rev().find(above).map_or(0, |row| row.samples);
        let limit = self.plan.as_ref().map_or(FilmTile::MOST, |plan| plan.limit(after).min(FilmTile::MOST));
        after + until.next_pass(after, self.film.batch(), elapsed, rate, error, above).min(limit.saturating_sub(after))
    }

    /// Begins or continues a pass to this number of samples.
    pub fn begin(&mut self, aim: u32) {
        if let Some(plan) = &mut self.plan {
            plan.prepare(&mut self.film);
        }
        self.aim = aim;
    }

    /// A view for observers.
    pub fn sight(&self) -> Sight {
        self.sight.clone()
    }

    /// The tiles, visible to observers, and their target after the pass.
    pub(super) fn goal(&mut self) -> (Work<'_>, Goal<'_>) {
        let (done, samples) = (self.film.samples(), self.aim);
        let goal = match &self.plan {
            Some(plan) => Goal::Planned { epoch: plan.epoch(), done, samples },
            None => Goal::Even { before: 0, samples },
        };
        let tiles = Loan::of(&mut self.film);
        let (error, history, seconds, aim) = (self.error, self.history.clone(), self.seconds, self.aim);
        let shown = |film| PassState { film, error, history, seconds, since: Instant::now(), aim, is_done: false };
        *self.sight.shown() = tiles.shared().map(shown);
        (Work { tiles, sight: &self.sight }, goal)
    }

    /// The adaptive sample allocation, if there is one.
    pub(super) fn epoch(&self) -> Option<&Epoch> {
        self.plan.as_ref().map(Adaptive::epoch)
    }

    /// Ends a complete pass, after this total time.
    pub fn end(&mut self, seconds: f64) -> HistoryRow {
        self.film.extend_to(self.aim);
        self.error = estimate(&self.film);
        self.seconds = seconds;
        let error = self.error.map_or(f64::NAN, |e| e.value);
        let row = HistoryRow { seconds, samples: self.aim, error };
        self.history.push(row);
        row
    }

    /// Serializes the render, without its scene and picture size.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut to = Writer::default();
        to.word(self.film.side());
        self.film.write(&mut to);
        to.word(self.aim);
        to.float(self.seconds);
        to.word(self.history.len() as u32);
        for row in &self.history {
            to.float(row.seconds);
            to.word(row.samples);
            to.float(row.error);
        }
        if let Some(plan) = &self.plan {
            plan.write(&mut to);
        }
        to.0
    }

    /// Maximum size of [`Rendering::to_bytes`] for a film of this size and a history of a million passes.
    pub fn most_bytes(width: u32, height: u32, halves: bool, apart: bool) -> usize {
        // Per cell: 39 numbers of 8 bytes, 36 more if quarters are kept, and 4 of 4 bytes. Twice that covers the
        // headers of the smallest tiles.
        let cells = width as usize * height as usize * if halves { 2 } else { 1 };
        let numbers = if apart { 39 + 36 } else { 39 };
        cells * 2 * (numbers * 8 + 4 * 4) + 20_000_000 + 1024
    }

    /// Reads the bytes of [`Rendering::to_bytes`] for a film with the same size, batches, halves, clamping, patches and
    /// quarters. The bytes are untrusted.
    #[allow(clippy::too_many_arguments)]
    pub fn from_bytes(
        bytes: &[u8],
        width: u32,
        height: u32,
        batch: u32,
        halves: bool,
        clamp: Option<f64>,
        patch: u32,
        apart: bool,
    ) -> Result<Self, Malformed> {
        let mut from = Reader(bytes);
        let side: u32 = from.word()?;
        check((1..=64).contains(&side), "tiles have no size")?;
        check(side.is_multiple_of(patch), "tiles hold parts of patches")?;
        // Minimum size of a film, so that no memory is allocated for one that is not there.
        let tiles = width.div_ceil(side) as usize * height.div_ceil(side) as usize;
        check(bytes.len() / 32 >= tiles, "they end too early")?;
        let film = Film::new(width, height, side, batch, halves, clamp).in_patches(patch).kept_apart(apart);
        let mut this = Self::new(film);
        this.film.read(&mut from)?;
        this.aim = from.word()?;
        this.seconds = from.float()?;
        for _ in 0..from.length(20)? {
            let row = HistoryRow { seconds: from.float()?, samples: from.word()?, error: from.float()? };
            this.history.push(row);
        }
        if let Some(plan) = &mut this.plan {
            plan.read(&this.film, &mut from)?;
        }
        from.end()?;
        this.check_passes()?;
        this.error = (this.film.samples() > 0).then(|| estimate(&this.film)).flatten();
        Ok(this)
    }

    fn check_passes(&self) -> Result<(), Malformed> {
        let (done, aim) = (self.film.samples(), self.aim);
        check(done <= aim && aim <= FilmTile::MOST, "a pass ends before it begins")?;
        // Bounds the length of a pass that malicious bytes may request.
        check(aim - done <= self.film.block(), "a pass is too long")?;
        let decided = self.plan.as_ref().is_none_or(|plan| aim == done || aim <= plan.epoch().to);
        check(decided, "a pass ends after its epoch")?;
        let even = |count: &u32| (done..=aim).contains(count);
        let fits = self.plan.is_some() || self.film.tiles().iter().all(|tile| tile.counts().iter().all(even));
        check(fits, "a pixel's sample count is not that of its pass")?;
        let times = || self.history.iter().map(|row| row.seconds).chain([self.seconds]);
        check(times().all(|t| t.is_finite() && t >= 0.0) && times().is_sorted(), "times decrease")?;
        let ordered = self.history.is_sorted_by(|a, b| a.samples < b.samples);
        let last = self.history.last().map_or(0, |row| row.samples);
        check(ordered && last == done, "passes are not in order")
    }
}

fn step(before: &HistoryRow, after: &HistoryRow) -> f64 {
    (after.seconds - before.seconds) / f64::from(after.samples - before.samples)
}

/// Square roots in single precision.
pub fn roots(variances: Vec<Rgb>) -> Vec<[f32; 3]> {
    single(variances.into_iter().map(|variance| variance.map(f64::sqrt)).collect())
}

fn single(pixels: Vec<Rgb>) -> Vec<[f32; 3]> {
    pixels.into_iter().map(|rgb| rgb.to_array().map(|x| x as f32)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Quiet, Settings, go_on, render};
    use super::*;
    use proptest::prelude::*;
    use raywright_integrators::Path;
    use raywright_scene::fixtures::cornell;
    use std::sync::OnceLock;

    const SIZE: [u32; 2] = [9, 7];

    fn settings(samples: u32, adaptive: bool, clamp: Option<f64>) -> Settings {
        let until = Until { samples: Some(samples), ..Until::default() };
        Settings { until, threads: Some(2), adaptive, apart: clamp.is_some(), clamp, ..Settings::default() }
    }

    fn read(bytes: &[u8], adaptive: bool, clamp: Option<f64>) -> Result<Rendering, Malformed> {
        Rendering::from_bytes(bytes, SIZE[0], SIZE[1], 1, adaptive, clamp, 1, clamp.is_some())
    }

    fn assert_same(a: &Rendering, b: &Rendering) {
        assert_eq!((&a.film, a.error, a.aim), (&b.film, b.error, b.aim));
        let rows = |r: &Rendering| r.history.iter().map(|h| (h.samples, h.error.to_bits())).collect::<Vec<_>>();
        assert_eq!(rows(a), rows(b));
    }

    #[test]
    fn bytes_bring_back_what_goes_on_to_the_same() {
        let (scene, camera) = cornell(SIZE[0], SIZE[1]);
        for (adaptive, clamp) in [(false, None), (false, Some(1.0)), (true, None), (true, Some(1.0))] {
            let run = |samples| {
                render(&scene, &camera, &Path::default(), &settings(samples, adaptive, clamp), &mut Quiet).unwrap()
            };
            let whole = run(72);
            for samples in [0, 1, 5, 16, 40, 72] {
                let part = run(samples);
                let bytes = part.to_bytes();
                assert!(bytes.len() <= Rendering::most_bytes(SIZE[0], SIZE[1], adaptive, clamp.is_some()));
                let mut back = read(&bytes, adaptive, clamp).unwrap();
                assert_same(&back, &part);
                assert_eq!(back.to_bytes(), bytes);
                let settings = Settings { threads: Some(1), ..settings(72, adaptive, clamp) };
                assert!(go_on(&mut back, &scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap());
                // Errors are estimated after other passes if one ended early.
                assert_eq!((&back.film, back.error), (&whole.film, whole.error));
            }
        }
    }

    #[test]
    fn bytes_of_another_shape_are_refused() {
        let (scene, camera) = cornell(SIZE[0], SIZE[1]);
        let bytes =
            render(&scene, &camera, &Path::default(), &settings(20, false, None), &mut Quiet).unwrap().to_bytes();
        assert!(read(&bytes, false, None).is_ok());
        assert!(read(&bytes, true, None).is_err());
        assert!(read(&bytes, false, Some(1.0)).is_err());
        assert!(Rendering::from_bytes(&bytes, 65_536, 65_536, 1, false, None, 1, false).is_err());
        assert!(Rendering::from_bytes(&bytes, SIZE[0], SIZE[1], 4, false, None, 1, false).is_err());
    }

    /// Bytes of a uniform and of an adaptive render.
    fn stored(adaptive: bool) -> &'static [u8] {
        static STORED: [OnceLock<Vec<u8>>; 2] = [const { OnceLock::new() }; 2];
        STORED[usize::from(adaptive)].get_or_init(|| {
            let (scene, camera) = cornell(SIZE[0], SIZE[1]);
            let settings = settings(24, adaptive, Some(1.0));
            render(&scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap().to_bytes()
        })
    }

    /// Queries everything that bytes may contain, and continues the render.
    fn use_up(mut rendering: Rendering) {
        let (scene, camera) = cornell(SIZE[0], SIZE[1]);
        let bytes = rendering.to_bytes();
        assert!(bytes.len() <= Rendering::most_bytes(SIZE[0], SIZE[1], rendering.plan.is_some(), true));
        let _ = (rendering.rgb(), rendering.standard_error(), rendering.film.counts(), rendering.film.clamped());
        let cells = || rendering.film.tiles().iter().flat_map(|tile| tile.counts());
        if rendering.aim < 64 && cells().all(|&count| count < 256) {
            let settings = settings(rendering.aim + 1, rendering.plan.is_some(), Some(1.0));
            go_on(&mut rendering, &scene, &camera, &Path::default(), &settings, &mut Quiet).unwrap();
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_refused_or_of_use(bytes in prop::collection::vec(any::<u8>(), 0..2000), adaptive: bool) {
            if let Ok(rendering) = read(&bytes, adaptive, Some(1.0)) {
                use_up(rendering);
            }
        }

        #[test]
        fn so_are_bytes_with_changes(
            adaptive: bool,
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
            end in any::<prop::sample::Index>(),
            cut in 0u8..4,
        ) {
            let mut bytes = stored(adaptive).to_vec();
            for (at, value) in changes {
                // Most bytes are sums; counts are more fragile: those of the first tile, and the end.
                let at = at.index(if value % 2 == 0 { bytes.len() } else { 200 });
                let at = if value % 4 == 3 { bytes.len() - 1 - at } else { at };
                bytes[at] = value;
            }
            if cut == 0 {
                bytes.truncate(end.index(bytes.len()));
            }
            if let Ok(rendering) = read(&bytes, adaptive, Some(1.0)) {
                use_up(rendering);
            }
        }
    }
}
