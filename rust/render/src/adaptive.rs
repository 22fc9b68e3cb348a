//! Adaptive sampling.

use super::bytes::{Malformed, Reader, Writer, check};
use super::denominators::{Denominators, cross};
use super::film::Film;
use super::sample_allocation::{Epoch, dither};
use raywright_base::parallel::{self, CHUNK};
use raywright_optics::Rgb;

/// Decides the number of samples of each pixel, so that most samples go to pixels with large error and no pixel is
/// biased.
///
/// Naive adaptive sampling gives a pixel more samples if its first ones vary and averages all of them. That is biased
/// (Kirk and Arvo, "Unbiased Sampling Techniques for Image Synthesis", 1991): a bright sample causes further samples
/// that dilute it, and its absence is not corrected, so rare bright events come out too dark. Here each pixel has two
/// halves, and *the samples of one half decide the number of samples of the other*. The values of a half do not affect
/// its own count, so its mean is unbiased, and so is the usual estimate of that mean's variance. The pixel is the plain
/// mean of both means. Weighting by counts would let a half's samples affect its weight.
///
/// The other half must not be correlated with its own count either. A half's count follows from *evidence* in the
/// other: a number of samples that is equal for all pixels, whatever was decided, at the start of each epoch. Samples
/// beyond the evidence only contribute to the mean.
///
/// An epoch ends when the samples of all pixels have doubled. At its start, each half is allotted its samples up to the
/// end. The error of a sum over pixels is least if counts are proportional to the square root of one sample's
/// contribution to it (Neyman, 1934), here to relMSE. That contribution is estimated from few samples and smoothed over
/// neighbors; without smoothing, as much is lost as is gained. A Cornell box with optimal counts would need 1.5 times
/// fewer samples than uniform sampling; this method needs 1.3 to 1.35 times fewer.
///
/// Pixels of a patch take their samples together, so they all have the same number, the mean of their individual ones.
///
/// A cell's number of samples depends only on the seed and on the mean number of samples, not on passes or threads.
#[derive(Clone, Debug)]
pub(super) struct Adaptive {
    epoch: Epoch,
    /// Samples of each cell that are evidence at the end of the epoch.
    evidence: u32,
}

impl Adaptive {
    /// Mean samples per pixel before the first decision.
    const FIRST: u32 = 16;

    /// Share of an epoch's samples that is evidence for the next.
    const EVIDENCE: f64 = 0.25;

    /// Maximum growth of a cell's samples in an epoch, by this factor or to this multiple of the mean, whatever the
    /// evidence.
    const GROWTH: f64 = 4.0;

    /// Lower bound of a pixel's weight, relative to the mean, because low variance may be luck.
    const LEAST: f64 = 0.01;

    /// Starts the first epoch of an empty film in halves.
    pub fn new(film: &mut Film) -> Self {
        let first = Self::FIRST.max(2 * film.batch());
        film.take_evidence(first / 2);
        let shares = film.tiles().iter().map(|tile| vec![[0, first / 2]; tile.counts().len()]).collect();
        Self { epoch: Epoch { from: 0, to: first, patch: film.patch(), shares }, evidence: first / 2 }
    }

    /// Mean samples per pixel that a film with `done` samples can reach in one pass.
    pub fn limit(&self, done: u32) -> u32 {
        let end = self.epoch.to;
        if done < end { end } else { end.saturating_mul(2) }
    }

    /// The current epoch.
    pub fn epoch(&self) -> &Epoch {
        &self.epoch
    }

    /// Begins the next epoch if the current one is over.
    pub fn prepare(&mut self, film: &mut Film) {
        if film.samples() == self.epoch.to {
            self.decide(film, |half| 1 - half);
        }
    }

    /// Writes the current epoch as bytes.
    pub fn write(&self, to: &mut Writer) {
        to.word(self.evidence);
        self.epoch.write(0..self.epoch.shares.len(), to);
    }

    /// Reads the epoch of a film that has been read. After an error, this plan is invalid.
    pub fn read(&mut self, film: &Film, from: &mut Reader) -> Result<(), Malformed> {
        self.evidence = from.word()?;
        self.epoch = Epoch::read(film.tiles().iter(), film.patch(), from)?;
        let Epoch { from: start, to, shares, .. } = &self.epoch;
        check((*start..=*to).contains(&film.samples()), "an epoch ends before it begins")?;
        check(self.evidence > 0 && self.evidence <= *to, "evidence is missing")?;
        let all: u64 = shares.iter().flatten().map(|&[_, end]| u64::from(end)).sum();
        // Bounds the length of a pass that malicious bytes may request. Cells are rounded to whole batches.
        let most = (u64::from(*to) + 2 * u64::from(film.batch())) * film.pixel_count() as u64;
        check(all <= most, "cells have more samples than were taken")
    }

    /// Begins an epoch. The half `decider(half)` decides for each half.
    fn decide(&mut self, film: &mut Film, decider: impl Fn(usize) -> usize) {
        let (from, to, patch) = (self.epoch.to, self.epoch.to.saturating_mul(2), self.epoch.patch);
        let batch = film.batch();
        let mean = f64::from(from / 2);
        let more = ((mean * Self::EVIDENCE).ceil() as u32).next_multiple_of(batch);
        let width = film.width() as usize;
        let mut shares: Vec<Vec<[u32; 2]>> =
            film.tiles().iter().map(|tile| tile.counts().iter().map(|&count| [count; 2]).collect()).collect();
        for half in 0..2 {
            let weights = weights(film, decider(half), self.evidence);
            let mut limits = vec![[0.0; 2]; weights.len()];
            for tile in film.tiles() {
                for (cell, (x, y)) in (half..).step_by(2).zip(tile.pixels()) {
                    let count = f64::from(tile.counts()[cell]);
                    limits[y as usize * width + x as usize] = [count + f64::from(more), Self::GROWTH * count.max(mean)];
                }
            }
            let level = level(&weights, &limits, f64::from(to / 2) * weights.len() as f64);
            for (tile, shares) in film.tiles().iter().zip(&mut shares) {
                for (cell, (x, y)) in (half..).step_by(2).zip(tile.pixels()) {
                    let pixel = y as usize * width + x as usize;
                    let [start, end] = &mut shares[cell];
                    let more = (level * weights[pixel]).clamp(limits[pixel][0], limits[pixel][1]) - f64::from(*start);
                    *end = *start + batch * (more / f64::from(batch) + dither((x, y), patch, half)) as u32;
                }
            }
        }
        film.take_evidence(more);
        *self = Self { epoch: Epoch { from, to, patch, shares }, evidence: self.evidence + more };
    }
}

/// Relative number of samples that each pixel should have, from this number of samples of one half.
fn weights(film: &Film, half: usize, samples: u32) -> Vec<f64> {
    let (width, count) = (film.width() as usize, f64::from(samples));
    let evidence = film.evidence(half);
    let means = parallel::collect(evidence.len(), |pixel| evidence[pixel].0 / count);
    let errors = parallel::collect(evidence.len(), |pixel| {
        let (sum, squares) = evidence[pixel];
        // For independent samples; otherwise the variance is wrong, but a fair guide.
        let variance = ((squares - sum * sum / count) / (count * (count - 1.0))).at_least(Rgb::ZERO);
        let cross = cross(&means, width, pixel % width, pixel / width);
        variance.dot(Denominators::new(&cross, variance, count).inverse)
    });
    let mut weights = in_patches(smoothed(&errors, width), width, film.patch() as usize);
    parallel::each_chunk_mut(&mut weights, CHUNK, &|_, some| {
        some.iter_mut().for_each(|weight| *weight = weight.sqrt())
    });
    let mean = ordered_sum(weights.len(), |i| weights[i]) / weights.len() as f64;
    let known = |weight: f64| if mean > 0.0 { weight + Adaptive::LEAST * mean } else { 1.0 };
    parallel::each_chunk_mut(&mut weights, CHUNK, &|_, some| {
        some.iter_mut().for_each(|weight| *weight = known(*weight))
    });
    weights
}

/// Smooths values over two pixels in each direction, by the weights 1, 4, 6, 4, 1 along both axes.
fn smoothed(values: &[f64], width: usize) -> Vec<f64> {
    const KERNEL: [f64; 5] = [0.0625, 0.25, 0.375, 0.25, 0.0625];
    let height = values.len() / width.max(1);
    // At borders the outermost value is repeated.
    let at = |i: usize, k: usize, size: usize| (i + k).saturating_sub(2).min(size - 1);
    let across: Vec<f64> = parallel::collect(values.len(), |i| {
        (0..5).map(|k| KERNEL[k] * values[i - i % width + at(i % width, k, width)]).sum()
    });
    parallel::collect(values.len(), |i| {
        (0..5).map(|k| KERNEL[k] * across[at(i / width, k, height) * width + i % width]).sum()
    })
}

/// Mean over each patch with `patch` values per side, at every position in it.
fn in_patches(mut values: Vec<f64>, width: usize, patch: usize) -> Vec<f64> {
    if patch > 1 && width > 0 {
        parallel::each_chunk_mut(&mut values, patch * width, &|_, band| {
            for left in (0..width).step_by(patch) {
                let columns = left..width.min(left + patch);
                let mut sum = 0.0;
                for row in band.chunks(width) {
                    sum += row[columns.clone()].iter().sum::<f64>();
                }
                let mean = sum / (columns.len() * (band.len() / width)) as f64;
                band.chunks_mut(width).for_each(|row| row[columns.clone()].fill(mean));
            }
        });
    }
    values
}

/// Finds the factor by which the weights, clamped to their limits, sum to `total`.
fn level(weights: &[f64], limits: &[[f64; 2]], total: f64) -> f64 {
    let sum = |level: f64| ordered_sum(weights.len(), |i| (level * weights[i]).clamp(limits[i][0], limits[i][1]));
    let mut low = total / ordered_sum(weights.len(), |i| weights[i]);
    let mut high = low;
    // Bounded, in case no factor gives the total within the limits.
    for _ in 0..64 {
        if sum(low) <= total {
            break;
        }
        low /= 2.0;
    }
    for _ in 0..64 {
        if sum(high) >= total {
            break;
        }
        high *= 2.0;
    }
    for _ in 0..32 {
        let middle = (low + high) / 2.0;
        if sum(middle) < total {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Sums terms on all cores, in an order that depends only on their number.
fn ordered_sum(count: usize, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    const TOGETHER: usize = 4096;
    let parts = parallel::map_chunks(count, TOGETHER, |part| part.map(&term).sum::<f64>());
    parts.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::sampling::Sampler;

    /// A film of samples that are mostly 1 and rarely `1 / chance` more, with counts decided by the half
    /// `decider(half)`.
    fn film(seed: u64, chance: f64, samples: u32, batch: u32, decider: fn(usize) -> usize) -> Film {
        let mut film = Film::new(8, 8, 4, batch, true, None);
        let mut plan = Adaptive::new(&mut film);
        while film.samples() < samples {
            if film.samples() == plan.epoch.to {
                plan.decide(&mut film, decider);
            }
            let goal = samples.min(plan.epoch.to);
            for (i, tile) in film.extend_to(goal).iter_mut().enumerate() {
                for cell in 0..tile.counts().len() {
                    let (x, y) = tile.position(cell);
                    for nth in tile.counts()[cell]..plan.epoch.goal(i, cell, (x, y), goal) {
                        let number = tile.number(cell, nth);
                        let rare = Sampler::new(seed, y * 8 + x, number).one(0) < chance;
                        tile.add(cell, Rgb::splat(1.0 + f64::from(rare) / chance), 1.0);
                    }
                }
            }
        }
        film
    }

    /// Deviation of the mean over seeds in standard errors, and the mean.
    fn deviation(seeds: u64, batch: u32, decider: fn(usize) -> usize) -> (f64, f64) {
        let brightness = |seed| film(seed, 0.01, 64, batch, decider).means().iter().map(|m| m[0]).sum::<f64>() / 64.0;
        let means = parallel::map(seeds as usize, |seed| brightness(seed as u64));
        let count = seeds as f64;
        let mean = means.iter().sum::<f64>() / count;
        let variance = means.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0) / count;
        ((mean - 2.0) / variance.sqrt(), mean)
    }

    #[test]
    fn no_mean_is_biased_by_decisions_of_the_other_half() {
        // The probability of exceeding four standard errors is 1 in 16,000. One sample in a hundred carries half of the
        // light.
        for batch in [1, 4] {
            let (off, mean) = deviation(1000, batch, |half| 1 - half);
            assert!(off.abs() < 4.0, "{mean}: off by {off} standard errors");
        }
    }

    #[test]
    fn that_test_finds_the_bias_of_deciding_from_what_is_averaged() {
        let (off, mean) = deviation(1000, 1, |half| half);
        assert!(off < -20.0 && mean < 1.9, "{mean}: off by {off} standard errors");
    }

    #[test]
    fn variances_are_unbiased_too() {
        let films: Vec<Film> = parallel::map(1000, |seed| film(seed as u64, 0.1, 64, 1, |half| 1 - half));
        // Ten values for the error of a ratio of sums over all pixels.
        let ratios: Vec<f64> = films
            .chunks(100)
            .map(|films| {
                let told: f64 = films.iter().flat_map(|f| f.variances().unwrap()).map(|v| v[0]).sum();
                let squares: f64 = films.iter().flat_map(Film::means).map(|m| (m[0] - 2.0).powi(2)).sum();
                told / squares
            })
            .collect();
        let mean = ratios.iter().sum::<f64>() / 10.0;
        let error = (ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / 90.0).sqrt();
        // Student's t with nine degrees of freedom exceeds 4.3 with probability 1 in 500.
        assert!((mean - 1.0).abs() < 4.3 * error && error < 0.02, "{mean} ± {error}");
    }

    /// Exposes a film of brightness 1 with noise `noise(x)` per column.
    fn columns(samples: u32, batch: u32, noise: impl Fn(u32) -> f64) -> Film {
        let mut film = Film::new(32, 32, 16, batch, true, None);
        let mut plan = Adaptive::new(&mut film);
        while film.samples() < samples {
            plan.prepare(&mut film);
            let goal = samples.min(plan.limit(film.samples()));
            for (i, tile) in film.extend_to(goal).iter_mut().enumerate() {
                for cell in 0..tile.counts().len() {
                    let (x, y) = tile.position(cell);
                    for nth in tile.counts()[cell]..plan.epoch.goal(i, cell, (x, y), goal) {
                        let number = tile.number(cell, nth);
                        let draw = 2.0 * Sampler::new(5, y * 32 + x, number).one(0) - 1.0;
                        tile.add(cell, Rgb::splat(1.0 + noise(x) * draw), 1.0);
                    }
                }
            }
        }
        film
    }

    #[test]
    fn samples_go_by_the_root_of_what_they_bring() {
        // Four times the deviation on one side requires four times the samples there.
        let film = columns(256, 1, |x| if x < 16 { 0.8 } else { 0.2 });
        let counts = film.counts();
        let mean = |columns: std::ops::Range<usize>| {
            let all: Vec<f64> =
                counts.chunks(32).flat_map(|row| row[columns.clone()].to_vec()).map(f64::from).collect();
            all.iter().sum::<f64>() / all.len() as f64
        };
        // Evidence is uniform: a quarter of the samples and the first sixteen, so quiet columns have slightly more.
        let (many, few) = (mean(0..12), mean(20..32));
        assert!((3.0..4.5).contains(&(many / few)), "{many} and {few}");
        assert!((mean(0..32) / 256.0 - 1.0).abs() < 0.01);
    }

    #[test]
    fn pictures_without_noise_get_the_same_everywhere() {
        assert!(columns(64, 1, |_| 0.0).counts().iter().all(|&count| count == 64));
    }

    #[test]
    fn batches_are_whole_at_the_end_of_an_epoch() {
        for batch in [4, 16] {
            let film = columns(128, batch, |x| f64::from(x) / 32.0);
            assert!(film.tiles().iter().all(|tile| tile.counts().iter().all(|n| n.is_multiple_of(batch))));
            let all: u32 = film.counts().iter().sum();
            assert!((f64::from(all) / 1024.0 / 128.0 - 1.0).abs() < 0.02);
        }
    }

    proptest! {
        #[test]
        fn levels_give_the_total(seed in 0u64..1000, total in 0.0..1.0f64) {
            let draw = |i: u32| Sampler::new(seed, 0, i).one(0);
            let weights: Vec<f64> = (0..200).map(|i| draw(i).powi(4) + 1e-4).collect();
            let limits: Vec<[f64; 2]> = (0..200).map(|i| [10.0 * draw(i + 200), 10.0 + 50.0 * draw(i + 400)]).collect();
            let (least, most) = (limits.iter().map(|l| l[0]).sum::<f64>(), limits.iter().map(|l| l[1]).sum::<f64>());
            let total = least + total * (most - least);
            let level = level(&weights, &limits, total);
            let sum: f64 = weights.iter().zip(&limits).map(|(w, l)| (level * w).clamp(l[0], l[1])).sum();
            prop_assert!((sum / total - 1.0).abs() < 1e-3, "{} not {}", sum, total);
        }
    }
}
