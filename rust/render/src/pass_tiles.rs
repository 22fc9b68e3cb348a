//! Execution of a pass: samples of all pixels, tile by tile on all threads.

use super::camera_sampler::{CameraSampler, PixelSample};
use super::patchwork::Patchwork;
use super::sample_allocation::Epoch;
use super::shared_film::held;
use super::splats::{Brought, LightTracer};
use super::{FilmTile, Settings};
use raywright_base::parallel;
use raywright_base::timing::{self, timed};
use raywright_base::workers::Cancel;
use raywright_integrators::{CameraSample, CameraSamples, Integrator, Session, Worker};
use raywright_optics::Rgb;
use raywright_scene::{Camera, Scene};
use std::ops::Range;
use std::slice;
use std::sync::{Mutex, PoisonError};

/// Maximum number of paths in flight: enough to fill the accelerator's kernels, few enough to stay in cache.
const BATCH: usize = 4096;

/// Paths per call of an integrator that runs on the calling thread, where a call costs more than a path.
const LARGE_BATCH: usize = 65_536;

/// A picture being rendered: everything that is constant over its passes.
pub(super) struct Exposure<'a> {
    session: &'a dyn Session,
    /// True if all work must be on the calling thread.
    pub stays: bool,
    samples: CameraSampler<'a>,
    /// True if samples may be negative.
    signed: bool,
    /// Tracer of light paths, if there are any.
    light: Option<LightTracer<'a>>,
    /// Pixels that share samples.
    patchwork: Patchwork,
    /// Idle workers, kept to reuse their memory.
    idle: Mutex<Vec<Bench<'a>>>,
}

/// Target numbers of samples. Targets are reached in steps of one sample per pixel on average. Pixels of a patch share
/// samples within a step, so the partition depends only on the step.
#[derive(Clone, Copy)]
pub(super) enum Goal<'a> {
    /// The same number in all cells, including `before` samples on another film.
    Even { before: u32, samples: u32 },
    /// By an epoch for `samples` on average, when all pixels have `done` on average.
    Planned { epoch: &'a Epoch, done: u32, samples: u32 },
}

impl Goal<'_> {
    /// Number of samples of a cell after this number on average.
    #[inline]
    fn at(&self, number: usize, tile: &FilmTile, cell: usize, samples: u32) -> u32 {
        match *self {
            Self::Even { before, .. } => samples - before,
            Self::Planned { epoch, .. } => epoch.goal(number, cell, tile.position(cell), samples),
        }
    }

    /// Remaining steps of a tile.
    fn steps(&self, tile: &FilmTile) -> Range<u32> {
        match *self {
            Self::Even { before, samples } => before + tile.fewest()..samples,
            Self::Planned { done, samples, .. } => done..samples,
        }
    }

    fn before(&self) -> u32 {
        if let Self::Even { before, .. } = *self { before } else { 0 }
    }
}

/// A target, and the contributions of light paths on the way to it.
#[derive(Clone, Copy)]
struct TilePass<'a> {
    goal: Goal<'a>,
    light: Option<&'a Brought>,
    /// True if the session was prepared for it.
    is_ready: bool,
}

impl TilePass<'_> {
    /// Returns whether to stop. Computed light paths and a prepared session are used up first, so that frequent pauses
    /// still make progress.
    fn is_ended(&self, stop: &Stop) -> bool {
        stop.cancel.is_raised() || self.light.is_none() && !self.is_ready && stop.pause.is_raised()
    }
}

/// Signals that stop a pass.
#[derive(Default)]
pub(super) struct Stop {
    /// Ends all work at once; raised by an observer or by an integrator that cannot continue.
    pub cancel: Cancel,
    /// Ends it once work in progress is done.
    pub pause: Cancel,
}

impl Stop {
    fn is_raised(&self) -> bool {
        self.cancel.is_raised() || self.pause.is_raised()
    }
}

/// State of a thread.
struct Bench<'a> {
    worker: Box<dyn Worker + 'a>,
    /// True if samples may be negative.
    signed: bool,
    /// Samples to be taken next.
    wanted: Vec<PixelSample>,
    samples: CameraSamples,
    /// The same one after the other, for whom that serves.
    rows: Vec<CameraSample>,
    /// How much each sample counts, by the filter and the camera: also those for which the camera has no ray, and the
    /// integrator is not asked.
    weights: Vec<f64>,
    radiance: Vec<Rgb>,
    /// End of each group of samples that share, among those to be taken; empty if none share.
    ends: Vec<usize>,
    /// Sizes of the groups.
    groups: Vec<u32>,
    /// Cells of the samples.
    runs: Vec<Run>,
}

/// A cell whose samples are taken with those of others.
struct Member {
    cell: usize,
    position: (u32, u32),
    /// Its samples in a step.
    samples: Range<u32>,
    /// Its current number of samples.
    count: u32,
}

impl Member {
    /// Its own number of a sample of a step, if that exists and has not been taken.
    #[inline]
    fn wants(&self, of_step: u32) -> Option<u32> {
        let nth = self.samples.start + of_step;
        (nth < self.samples.end && nth >= self.count).then_some(nth)
    }
}

/// Consecutive samples of one cell.
struct Run {
    tile: usize,
    cell: usize,
    count: u32,
}

impl<'a> Exposure<'a> {
    /// Begins a picture of a scene by a camera, in a session of an integrator.
    pub fn new(
        scene: &Scene,
        camera: &'a dyn Camera,
        integrator: &dyn Integrator,
        session: &'a dyn Session,
        settings: &'a Settings,
    ) -> Self {
        let samples = CameraSampler::new(scene, camera, session, settings);
        let patchwork = Patchwork { patch: integrator.patch(scene) };
        let (stays, light) = (integrator.runs_on_caller(), LightTracer::new(camera, session, settings));
        let signed = scene.plan().needs().waves;
        Self { session, stays, samples, signed, light, patchwork, idle: Mutex::default() }
    }

    /// Adds samples until the target is reached or `stop` is raised; returns whether it was reached. In either case
    /// each cell has the first of its samples and nothing else, and can be continued. Before this, each pixel has
    /// `done` samples, or all have on average.
    pub fn expose(&self, tiles: &[Mutex<FilmTile>], done: u32, goal: Goal, stop: &Stop) -> bool {
        self.session.before_pass(done, &stop.cancel);
        self.in_parts(tiles, goal, false, stop, |tiles, part| {
            let reached = |number: usize| {
                !part.is_ended(stop) && {
                    let mut bench = self.take_bench();
                    let reached = self.expose_tiles(
                        slice::from_ref(&tiles[number]),
                        number,
                        part,
                        BATCH,
                        &mut bench,
                        stop,
                        &mut || {},
                    );
                    self.put_bench(bench);
                    reached
                }
            };
            !parallel::map(tiles.len(), reached).contains(&false)
        })
    }

    /// Like [`Exposure::expose`], with the integrator on this thread alone. After each batch, which is large for such
    /// an integrator, `poll` is called and may request a stop.
    pub fn expose_here(
        &self,
        tiles: &[Mutex<FilmTile>],
        done: u32,
        goal: Goal,
        stop: &Stop,
        mut poll: impl FnMut(),
    ) -> bool {
        self.session.before_pass(done, &stop.cancel);
        let most = if self.stays { LARGE_BATCH } else { BATCH };
        self.in_parts(tiles, goal, true, stop, |tiles, part| {
            let mut bench = self.take_bench();
            let reached = self.expose_tiles(tiles, 0, part, most, &mut bench, stop, &mut poll);
            self.put_bench(bench);
            reached
        })
    }

    /// Works towards a target: at once or, with light paths or a prepared session, in parts of as many samples as these
    /// hold. Returns whether all parts were done.
    fn in_parts(
        &self,
        tiles: &[Mutex<FilmTile>],
        goal: Goal,
        alone: bool,
        stop: &Stop,
        mut work: impl FnMut(&[Mutex<FilmTile>], TilePass) -> bool,
    ) -> bool {
        let ready = self.session.at_once();
        let at_once = self.light.as_ref().map(LightTracer::at_once).into_iter().chain(ready).min();
        let (Some(at_once), Goal::Even { before, samples }) = (at_once, goal) else {
            return work(tiles, TilePass { goal, light: None, is_ready: false });
        };
        let first = before + tiles.iter().map(|tile| held(tile).fewest()).min().unwrap_or(0);
        (first..samples).step_by(at_once.max(1) as usize).all(|start| {
            if start > first && stop.is_raised() {
                return false;
            }
            let end = samples.min(start.saturating_add(at_once.max(1)));
            if ready.is_some() {
                self.session.before_samples(start..end, alone, &stop.cancel);
            }
            let brought = self.light.as_ref().map(|light| light.trace(start..end, alone, &stop.cancel));
            let goal = Goal::Even { before, samples: end };
            let part = TilePass { goal, light: brought.as_ref(), is_ready: ready.is_some() };
            !stop.cancel.is_raised() && work(tiles, part)
        })
    }

    fn take_bench(&self) -> Bench<'a> {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        idle.unwrap_or_else(|| Bench {
            worker: self.session.worker(),
            signed: self.signed,
            wanted: Vec::new(),
            samples: CameraSamples::default(),
            rows: Vec::new(),
            weights: Vec::new(),
            radiance: Vec::new(),
            ends: Vec::new(),
            groups: Vec::new(),
            runs: Vec::new(),
        })
    }

    fn put_bench(&self, bench: Bench<'a>) {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(bench);
    }

    /// Takes tiles, numbered from `first`, to the target in batches of at most `most` paths.
    #[allow(clippy::too_many_arguments)]
    fn expose_tiles(
        &self,
        tiles: &[Mutex<FilmTile>],
        first: usize,
        part: TilePass,
        most: usize,
        bench: &mut Bench,
        stop: &Stop,
        poll: &mut dyn FnMut(),
    ) -> bool {
        bench.clear();
        let goal = part.goal;
        let before = goal.before();
        let works_together = self.patchwork.patch > 1;
        let mut members: Vec<Member> = Vec::new();
        for index in 0..tiles.len() {
            let mut tile = held(&tiles[index]);
            let (number, steps) = (first + index, goal.steps(&tile));
            // Pixels that do not share take all their samples consecutively, because their rays are coherent.
            let stride = if works_together { 1 } else { steps.len().max(1) as u32 };
            for step in steps.clone().step_by(stride as usize) {
                let end = steps.end.min(step + stride);
                for cells in tile.together(self.patchwork, step) {
                    members.clear();
                    members.extend(cells.map(|cell| Member {
                        cell,
                        position: tile.position(cell),
                        samples: goal.at(number, &tile, cell, step)..goal.at(number, &tile, cell, end),
                        count: tile.counts()[cell],
                    }));
                    for of_step in 0..members.iter().map(|member| member.samples.len()).max().unwrap_or(0) as u32 {
                        for member in &members {
                            let Some(nth) = member.wants(of_step) else { continue };
                            let number = before + tile.number(member.cell, nth);
                            bench.add(index, member.cell, PixelSample { position: member.position, number });
                        }
                        if works_together && bench.ends.last().copied().unwrap_or(0) < bench.wanted.len() {
                            bench.ends.push(bench.wanted.len());
                        }
                        if bench.wanted.len() + members.len() > most {
                            // Released, so that observers need not wait for rays.
                            drop(tile);
                            let developed = bench.develop(&self.samples, tiles, part.light, &stop.cancel);
                            poll();
                            if !developed || part.is_ended(stop) {
                                return false;
                            }
                            tile = held(&tiles[index]);
                        }
                    }
                }
            }
        }
        bench.develop(&self.samples, tiles, part.light, &stop.cancel)
    }
}

impl Bench<'_> {
    fn clear(&mut self) {
        self.wanted.clear();
        self.samples.clear();
        self.weights.clear();
        self.ends.clear();
        self.groups.clear();
        self.runs.clear();
    }

    /// Adds a sample of a cell to the batch.
    #[inline]
    fn add(&mut self, tile: usize, cell: usize, wanted: PixelSample) {
        self.wanted.push(wanted);
        match self.runs.last_mut() {
            Some(run) if (run.tile, run.cell) == (tile, cell) => run.count += 1,
            _ => self.runs.push(Run { tile, cell, count: 1 }),
        }
    }

    /// Takes the samples, adds their radiance to their cells, and clears the batch. Returns whether it did; results of
    /// a canceled integrator are discarded.
    fn develop(
        &mut self,
        sampler: &CameraSampler,
        tiles: &[Mutex<FilmTile>],
        light: Option<&Brought>,
        cancel: &Cancel,
    ) -> bool {
        if self.wanted.is_empty() {
            return true;
        }
        timed(timing::Part::Camera, || sampler.take(&self.wanted, &mut self.samples, &mut self.weights));
        let mut start = 0;
        for &end in &self.ends {
            let seen = self.weights[start..end].iter().filter(|&&weight| weight != 0.0).count();
            if seen > 0 {
                self.groups.push(seen as u32);
            }
            start = end;
        }
        self.radiance.resize(self.samples.len, Rgb::ZERO);
        self.worker.radiance_of_columns(&self.samples, &self.groups, &mut self.rows, cancel, &mut self.radiance);
        if cancel.is_raised() {
            return false;
        }
        timed(timing::Part::Film, || {
            let (mut radiance, mut wanted) = (self.radiance.iter(), self.weights.iter().zip(&self.wanted));
            for runs in self.runs.chunk_by(|a, b| a.tile == b.tile) {
                let mut tile = held(&tiles[runs[0].tile]);
                for &Run { cell, count, .. } in runs {
                    tile.add_run(cell, count, |tile| {
                        let Some((&weight, wanted)) = wanted.next() else { return Rgb::ZERO };
                        let seen = if weight == 0.0 { None } else { radiance.next() };
                        let seen = seen.copied().unwrap_or(Rgb::ZERO);
                        match light {
                            // A wavelength's color is negative in some channels.
                            None if self.signed => tile.weighted_with(cell, Rgb::ZERO, weight, seen * weight),
                            None => tile.weighted(cell, seen, weight),
                            Some(light) if self.signed => {
                                let brought = seen * weight + light.to(wanted.position, wanted.number);
                                tile.weighted_with(cell, Rgb::ZERO, weight, brought)
                            }
                            Some(light) => {
                                tile.weighted_with(cell, seen, weight, light.to(wanted.position, wanted.number))
                            }
                        }
                    });
                }
            }
        });
        self.clear();
        true
    }
}
