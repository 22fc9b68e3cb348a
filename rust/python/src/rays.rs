//! Batches of rays in array form, distributed over threads.

use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyFloat;

use super::arrays::{Numbers, Row, TripleRows, Triples};
use super::broadcast::{Repeats, some_of};
use super::held_rows::Held;
use raywright::math::ray_sort::WINDOW;
use raywright::math::{Ray, Tiling, row_length};
use raywright::{parallel, workers};

/// Maximum number of rays gathered and traced together: few enough to stay in a near cache and for Ctrl-C to be
/// handled, and enough to keep rays in flight. (512 takes 2 to 5 % longer for scattered rays, and the same for others;
/// 8192 gains nothing.)
pub const BATCH: usize = 2048;

/// Minimum rays per task, enough to make the hand-over negligible.
const LEAST: usize = 1024;

/// Rays or points per task, for this total number.
pub fn share(count: usize) -> usize {
    (count / 32).clamp(LEAST, BATCH)
}

/// Points per task if they are sorted by place: the more points, the closer are neighbors.
pub fn sorted_share(count: usize, threads: Option<usize>) -> PyResult<usize> {
    /// Few enough for Ctrl-C to be handled.
    const MOST: usize = 65536;
    if count <= LEAST {
        return Ok(LEAST);
    }
    let threads = workers::pool(threads).map_err(PyRuntimeError::new_err)?.threads();
    Ok((count / (8 * threads)).clamp(LEAST, MOST))
}

/// A batch of rays in array form: each part one for all rays, or one per ray.
#[derive(Clone, Copy)]
pub struct RayArrays<'a> {
    pub(super) origins: TripleRows<'a>,
    pub(super) directions: TripleRows<'a>,
    pub(super) t_min: &'a [f64],
    pub(super) t_max: &'a [f64],
    time: &'a [f64],
    /// Number of rays.
    pub count: usize,
    pub(super) tiling: Tiling,
}

/// The ray arguments of the Python package as one tuple: arrays and numbers, their common leading shape, and the number
/// of threads.
pub struct RayArguments<'py> {
    pub origins: Triples<'py>,
    pub directions: Triples<'py>,
    pub t_min: Numbers<'py>,
    pub t_max: Numbers<'py>,
    pub shape: Vec<usize>,
    pub threads: Option<usize>,
    /// None is 0 for all.
    pub time: Option<Numbers<'py>>,
    /// Rays to be traced, or all; others hit nothing.
    pub mask: Option<PyReadonlyArrayDyn<'py, bool>>,
}

impl<'py> FromPyObject<'_, 'py> for RayArguments<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let (origins, directions, t_min, t_max, shape, threads, time, mask) = object.extract()?;
        Ok(Self { origins, directions, t_min, t_max, shape, threads, time, mask })
    }
}

impl<'py> RayArguments<'py> {
    /// Rays that need neither conversion nor broadcasting, on all cores; `None` for others, also for wrong ones. For a
    /// few rays, the checks and conversions of the Python package take as long as tracing.
    pub fn plain([origins, directions, t_min, t_max]: [&Bound<'py, PyAny>; 4]) -> Option<Self> {
        let number = |object: &Bound<'py, PyAny>| {
            let number = object.cast_exact::<PyFloat>().ok()?.value();
            (!number.is_nan()).then_some(Numbers::One([number]))
        };
        let (t_min, t_max) = (number(t_min)?, number(t_max)?);
        let ((origins, from), (directions, along)) = (Triples::plain(origins)?, Triples::plain(directions)?);
        if from != along && !from.is_empty() && !along.is_empty() {
            return None;
        }
        let shape = if from.is_empty() { along } else { from };
        Some(Self { origins, directions, t_min, t_max, shape, threads: None, time: None, mask: None })
    }
}

impl RayArguments<'_> {
    /// The rays.
    pub fn rays(&self) -> PyResult<RayBatch<'_>> {
        let (origins, some) = self.origins.repeated("origins")?;
        let mut repeats = [some, None, None, None, None];
        let directions;
        (directions, repeats[1]) = self.directions.repeated("directions")?;
        let (t_min, t_max, time);
        (t_min, repeats[2]) = self.t_min.repeated("t_min")?;
        (t_max, repeats[3]) = self.t_max.repeated("t_max")?;
        (time, repeats[4]) = match &self.time {
            Some(time) => time.repeated("time")?,
            None => (&[0.0][..], None),
        };
        let count = self.shape.iter().product();
        let lengths = [origins.len(), directions.len(), t_min.len(), t_max.len(), time.len()];
        if lengths.iter().zip(&repeats).any(|(&n, repeats)| repeats.is_none() && n != 1 && n != count) {
            return Err(PyValueError::new_err(format!(
                "origins, directions, t_min, t_max and time have lengths {lengths:?}, expected 1 or {count}"
            )));
        }
        // The rays of an image are traced in tiles, which are more coherent than rows.
        let row = match self.shape.as_slice() {
            [_, .., row] => *row,
            _ => match row_length(directions.len(), |i| directions.get(i)) {
                0 => row_length(origins.len(), |i| origins.get(i)),
                row => row,
            },
        };
        let rays = RayArrays { origins, directions, t_min, t_max, time, count, tiling: Tiling::new(count, row) };
        let mask = self.mask.as_ref().map(|mask| Repeats::of("mask", mask, 1)).transpose()?;
        if let Some((asked, None)) = mask
            && ![1, count].contains(&asked.len())
        {
            return Err(PyValueError::new_err(format!("mask has {} entries, expected {count}", asked.len())));
        }
        let is_whole = mask.is_none() && repeats.iter().all(Option::is_none);
        Ok(RayBatch { rays, mask, repeats: (!is_whole).then(|| Box::new(repeats)) })
    }
}

/// All rays of a call. Broadcast arrays are not expanded, but copied for a chunk of rays at a time, so a call needs
/// memory only for its results.
pub struct RayBatch<'a> {
    rays: RayArrays<'a>,
    mask: Option<(&'a [bool], Option<Repeats>)>,
    /// For origins, directions, `t_min`, `t_max` and time; `None` if nothing is broadcast and there is no mask.
    repeats: Option<Box<[Option<Repeats>; 5]>>,
}

impl RayBatch<'_> {
    /// Number of rays.
    pub fn count(&self) -> usize {
        self.rays.count
    }

    /// Rays per task.
    pub fn chunk(&self) -> usize {
        self.rays.chunk()
    }

    /// Rays per task if they are reordered.
    pub fn window(&self) -> usize {
        self.rays.window()
    }

    /// Calls `work` with the rays from `start` on, as arrays and a start index within them.
    #[inline(always)]
    pub fn part<T>(&self, start: usize, count: usize, work: impl FnOnce(&RayArrays<'_>, usize) -> T) -> T {
        let Some(repeats) = &self.repeats else { return work(&self.rays, start) };
        let RayArrays { origins, directions, t_min, t_max, time, tiling, .. } = self.rays;
        let some = |i: usize, rows| Held::of(repeats[i].as_ref(), rows, start, count);
        let (origins, directions) = (some(0, origins), some(1, directions));
        let some = |i: usize, all| some_of(repeats[i].as_ref(), all, start, count);
        let (t_min, mut t_max, time) = (some(2, t_min), some(3, t_max), some(4, time));
        if let Some((asked, repeats)) = &self.mask {
            let asked = some_of(repeats.as_ref(), asked, start, count);
            if asked.len().max(t_max.len()) > 1 && t_max.len() == 1 {
                t_max = vec![t_max[0]; count];
            }
            for (i, far) in t_max.iter_mut().enumerate() {
                // No t is below minus infinity.
                if !asked[if asked.len() == 1 { 0 } else { i }] {
                    *far = f64::NEG_INFINITY;
                }
            }
        }
        let (origins, directions) = (origins.rows(), directions.rows());
        let (t_min, t_max, time) = (&*t_min, &*t_max, &*time);
        work(&RayArrays { origins, directions, t_min, t_max, time, count, tiling }, 0)
    }
}

impl RayArrays<'_> {
    /// Rays per task.
    pub fn chunk(&self) -> usize {
        self.tiling.chunk(share(self.count))
    }

    /// Rays per task if they are reordered.
    pub fn window(&self) -> usize {
        self.tiling.chunk(if self.tiling.is_sequence() {
            (self.count / 32).clamp(LEAST, WINDOW)
        } else {
            share(self.count)
        })
    }

    /// A ray.
    pub fn ray(&self, i: usize) -> Ray {
        let of = |length: usize| if length == 1 { 0 } else { i };
        let Self { t_min, t_max, time, .. } = *self;
        Ray {
            t_min: t_min[of(t_min.len())],
            t_max: t_max[of(t_max.len())],
            time: time[of(time.len())],
            ..Ray::new(self.origins.get(of(self.origins.len())), self.directions.get(of(self.directions.len())))
        }
    }

    /// Calls `answer` with up to [`BATCH`] rays at a time of the `count` from `start` on, and with their positions.
    #[inline(always)]
    pub fn gathered(&self, start: usize, count: usize, mut answer: impl FnMut(&[Ray], &[usize])) {
        let some = BATCH.min(count);
        let (mut rays, mut places) = (Vec::with_capacity(some), vec![0; some]);
        for from in (0..count).step_by(BATCH) {
            let places = &mut places[..BATCH.min(count - from)];
            self.tiling.places(from, count, places);
            rays.clear();
            // Branches on the float types once, not per ray.
            match (self.origins, self.directions) {
                (TripleRows::Single(o), TripleRows::Single(d)) => self.gather(o, d, start, places, &mut rays),
                (TripleRows::Single(o), TripleRows::Double(d)) => self.gather(o, d, start, places, &mut rays),
                (TripleRows::Double(o), TripleRows::Single(d)) => self.gather(o, d, start, places, &mut rays),
                (TripleRows::Double(o), TripleRows::Double(d)) => self.gather(o, d, start, places, &mut rays),
            }
            answer(&rays, places);
        }
    }

    /// Gathers the rays at some positions after `start`.
    fn gather<O: Row, D: Row>(
        &self,
        origins: &[O],
        directions: &[D],
        start: usize,
        places: &[usize],
        rays: &mut Vec<Ray>,
    ) {
        let Self { t_min, t_max, time, .. } = *self;
        // A single row has stride 0.
        let step = |length: usize| usize::from(length != 1);
        let [origin, direction] = [step(origins.len()), step(directions.len())];
        let [near, far, when] = [step(t_min.len()), step(t_max.len()), step(time.len())];
        // `move` tells the compiler that inputs do not alias the output.
        rays.extend(places.iter().map(move |&place| {
            let i = start + place;
            Ray {
                origin: origins[i * origin].vector(),
                direction: directions[i * direction].vector(),
                t_min: t_min[i * near],
                t_max: t_max[i * far],
                time: time[i * when],
                misses: [Ray::NO_TRIANGLE; 2],
            }
        }));
    }
}

/// Output arrays that can be split among threads.
pub trait SplitOutput: Send + Sized {
    /// Splits off the part of the first `at` rays.
    fn split(self, at: usize) -> (Self, Self);
}

impl<T: Send> SplitOutput for &mut [T] {
    fn split(self, at: usize) -> (Self, Self) {
        self.split_at_mut(at)
    }
}

impl<P: SplitOutput> SplitOutput for Option<P> {
    fn split(self, at: usize) -> (Self, Self) {
        match self.map(|parts| parts.split(at)) {
            Some((first, others)) => (Some(first), Some(others)),
            None => (None, None),
        }
    }
}

impl<A: SplitOutput, B: SplitOutput> SplitOutput for (A, B) {
    fn split(self, at: usize) -> (Self, Self) {
        let ((a, c), (b, d)) = (self.0.split(at), self.1.split(at));
        ((a, b), (c, d))
    }
}

impl<A: SplitOutput, B: SplitOutput, C: SplitOutput, D: SplitOutput> SplitOutput for (A, B, C, D) {
    fn split(self, at: usize) -> (Self, Self) {
        let ((a, e), (b, f), (c, g), (d, h)) = (self.0.split(at), self.1.split(at), self.2.split(at), self.3.split(at));
        ((a, b, c, d), (e, f, g, h))
    }
}

/// Fills `n` results, `chunk` at a time, without the interpreter lock and with signal handling.
pub fn answer<P: SplitOutput>(
    py: Python<'_>,
    n: usize,
    chunk: usize,
    threads: Option<usize>,
    parts: P,
    fill: impl Fn(usize, P) + Sync,
) -> PyResult<()> {
    let mut chunks = Vec::with_capacity(n.div_ceil(chunk));
    let mut rest = parts;
    for start in (0..n).step_by(chunk) {
        let (part, more) = rest.split(chunk.min(n - start));
        chunks.push((start, part));
        rest = more;
    }
    each(py, threads, chunks, |(start, part)| fill(start, part)).map(drop)
}

/// Chunks of `n` rays: the start and length of each.
pub fn chunks(n: usize, chunk: usize) -> Vec<(usize, usize)> {
    (0..n).step_by(chunk).map(|start| (start, chunk.min(n - start))).collect()
}

/// Maps `work` over chunks in order, without the interpreter lock and with signal handling. A single chunk runs on the
/// calling thread, because waking others takes longer.
pub fn each<C: Send, T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    chunks: Vec<C>,
    work: impl Fn(C) -> T + Sync,
) -> PyResult<Vec<T>> {
    if chunks.len() <= 1 {
        return Ok(py.detach(|| chunks.into_iter().map(&work).collect()));
    }
    let mut signal = Ok(());
    let made = py
        .detach(|| {
            workers::watched(
                threads,
                |cancel| {
                    let made = parallel::map_parts(chunks, |chunk| (!cancel.is_raised()).then(|| work(chunk)));
                    made.into_iter().collect::<Option<_>>()
                },
                || {
                    signal = Python::attach(|py| py.check_signals());
                    signal.is_ok()
                },
            )
        })
        .map_err(PyRuntimeError::new_err)?;
    signal?;
    made.ok_or_else(|| PyRuntimeError::new_err("work was canceled without a signal"))
}
