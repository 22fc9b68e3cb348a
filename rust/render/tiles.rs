//! Work on a pass: samples of all pixels, tile by tile over the threads.

use super::filter::Filter;
use super::{Film, FilmTile, Settings};
use crate::integrators::{CameraSample, Integrator, Worker};
use crate::optics::Rgb;
use crate::sampling::SamplerKind;
use crate::scene::{Camera, Scene};
use crate::workers::Cancel;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Paths advanced together at most: enough to keep the accelerator's kernels full, few enough to stay in cache.
const BATCH: usize = 4096;

/// A picture being taken: everything that stays the same from pass to pass.
pub(super) struct Exposure<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    pub integrator: &'a dyn Integrator,
    pub sampler: SamplerKind,
    pub filter: &'a dyn Filter,
    pub seed: u64,
    /// Whether samples are spread over the time that the shutter is open.
    moves: bool,
    /// Workers that no thread is using: their memory is used again.
    idle: Mutex<Vec<Bench<'a>>>,
}

/// What a thread works with.
struct Bench<'a> {
    worker: Box<dyn Worker + 'a>,
    samples: Vec<CameraSample>,
    /// What each sample counts by the filter.
    weights: Vec<f64>,
    radiance: Vec<Rgb>,
}

impl<'a> Exposure<'a> {
    pub fn new(scene: &'a Scene, camera: &'a Camera, integrator: &'a dyn Integrator, settings: &'a Settings) -> Self {
        let (sampler, filter, seed) = (settings.sampler, settings.filter.as_ref(), settings.seed);
        let moves = scene.geometry().moves();
        Self { scene, camera, integrator, sampler, filter, seed, moves, idle: Mutex::default() }
    }

    /// The side of tiles for a number of threads: 16, or less where that would leave threads without work.
    pub fn tile_side(&self, threads: usize) -> u32 {
        let tiles =
            |side: u32| self.camera.width().div_ceil(side) as usize * self.camera.height().div_ceil(side) as usize;
        [16, 8, 4].into_iter().find(|&side| tiles(side) >= 8 * threads).unwrap_or(2)
    }

    /// Adds the samples of these numbers to all pixels. Returns soon after `cancel` is raised, leaving a film of no use.
    pub fn expose(&self, film: &mut Film, numbers: Range<u32>, cancel: &Cancel) {
        film.extend(numbers.len() as u32).par_iter_mut().with_max_len(1).for_each(|tile| {
            if !cancel.is_raised() {
                let mut bench = self.take_bench();
                self.expose_tile(tile, numbers.clone(), &mut bench, cancel);
                self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(bench);
            }
        });
    }

    fn take_bench(&self) -> Bench<'a> {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        idle.unwrap_or_else(|| Bench {
            worker: self.integrator.worker(self.scene),
            samples: Vec::new(),
            weights: Vec::new(),
            radiance: Vec::new(),
        })
    }

    fn expose_tile(&self, tile: &mut FilmTile, numbers: Range<u32>, bench: &mut Bench, cancel: &Cancel) {
        let together = (BATCH / tile.pixels().count()).max(1);
        for first in numbers.clone().step_by(together) {
            if cancel.is_raised() {
                return;
            }
            let numbers = first..numbers.end.min(first + together as u32);
            bench.samples.clear();
            bench.weights.clear();
            for (x, y) in tile.pixels() {
                for number in numbers.clone() {
                    let (sample, weight) = self.camera_sample(x, y, number);
                    bench.samples.push(sample);
                    bench.weights.push(weight);
                }
            }
            bench.radiance.resize(bench.samples.len(), Rgb::ZERO);
            bench.worker.radiance(&mut bench.samples, cancel, &mut bench.radiance);
            let each = bench.radiance.chunks(numbers.len()).zip(bench.weights.chunks(numbers.len()));
            for (pixel, (radiance, weights)) in each.enumerate() {
                for ((number, &radiance), &weight) in numbers.clone().zip(radiance).zip(weights) {
                    tile.add(pixel, number, radiance, weight);
                }
            }
        }
    }

    /// A sample of a pixel, placed by the filter, and what it counts. Where anything moves, it is uniform over the shutter's time too.
    fn camera_sample(&self, x: u32, y: u32, number: u32) -> (CameraSample, f64) {
        let mut sampler = self.sampler.sampler(self.seed, y * self.camera.width() + x, number);
        let ([right, down], weight) = self.filter.sample(sampler.two(0));
        // Offsets from the centre are added to the half first, so that those of the pixel's own square are exact.
        let mut ray = self.camera.ray(f64::from(x) + (0.5 + right), f64::from(y) + (0.5 + down));
        if self.moves {
            ray.time = sampler.one(3);
        }
        (CameraSample { ray, sampler }, weight)
    }
}
